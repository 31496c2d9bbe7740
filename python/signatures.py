"""Write what editors and `help()` show of the package: batten/__init__.pyi, batten/dask.pyi and batten/_signatures.py.

    python signatures.py INCLUDE_FOLDER PACKAGE_FOLDER MODULE OUTPUT_FOLDER

MODULE is the built `batten._native`. In place of ``**settings`` of each function marked by `takes`, signatures and docstrings
get the options of its structs: names and types from MODULE, defaults from its functions, texts from the headers' comments.
"""

import ast
import importlib.util
import math
import re
import sys
import textwrap
from pathlib import Path

HEAD = '''"""{text}"""

import datetime
import os
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import nan
from typing import Any, Literal, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self
'''


#: Functions of the package in the place of the library's.
PYTHON = {"bat_mesh_repair": ":meth:`Mesh.repair`", "bat_mesh_weld": ":meth:`Mesh.weld`", "bat_mesh_compare": ":func:`measure`",
          "bat_mesh_triangulate": ":meth:`PolygonMesh.triangulate`", "bat_mesh_limit_normals": ":meth:`Mesh.normals`",
          "bat_curve_refine": ":func:`refine`", "bat_curves_refine": ":func:`refine`"}  # fmt: skip
#: Options that mean something else in Python.
SPECIAL = {path: "of the learned scheme, which it chooses: 0, nearest to the data, to 1, smoothest."
           for path in [("scheme", "fairness"), ("refine", "scheme", "fairness")]}  # fmt: skip
#: Methods that nobody calls.
HIDDEN = {"__array_finalize__", "__dir__", "__reduce__", "__setattr__"}


def load(name, path):
    """Import a file as a module of the package, without the package."""
    spec = importlib.util.spec_from_file_location(name, path)
    sys.modules[name] = module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def comments(folder):
    """The comments of all fields of structs in the headers: {struct: {field: text}}."""
    found = {}
    field = re.compile(r"((?:[ \t]*///(?!<)[^\n]*\n)*)\s*([^;/]+?);[ \t]*((?:///<[^\n]*\n?\s*)*)")
    research = folder.parents[1] / "research" / "include" / "batten" / "research"
    for header in [*sorted(folder.glob("*.h")), research / "curve_analysis.h", research / "chart_picture.h"]:
        text = header.read_text()
        for name, body in re.findall(r"^(?:typedef )?struct (\w+)\n\{\n(.*?)^\}", text, flags=re.S | re.M):
            texts = found.setdefault(name, {})
            for before, declared, after in field.findall(body):
                names = re.search(r"(\w+)(?:\[\w+\])*$", declared.strip())
                if names:
                    texts[names[1]] = " ".join(re.sub(r"///<?", "", before + after).split())
    return found


class Options:
    """The options of structs: annotations, defaults and texts for people."""

    def __init__(self, include, module, package):
        load("batten._native", module)
        self.module = load("batten._options", package / "_options.py")
        self.texts, self.names = comments(include / "batten"), {}
        ffi, lib = self.module.ffi, self.module.lib
        for kind in (name for group in ffi.list_types() for name in group):
            type, family = ffi.typeof(kind), self.module.family_of(kind)
            if type.kind == "enum" and family is not None:
                for name, value in type.relements.items():
                    self.names[name] = f'``"{ffi.string(lib.bat_choice_name(family, value)).decode()}"``'

    def of(self, kinds, own):
        """(name, annotation, default, type in words, text) of the options of structs, without names in `own`."""
        found = {}
        for kind in kinds:
            for name, field in self.module.fields(kind).items():
                if name not in own and name not in found:
                    found[name] = (*self.describe(field), self.text(kind, field.path))
        return [(name, *rest) for name, rest in found.items()]

    def describe(self, field):
        ffi, type, value = self.module.ffi, field.type, field.default
        family, named = self.module.family_of(type.cname.split()[-1]), self.module.default_name(field)
        if family is not None:
            names = self.module.names(family)
            listed = list(dict.fromkeys([named, *names]))
            words = "{" + ", ".join(f'"{name}"' for name in listed) + "}"
            literal = f"Literal[{', '.join(map(repr, listed))}]"
            more = type.kind == "struct"  # names with settings, as in "four-point:w=0.06"
            return (f"{literal} | str" if more else literal), repr(named), words + (" or one of these with settings" if more else "")
        if field.path[-1] in ("sigma",):
            return "float | Literal['auto']", repr(value), 'float or "auto"'
        if type.kind == "array":
            return "Sequence[int]", repr(list(value)), "pair of int"
        if type.kind == "pointer":
            return ("str | None", "None", "str") if type.item.cname == "char" else ("ArrayLike | None", "None", "array_like")
        word = {bool: "bool", int: "int", float: "float"}[value.__class__]
        return word, "nan" if isinstance(value, float) and math.isnan(value) else repr(value), word

    def text(self, kind, path):
        """The comment of a field, in the package's words."""
        struct = self.module.ffi.typeof(kind)
        for name in path[:-1]:
            struct = dict(struct.fields)[name].type
        text = SPECIAL.get(path) or self.texts.get(struct.cname.split()[-1], {}).get(path[-1], "")
        text = re.sub(r"\bBAT_\w+", self.constant, text.replace("BAT_MOTION_SIGMA_AUTO", '``"auto"``'))
        text = re.sub(r"\bbat_\w+::(\w+)", r"`\1`", text)
        text = re.sub(r"\bbat_\w+\(\)", lambda found: PYTHON.get(found[0][:-2], f"``{found[0]}``"), text)
        text = re.sub(r"\b[Nn]ull\b", "None", text)
        text = re.sub(r"(?:[;,]|(?<=\.))?\s*\b[Dd]efault:? [^;.]*(?:\.\d+[^;.]*)?\.?$", "", text).strip()
        family = self.module.family_of(dict(struct.fields)[path[-1]].type.cname.split()[-1])
        if not text and family is not None:
            text = "the " + self.module.ffi.string(family.what).decode()
        return text[:1].upper() + text[1:] + ("" if not text or text.endswith(".") else ".")

    def constant(self, found):
        """A constant of the library in the package's words: a choice, a number, an exception."""
        number = getattr(self.module.lib, found[0], None)
        if found[0] in self.names or number is None:
            return self.names.get(found[0], found[0])
        error = "".join(part.capitalize() for part in found[0].split("_")[1:])
        return f":class:`{error}`" if found[0] in self.module.ffi.typeof("bat_status").relements else str(number)


def settings_of(function):
    """The structs of a function marked by `takes`; the functions whose options it has, marked by `like`."""
    for mark in function.decorator_list:
        if isinstance(mark, ast.Call) and getattr(mark.func, "id", "") in ("takes", "like"):
            return mark.func.id, [ast.literal_eval(argument) for argument in mark.args]
    return None


def expand(function, rows):
    """Put options in the place of ``**settings``."""
    arguments = function.args
    if arguments.kwarg is None:
        return
    arguments.kwarg = None
    for name, annotation, default, *_ in rows:
        arguments.kwonlyargs.append(ast.arg(name, ast.parse(annotation, mode="eval").body))
        arguments.kw_defaults.append(ast.parse(default, mode="eval").body)


def documented(text, rows):
    """A docstring with entries for options in the place of ``**settings``."""
    entries = []
    for name, _, default, words, about in rows:
        entries.append(f"{name} : {words}, default {default}")
        entries += textwrap.wrap(about, 100, initial_indent="    ", subsequent_indent="    ")
    lines = text.splitlines()
    at = next((i for i, line in enumerate(lines) if line.strip() == "**settings"), None)
    if at is None:
        return "\n".join([text.rstrip(), "", "Parameters", "----------", *entries, ""])
    end = at + 1
    while end < len(lines) and lines[end].startswith("    "):
        end += 1
    return "\n".join(lines[:at] + entries + lines[end:])


class Writer:
    def __init__(self, options, package):
        self.options, self.package = options, package
        self.runtime = []  # (qualified name, function)
        self.trees = {path.stem: ast.parse(path.read_text()) for path in sorted(package.glob("*.py")) if path.stem != "_signatures"}
        self.found = {}  # top-level statements by name
        for name, tree in self.trees.items():
            if name != "dask":
                for node in tree.body:
                    if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                        self.found.setdefault(node.name, []).append(node)
        self.keywords = {}
        for nodes in self.found.values():  # overloads have the options of what is behind them
            for node in nodes[:-1]:
                node.decorator_list += [mark for mark in nodes[-1].decorator_list if isinstance(mark, ast.Call)]

    def rows(self, function):
        marked = settings_of(function)
        if marked is None:
            return None
        own = {argument.arg for argument in (*function.args.args, *function.args.posonlyargs, *function.args.kwonlyargs)}
        if marked[0] == "takes":
            return self.options.of(marked[1], own)
        rows = []
        for name in marked[1]:
            rows += [row for row in self.keywords[name] if row[0] not in own]
        return rows

    def function(self, node, qualified, document=None, rows=None):
        """A function as a stub; its options are kept for the module that sets them when the package is imported."""
        rows = self.rows(node) or rows
        text = ast.get_docstring(node)
        stub = ast.FunctionDef(node.name, node.args, [ast.Expr(ast.Constant(...))], [], node.returns, lineno=0)
        names = [getattr(mark, "id", "") for mark in node.decorator_list]
        stub.decorator_list = [mark for mark in node.decorator_list
                               if getattr(mark, "id", "") in ("overload", "property", "classmethod", "staticmethod")]  # fmt: skip
        if rows is not None:
            defaults = [None] * (len(node.args.kwonlyargs) - len(node.args.kw_defaults)) + node.args.kw_defaults
            own = [(a.arg, ast.unparse(a.annotation), ast.unparse(d)) for a, d in zip(node.args.kwonlyargs, defaults) if d is not None]
            expand(node, rows)
            if "overload" not in names:
                self.keywords[qualified] = [(*row, "", "") for row in own] + rows
                self.runtime.append((qualified, node, documented(text or "", rows) if document is None else document))
                text = documented(text, rows) if text else text
        if text and "overload" not in names:
            stub.body = [ast.Expr(ast.Constant(indented(text, 1 + ("." in qualified))))]
        return stub

    def stub(self, node):
        """A public class or function as a stub."""
        if isinstance(node, ast.FunctionDef):
            return self.function(node, node.name)
        body = []
        for item in node.body:
            if isinstance(item, ast.AnnAssign) and not item.target.id.startswith("_"):
                body.append(ast.AnnAssign(item.target, item.annotation, None, 1))
            elif isinstance(item, ast.FunctionDef) and (
                    item.name.startswith(("__", "_repr_")) and item.name not in HIDDEN or not item.name.startswith("_")):
                made = self.function(item, f"{node.name}.{item.name}", "" if item.name == "__init__" else None)
                body.append(made)
                if item.name == "__init__" and settings_of(item):
                    rows = self.keywords[f"{node.name}.__init__"]
                    own = {a.arg for a in item.args.kwonlyargs} - {row[0] for row in rows if row[3]}
                    text = documented(ast.get_docstring(node), [row for row in rows if row[0] not in own and row[3]])
                    self.runtime.append((node.name, None, text))
                    node.body[0] = ast.Expr(ast.Constant(indented(text, 1)))
        if ast.get_docstring(node):
            body.insert(0, ast.Expr(ast.Constant(indented(ast.get_docstring(node), 1))))
        body = without_bodies(body)
        return ast.ClassDef(node.name, node.bases, node.keywords, body or [ast.Expr(ast.Constant(...))], [], lineno=0)


def without_bodies(nodes):
    """Statements without the functions behind overloads, whose docstrings the first of these gets."""
    first, made = {}, []
    for node in nodes:
        if isinstance(node, ast.FunctionDef) and any(getattr(mark, "id", "") == "overload" for mark in node.decorator_list):
            first.setdefault(node.name, node)
        elif isinstance(node, ast.FunctionDef) and node.name in first:
            first[node.name].body = node.body
            continue
        made.append(node)
    return made


def indented(text, depth):
    """A docstring as it stands in a file."""
    lines = text.rstrip().split("\n")
    blank = "    " * depth
    return "\n".join([lines[0], *(blank + line if line else "" for line in lines[1:])]) + (f"\n{blank}" if len(lines) > 1 else "")


def exported(tree):
    for node in tree.body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            return ast.literal_eval(node.value)
    return []


def aliases(tree):
    """Names of types that a module defines."""
    return [node for node in tree.body if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
            and re.fullmatch(r"_?[A-Z]\w*[a-z]\w*", node.targets[0].id) and isinstance(node.value, (ast.Subscript, ast.BinOp, ast.Call))]  # fmt: skip


def main():
    include, package, module, out = map(Path, sys.argv[1:])
    writer = Writer(Options(include, module, package), package)
    names = exported(writer.trees["__init__"])
    parts = [part for name in ("_core", "curves", "meshes", "maps", "motions", "surfaces", "spaces") for part in aliases(writer.trees[name])]
    wanted, order = list(names), []
    for name in wanted:
        for node in writer.found[name]:
            if isinstance(node, ast.ClassDef):
                wanted += [base.id for base in node.bases if isinstance(base, ast.Name) and base.id in writer.found and base.id not in wanted]
    for name in writer.found:
        if name in wanted:
            order += writer.found[name]
    order.sort(key=lambda node: not isinstance(node, ast.ClassDef))
    stubs = without_bodies([writer.stub(node) for node in order])
    version = ast.parse("__version__: str\n__all__ = " + repr(names)).body
    write(out / "__init__.pyi", ast.get_docstring(writer.trees["__init__"]), "", parts + version + stubs)

    main_runtime, writer.runtime = writer.runtime, []
    dask = writer.trees["dask"]
    kept = [node for node in dask.body if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")]
    version = ast.parse("__all__ = " + repr(exported(dask))).body
    more = "from batten import Floats, Progress, Motion, Report, Space, Times\n"
    write(out / "dask.pyi", ast.get_docstring(dask), more, version + [writer.function(node, node.name) for node in kept])
    lines = ['"""Signatures and docstrings of functions whose options are those of structs. Written by signatures.py."""',
             "", "from __future__ import annotations", "", "from math import nan", "", ""]  # fmt: skip
    for table, runtime in (("BATTEN", main_runtime), ("DASK", writer.runtime)):
        entries = []
        for place, node, text in runtime:
            alias = "None"
            if node is not None:
                alias = f"{table.lower()}_{place.replace('.', '_')}"
                bare = ast.FunctionDef(alias, node.args, [ast.Pass()], [], node.returns, lineno=0)
                lines += [ast.unparse(ast.fix_missing_locations(bare)), ""]
            entries.append(f"    {place!r}: ({alias}, {text!r}),")
        lines += [f"{table} = {{", *entries, "}", ""]
    (out / "_signatures.py").write_text("\n".join(lines))


def write(path, text, more, nodes):
    tree = ast.fix_missing_locations(ast.Module(nodes, []))
    path.write_text(HEAD.format(text=text) + more + "\n" + ast.unparse(tree) + "\n")


if __name__ == "__main__":
    main()

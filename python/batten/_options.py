"""Structs of options of the library as keyword arguments: names, types, defaults, and their texts.

The build reads this module, too, to write signatures; so it needs no package beside cffi's runtime.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

from batten._native import ffi as ffi, lib as lib

F = TypeVar("F", bound=Callable[..., Any])

#: Fields of options that functions of the package set, or that nobody can.
_OURS = {"progress", "report", "context", "model", "rule", "given", "distance", "limit_normals", "vertex_normals", "notes", "repairs",
         "polygons", "errors", "point_count"}  # fmt: skip
#: Fields of a struct that a text describes as a whole, which can be set beside the text.
_BESIDE = {"fairness"}
#: Keyword-only arguments of the functions that take a struct of options, for messages.
_beside: dict[str, set[str]] = {}


class Field(NamedTuple):
    """An option: its path in structs, its type in C, and its default value there."""

    path: tuple[str, ...]
    type: Any
    default: Any


@functools.cache
def fields(kind: str) -> dict[str, Field]:
    """The options of a struct in its order, with those of structs inside; outer ones come before inner ones of the same
    name."""
    defaults = ffi.new(f"{kind} *", getattr(lib, kind.removesuffix("_options") + "_defaults")())
    found: dict[str, Field] = {}

    def visit(struct: Any, kind: Any, path: tuple[str, ...], chosen: Any) -> None:
        for name, field in kind.fields:
            inside, type = (*path, name), field.type
            if name in _OURS or (name == "points" and type.kind == "pointer") or (chosen is not None and name not in chosen):
                continue
            value = getattr(struct, name) if chosen is None else _learned(name)
            whole = type.kind != "struct" or parser(type) is not None
            if whole and (name not in found or len(found[name].path) > len(inside)):
                found[name] = Field(inside, type, value)
            if type.kind == "struct":
                visit(value, type, inside, _BESIDE if whole else None)

    visit(defaults, ffi.typeof(kind), (), None)
    return found


def _learned(setting: str) -> float:
    """The default of a setting of the learned scheme of curves."""
    row = ffi.new("bat_choice **")
    lib.bat_choice_find(family_of("bat_curve_scheme"), b"learned", row, ffi.NULL)
    return float(dict(part.split("=") for part in ffi.string(row[0].settings).decode().split(","))[setting])


def parser(kind: Any) -> Any:
    """The function that reads a value of a type from a text; None where there is none."""
    return getattr(lib, kind.cname.split()[-1] + "_by_name", None)


@functools.cache
def family_of(name: str) -> Any:
    """The table of a type of the library, or of a subject such as ``"bat_space"``; None where there is none."""
    table = getattr(lib, f"{name}_family", None)
    return None if table is None else ffi.new("bat_family *", table)


def names(family: Any) -> list[str]:
    """The names in a table."""
    found: list[str] = []
    while (row := lib.bat_choices(family, len(found))) != ffi.NULL:
        found.append(ffi.string(row.name).decode())
    return found


def default_name(field: Field) -> str | None:
    """The name of the default of an option that is a choice."""
    if field.type.kind == "struct":
        return "auto"
    family = family_of(field.type.cname.split()[-1])
    return None if family is None else ffi.string(lib.bat_choice_name(family, field.default)).decode()


def takes(*kinds: str) -> Callable[[F], F]:
    """Mark a function whose ``**settings`` are options of structs: the build gives it their names, defaults and texts."""

    def mark(function: F) -> F:
        code: Any = function.__code__  # type: ignore[attr-defined]
        for kind in kinds:
            names = code.co_varnames[: code.co_argcount + code.co_kwonlyargcount]
            _beside.setdefault(kind, set()).update(names[code.co_posonlyargcount :])
        return function

    return mark


def like(name: str) -> Callable[[F], F]:
    """Mark a function that hands its ``**settings`` to another one of the package."""
    return lambda function: function


def show_signatures(table: str, names: dict[str, Any]) -> None:
    """Give functions whose options are those of structs the signatures and docstrings that the build wrote."""
    import inspect

    from batten import _signatures

    for place, (shown, text) in getattr(_signatures, table).items():
        found = functools.reduce(getattr, place.split(".")[1:], names[place.split(".")[0]])
        function = getattr(found, "__func__", found)
        if shown is not None:
            function.__signature__ = inspect.signature(shown)
        if text:
            function.__doc__ = text


def unknown(kind: str, name: str) -> str:
    """A message about a name that is no option of a struct."""
    known = set(fields(kind)) | _beside.get(kind, set()) - {"self"}
    return f"unknown option '{name}'; {hint(name, known)}"


def no_choice(subject: str, name: str) -> str | None:
    """A message about a text that names no row of a table; None where it names one, or there is no table."""
    if (family := family_of(subject)) is None:
        return None
    known, first = names(family), name.partition(":")[0]
    if first in known:
        return None
    return f"there is no {ffi.string(family.what).decode()} '{name}'; {hint(first, set(known))}"


def hint(name: str, known: set[str]) -> str:
    """What a name that is not known may have meant."""
    import difflib

    near = difflib.get_close_matches(name, sorted(known), 1, 0.7)
    return f"did you mean {near[0]}?" if near else f"there are {', '.join(sorted(known))}"

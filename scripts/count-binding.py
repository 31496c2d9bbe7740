#!/usr/bin/env python3
"""Count the lines of binding code of the Python package for each public function.

Lines are those of code: no blank ones, comments and docstrings. Binding code is python/native.py, python/ragged.c and all of
python/batten. Two numbers of functions are set against it: those of the C library that the package can call, and the
functions, methods, properties and constructors of the package that have a public name.
"""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FUNCTION = (ast.FunctionDef, ast.AsyncFunctionDef)


def code_lines(source: str) -> int:
    """The lines on which a statement of Python, other than a docstring, stands."""
    lines: set[int] = set()
    tree = ast.parse(source)
    texts = {
        id(node.body[0])
        for node in ast.walk(tree)
        if isinstance(node, (ast.Module, ast.ClassDef, *FUNCTION)) and ast.get_docstring(node, clean=False) is not None
    }
    blank = {i for i, line in enumerate(source.splitlines(), 1) if not line.strip() or line.strip().startswith("#")}
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt) and id(node) not in texts:
            first = [node.lineno] + [item.lineno for item in getattr(node, "decorator_list", [])]
            end = node.body[0].lineno - 1 if getattr(node, "body", None) else node.end_lineno or node.lineno
            lines.update(range(min(first), max(end, node.lineno) + 1))
    for node in ast.walk(tree):
        if id(node) in texts:
            lines.difference_update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    return len(lines - blank)


def c_lines(source: str) -> int:
    code = re.sub(r"//[^\n]*|/\*.*?\*/", "", source, flags=re.S)
    return sum(bool(line.strip()) for line in code.splitlines())


def public_functions(source: str) -> int:
    """Functions and methods whose names, and those of their class, do not begin with an underscore; and special methods."""
    count = 0
    for node in ast.parse(source).body:
        if isinstance(node, FUNCTION):
            count += not node.name.startswith("_")
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            count += sum(isinstance(item, FUNCTION) and (not item.name.startswith("_") or item.name.startswith("__") or "_repr_" in item.name)
                         for item in node.body)  # fmt: skip
    return count


def main() -> None:
    modules = [path for path in sorted((ROOT / "python/batten").glob("*.py"))]
    lines = {path.name: code_lines(path.read_text()) for path in [*modules, ROOT / "python/native.py"]}
    lines["ragged.c"] = c_lines((ROOT / "python/ragged.c").read_text())
    total = sum(lines.values())
    headers = "".join(path.read_text() for path in (ROOT / "include/batten").glob("*.h"))
    library = len(re.findall(r"^BAT_API\b", headers, flags=re.M))
    package = sum(public_functions(path.read_text()) for path in modules if path.name != "_core.py")
    print(", ".join(f"{name} {count}" for name, count in lines.items()))
    print(f"{total} lines: {total / library:.1f} for each of {library} functions of the library, "
          f"{total / package:.1f} for each of {package} functions of the package")  # fmt: skip


if __name__ == "__main__":
    main()

"""What every call needs: errors, options by keyword, arrays without copies, progress, pictures."""

from __future__ import annotations

import functools
import math
import os
import tempfile
import threading
import weakref
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Threads that wait spin for microseconds, not milliseconds that others could use. OpenMP's runtime reads this once.
_waiting = {"GOMP_SPINCOUNT": "1000", "KMP_BLOCKTIME": "0"}
_waiting = {} if {"OMP_WAIT_POLICY", *_waiting} & os.environ.keys() else _waiting
os.environ.update(_waiting)
from batten._options import (F, family_of as family_of, default_name, ffi as ffi, fields, hint as hint, lib as lib, like as like, no_choice as no_choice, parser,
                             show_signatures as show_signatures, takes as takes, unknown)  # fmt: skip  # noqa: E402

for _name in _waiting:
    del os.environ[_name]

Floats = NDArray[np.float64]
Rows = ArrayLike | Sequence[object]  # checkers of types take [[0, 0.5], [1, 2]] for a list of objects
Progress = bool | Callable[[float], object]

#: What a thread that is inside the library keeps: who shows its progress, and an exception raised by a callback.
_thread = threading.local()


class BattenError(Exception):
    """A call of the library failed.

    Attributes
    ----------
    status : str
        The kind of failure, such as ``"invalid point"``.
    index : int or None
        The point, face or other item at fault, counted from 0.
    curve : int or None
        Of several curves, the one at fault.
    line : int or None
        The line of the file at fault, counted from 1.
    option : str or None
        The argument at fault.
    remedy : str or None
        The argument that leads out, or the method, as in ``"Mesh.repair"``.
    """

    status: str = ""
    index: int | None = None
    curve: int | None = None
    line: int | None = None
    option: str | None = None
    remedy: str | None = None


class BattenWarning(UserWarning):
    """What the library assumed, changed, or could not do in a result that is otherwise good."""


class InvalidArgument(BattenError, ValueError):
    """An option is out of range, or two contradict each other."""


class InvalidPoint(BattenError, ValueError):
    """A point is not in its space, not finite, or repeats its neighbour."""


class CutLocus(BattenError, ValueError):
    """Two neighbours have no unique shortest geodesic."""


class Unsupported(BattenError, ValueError):
    """A combination of arguments without a meaning."""


class NoConvergence(BattenError, ValueError):
    """An iteration did not converge, or a scheme has no limit."""


class TooLarge(BattenError, ValueError):
    """The result would be larger than the memory or the limit."""


class OutOfMemory(BattenError, MemoryError):
    """An allocation failed."""


class BadFile(BattenError, ValueError):
    """The content of a file is wrong."""


class FileAccess(BattenError, OSError):
    """A file cannot be opened, read or written."""


class NotManifold(BattenError, ValueError):
    """The faces of a mesh do not form a manifold."""


#: An exception for each status.
_ERRORS: dict[int, type[BattenError]] = {
    lib.BAT_INVALID_ARGUMENT: InvalidArgument,
    lib.BAT_INVALID_POINT: InvalidPoint,
    lib.BAT_CUT_LOCUS: CutLocus,
    lib.BAT_UNSUPPORTED: Unsupported,
    lib.BAT_NO_CONVERGENCE: NoConvergence,
    lib.BAT_TOO_LARGE: TooLarge,
    lib.BAT_NO_MEMORY: OutOfMemory,
    lib.BAT_BAD_FILE: BadFile,
    lib.BAT_FILE_ACCESS: FileAccess,
    lib.BAT_NOT_MANIFOLD: NotManifold,
}
_ERROR = ffi.typeof("bat_error *")
#: Methods in the place of options that a function has not.
_METHODS = {"repair": "Mesh.repair"}
NO_INDEX = int(ffi.cast("size_t", -1))


def call(function: Callable[..., int], *arguments: Any) -> None:
    """Call a function of the library, whose last parameter is an error, and raise what went wrong."""
    error = ffi.new(_ERROR)
    _thread.raised = None
    status = function(*arguments, error)
    if status == 0:
        return
    if _thread.raised is not None:
        raise _thread.raised
    text, option, remedy, effect = (
        ffi.string(part).decode(errors="replace") for part in (error.text, error.option, error.remedy, error.remedy_effect)
    )
    text, remedy = _argument(option) + text[len(option) :], _argument(remedy)
    method = _METHODS.get(remedy)
    method = None if method and any(remedy in _known(argument) for argument in arguments) else method
    if remedy:
        text += f"; Mesh.of(mesh).{remedy}() {effect}" if method else f"; {remedy}= {effect}"
    curve = None if error.curve == NO_INDEX else int(error.curve)
    exception = _ERRORS.get(status, BattenError)(text if curve is None else f"curve {curve}: {text}")
    exception.status, exception.curve = ffi.string(lib.bat_status_name(status)).decode(), curve
    exception.index = None if error.index == NO_INDEX else error.index
    exception.line = error.line or None
    exception.option, exception.remedy = _argument(option) or None, method or remedy or None
    raise exception


def call_on_file(function: Callable[..., int], path: str | os.PathLike[str], *arguments: Any) -> None:
    """Call a function that takes the path of a file first. Errors name the file, and the line where there is one."""
    try:
        call(function, os.fsencode(path), *arguments)
    except BattenError as error:
        if error.option is None:
            error.args = (f"{os.fsdecode(path)}{f':{error.line}' if error.line else ''}: {error}",)
        raise


def call_named(function: Callable[..., int], name: str, *arguments: Any) -> None:
    """Call a function that takes the name of a row of a table first, whose subject is that of the function."""
    try:
        call(function, name.encode(), *arguments)
    except BattenError as error:
        if text := no_choice(ffi.typeof(arguments[-1]).item.cname.split()[-1], name):
            error.args = (text,)
        raise


def _known(argument: Any) -> Any:
    """The names of options in an argument of a function of the library."""
    kind = ffi.typeof(argument).cname if isinstance(argument, ffi.CData) else ""
    return fields(kind.removesuffix(" *").removeprefix("struct ")) if kind.endswith("_options *") else ()


def _argument(field: str) -> str:
    """The argument that sets a field, which may be in a struct inside, as "rules.boundary"."""
    return field.rpartition(".")[2]


def keep_exception(_: Any, exception: BaseException, __: Any) -> None:
    """Remember an exception of a callback: the function of the library stops, and call() raises it."""
    _thread.raised = getattr(_thread, "raised", None) or exception


@ffi.def_extern(error=False, onerror=keep_exception)  # type: ignore[untyped-decorator]
def batten_report(_: Any, fraction: float) -> bool:
    show = getattr(_thread, "show", None)
    return show is None or show(fraction) is not False


def shown(progress: Progress, title: str) -> AbstractContextManager[None]:
    """Show the progress of the calls inside: by a function, or by tqdm where it is installed."""
    return _QUIET if progress is False else _showing(progress, title)


_QUIET = nullcontext()


@contextmanager
def _showing(progress: Progress, title: str) -> Iterator[None]:
    if not (progress is None or isinstance(progress, (bool, np.bool_)) or callable(progress)):
        raise TypeError(f"progress: True, False or a function is needed, not {progress!r}")
    if not progress:
        yield
        return
    bar = None
    show = progress if callable(progress) else None
    if show is None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            yield
            return
        bar = tqdm(total=1.0, desc=title, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}")
        show = lambda fraction: bar.update(fraction - bar.n) and None  # noqa: E731
    before, _thread.show = getattr(_thread, "show", None), show
    lib.batten_set_eager(True)
    try:
        yield
    finally:
        _thread.show = before
        lib.batten_set_eager(before is not None)
        if bar is not None:
            bar.close()


# Options: structs of the library whose fields are set by name, also those of structs inside.


def chosen(family: Any, name: str) -> Any:
    """The row of a name in a table."""
    row = ffi.new("bat_choice **")
    call(lib.bat_choice_find, family, name.encode(), row)
    return row[0]


def _assign(struct: Any, path: tuple[str, ...], kind: Any, value: Any, keep: list[Any]) -> None:
    """Set a field. A text chooses a row of the table that belongs to the field's type."""
    for name in path[:-1]:
        struct = getattr(struct, name)
    family, parse = family_of(kind.cname.split()[-1]), parser(kind)
    try:
        if value is None and kind.kind != "pointer":
            raise TypeError("None is no value; leave the option out for its default")
        if isinstance(value, str) and "\0" in value:
            raise ValueError("a text without null characters is needed")
        if isinstance(value, str) and parse is not None:
            parsed = ffi.new(ffi.getctype(kind, "*"))
            call(parse, value.encode(), parsed)
            value = parsed[0]
        elif isinstance(value, str) and family is not None:
            value = chosen(family, value).value
        elif isinstance(value, str):
            keep.append(ffi.new("char[]", value.encode()))
            value = keep[-1]
        elif kind.kind == "pointer" and value is not None:
            keep.append(ffi.from_buffer(ffi.typeof("double[]"), array(value, path[-1], None)))
            value = keep[-1]
        elif isinstance(value, (np.generic, np.ndarray)):
            value = value.tolist()
        setattr(struct, path[-1], ffi.NULL if value is None else value)
    except BattenError as error:
        text = no_choice(kind.cname.split()[-1], value)
        if text is None:
            raise
        error.args, error.option = (f"{path[-1]}: {text}",), path[-1]
        raise error from None
    except (OverflowError, IndexError) as error:
        least = "; 0 or more is needed" if isinstance(value, int) and value < 0 else ""
        raise ValueError(f"{path[-1]}: {value} is out of range{least}") from error
    except (TypeError, ValueError) as error:
        raise type(error)(f"{path[-1]}: {error}") from None


def set_field(struct: Any, name: str, value: Any) -> None:
    """Set a field of a struct that holds numbers and choices, the latter by their names."""
    fields = dict(ffi.typeof(struct).fields)
    if name not in fields:
        raise TypeError(f"unknown name '{name}'; there are {', '.join(fields)}")
    _assign(struct, (name,), fields[name].type, value, [])


def _build(kind: str, **given: Any) -> tuple[Any, list[Any]]:
    """A struct of options: the defaults, then what is given."""
    known = fields(kind)
    keep: list[Any] = []
    options = ffi.new(f"{kind} *", getattr(lib, kind.removesuffix("_options") + "_defaults")())
    if "threads" in known and "threads" not in given:
        given["threads"] = int(os.environ.get("BATTEN_THREADS", 0))
    for name in sorted(given, key=lambda name: len(known[name].path) if name in known else 0):
        if name not in known:
            raise TypeError(unknown(kind, name))
        field = known[name]
        if not (isinstance(given[name], str) and given[name] == default_name(field)):  # a default may have no other name
            _assign(options, field.path, field.type, given[name], keep)
    if (progress := _progress(kind)) is not None:
        _assign(options, progress, ffi.typeof("int"), ffi.addressof(lib, "batten_report_seldom"), keep)
    return options, keep


@functools.cache
def _progress(kind: str) -> tuple[str, ...] | None:
    """The path of the function that reports progress in a struct of options."""
    structs: list[tuple[tuple[str, ...], Any]] = [((), ffi.typeof(kind))]
    for path, struct in structs:
        for name, field in struct.fields:
            if name == "progress":
                return (*path, name, "report")
            if field.type.kind == "struct":
                structs.append(((*path, name), field.type))
    return None


_built = functools.lru_cache(256, typed=True)(_build)


def shared_options(kind: str, given: dict[str, Any]) -> tuple[Any, list[Any]]:
    """A struct of options with `given` set by name, which nobody may change, and what it needs as long as it is used."""
    try:
        return _built(kind, **given)
    except TypeError:
        return _build(kind, **given)


def options(kind: str, given: dict[str, Any]) -> Any:
    """A struct of options of one call, with `given` set by name."""
    built, keep = shared_options(kind, given)
    fresh = ffi.new(f"{kind} *", built[0])
    if keep:
        kept[fresh] = keep
    return fresh


def check_options(kind: str, given: dict[str, Any]) -> None:
    """Refuse options that are unknown or out of their ranges."""
    table = ffi.new("bat_options_table *", getattr(lib, f"{kind.removesuffix('_options')}_fields"))
    call(lib.bat_options_check, table, options(kind, given))


kept: weakref.WeakKeyDictionary[Any, list[Any]] = weakref.WeakKeyDictionary()


# Arrays.


_FLOAT = np.dtype(np.float64)


def unmasked(value: Any, name: str) -> NDArray[Any]:
    """An array without masked values, whose numbers are not meant."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise ValueError(f"{name}: values are masked; drop or fill them first")
    given = np.asarray(value)
    return _filled(value, given, name) if given.dtype == object and hasattr(value, "to_numpy") else given


def _filled(value: Any, given: NDArray[Any], name: str) -> NDArray[Any]:
    """The numbers of nullable columns of pandas, none of which may be missing."""
    table = hasattr(value, "dtypes") and hasattr(value, "columns")
    if not all(getattr(kind, "kind", "O") in "fiub" for kind in (value.dtypes if table else [getattr(value, "dtype", None)])):
        return given
    bad = value.isna()
    if np.asarray(bad).any():
        where = f" in column {', '.join(repr(column) for column in value.columns[bad.any()])}" if table else ""
        raise ValueError(f"{name}: values are missing{where}; drop or fill them first")
    return np.asarray(value.to_numpy(dtype=float))


def array(value: Any, name: str, columns: int | None, dtype: Any = np.float64) -> NDArray[Any]:
    """An aligned C-contiguous array: the given one where it is that already. `columns` above 0 demand rows of that length,
    0 rows of any length, None nothing."""
    given = unmasked(value, name)
    if given.dtype is _FLOAT and dtype is np.float64 and given.ndim == 2 and columns == 0 and given.flags.carray and given.size:
        return given
    if given.dtype.kind not in "fiub":
        raise TypeError(f"{name}: numbers are needed, not an array of {given.dtype}")
    if columns is not None and (given.ndim != 2 or given.shape[1] == 0 or columns not in (0, given.shape[1])):
        shape = f"(n, {columns or 'dimension'})"
        raise ValueError(f"{name}: an array of shape {shape} is needed, not {given.shape}")
    if dtype is not np.float64 and given.size:
        if given.dtype.kind == "f" and not np.array_equal(given, np.trunc(given)):
            raise TypeError(f"{name}: whole numbers are needed")
        limits = np.iinfo(dtype)
        if given.min() < limits.min or given.max() > limits.max:
            raise ValueError(f"{name}: numbers from {limits.min} to {limits.max} are needed, not {given.min()} or {given.max()}")
    made = np.ascontiguousarray(given, dtype).reshape(given.shape)
    return made if made.flags.aligned else made.copy()


def flag(value: Any, name: str) -> bool:
    """A truth value. Texts are none: "no" would count as true."""
    if not isinstance(value, (bool, np.bool_)) and not (isinstance(value, (int, np.integer)) and value in (0, 1)):
        raise TypeError(f"{name}: True or False is needed, not {value!r}")
    return bool(value)


_DOUBLES = ffi.typeof("double[]")
_NULL = ffi.NULL


def pointer(values: NDArray[Any] | None, kind: str = "") -> Any:
    """A pointer to the numbers of an array, which it keeps alive; by default to ``double[]``."""
    return _NULL if values is None else ffi.from_buffer(ffi.typeof(kind) if kind else _DOUBLES, values)


def take(memory: Any, shape: tuple[int, ...], dtype: Any = np.float64) -> NDArray[Any]:
    """The array in memory that the library allocated. The array owns it from now on."""
    kind = np.dtype(dtype)
    size = math.prod(shape) * kind.itemsize
    if memory == ffi.NULL or size == 0:
        lib.free(memory)
        return np.empty(shape, kind)
    owner = ffi.gc(memory, lib.free, size)
    return np.frombuffer(ffi.buffer(owner, size), kind).reshape(shape)


# Structs of results.


class Report(dict[str, Any]):
    """Named results, as a dictionary whose entries are attributes too.

    >>> report = Report(length=2.0)
    >>> report.length, report["length"]
    (2.0, 2.0)
    """

    __setattr__ = dict.__setitem__

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        width = max(map(len, self), default=0)
        return "\n".join(f"{name:>{width}}: {value}" for name, value in self.items())

    def __reduce__(self) -> tuple[Any, ...]:
        return Report, (dict(self),)


@functools.cache
def _constant(kind: Any, value: int) -> str:
    """The name of a value of an enumeration that has no table: what its constant has beside the others."""
    names = [name.split("_") for name in kind.relements]
    common = next(i for i, parts in enumerate(zip(*names)) if len(set(parts)) > 1)
    return "-".join(kind.elements[value].split("_")[common:]).lower()


def report(struct: Any) -> Report:
    """The numbers, names and texts of a struct; arrays behind pointers are left out."""
    found = Report()
    for name, field in ffi.typeof(struct).fields if ffi.typeof(struct).kind == "struct" else ffi.typeof(struct[0]).fields:
        value, kind = getattr(struct, name), field.type
        if kind.kind == "enum":
            family = family_of(kind.cname.split()[-1])
            value = _constant(kind, value) if family is None else ffi.string(lib.bat_choice_name(family, value)).decode()
        elif kind.kind == "array" and kind.item.cname == "char":
            value = ffi.string(value).decode()
        elif kind.kind == "array":
            value = np.array(list(value)) if kind.item.kind == "primitive" else [report(item) for item in value]
        elif kind.kind == "struct":
            value = report(value)
        elif kind.kind != "primitive":
            continue
        elif kind.cname == "size_t" and value == NO_INDEX:
            value = None
        found[name] = value
    return found


def choices(family: str) -> list[Report]:
    """The table of a family of choices: names, settings, summaries.

    Parameters
    ----------
    family : str
        ``"curve_scheme"``, ``"mesh_scheme"``, ``"space"``, ``"motion_scheme"``, ``"curve_end_rule"``, … — the part between
        ``bat_`` and ``_family`` in the C library.

    Examples
    --------
    >>> [row.name for row in batten.choices("mesh_scheme")][:5]
    ['learned', 'loop', 'catmull-clark', 'butterfly', 'midpoint']
    """
    table = family_of(f"bat_{family}")
    if table is None:
        known = sorted(name[4:-7] for name in dir(lib) if name.startswith("bat_") and name.endswith("_family"))
        raise InvalidArgument(f"no family '{family}'; there are {', '.join(known)}")
    rows: list[Report] = []
    while (row := lib.bat_choices(table, len(rows))) != ffi.NULL:
        fields = [(name, getattr(row, name)) for name in ("name", "settings", "summary", "endings")]
        rows.append(Report((name, ffi.string(text).decode() if text else "") for name, text in fields))
    return rows


def drawn(method: F) -> F:
    """A method that draws a result in a notebook. Where it cannot be drawn, the notebook shows its text."""

    @functools.wraps(method)
    def safely(self: Any) -> Any:
        try:
            return method(self)
        except Exception:
            return None

    return safely  # type: ignore[return-value]


def written(function: Callable[..., int], suffix: str, *arguments: Any, path: str | os.PathLike[str] | None = None) -> bytes:
    """What a function of the library writes to a file, as bytes; or written to `path`."""
    if path is not None:
        call_on_file(function, path, *arguments)
        return b""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"batten.{suffix}"
        call(function, os.fsencode(file), *arguments)
        return file.read_bytes()

"""The package as a whole: examples, types, what is exported."""

import functools
import importlib
import inspect
import os
import pickle
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import batten

MODULES = [module.name for module in pkgutil.iter_modules(batten.__path__) if module.name != "_native"]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name, monkeypatch):
    for peer in {"maps": ["shapely"], "motions": ["scipy"]}.get(name, []):
        pytest.importorskip(peer)
    from conftest import run_examples

    assert run_examples(importlib.import_module(f"batten.{name}")).failed == 0


def test_public_names_have_documentation():
    for name in batten.__all__:
        assert getattr(batten, name).__doc__, name
        assert getattr(batten, name).__module__ == "batten"


def test_exceptions_pickle():
    try:
        batten.refine([[0, 0], [0, 0]])
    except batten.InvalidPoint as error:
        again = pickle.loads(pickle.dumps(error))
        assert (str(again), again.index, again.status) == (str(error), 1, "invalid point")


#: Functions, and some of their options.
OPTIONS = {
    "refine": ["levels", "scheme", "fairness", "ends", "space", "closed"], "smooth": ["levels", "topology", "keep_area"],
    "refine_mesh": ["levels", "scheme", "fairness", "boundary", "creases"], "decimate": ["vertices", "method", "map"],
    "fit_surface": ["tolerance", "degree", "force"], "Motion": ["ends", "sigma", "velocities"], "analyze": ["depth"],
    "measure": ["samples", "geodesic"], "Mesh.read": ["repair"], "Mesh.write": ["encoding"], "Mesh.picture": ["up", "wires"],
    "Motion.read": ["ends", "sigma"],
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_signatures_have_names_defaults_and_texts(name):
    function = functools.reduce(getattr, name.split("."), batten)
    parameters = inspect.signature(function).parameters
    assert {"settings", "options"}.isdisjoint(parameters) and set(OPTIONS[name]) <= set(parameters)
    assert "**settings" not in inspect.getdoc(function) and "BAT_" not in inspect.getdoc(function)
    for parameter in parameters.values():
        if parameter.kind is parameter.KEYWORD_ONLY and parameter.name not in ("vertex_normals", "suffix", "wires", "flat"):
            assert parameter.default is not parameter.empty and parameter.annotation != "Any" or name == "refine_mesh"
            assert re.search(rf"^(.*, )?{parameter.name}(, .*)?( : .*)?$", inspect.getdoc(function), flags=re.M), parameter.name


def test_signatures_have_the_defaults_of_the_library():
    parameters = inspect.signature(batten.refine).parameters
    given = {name: parameter.default for name, parameter in parameters.items()
             if parameter.kind is parameter.KEYWORD_ONLY and name != "fairness"}  # fmt: skip
    assert given["levels"] == 5 and given["scheme"] == "auto" and given["ends"] == "reflect"
    points = np.random.default_rng(1).normal(size=(9, 2))
    assert np.array_equal(batten.refine(points, **given), batten.refine(points))
    fairness = parameters["fairness"].default
    assert np.array_equal(batten.refine(points, fairness=fairness), batten.refine(points, scheme="learned"))


def checked(tmp_path, command):
    """The lines on which a checker of types finds faults, and what it prints."""
    folder = Path(batten.__file__).parent.parent
    # An installed package is found by its py.typed; its folder has other packages' files, too.
    path = {} if folder.name == "site-packages" else {"MYPYPATH": str(folder)}
    run = subprocess.run([sys.executable, "-m", *command], cwd=tmp_path, env=os.environ | path, capture_output=True, text=True)
    return run.returncode, {int(line) for line in re.findall(r"\.py:(\d+)(?::\d+)?(?: -|:) error", run.stdout)}, run.stdout


typed = pytest.mark.skipif("BATTEN_TEST_TYPES" not in os.environ, reason="`scripts/test-python --full` runs it")
HERE = Path(__file__).parent


@typed
def test_types(tmp_path):
    code, _, text = checked(tmp_path, ["mypy", "--config-file", HERE.parents[1] / "pyproject.toml", "-p", "batten"])
    assert code == 0, text


@typed
@pytest.mark.parametrize("checker", [["mypy", "--strict"], ["pyright", "--pythonpath", sys.executable]])
def test_types_that_users_see(tmp_path, checker):
    if checker[0] == "pyright" and checked(tmp_path, ["pyright", "--version"])[0]:
        pytest.skip("pyright cannot be had")
    shutil.copy(HERE / "user.py", tmp_path)
    shutil.copy(HERE / "misuser.py", tmp_path)
    code, _, text = checked(tmp_path, [*checker, "user.py"])
    assert code == 0, text
    _, lines, text = checked(tmp_path, [*checker, "misuser.py"])
    wrong = [i for i, line in enumerate((HERE / "misuser.py").read_text().splitlines(), 1) if line.startswith("batten.")]
    assert lines == set(wrong), text


def test_what_users_write_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    exec(compile((HERE / "user.py").read_text(), "user.py", "exec"), {"__name__": "user"})

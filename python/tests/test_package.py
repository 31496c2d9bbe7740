"""The package as a whole: examples, types, what is exported."""

import importlib
import os
import pickle
import pkgutil
import subprocess
import sys
from pathlib import Path

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


@pytest.mark.skipif("BATTEN_TEST_TYPES" not in os.environ, reason="needs mypy; `scripts/test-python --full` runs it")
def test_types(tmp_path):
    folder = Path(batten.__file__).parent.parent
    # An installed package is found by its py.typed; its folder has other packages' files, too.
    path = {} if folder.name == "site-packages" else {"MYPYPATH": str(folder)}
    settings = Path(__file__).parents[2] / "pyproject.toml"
    run = subprocess.run([sys.executable, "-m", "mypy", "--config-file", settings, "-p", "batten"], cwd=tmp_path,
                         env=os.environ | path, capture_output=True, text=True)  # fmt: skip
    assert run.returncode == 0, run.stdout

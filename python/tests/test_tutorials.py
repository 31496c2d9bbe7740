"""The tutorials of docs/tutorials run."""

import os
import runpy
from pathlib import Path

import pytest

TUTORIALS = sorted((Path(__file__).parents[2] / "docs/tutorials").glob("*.py"))


@pytest.mark.skipif("BATTEN_TEST_TYPES" not in os.environ, reason="needs more packages; `scripts/test-python --full` runs it")
@pytest.mark.parametrize("tutorial", TUTORIALS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("default::batten.BattenWarning")
def test_tutorial(tutorial, monkeypatch):
    plt = pytest.importorskip("matplotlib.pyplot")
    pytest.importorskip("IPython")
    monkeypatch.chdir(tutorial.parent)
    ran = runpy.run_path(str(tutorial))
    plt.close("all")
    assert "batten" in ran

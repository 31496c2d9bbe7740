"""What the tests share."""

import doctest
import importlib.util

import numpy as np
import pytest

import batten


@pytest.fixture
def random():
    return np.random.default_rng(1)


@pytest.fixture
def circle():
    """Twelve points of an ellipse."""
    angles = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    return np.stack([2 * np.cos(angles), np.sin(angles)], axis=1)


@pytest.fixture
def tetrahedron():
    return batten.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture
def sphere_mesh(tetrahedron):
    """A closed mesh of 1,024 faces."""
    return batten.refine_mesh(tetrahedron, scheme="loop", levels=4)


@pytest.fixture
def patch():
    """Points of a saddle, in a grid."""
    t = np.linspace(0, 1, 12)
    x, y = (part.ravel() for part in np.meshgrid(t, t))
    return np.stack([x, y, x * y], axis=1)


def draws(result):
    """Whether a result plots itself, where matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is None or result.plot() is not None


def run_examples(module):
    """Run the examples of a module's docstrings."""
    return doctest.testmod(module, extraglobs={"batten": batten, "np": np})

"""Spaces whose functions are written in Python."""

import pickle

import numpy as np
import pytest

import batten


def exp(p, v):
    angle = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.cos(angle) * p + np.sinc(angle / np.pi) * v


def log(p, q):
    across = q - (p * q).sum(axis=-1, keepdims=True) * p
    sine = np.linalg.norm(across, axis=-1, keepdims=True)
    angle = np.arctan2(sine, (p * q).sum(axis=-1, keepdims=True))
    return across * (angle / np.where(sine == 0, 1, sine))


def project(x):
    return x / np.linalg.norm(x, axis=-1, keepdims=True)


OWN = batten.Space("own sphere", 3, dimension=2, exp=exp, log=log, project=project, injectivity=np.pi)


def test_the_sphere_in_python_is_the_library_s(random):
    sphere = batten.Space("sphere")
    points = project(random.normal(size=(6, 3)))
    own = batten.refine(points, space=OWN, scheme="log-exp-4", levels=3)
    np.testing.assert_allclose(own, batten.refine(points, space=sphere, scheme="log-exp-4", levels=3), atol=1e-12)
    p, q, v = points[:-1], points[1:], log(points[:-1], project(random.normal(size=(5, 3)))) / 2
    np.testing.assert_allclose(OWN.transport(p, q, v), sphere.transport(p, q, v), atol=1e-9)  # the pole ladder is exact here
    np.testing.assert_allclose(OWN.distance(p, q), sphere.distance(p, q), atol=1e-12)
    assert OWN.distance(points[0], points).shape == (6,)


def test_motions_in_a_space_of_python(random):
    points = project(np.cumsum(random.normal(size=(5, 3)), axis=0) + [9, 0, 0])
    own = batten.Motion(np.arange(5.0), points, space=OWN, ends="natural")
    known = batten.Motion(np.arange(5.0), points, space="sphere", ends="natural")
    np.testing.assert_allclose(own(np.linspace(0, 4, 9)), known(np.linspace(0, 4, 9)), atol=1e-7)


def test_exceptions_come_out():
    def broken(p, q):
        raise RuntimeError("broken")

    with pytest.raises(RuntimeError, match="broken"):
        batten.refine([[1.0], [2.0], [4.0]], space=batten.Space("x", 1, exp=lambda p, v: p + v, log=broken))
    with pytest.raises(ValueError, match="2 numbers, not 1"):
        batten.refine([[1.0], [2.0], [4.0]], space=batten.Space("x", 1, exp=lambda p, v: [1, 2], log=lambda p, q: q - p))

    def beyond(p, q):
        raise batten.CutLocus("no way")

    with pytest.raises(batten.CutLocus):
        batten.Space("x", 1, exp=lambda p, v: p + v, log=beyond).log([1.0], [2.0])


def test_faults_are_named():
    space = batten.Space("positive", 1, exp=lambda p, v: p * np.exp(v), log=lambda p, q: np.log(q / p),
                         fault=lambda p: None if p[0] > 0 else "not positive")  # fmt: skip
    with pytest.raises(batten.InvalidPoint, match="not positive") as caught:
        batten.refine([[1.0], [-1.0]], space=space)
    assert caught.value.index == 1


def test_pickles():
    again = pickle.loads(pickle.dumps(OWN))
    assert float(again.distance([1.0, 0, 0], [0, 1.0, 0])) == pytest.approx(np.pi / 2)
    assert pickle.loads(pickle.dumps(batten.Space("rigid", weight=2.0))).struct.weight == 2


def test_arguments_are_checked():
    with pytest.raises(TypeError, match="no function 'expp'"):
        batten.Space("x", 1, expp=exp)
    with pytest.raises(TypeError, match="needs exp, log and point_dim"):
        batten.Space("x", 1, exp=exp)
    with pytest.raises(ValueError, match="no space 'x'"):
        batten.Space("x")

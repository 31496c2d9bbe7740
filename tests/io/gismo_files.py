"""Surfaces that G+Smo itself writes, read by batten, written again, and evaluated by G+Smo.

usage: gismo_files.py BATTEN

It needs the package pygismo, and ends with 77 without it. Boxes of G+Smo's files are those of its kd-tree: nested, in no
order, several of a level, counted in the spans of their own level.
"""

import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
    import pygismo
except ImportError:
    print("pygismo is missing")
    sys.exit(77)

hsplines, nurbs = pygismo.hsplines, pygismo.nurbs


def knots(spans, degree, length=1.0):
    inner = [length * i / spans for i in range(1, spans)]
    return nurbs.gsKnotVector([0.0] * (degree + 1) + inner + [length] * (degree + 1), degree)


def surface(spans, degrees, boxes=(), area=None, truncated=True, length=1.0, dimension=3):
    tensor = nurbs.gsTensorBSplineBasis2(
        knots(spans[0], degrees[0], length), knots(spans[1], degrees[1])
    )
    basis = (hsplines.gsTHBSplineBasis2 if truncated else hsplines.gsHBSplineBasis2)(tensor)
    for box in boxes:
        basis.refineElements(box)
    if area is not None:
        basis.refine(np.array(area))
    control = np.random.default_rng(1).random((basis.size(), dimension))
    return (hsplines.gsTHBSpline2 if truncated else hsplines.gsHBSpline2)(basis, control)


CASES = {
    "nested boxes": dict(spans=(4, 4), degrees=(2, 2), boxes=[[1, 0, 0, 6, 6], [2, 2, 2, 8, 8]]),
    "two degrees": dict(
        spans=(4, 3), degrees=(3, 2), boxes=[[1, 0, 0, 6, 6]], area=[[0.6, 0.9], [0.5, 1.0]]
    ),
    "levels left out": dict(spans=(1, 1), degrees=(3, 3), boxes=[[1, 0, 0, 1, 2], [3, 0, 0, 3, 5]]),
    "not truncated": dict(spans=(5, 4), degrees=(2, 2), boxes=[[1, 2, 2, 8, 8]], truncated=False),
    "one level": dict(spans=(3, 3), degrees=(2, 2)),
    "knots to 6": dict(spans=(3, 3), degrees=(2, 2), boxes=[[1, 0, 0, 4, 4]], length=6.0),
    "in the plane": dict(spans=(3, 3), degrees=(2, 2), boxes=[[1, 0, 0, 4, 4]], dimension=2),
}


def check(batten, folder, name, case):
    written, read = os.path.join(folder, "written.xml"), os.path.join(folder, "read.xml")
    made = surface(**case)
    patches = pygismo.core.gsMultiPatch()
    patches.addPatch(made)
    data = pygismo.io.gsFileData()
    data.setFloatPrecision(17)
    data.add(patches)
    data.save(written)
    subprocess.run([batten, "surface", written, "-o", read, "--quiet"], check=True)
    back = pygismo.core.gsMultiPatch()
    pygismo.io.gsReadFile(read, back)
    at = np.random.default_rng(2).random((2, 200))
    difference = np.abs(
        back.patch(0).eval(at) - made.eval(at * np.array([[case.get("length", 1.0)], [1.0]]))
    )
    assert back.patch(0).basis().size() == made.basis().size(), name
    assert difference.max() < 1e-14, (name, difference.max())


def main():
    with tempfile.TemporaryDirectory() as folder:
        for name, case in CASES.items():
            check(sys.argv[1], folder, name, case)
    print(len(CASES), "surfaces of G+Smo come back")


main()

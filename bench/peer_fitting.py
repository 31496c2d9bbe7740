"""Distances of held-out points: adaptive fits of G+Smo and of batten, with the same parameters and as many functions.

    pip install pygismo numpy scipy
    python bench/peer_fitting.py build/release/batten [CLOUD.xyz …]

G+Smo fits as its adaptive fitting example does: bidegree 2, 8 x 8 cells, smoothing 1e-7, the cells of the 10 % worst points
and two rings refined, here with one correction of the parameters after each fit. Every tenth point is held out of both
fits. batten gets the parameters that G+Smo begins with. Clouds are files with boundary points first, `NAME-N.xyz`, or made
by formulas with noise. Both surfaces are evaluated by G+Smo. Without pygismo nothing is compared.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

SIZES = (150, 400, 1000)  # functions from which on a fit of G+Smo is compared
SHAPES = {
    "waves": lambda u, v: 0.1 * np.sin(5 * u) * np.cos(4 * v) + 0.2 * u * v,
    "bumps": lambda u, v: 0.2 * np.exp(-((u - 0.35) ** 2 + (v - 0.4) ** 2) / 0.02)
    + 0.15 * np.exp(-((u - 0.7) ** 2 + (v - 0.65) ** 2) / 0.03),
    "ripples": lambda u, v: 0.03 * np.sin(14 * u) * np.sin(12 * v + 1) + 0.1 * np.sin(3 * u + 2 * v),
    "edge": lambda u, v: 0.15 * np.tanh((u - 0.5 + 0.2 * np.sin(3 * v)) / 0.04),
}


def made(shape, sigma, count=5000, seed=1):
    """Points on a height field and their true parameters."""
    random = np.random.default_rng(seed)
    at = random.uniform(size=(count, 2))
    return np.column_stack([at, shape(*at.T)]) + sigma * random.normal(size=(count, 3)), at


def parameterized(batten, path):
    """The points of a file in the unit box, and their parameters by batten."""
    with tempfile.TemporaryDirectory() as folder:
        at = Path(folder) / "at.txt"
        subprocess.run([batten, "surface", path, "--parameterization", "stretch-minimizing", "--corrections", "0",
                        "--functions", "300", "--force", "--parameters", at, "-o", Path(folder) / "s.json", "--quiet"],
                       check=True)
        points, at = np.loadtxt(path, usecols=(0, 1, 2)), np.loadtxt(at)
    points = (points - points.min(0)) / np.ptp(points, axis=0).max()
    return points, at


def distances(surface, points, side=700):
    """Distances of points from a surface: of the nearest sample, corrected by its tangent plane."""
    from scipy.spatial import cKDTree

    t = np.linspace(0, 1, side)
    at = np.stack(np.meshgrid(t, t), 0).reshape(2, -1)
    samples = surface.eval(np.asfortranarray(at)).T
    grid = samples.reshape(side, side, 3)
    normals = np.cross(np.gradient(grid, axis=1), np.gradient(grid, axis=0)).reshape(-1, 3)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    near, found = cKDTree(samples).query(points)
    step = points - samples[found]
    inside = ((at[:, found] > 0) & (at[:, found] < 1)).all(0)
    return np.where(inside, np.abs((step * normals[found]).sum(1)), near)


def fits_of_gismo(gs, points, at):
    """Surfaces of growing size, each with its number of functions."""
    ends = np.array([0.0, 0, 0, *np.arange(1, 8) / 8, 1, 1, 1])
    knots = gs.nurbs.gsKnotVector(ends, 2)
    basis = gs.hsplines.gsTHBSplineBasis2(gs.nurbs.gsTensorBSplineBasis2(knots, knots))
    while basis.size() < 1.5 * SIZES[-1]:
        fit = gs.modelling.gsFitting(np.asfortranarray(at.T), np.asfortranarray(points.T), basis)
        fit.compute(1e-7)
        fit.parameterCorrection()
        fit.compute(1e-7)
        surface = fit.result()
        yield basis.size(), surface
        error = np.linalg.norm(surface.eval(np.asfortranarray(at.T)).T - points, axis=1)
        worst = at[error >= np.quantile(error, 0.9)]
        boxes = np.repeat(worst, 2, axis=0).T
        basis.refineElements(basis.asElements(np.asfortranarray(boxes), 2))


def fit_of_batten(gs, batten, points, at, functions, degree):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        np.savetxt(folder / "p.xyz", points)
        np.savetxt(folder / "at.txt", np.clip(at, 0, 1))
        subprocess.run([batten, "surface", folder / "p.xyz", "--parameterization", folder / "at.txt", "--functions",
                        str(functions), "--degree", str(degree), "--force", "-o", folder / "s.xml", "--quiet"], check=True)
        patches = gs.core.gsMultiPatch()
        gs.io.gsReadFile(str(folder / "s.xml"), patches)
        return patches  # which own their patch


def compare(gs, batten, name, points, at):
    held = np.arange(len(points)) % 10 == 5
    wanted = list(SIZES)
    for functions, surface in fits_of_gismo(gs, points[~held], at[~held]):
        if not wanted or functions < wanted[0]:
            continue
        while wanted and functions >= wanted[0]:
            wanted.pop(0)
        peer = distances(surface, points[held])
        row = f"| {name} | {functions} | {np.sqrt(np.mean(peer**2)):.3g}, {peer.max():.3g}"
        for degree in (2, 3):
            patches = fit_of_batten(gs, batten, points[~held], at[~held], functions, degree)
            own = distances(patches.patch(0), points[held])
            ratios = np.sqrt(np.mean(own**2) / np.mean(peer**2)), own.max() / peer.max()
            row += f" | {np.sqrt(np.mean(own**2)):.3g}, {own.max():.3g} | {ratios[0]:.2f}, {ratios[1]:.2f}"
        print(row + " |", flush=True)


def main():
    batten, *files = sys.argv[1:]
    try:
        import pygismo as gs
    except ImportError:
        print("pygismo is not installed")
        return
    print("Root mean square and largest distance of held-out points, and their ratios batten / G+Smo")
    print("| cloud | functions | G+Smo | batten, bidegree 2 | ratios | batten, bidegree 3 | ratios |")
    for name, shape in SHAPES.items():
        for sigma in (0, 0.002):
            compare(gs, batten, f"{name}, sigma {sigma}", *made(shape, sigma))
    for path in files:
        compare(gs, batten, Path(path).stem, *parameterized(batten, path))


if __name__ == "__main__":
    main()

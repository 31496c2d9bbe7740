"""What a user writes. The tests check it with `mypy --strict` and pyright, and that what comes out has the types it should."""

import datetime

import numpy as np

import batten

square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
curve = batten.refine(square, closed=True, levels=3, scheme="four-point:w=0.05", fairness=0.5, ends="reflect", tolerance=1e-3)
curve = batten.refine([[0, 0], [1, 0], [1, 1]], levels=2)
length: float = batten.measure(curve).length
rows: int = curve.shape[0]
where: batten.Space | None = curve.space
curves = batten.refine([square, square[:3]], scheme="chaikin")
curves = batten.refine(square, [0, 2, 4], levels=1)
first: batten.Curve = curves[0]
some: list[batten.Curve] = curves[1:]
offsets = curves.offsets.tolist()
proof = batten.analyze("four-point", depth=8)
points = batten.from_lonlat([[-0.5, 51.5], [-30, 58]])
vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
fine = batten.refine_mesh(vertices, faces, scheme="loop", levels=2, boundary="edges")
again: batten.Mesh = batten.refine_mesh(batten.Mesh(vertices, faces), scheme="learned", fairness=0.5)
position, triangles = fine
coarse, to_fine = batten.decimate(again, vertices=10, method="fast")
kept: batten.Decimation = batten.decimate(vertices, faces, ratio=1.0)
distances = batten.measure(again, (vertices, faces), samples=100)
motion = batten.Motion([0, 1, 2], [[0.0], [1.0], [8.0]], ends="natural", sigma="auto")
speed: float = float(motion.velocity(0.5)[0])
dates = [datetime.datetime(2026, 1, 1), datetime.datetime(2026, 1, 2), datetime.datetime(2026, 1, 4)]
dated = batten.Motion(dates, [[0.0], [1.0], [8.0]], sigma=0.1)
pose = dated(dates[1])
speeds = dated.velocity(dates), dated.acceleration(np.array(dates, "M8[us]")), dated.uncertainty(np.datetime64("2026-01-03"))
steps = [date - dates[0] for date in dates]
timed = batten.Motion(steps, [[0.0], [1.0], [8.0]])(steps[1]), batten.Motion(np.array(steps, "m8[s]"), [[0.0], [1.0], [8.0]])(steps)
again.write("mesh.obj", format="obj", threads=2)
read: batten.Mesh = batten.Mesh.read("mesh.obj", repair=True)
png: bytes = read.picture(width=300, up="z")
x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12)))
surface = batten.fit_surface(np.stack([x, y, x * y], axis=1), tolerance=0.01, degree=[3, 3])
wide: bool = bool(len(surface.points) > 1000)
either = batten.fit_surface(np.stack([x, y, x * y], axis=1), shell=wide)
np.savetxt("scan.xyz", surface.points)
scan = batten.read_points("scan.xyz", format="xyz", classes=None, strict=True)
count: int = len(scan)
step: bytes = surface.to_step()
try:
    batten.refine(square, levels=70)
except batten.InvalidArgument as error:
    option: str | None = error.option

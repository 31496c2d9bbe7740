# %% [markdown]
# # Surfaces
#
# Scattered points of a scan become a spline surface, for programs of computer-aided design. [Surfaces from
# scans](../surfaces.md) explains the way.

# %%
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import batten

# %% [markdown]
# ## A scan
#
# Points of a wavy patch with noise, in no order.

# %%
random = np.random.default_rng(1)
x, y = random.uniform(0, 1, size=(2, 3000))
z = 0.15 * np.sin(5 * x) * np.cos(4 * y)
points = np.stack([x, y, z], axis=1) + random.normal(0, 0.003, size=(3000, 3))
round(batten.cloud_noise(points), 4)

# %% [markdown]
# ## The fit
#
# The boundary, its corners and the parameters are found. Then the surface is refined where it is not near enough yet. One
# point in ten is held out meanwhile: refinement ends when their distances no longer fall. The picture shows the surface,
# the distances of the points, and the parameters.

# %%
surface = batten.fit_surface(points, tolerance=0.01)
surface

# %%
report = surface.report
report.reached, report.functions, report.rms, report.held_out_rms

# %% [markdown]
# ## What it is good for
#
# The surface is called with parameters, which are broadcast. It has derivatives and normals.

# %%
t = np.linspace(0, 1, 60)
grid = surface(t[None, :], t[:, None])
slope = surface.derivatives(t[None, :], t[:, None])
area = np.linalg.norm(np.cross(slope[..., 0, :], slope[..., 1, :]), axis=-1).mean()
grid.shape, round(float(area), 3)

# %%
figure = plt.figure(figsize=(7, 5))
axes = surface.plot(figure.add_subplot(projection="3d"), cmap="viridis", alpha=0.8)
axes.set_box_aspect((1, 1, 0.4))

# %% [markdown]
# Errors against the shape without noise are smaller than the noise, because many points share a function.

# %%
truth = 0.15 * np.sin(5 * grid[..., 0]) * np.cos(4 * grid[..., 1])
float(np.abs(grid[..., 2] - truth)[5:-5, 5:-5].mean())

# %% [markdown]
# `to_step` writes it for other programs, `to_vtk` with the points and their distances, `mesh` gives triangles.

# %%
with tempfile.TemporaryDirectory() as folder:
    surface.to_step(Path(folder) / "patch.step")
    print((Path(folder) / "patch.step").read_text()[:60].splitlines()[0])
surface.mesh(32)

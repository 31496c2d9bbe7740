# %% [markdown]
# # Meshes
#
# A coarse mesh becomes a fine one by subdivision. [Meshes](../meshes.md) explains the schemes and the options.

# %%
import matplotlib.pyplot as plt
import numpy as np
import trimesh
from IPython.display import Image

import batten

# %% [markdown]
# ## From coarse to fine
#
# An icosahedron of trimesh, stretched. `refine_mesh` takes it and gives a `trimesh.Trimesh` back; a `batten.Mesh` draws
# itself in a notebook.

# %%
coarse = trimesh.creation.icosahedron()
coarse.vertices *= [1.5, 1.0, 0.7]
fine = batten.refine_mesh(coarse, levels=3, scheme="loop")
type(fine).__name__, fine.faces.shape

# %%
batten.Mesh.of(fine)

# %% [markdown]
# The schemes: Loop's surface is smooth and shrinks; butterfly keeps the vertices.

# %%
figure, panels = plt.subplots(1, 3, figsize=(10, 3.4), subplot_kw={"projection": "3d"})
for axes, scheme in zip(panels, ["midpoint", "loop", "butterfly"]):
    mesh = batten.refine_mesh(batten.Mesh.of(coarse), scheme=scheme, levels=3)
    mesh.plot(axes, color="tab:cyan", edgecolor="0.4", linewidth=0.1)
    axes.set_title(f"{scheme}, volume {batten.measure(mesh).volume:.3f}")
    axes.set_box_aspect((1.5, 1, 0.7))
    axes.set_axis_off()

# %% [markdown]
# ## Sharp edges
#
# Creases stay sharp: infinitely, or for as many levels as their sharpness. Here the edges of a cube's upper face.

# %%
corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
rims = [(4, 5, np.inf), (5, 7, np.inf), (7, 6, np.inf), (6, 4, np.inf)]
batten.refine_mesh(corners, quads, creases=rims, levels=4)

# %% [markdown]
# Faces of four corners were refined by Catmull and Clark's scheme, which makes quads.
#
# ## Values at vertices
#
# Channels are refined with the mesh. `picture` shows values as colours.

# %%
start = batten.Mesh.of(coarse)
height = np.sin(3 * start.vertices[:, :1])
coloured = batten.refine_mesh(start, channels=height, scheme="loop", levels=4)
Image(coloured.picture(coloured.channels[:, 0]))

# %% [markdown]
# ## Measures
#
# `measure` of a mesh gives its size, topology and quality; of two the distances of their surfaces.

# %%
summary = batten.measure(coloured)
summary.vertices, summary.faces, round(summary.area, 3), round(summary.volume, 3)

# %%
sphere = trimesh.creation.icosphere(4)
ball = batten.refine_mesh(batten.Mesh.of(trimesh.creation.icosahedron()), levels=3, scheme="butterfly")
batten.measure(ball, sphere).mean

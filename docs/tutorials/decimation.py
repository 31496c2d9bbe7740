# %% [markdown]
# # Decimation
#
# A fine mesh becomes a coarse one by edge collapses, and a map tells where each point went. [The
# algorithm](../algorithms/decimation.md) has the formulas.

# %%
import numpy as np
import trimesh
from IPython.display import Image

import batten

# %% [markdown]
# ## A fine mesh
#
# A bumpy sphere of 20,480 faces, from an icosahedron.

# %%
icosahedron = trimesh.creation.icosahedron()
fine = batten.refine_mesh(batten.Mesh.of(icosahedron), scheme="loop", levels=5)
lengths = np.linalg.norm(fine.vertices, axis=1, keepdims=True)
directions = fine.vertices / lengths
bumps = 1 + 0.08 * np.prod(np.sin(7 * directions + 1), axis=1)
fine = batten.Mesh(directions * bumps[:, None], fine.faces)
fine

# %% [markdown]
# ## Where to stop
#
# By a number of vertices or faces, a ratio, or an error. With an error the distance of both surfaces is proven: `bound`.

# %%
coarse, to_fine = batten.decimate(fine, vertices=500)
coarse

# %%
near = batten.decimate(fine, tolerance=0.01)
near.mesh, near.bound

# %% [markdown]
# The vertices of both, and their measured mean and Hausdorff distances:

# %%
for mesh in (coarse, near.mesh):
    distance = batten.measure(fine, mesh)
    print(len(mesh.vertices), f"{distance.mean:.2e} {distance.hausdorff:.2e}")

# %% [markdown]
# ## The map
#
# The map is bijective. It is called with points of the coarse mesh and gives points on the fine one. Here it carries the
# height of the bumps from the fine mesh to the coarse one, which is then shown as a colour.

# %%
there = to_fine(coarse.vertices)
height = np.linalg.norm(there, axis=1)
Image(coarse.picture(height, wires=True))

# %%
back = to_fine(there, inverse=True)
float(np.abs(back - coarse.vertices).max())

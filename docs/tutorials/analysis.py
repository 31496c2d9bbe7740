# %% [markdown]
# # Analysis
#
# A linear subdivision scheme is given by its mask. `analyze` proves what it can of the scheme's limit curves: convergence,
# smoothness, and the polynomials that they reproduce. [The algorithm](../algorithms/curve-analysis.md) has the theorems.

# %%
import matplotlib.pyplot as plt
import numpy as np

import batten

# %% [markdown]
# ## A scheme by its name
#
# A notebook shows the basic limit function: what becomes of one point at 1 among points at 0.

# %%
four_point = batten.analyze("four-point")
four_point

# %%
four_point.converges, four_point.smooth_proven, four_point.reproduction_degree

# %% [markdown]
# ## A mask of your own
#
# The coefficients suffice. Those of Chaikin's scheme are the binomial ones of quadratic B-splines; its limit stencil tells
# where a point goes.

# %%
chaikin = batten.analyze([0.25, 0.75, 0.75, 0.25])
chaikin.smooth_proven, chaikin.limit

# %% [markdown]
# ## The tension of the four-point scheme
#
# A parameter w moves the curve between the polygon (0) and tight bends. The known range of smooth limits is open above; the
# analysis gives proven bounds for each w.

# %%
figure, axes = plt.subplots(figsize=(8, 3.2))
for w in (0.0, 1 / 32, 1 / 16, 1 / 10):
    found = batten.analyze([-w, 0, 0.5 + w, 1, 0.5 + w, 0, -w])
    found.plot(axes, label=f"w = {w:.3g}: C{found.smooth_proven} proven")
axes.legend();

# %% [markdown]
# ## The spectrum
#
# The eigenvalues of the subdivision matrix are those of differentiation as long as the scheme is smooth: 1, 1/2, 1/4.

# %%
np.sort(np.abs(four_point.eigenvalues))[::-1][:5].round(6)

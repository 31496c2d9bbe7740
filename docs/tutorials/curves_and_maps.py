# %% [markdown]
# # Curves and maps
#
# A coarse polyline becomes a smooth curve through its points. The tutorial begins in the plane, goes to the sphere, and
# ends with polygons that share borders. [Curves](../curves.md) explains the options.

# %%
import geopandas
import matplotlib.pyplot as plt
import numpy as np

import batten

# %% [markdown]
# ## A closed curve
#
# The body of a guitar, 22 points in centimetres. `refine` gives an array of points; in a notebook it draws itself.

# %%
outline = np.loadtxt("../../examples/data/outline.csv", delimiter=",", skiprows=3)[:, :2]
body = batten.refine(outline, closed=True, levels=5)
body

# %% [markdown]
# The given points are kept. The default here is the learned scheme; all schemes are rows of a table.

# %%
[row.name for row in batten.choices("curve_scheme")]

# %% [markdown]
# The schemes differ in how they bend. The bending energy is the integral of the squared curvature.

# %%
figure, panels = plt.subplots(1, 3, figsize=(10, 5), sharey=True)
for axes, scheme in zip(panels, ["learned", "four-point", "chaikin"]):
    curve = batten.refine(outline, closed=True, levels=5, scheme=scheme)
    axes.plot(*outline.T, "o", color="0.5", markersize=3)
    curve.plot(axes, color="tab:red")
    axes.set_title(f"{scheme}, energy {batten.measure(curve).bending:.3g}")
    axes.set_aspect("equal")

# %% [markdown]
# ## A track on the sphere
#
# Points of the sphere are unit vectors. `from_lonlat` and `to_lonlat` convert degrees. The ground track of a satellite
# crosses the antimeridian, which is no special place on the sphere.

# %%
track = geopandas.read_file("../../examples/data/iss-track.geojson")
degrees = track.geometry.get_coordinates().to_numpy()
points = batten.from_lonlat(degrees[:-1])  # the last point is the first
orbit = batten.refine(points, space="sphere", closed=True, levels=5)
orbit

# %% [markdown]
# ## Many curves at once
#
# Points and offsets, as in GeoArrow, hold many curves in two arrays. One call refines them all, on all processors.

# %%
random = np.random.default_rng(1)
steps = random.normal(size=(200, 8, 2)) / 3 + [1, 0]
lines = np.cumsum(steps, axis=1) + random.uniform(0, 60, size=(200, 1, 2))
smooth = batten.refine(lines.reshape(-1, 2), np.arange(0, 1601, 8), levels=4)
smooth

# %% [markdown]
# ## A map
#
# Polygons of a map share borders. `smooth` takes tables of geopandas and geometries of shapely, finds the shared borders,
# and refines each of them once: no gap opens, and nothing crosses.

# %%
regions = geopandas.read_file("../../examples/data/map.geojson")
fine = batten.smooth(regions, levels=4)
fine.crs == regions.crs, len(fine), bool(fine.is_valid.all())

# %%
west, south, east, north = regions.total_bounds
middle = [(west + east) / 2, (south + north) / 2]
figure, panels = plt.subplots(1, 2, figsize=(10, 5), sharex=True, sharey=True)
for axes, table, title in zip(panels, [regions, fine], ["given", "smoothed"]):
    colours = np.arange(len(table)) % 9
    table.plot(ax=axes, column=colours, cmap="Pastel1", edgecolor="0.3")
    axes.set_xlim(middle[0], middle[0] + (east - west) / 5)
    axes.set_ylim(middle[1], middle[1] + (north - south) / 5)
    axes.set_title(title)

# %% [markdown]
# The table of the result has the index, the columns and the coordinate reference system of the given one:
# `fine.to_file("smooth.gpkg")` writes it.

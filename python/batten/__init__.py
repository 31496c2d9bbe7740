"""batten turns coarse geometry into fair geometry: curves, maps, motions, meshes and scans.

Arrays go in and come out. See https://docs.python.org/3/library/warnings.html for how to turn notes of the library
(:class:`BattenWarning`) off.
"""

from batten._core import BattenError, BattenWarning, Report, choices
from batten.curves import analyze, refine, Curve, Curves
from batten.maps import smooth
from batten.spaces import Space, from_lonlat, to_lonlat

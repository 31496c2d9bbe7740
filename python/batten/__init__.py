"""batten turns coarse geometry into fair geometry: curves, maps, motions, meshes and scans.

Arrays go in and come out. Options of the C library are keyword arguments of the same name. Functions with long
calculations have `progress`, can be interrupted, release the global interpreter lock, and take `threads`; the environment
variable ``BATTEN_THREADS`` sets the default.
"""

from batten._core import (BadFile, BattenError, BattenWarning, CutLocus, FileAccess, InvalidArgument, InvalidPoint, NoConvergence,
                          NotManifold, OutOfMemory, Report, TooLarge, Unsupported, choices, ffi, lib, show_signatures)  # fmt: skip
from batten.curves import Analysis, Curve, Curves, analyze, refine
from batten.maps import smooth
from batten.measures import measure
from batten.meshes import Decimation, Mesh, MeshMap, PolygonMesh, _Faces, decimate, refine_mesh
from batten.motions import Motion
from batten.scans import read_points
from batten.spaces import Space, from_lonlat, to_lonlat
from batten.surfaces import Shell, Surface, cloud_noise, fit_surface

__version__: str = ffi.string(lib.bat_version()).decode()
__all__ = [
    "refine", "smooth", "analyze", "measure", "refine_mesh", "decimate", "fit_surface", "cloud_noise", "read_points", "choices", "from_lonlat", "to_lonlat",
    "Analysis", "Curve", "Curves", "Decimation", "Mesh", "MeshMap", "Motion", "PolygonMesh", "Report", "Shell", "Space", "Surface",
    "BattenError", "BattenWarning", "BadFile", "CutLocus", "FileAccess", "InvalidArgument", "InvalidPoint", "NoConvergence",
    "NotManifold", "OutOfMemory", "TooLarge", "Unsupported",
]  # fmt: skip

for _name in __all__:  # as users know them
    globals()[_name].__module__ = __name__
show_signatures("BATTEN", {**globals(), "_Faces": _Faces})

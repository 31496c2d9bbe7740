from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Batten(CMakePackage):
    """Turns coarse geometry into fair geometry: curves, motions, meshes and scans."""

    homepage = "@HOMEPAGE@"
    url = "@URL@"

    license("MIT")

    version("@VERSION@", sha256="@SHA256@")

    variant("gdal", default=False, description="Formats of maps and drawings by GDAL")
    variant("mpi", default=False, description="The program batten-mpi")

    depends_on("c", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("cairo@1.16:")
    depends_on("expat@2.4:")
    depends_on("jansson@2.13:")
    depends_on("openblas@0.3.13:")
    depends_on("qhull@8.0: +shared")
    depends_on("suite-sparse")
    depends_on("zlib-api")
    depends_on("gdal@3.4:", when="+gdal")
    depends_on("mpi", when="+mpi")
    depends_on("petsc@3.18:", when="+mpi")

    def cmake_args(self):
        return [
            self.define("BATTEN_TESTS", False),
            self.define("BATTEN_BENCH", False),
            self.define("BATTEN_EXAMPLES", False),
            self.define_from_variant("BATTEN_GDAL", "gdal"),
            self.define_from_variant("BATTEN_MPI", "mpi"),
        ]

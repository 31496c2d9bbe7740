"""The library: conan create packaging/conan, in the source or with the archive of a release."""
import os

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, get, rmdir
from conan.tools.gnu import PkgConfigDeps


class Batten(ConanFile):
    name = "batten"
    version = "@VERSION@"
    license = "MIT"
    homepage = "@HOMEPAGE@"
    description = "Turns coarse geometry into fair geometry: curves, motions, meshes and scans"
    package_type = "shared-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"files": [True, False], "pictures": [True, False], "surfaces": [True, False]}
    default_options = {"files": True, "pictures": False, "surfaces": False}

    def layout(self):
        cmake_layout(self)

    def source(self):
        get(self, "@URL@", sha256="@SHA256@", strip_root=True)

    def requirements(self):
        if self.options.files:
            for name in ("expat/[>=2.4]", "jansson/[>=2.13]", "zlib/[>=1.2.9]"):
                self.requires(name)
        if self.options.pictures:
            self.requires("cairo/[>=1.16]")
        if self.options.surfaces:
            for name in ("openblas/[>=0.3.13]", "qhull/[>=8.0]", "suitesparse-amd/[>=3]"):
                self.requires(name)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("files", "pictures", "surfaces"):
            toolchain.cache_variables[f"BATTEN_{part.upper()}"] = bool(getattr(self.options, part))
        for part in ("TESTS", "BENCH", "EXAMPLES", "PROGRAM", "RESEARCH"):
            toolchain.cache_variables[f"BATTEN_{part}"] = False
        for part in ("MPI", "GDAL") + (() if self.options.surfaces else ("BLAS",)):
            toolchain.cache_variables[f"BATTEN_{part}"] = "OFF"
        toolchain.generate()
        CMakeDeps(self).generate()
        PkgConfigDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        for folder in ("lib/cmake", "lib/pkgconfig", "share"):
            rmdir(self, os.path.join(self.package_folder, folder))

    def package_info(self):
        self.cpp_info.libs = ["batten"]
        self.cpp_info.set_property("cmake_target_name", "batten::batten")
        self.cpp_info.system_libs = ["m"]

class Batten < Formula
  desc "Turns coarse geometry into fair geometry: curves, motions, meshes, scans"
  homepage "@HOMEPAGE@"
  url "@URL@"
  version "@VERSION@"
  sha256 "@SHA256@"
  license "MIT"

  depends_on "cmake" => :build
  depends_on "pkgconf" => :build
  depends_on "cairo"
  depends_on "gdal"
  depends_on "jansson"
  depends_on "libomp"
  depends_on "openblas"
  depends_on "qhull"
  depends_on "suite-sparse"

  uses_from_macos "expat"
  uses_from_macos "zlib"

  def install
    args = %w[-DBATTEN_TESTS=OFF -DBATTEN_BENCH=OFF -DBATTEN_EXAMPLES=OFF -DBATTEN_MPI=OFF]
    system "cmake", "-S", ".", "-B", "build", *args, *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"batten", "shape", "cage", "-o", "cage.obj"
    system bin/"batten", "mesh", "cage.obj", "-o", "fine.obj"
    assert_path_exists testpath/"fine.obj"
  end
end

{ stdenv, fetchurl, cmake, pkg-config, cairo, expat, gdal, jansson, openblas, qhull, suitesparse, zlib, lib }:

stdenv.mkDerivation {
  pname = "batten";
  version = "@VERSION@";
  src = fetchurl {
    url = "@URL@";
    sha256 = "@SHA256@";
  };
  nativeBuildInputs = [ cmake pkg-config ];
  buildInputs = [ cairo expat gdal jansson openblas qhull suitesparse zlib ];
  cmakeFlags = [
    "-DBATTEN_TESTS=OFF"
    "-DBATTEN_BENCH=OFF"
    "-DBATTEN_EXAMPLES=OFF"
    "-DBATTEN_MPI=OFF"
  ];
  postPatch = "patchShebangs cmake scripts";
  meta = {
    description = "Turns coarse geometry into fair geometry: curves, motions, meshes, scans";
    homepage = "@HOMEPAGE@";
    license = lib.licenses.mit;
    mainProgram = "batten";
    platforms = lib.platforms.unix;
  };
}

# A toolchain for the Linux of another processor: Debian's cross compiler, and the packages that scripts/foreign-packages unpacks.
# Environment: BATTEN_MACHINE, as in aarch64, and BATTEN_SYSROOT, the folder of the packages.

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR $ENV{BATTEN_MACHINE})
set(CMAKE_C_COMPILER $ENV{BATTEN_MACHINE}-linux-gnu-gcc)
set(CMAKE_SYSROOT $ENV{BATTEN_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)

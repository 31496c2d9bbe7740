# The toolchain of the web page and the npm package: emscripten as Debian installs it, or any that is in the path.
#
# Libraries that emscripten does not bring are those that web/libraries compiled into build/web-libraries.

execute_process(COMMAND em-config EMSCRIPTEN_ROOT OUTPUT_VARIABLE emscripten OUTPUT_STRIP_TRAILING_WHITESPACE
                RESULT_VARIABLE missing)
if(missing)
  message(FATAL_ERROR "emscripten is missing; scripts/install-deps web installs it")
endif()
include(${emscripten}/cmake/Modules/Platform/Emscripten.cmake)

# pkg-config must not find the libraries of this machine.
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_CURRENT_LIST_DIR}/../build/web-libraries/lib/pkgconfig)
set(ENV{PKG_CONFIG_PATH} "")
# Vectors of 128 bits and instructions that copy memory, which all browsers have had since 2023.
set(CMAKE_C_FLAGS_INIT "-msimd128 -mbulk-memory")
# CMake does not look for libraries outside of emscripten's own folders.
add_link_options(-L${CMAKE_CURRENT_LIST_DIR}/../build/web-libraries/lib)
list(APPEND CMAKE_FIND_ROOT_PATH ${CMAKE_CURRENT_LIST_DIR}/../build/web-libraries)

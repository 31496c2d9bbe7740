# What a hostile file could turn a fault into is limited: by checks of buffers and of the stack, by control flow that jumps to
# known places alone, and by tables that nothing writes after the start. scripts/check-hardening finds all of it in the binaries.
option(BATTEN_HARDENED "Harden what is built" ON)

# The linker shows the public functions alone: OpenMP has names of its own for critical sections.
if(CMAKE_SYSTEM_NAME STREQUAL Linux AND NOT BATTEN_SANITIZED)
  set(BATTEN_EXPORTS -Wl,--version-script,${PROJECT_SOURCE_DIR}/cmake/exports.map)
endif()
if(NOT BATTEN_HARDENED OR EMSCRIPTEN OR BATTEN_SANITIZED)
  return()
endif()

include(CheckCCompilerFlag)
if(CMAKE_C_COMPILER_ID MATCHES Clang)
  # It takes flags that mean nothing on the machine, with a warning.
  set(CMAKE_REQUIRED_FLAGS -Werror=unused-command-line-argument)
endif()
foreach(flag -fstack-protector-strong -fstack-clash-protection -fcf-protection=full)
  string(MAKE_C_IDENTIFIER "BATTEN_HAS${flag}" known)
  check_c_compiler_flag(${flag} ${known})
  if(${known})
    target_compile_options(batten_settings INTERFACE ${flag})
  endif()
endforeach()
unset(CMAKE_REQUIRED_FLAGS)
# Checks of buffers need an optimizing compiler. Some compilers define the macro themselves.
target_compile_options(batten_settings INTERFACE $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3>)
if(CMAKE_SYSTEM_NAME STREQUAL Linux)
  target_link_options(batten_settings INTERFACE -Wl,-z,relro,-z,now,-z,noexecstack)
endif()
if(MINGW)
  target_link_libraries(batten_settings INTERFACE ssp) # the checks are in a library of their own
endif()

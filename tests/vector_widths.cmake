# Hot loops are compiled for several vector widths, and the machine picks one. Here each width is compiled by itself, so that
# every one the machine can run is tested, and all must give the same bytes.

include(CheckCSourceRuns)
if(NOT CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64 OR BATTEN_SANITIZED)
  return()
endif()

# The files with clones. What they define comes before the library's own copy.
set(cloned_sources)
foreach(source ${BATTEN_SOURCES})
  file(STRINGS ${source} clones REGEX "^LANES_CLONES")
  if(clones)
    list(APPEND cloned_sources ${source})
  endif()
endforeach()

add_executable(refine_digest curve/refine_digest.c)
target_link_libraries(refine_digest PRIVATE batten_internal)
target_include_directories(refine_digest PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/support)

foreach(architecture x86-64 x86-64-v3 x86-64-v4)
  string(REPLACE - _ label ${architecture})
  string(REGEX REPLACE "^x86-64-?" "" version ${architecture})
  # The compiler's own answer, which asks the operating system too. Plain x86-64 has no name there.
  if(version)
    check_c_source_runs("int main(void) { return !__builtin_cpu_supports(\"${architecture}\"); }" supported_${label})
  else()
    set(supported_${label} 1)
  endif()
  if(NOT supported_${label})
    continue()
  endif()

  add_library(cloned_${label} OBJECT ${cloned_sources})
  target_link_libraries(cloned_${label} PRIVATE batten_settings)
  # Without __gnu_linux__ base/lanes.h makes no clones.
  target_compile_options(cloned_${label} PRIVATE -march=${architecture} -U__gnu_linux__)

  foreach(name refine refine_invariance)
    batten_test(${name}_${label} curve/test_${name}.c $<TARGET_OBJECTS:cloned_${label}>)
  endforeach()
  add_executable(refine_digest_${label} curve/refine_digest.c $<TARGET_OBJECTS:cloned_${label}>)
  target_link_libraries(refine_digest_${label} PRIVATE batten_internal)
  target_include_directories(refine_digest_${label} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/support)
  add_test(NAME same_bytes_${label} COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/curve/same-output $<TARGET_FILE:refine_digest>
                                            $<TARGET_FILE:refine_digest_${label}>)
endforeach()

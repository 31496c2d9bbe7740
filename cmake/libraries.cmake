# The libraries that are installed: batten and batten-research, each shared and static; static alone where BUILD_SHARED_LIBS is
# off. Each shows the functions of its own public headers and nothing else.
set(BATTEN_KINDS shared static)
if(DEFINED BUILD_SHARED_LIBS AND NOT BUILD_SHARED_LIBS)
  set(BATTEN_KINDS static)
endif()
list(GET BATTEN_KINDS 0 BATTEN_KIND)

# An interface may change with every minor version until 1.0, and with every major one from then on.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(BATTEN_ABI ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set(BATTEN_COMPATIBILITY SameMinorVersion)
else()
  set(BATTEN_ABI ${PROJECT_VERSION_MAJOR})
  set(BATTEN_COMPATIBILITY SameMajorVersion)
endif()

if(CMAKE_SYSTEM_NAME STREQUAL Linux AND CMAKE_OBJCOPY)
  set(BATTEN_HAS_BINUTILS ON)
endif()

# The compiler knows the linker for the machine that it compiles for, where it is told that machine.
separate_arguments(machine_flags UNIX_COMMAND "${CMAKE_C_FLAGS}")
list(FILTER machine_flags INCLUDE REGEX "^(-m|--target=|-fuse-ld=|-B)")
separate_arguments(compiler_words UNIX_COMMAND "${CMAKE_C_COMPILER_ARG1}")
set(BATTEN_JOIN ${CMAKE_C_COMPILER} ${compiler_words} ${machine_flags} -r -nostdlib)
if(CMAKE_C_COMPILER_TARGET)
  list(APPEND BATTEN_JOIN ${CMAKE_C_COMPILE_OPTIONS_TARGET}${CMAKE_C_COMPILER_TARGET})
endif()

# An archive has no notion of a hidden name: internal functions could clash with a user's. So its objects are joined to one,
# in which hidden names become local. Needs GNU or LLVM tools; elsewhere the archive is a plain one.
#
# More arguments: what else is linked in, and options for objcopy after OPTIONS.
function(batten_static_library target objects)
  cmake_parse_arguments(PARSE_ARGV 2 more "" "ARCHIVE" "OPTIONS")
  if(BATTEN_HAS_BINUTILS)
    set(joined ${PROJECT_BINARY_DIR}/${target}.o)
    add_custom_command(
      OUTPUT ${joined}
      COMMAND ${BATTEN_JOIN} -o ${joined} $<TARGET_OBJECTS:${objects}> ${more_ARCHIVE}
      COMMAND ${CMAKE_OBJCOPY} --localize-hidden ${more_OPTIONS} ${joined}
      DEPENDS ${objects} $<TARGET_OBJECTS:${objects}> ${more_ARCHIVE}
      COMMENT "Joining the objects of the static library ${target}"
      COMMAND_EXPAND_LISTS VERBATIM)
    set_source_files_properties(${joined} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
    add_library(${target} STATIC ${joined})
    set_target_properties(${target} PROPERTIES LINKER_LANGUAGE C)
  else()
    add_library(${target} STATIC $<TARGET_OBJECTS:${objects}>)
  endif()
endfunction()

function(batten_shared_library target objects)
  add_library(${target} SHARED $<TARGET_OBJECTS:${objects}>)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${BATTEN_ABI})
  if(CMAKE_SYSTEM_NAME STREQUAL Linux AND NOT BATTEN_SANITIZED)
    target_link_options(${target} PRIVATE -Wl,--no-undefined ${BATTEN_EXPORTS})
  endif()
endfunction()

foreach(kind ${BATTEN_KINDS})
  cmake_language(CALL batten_${kind}_library batten_${kind} batten_objects)
  set_target_properties(batten_${kind} PROPERTIES OUTPUT_NAME batten EXPORT_NAME ${kind})
  target_include_directories(batten_${kind} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(batten_${kind} PRIVATE $<BUILD_INTERFACE:batten_settings>)
  add_library(batten::${kind} ALIAS batten_${kind})
endforeach()
add_library(batten::batten ALIAS batten_${BATTEN_KIND})
target_link_libraries(batten_static INTERFACE $<INSTALL_INTERFACE:batten::static_dependencies>)

# batten-research calls the public functions of batten, and hidden ones too. It carries a private copy of the objects with the
# hidden ones; the public functions in that copy get other names, so that every call of a public function goes to batten. Both
# libraries must agree on those: a space, for example, is recognized by its functions' addresses.
if(NOT BATTEN_RESEARCH OR NOT BATTEN_HAS_BINUTILS)
  return()
endif()
set(BATTEN_INSTALLS_RESEARCH ON)
set(private_archive ${PROJECT_BINARY_DIR}/libbatten-private.a)
add_custom_command(
  OUTPUT ${private_archive}
  COMMAND ${PROJECT_SOURCE_DIR}/cmake/private-archive ${private_archive} $<TARGET_OBJECTS:batten_objects>
  DEPENDS batten_objects $<TARGET_OBJECTS:batten_objects> ${PROJECT_SOURCE_DIR}/cmake/private-archive
  COMMENT "Copying internals for batten-research"
  COMMAND_EXPAND_LISTS VERBATIM)
add_custom_target(batten_private DEPENDS ${private_archive})

if(shared IN_LIST BATTEN_KINDS)
  batten_shared_library(batten_research_shared batten_research_objects)
  target_link_libraries(batten_research_shared PUBLIC batten_shared PRIVATE ${private_archive})
  target_link_options(batten_research_shared PRIVATE -Wl,--exclude-libs,libbatten-private.a)
endif()
batten_static_library(batten_research_static batten_research_objects ARCHIVE ${private_archive}
                      OPTIONS --wildcard "--localize-symbol=private_bat_*" "--localize-symbol=__odr_asan.*")
target_link_libraries(batten_research_static PUBLIC batten_static)
foreach(kind ${BATTEN_KINDS})
  add_dependencies(batten_research_${kind} batten_private)
  set_target_properties(batten_research_${kind} PROPERTIES OUTPUT_NAME batten-research EXPORT_NAME research_${kind})
  target_include_directories(batten_research_${kind} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/research/include>)
  target_link_libraries(batten_research_${kind} PRIVATE $<BUILD_INTERFACE:batten_settings>)
  add_library(batten::research_${kind} ALIAS batten_research_${kind})
endforeach()

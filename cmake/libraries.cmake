# The two libraries that are installed. Both show the functions of the public headers and nothing else.

# An interface may change with every minor version until 1.0.
set(BATTEN_ABI ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

add_library(batten_shared SHARED $<TARGET_OBJECTS:batten_objects>)
set_target_properties(batten_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${BATTEN_ABI})
if(CMAKE_SYSTEM_NAME STREQUAL Linux AND NOT BATTEN_SANITIZED)
  target_link_options(batten_shared PRIVATE -Wl,--no-undefined)
endif()

# An archive has no notion of a hidden name: internal functions could clash with a user's. So its objects are joined to one,
# in which hidden names become local. Needs GNU or LLVM tools; elsewhere the archive is a plain one.
if(CMAKE_SYSTEM_NAME STREQUAL Linux AND CMAKE_LINKER AND CMAKE_OBJCOPY)
  set(static_object ${PROJECT_BINARY_DIR}/batten-static.o)
  add_custom_command(
    OUTPUT ${static_object}
    COMMAND ${CMAKE_LINKER} -r -o ${static_object} $<TARGET_OBJECTS:batten_objects>
    COMMAND ${CMAKE_OBJCOPY} --localize-hidden ${static_object}
    DEPENDS batten_objects $<TARGET_OBJECTS:batten_objects>
    COMMENT "Joining the objects of the static library"
    COMMAND_EXPAND_LISTS VERBATIM)
  set_source_files_properties(${static_object} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  add_library(batten_static STATIC ${static_object})
  set_target_properties(batten_static PROPERTIES LINKER_LANGUAGE C)
else()
  add_library(batten_static STATIC $<TARGET_OBJECTS:batten_objects>)
endif()

foreach(kind shared static)
  set_target_properties(batten_${kind} PROPERTIES OUTPUT_NAME batten EXPORT_NAME ${kind})
  target_include_directories(batten_${kind} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(batten_${kind} PRIVATE $<BUILD_INTERFACE:batten_settings>)
  add_library(batten::${kind} ALIAS batten_${kind})
endforeach()
target_link_libraries(batten_static INTERFACE $<INSTALL_INTERFACE:batten::static_dependencies>)

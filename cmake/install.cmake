# What `cmake --install` copies: program, headers, both libraries, and how pkg-config and CMake find them.

include(CMakePackageConfigHelpers)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(TARGETS batten RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/batten DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN *.h)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(kind shared static)
  install(TARGETS batten_${kind} EXPORT batten-${kind} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT batten-${kind} FILE batten-${kind}.cmake NAMESPACE batten:: DESTINATION ${cmake_folder})
endforeach()

# Threads of the compiler that built the library, as linker options: "-lgomp -lpthread".
list(TRANSFORM OpenMP_C_LIB_NAMES PREPEND -l OUTPUT_VARIABLE openmp_options)
list(JOIN openmp_options " " openmp_options)

# Paths in the pkg-config file are relative to its own place, so that the installed tree can be moved.
file(RELATIVE_PATH pkgconfig_to_prefix /prefix/${pkgconfig_folder} /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/batten.pc.in ${PROJECT_BINARY_DIR}/batten.pc @ONLY)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/batten-config.cmake.in ${PROJECT_BINARY_DIR}/batten-config.cmake
                              INSTALL_DESTINATION ${cmake_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/batten-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/batten.pc DESTINATION ${pkgconfig_folder})
install(FILES ${PROJECT_BINARY_DIR}/batten-config.cmake ${PROJECT_BINARY_DIR}/batten-config-version.cmake
        DESTINATION ${cmake_folder})

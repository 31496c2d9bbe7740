# What `cmake --install` copies: program, headers, libraries, and how pkg-config and CMake find them. The library
# batten-research is the component `research`, which is installed only by name: cmake --install BUILD --component research.

include(CMakePackageConfigHelpers)
set(cmake_folder ${CMAKE_INSTALL_LIBDIR}/cmake/batten)
set(pkgconfig_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# "cairo>=1.16 expat>=2.4": modules that batten::static needs.
string(REPLACE " >= " ">=" cmake_modules "${BATTEN_MODULES}")
list(JOIN cmake_modules " " cmake_modules)
# "-lcholmod -lgomp -lpthread": linker options, with the threads of the compiler that built the library.
list(TRANSFORM OpenMP_C_LIB_NAMES PREPEND -l OUTPUT_VARIABLE openmp_options)
set(link_options ${BATTEN_LINK_OPTIONS} ${openmp_options} -lm)
string(REPLACE ";-l" ";" cmake_libraries ";${link_options}")
list(PREPEND link_options ${BATTEN_MODULE_OPTIONS})
list(JOIN link_options " " link_options)
# Where there is no shared library, pkg-config gives them without --static.
if(BATTEN_KIND STREQUAL static)
  set(link_options_static " ${link_options}")
  set(link_options)
endif()

# Paths in pkg-config files are relative to their own place, so that the installed tree can be moved.
file(RELATIVE_PATH pkgconfig_to_prefix /prefix/${pkgconfig_folder} /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/batten.pc.in ${PROJECT_BINARY_DIR}/batten.pc @ONLY)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/batten-config.cmake.in ${PROJECT_BINARY_DIR}/batten-config.cmake
                              INSTALL_DESTINATION ${cmake_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/batten-config-version.cmake COMPATIBILITY ${BATTEN_COMPATIBILITY})
if(NOT BATTEN_INSTALL)
  return()
endif()

if(BATTEN_PROGRAM)
  install(TARGETS batten RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # The program prints what shells complete, and its manual pages. A program for another machine cannot run here.
  if(NOT CMAKE_CROSSCOMPILING)
    set(made ${PROJECT_BINARY_DIR}/completion)
    add_custom_command(
      OUTPUT ${made}/batten ${made}/_batten ${made}/batten.fish ${made}/man/batten.1
      COMMAND ${CMAKE_COMMAND} -E make_directory ${made}/man
      COMMAND batten completion bash > ${made}/batten
      COMMAND batten completion zsh > ${made}/_batten
      COMMAND batten completion fish > ${made}/batten.fish
      COMMAND batten manual -o ${made}/man
      DEPENDS batten)
    add_custom_target(completion ALL DEPENDS ${made}/batten)
    install(FILES ${made}/batten DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
    install(FILES ${made}/_batten DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
    install(FILES ${made}/batten.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
    install(DIRECTORY ${made}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endif()
endif()
install(FILES ${BATTEN_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/batten)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(kind ${BATTEN_KINDS})
  install(TARGETS batten_${kind} EXPORT batten-${kind} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT batten-${kind} FILE batten-${kind}.cmake NAMESPACE batten:: DESTINATION ${cmake_folder})
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/batten.pc DESTINATION ${pkgconfig_folder})
install(FILES ${PROJECT_BINARY_DIR}/batten-config.cmake ${PROJECT_BINARY_DIR}/batten-config-version.cmake
        DESTINATION ${cmake_folder})

if(BATTEN_INSTALLS_RESEARCH)
  set(component COMPONENT research EXCLUDE_FROM_ALL)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/batten-research.pc.in ${PROJECT_BINARY_DIR}/batten-research.pc @ONLY)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/research/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${component}
          FILES_MATCHING PATTERN *.h)
  foreach(kind ${BATTEN_KINDS})
    install(TARGETS batten_research_${kind} EXPORT batten-research-${kind}
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ${component} NAMELINK_COMPONENT research
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} ${component})
    install(EXPORT batten-research-${kind} FILE batten-research-${kind}.cmake NAMESPACE batten:: DESTINATION ${cmake_folder}
            ${component})
  endforeach()
  install(FILES ${PROJECT_BINARY_DIR}/batten-research.pc DESTINATION ${pkgconfig_folder} ${component})
endif()

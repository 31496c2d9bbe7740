# The run path of what is built, the same in the build tree and installed: the folders of libraries that the system's loader
# does not search, as absolute paths. CMake ends a run path of its own for the build tree with an empty part, which means the
# current folder.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)
set(system_folders ${CMAKE_C_IMPLICIT_LINK_DIRECTORIES})
list(FILTER system_folders INCLUDE REGEX "^(/usr)?/lib(64)?(/${CMAKE_LIBRARY_ARCHITECTURE})?$")
foreach(library ${CAIRO_LINK_LIBRARIES} ${EXPAT_LINK_LIBRARIES} ${JANSSON_LINK_LIBRARIES} ${QHULL_LINK_LIBRARIES}
                ${OPENBLAS_LINK_LIBRARIES} ${OpenMP_C_LIBRARIES} ${MPI_C_LIBRARIES}
                ${BATTEN_PETSC_LIBRARY} ${BATTEN_DEPENDENCIES})
  get_filename_component(folder "${library}" DIRECTORY)
  get_filename_component(name "${library}" NAME)
  # Debian keeps each build of OpenBLAS in a folder of its own, and a link to the one chosen in a folder of the system.
  set(found)
  foreach(system_folder ${system_folders})
    file(GLOB links ${system_folder}/${name}.*)
    list(APPEND found ${links})
  endforeach()
  if(IS_ABSOLUTE "${library}" AND name MATCHES "\\.so" AND NOT folder IN_LIST system_folders AND NOT found)
    list(APPEND CMAKE_INSTALL_RPATH ${folder})
  endif()
endforeach()
list(REMOVE_DUPLICATES CMAKE_INSTALL_RPATH)
# What is loaded later is looked for in those folders too, but packaging tools drop folders that no linked library is in.
get_filename_component(folder "${openblas_file}" DIRECTORY)
if(BATTEN_BLAS_LIBRARY AND folder IN_LIST CMAKE_INSTALL_RPATH AND EXISTS ${folder}/${BATTEN_BLAS_LIBRARY})
  set(BATTEN_BLAS_LIBRARY ${folder}/${BATTEN_BLAS_LIBRARY})
endif()

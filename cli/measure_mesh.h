#ifndef CLI_MEASURE_MESH_H
#define CLI_MEASURE_MESH_H

#include "arguments.h"

#include "batten/base.h"

/// The file that a failed comparison is about, by its text: the first or the second, else the second.
const char *measure_file_at_fault(const char *const paths[2], const bat_error *error);

/// Whether the files of `batten measure` are meshes: as --mesh or --from says, else as the first file does whose ending or
/// content is clear; an OBJ file is a mesh when its first element is a face. Pipes are not looked into.
bool measure_means_meshes(const arguments *given);

/// `batten measure` of one or two meshes. Returns the program's exit code.
int measure_meshes(const arguments *given);

#endif

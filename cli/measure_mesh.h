#ifndef CLI_MEASURE_MESH_H
#define CLI_MEASURE_MESH_H

#include "arguments.h"

/// Whether the files of `batten measure` are meshes: as --mesh or --from says, else as the first file does whose ending or
/// content is clear; an OBJ file is a mesh when its first element is a face. Pipes are not looked into.
bool measure_means_meshes(const arguments *given);

/// `batten measure` of one or two meshes. Returns the program's exit code.
int measure_meshes(const arguments *given);

#endif

#ifndef CLI_MEASURE_MESH_H
#define CLI_MEASURE_MESH_H

#include "arguments.h"

#include "batten/base.h"

/// The file at fault in a comparison: the first one where the text of the error names it alone, else the second.
const char *measure_file_at_fault(const char *const paths[2], const bat_error *error);

/// Whether the files of `batten measure` are meshes: by --mesh or --from, else by the first file whose ending or content is
/// clear. An OBJ file is a mesh when its first element is a face. Pipes are not read.
bool measure_means_meshes(const arguments *given);

/// `batten measure` of one or two meshes. Returns the program's exit code.
int measure_meshes(const arguments *given);

#endif

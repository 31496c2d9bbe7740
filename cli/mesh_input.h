#ifndef CLI_MESH_INPUT_H
#define CLI_MESH_INPUT_H

#include "arguments.h"

#include "batten/mesh.h"
#include "batten/mesh_file.h"

/// @file
/// How verbs read meshes.

/// The mesh format that an option names; as it was when the option is not given. False after a message.
bool mesh_format_argument(const arguments *given, const char *option, bat_mesh_format *format);

/// Read a mesh, and repair it if that is wanted: faces with the same vertex twice are kept for it then.
/// @param repairs what was repaired; untouched without repair; may be null
/// @return as bat_mesh_read() and bat_mesh_repair(); `mesh` is untouched on failure
bat_status mesh_input_read(const char *path, const bat_mesh_read_options *options, bool repair,
                           bat_mesh_repair_report *repairs, bat_mesh *mesh, bat_error *error);

/// The number of places that were repaired.
size_t mesh_input_repaired(const bat_mesh_repair_report *repairs);

#endif

#ifndef CLI_MESH_FILES_H
#define CLI_MESH_FILES_H

#include "verb.h"

#include "batten/mesh_file.h"

/// @file
/// What the verbs that make a mesh of a mesh have in common: how its files are read and written, and what is told of them.

typedef struct mesh_files
{
    bat_mesh_read_options read;
    bat_mesh_write_options write;
    bool normals; ///< of vertices, are written
    bat_mesh_repair_report repairs;
    bat_mesh_notes notes;
} mesh_files;

/// Their options.
extern const option_spec MESH_FILE_OPTIONS[];

void mesh_files_begin(mesh_files *files);
/// Finish the options once they are read. False after a message.
bool mesh_files_check(mesh_files *files, const verb_call *call);
/// Print notes and repairs, as far as the call wants them.
void mesh_files_report(const mesh_files *files, const verb_call *call);

#endif

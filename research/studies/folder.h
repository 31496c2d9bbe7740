#ifndef RESEARCH_STUDIES_FOLDER_H
#define RESEARCH_STUDIES_FOLDER_H

#include "batten/mesh.h"

/// Names of files, sorted; all owned.
typedef struct folder_list
{
    char **names;
    size_t count;
} folder_list;

/// The files of a folder that are wanted.
/// @param list receives their names; release it with folder_list_free(). Empty on failure
/// @return BAT_OK, BAT_FILE_ACCESS with a text that names the folder, or BAT_NO_MEMORY
bat_status folder_read(const char *path, bool (*wanted)(const char *name), folder_list *list, bat_error *error);
void folder_list_free(folder_list *list);

/// bat_mesh_study_read(); the text of a failure begins with the path and the line.
bat_status folder_mesh_read(const char *path, bat_mesh *mesh, bat_error *error);

#endif

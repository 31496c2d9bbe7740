#include "research/studies/folder.h"

#include "base/error.h"
#include "batten/research/mesh_study.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bat_status add_name(folder_list *list, const char *name, bat_error *error)
{
    char **grown = realloc(list->names, (list->count + 1) * sizeof *grown);
    if (grown == NULL)
        return error_memory(error, (list->count + 1) * sizeof *grown);
    list->names = grown;
    list->names[list->count] = strdup(name);
    if (list->names[list->count] == NULL)
        return error_memory(error, strlen(name) + 1);
    list->count++;
    return BAT_OK;
}

bat_status folder_read(const char *path, bool (*wanted)(const char *name), folder_list *list, bat_error *error)
{
    DIR *stream = opendir(path);
    *list = (folder_list){.names = NULL};
    if (stream == NULL)
        return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "%s: the folder cannot be opened: %s", path,
                         strerror(errno));
    bat_status status = BAT_OK;
    for (const struct dirent *entry; status == BAT_OK && (entry = readdir(stream)) != NULL;)
        if (wanted(entry->d_name))
            status = add_name(list, entry->d_name, error);
    (void)closedir(stream);
    if (status != BAT_OK)
        folder_list_free(list);
    else if (list->count > 0)
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    return status;
}

void folder_list_free(folder_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    *list = (folder_list){.names = NULL};
}

bat_status folder_mesh_read(const char *path, bat_mesh *mesh, bat_error *error)
{
    bat_status status = bat_mesh_study_read(path, mesh, NULL, NULL, error);
    if (status == BAT_OK || error == NULL || error->line == 0)
        return error_prefix(error, status, "%s: ", path);
    size_t line = error->line;
    error->line = 0;
    return error_prefix(error, status, "%s:%zu: ", path, line);
}

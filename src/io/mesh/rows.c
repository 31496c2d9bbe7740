#include "io/mesh/formats.h"

#include "mesh/sides.h"

#include <stdarg.h>

/// @file
/// What writers and readers of meshes share: notes.

bool mesh_texture_by_vertex(const bat_mesh *mesh)
{
    return mesh->texture_faces != NULL && mesh->texture_count == mesh->vertex_count &&
           memcmp(mesh->texture_faces, mesh->faces, mesh_corners_until(mesh, mesh->face_count) * sizeof *mesh->faces) == 0;
}

// A list of texts that grows by one.

void bat_mesh_notes_free(bat_mesh_notes *notes)
{
    for (size_t i = 0; i < notes->count; i++)
        free(notes->texts[i]);
    free(notes->texts);
    *notes = (bat_mesh_notes){0};
}

/// Append a text, which then belongs to the notes.
static bool add_text(bat_mesh_notes *notes, char *text)
{
    char **texts = realloc(notes->texts, (notes->count + 1) * sizeof *texts);
    if (texts == NULL)
        return false;
    notes->texts = texts;
    notes->texts[notes->count++] = text;
    return true;
}

bat_status mesh_note(bat_mesh_notes *notes, bat_error *error, const char *format, ...)
{
    char text[BAT_ERROR_TEXT_SIZE];
    va_list arguments;
    if (notes == NULL)
        return BAT_OK;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (size_t i = 0; i < notes->count; i++)
        if (strcmp(notes->texts[i], text) == 0)
            return BAT_OK;
    char *copy = strdup(text);
    if (copy != NULL && add_text(notes, copy))
        return BAT_OK;
    free(copy);
    return error_memory(error, sizeof text);
}

bat_status mesh_notes_move(bat_mesh_notes *from, bat_mesh_notes *to, bat_error *error)
{
    bool moved = true;
    for (size_t i = 0; i < from->count && to != NULL && moved; i++)
    {
        moved = add_text(to, from->texts[i]);
        if (moved)
            from->texts[i] = NULL;
    }
    bat_mesh_notes_free(from);
    return moved ? BAT_OK : error_memory(error, sizeof *to->texts);
}

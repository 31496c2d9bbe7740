#include "mesh/labels.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>

/// @file
/// Copies of labels and materials.

char **mesh_label_name(bat_mesh_label *label, int index)
{
    char **const names[MESH_LABEL_NAMES] = {&label->object, &label->group, &label->material, &label->smoothing};
    return names[index];
}

const char *mesh_label_text(const bat_mesh_label *label, int index)
{
    const char *const names[MESH_LABEL_NAMES] = {label->object, label->group, label->material, label->smoothing};
    return names[index];
}

void mesh_labels_forget(bat_mesh *mesh)
{
    mesh->face_labels = NULL;
    mesh->labels = NULL;
    mesh->label_count = 0;
    mesh->material_files = mesh->material_json = NULL;
}

void mesh_labels_free(bat_mesh *mesh)
{
    for (size_t i = 0; i < mesh->label_count && mesh->labels != NULL; i++)
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
            free(*mesh_label_name(&mesh->labels[i], k));
    free(mesh->face_labels);
    free(mesh->labels);
    free(mesh->material_files);
    free(mesh->material_json);
    mesh_labels_forget(mesh);
}

/// Copy a text, which may be null. False when out of memory.
static bool copy_text(const char *from, char **to)
{
    *to = from != NULL ? strdup(from) : NULL;
    return from == NULL || *to != NULL;
}

static bool copy_table(const bat_mesh *from, bat_mesh *to)
{
    if (!copy_text(from->material_files, &to->material_files) || !copy_text(from->material_json, &to->material_json))
        return false;
    if (from->label_count == 0)
        return true;
    to->labels = calloc(from->label_count, sizeof *to->labels);
    if (to->labels == NULL)
        return false;
    to->label_count = from->label_count;
    for (size_t i = 0; i < from->label_count; i++)
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
            if (!copy_text(mesh_label_text(&from->labels[i], k), mesh_label_name(&to->labels[i], k)))
                return false;
    return true;
}

bat_status mesh_labels_carry(const bat_mesh *from, const uint32_t *sources, size_t each, bat_mesh *to, bat_error *error)
{
    size_t count = to->face_count;
    bool copied = copy_table(from, to);
    if (copied && from->face_labels != NULL)
    {
        to->face_labels = memory_array(count, sizeof *to->face_labels);
        copied = to->face_labels != NULL;
        for (size_t f = 0; f < count && copied; f++)
            to->face_labels[f] = from->face_labels[sources != NULL ? sources[f] : f / each];
    }
    return copied ? BAT_OK : error_memory(error, count * sizeof *to->face_labels);
}

bool channels_set_names(bat_mesh *mesh, const char *const *names, size_t count)
{
    char **made = count > 0 ? calloc(count, sizeof *made) : NULL;
    bool room = count == 0 || made != NULL;
    for (size_t i = 0; i < count && room; i++)
        room = copy_text(names[i], &made[i]);
    for (size_t i = 0; i < count && !room && made != NULL; i++)
        free(made[i]);
    if (!room)
        free(made);
    mesh->channel_names = room ? made : NULL;
    mesh->channel_count = room ? count : 0;
    return room;
}

bat_status channels_name(const bat_mesh *from, bat_mesh *to, bat_error *error)
{
    return channels_set_names(to, (const char *const *)from->channel_names, from->channel_count)
               ? BAT_OK
               : error_memory(error, from->channel_count * sizeof *to->channel_names);
}

void channels_bound(const bat_mesh *from, bat_mesh *to)
{
    size_t dim = from->channel_count;
    for (size_t c = 0; c < dim; c++)
    {
        bool bounded = true;
        for (size_t v = 0; v < from->vertex_count && bounded; v++)
            bounded = from->channels[v * dim + c] >= 0 && from->channels[v * dim + c] <= 1;
        for (size_t v = 0; v < to->vertex_count && bounded; v++)
            to->channels[v * dim + c] = fmin(1, fmax(0, to->channels[v * dim + c]));
    }
}

bat_status channels_make(const bat_mesh *from, size_t vertices, bat_mesh *to, bat_error *error)
{
    bat_status status = channels_name(from, to, error);
    if (status != BAT_OK)
        return status;
    to->channels = memory_array(vertices, from->channel_count * sizeof *to->channels);
    return to->channels != NULL ? BAT_OK : error_memory(error, vertices * from->channel_count * sizeof *to->channels);
}

const char *const mesh_colour_names[MESH_COLOURS] = {"red", "green", "blue", "alpha"};

size_t mesh_colours(const bat_mesh *mesh, size_t places[MESH_COLOURS])
{
    size_t count = 0;
    for (; count < MESH_COLOURS; count++)
    {
        size_t i = 0;
        while (i < mesh->channel_count && strcmp(mesh->channel_names[i], mesh_colour_names[count]) != 0)
            i++;
        if (i == mesh->channel_count)
            break;
        places[count] = i;
    }
    return count >= MESH_COLOURS - 1 ? count : 0;
}

/// @file
/// A file that keeps what a reconstruction has found, from which a stopped one goes on; see work.h.

#include "surface/shell/work.h"

#include "base/hash.h"
#include "learn/safetensors.h"
#include "mesh/check.h"
#include "mesh/labels.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char FORMAT[] = "batten shell steps 1";

enum
{
    MESHES = 2,
    ARRAYS = 4, ///< of a mesh
    REALS = 6,
    WHOLES = 4,
    NUMBERS = REALS + WHOLES + 2,
    NAME_SIZE = 32
};

static const char *const MESH_NAMES[MESHES] = {"mesh", "creased"};

/// Arrays of a mesh, whose channels are normals. Of a crease there are its vertices, and its sharpness as two halves.
static const struct
{
    const char *name;
    safetensors_type type;
    size_t width;
} ROWS[ARRAYS] = {{"positions", SAFETENSORS_F64, 3},
                  {"normals", SAFETENSORS_F64, 3},
                  {"faces", SAFETENSORS_U32, 3},
                  {"creases", SAFETENSORS_U32, sizeof(bat_mesh_crease) / sizeof(uint32_t)}};

static void name_array(size_t mesh, size_t array, char name[NAME_SIZE])
{
    (void)snprintf(name, NAME_SIZE, "%s.%s", MESH_NAMES[mesh], ROWS[array].name);
}

/// What identifies a reconstruction: the points in their frame, its unit, and the options that change what is kept.
static void make_key(const shell_work *work, char text[NAME_SIZE])
{
    const bat_shell_reconstruct_options *options = work->options;
    const double numbers[] = {work->unit,      options->tolerance, (double)options->faces, (double)options->spans,
                              options->crease, options->fill_holes};
    uint64_t key = hash_bytes(HASH_BEGIN, numbers, sizeof numbers);
    key = hash_bytes(key, work->points, 3 * work->count * sizeof *work->points);
    (void)snprintf(text, NAME_SIZE, "%016llx", (unsigned long long)key);
}

/// Copy the numbers of a reconstruction to a list, or from it.
static void move_numbers(shell_work *work, bool load, double list[NUMBERS])
{
    bat_shell_report *report = &work->report;
    double *reals[REALS] = {&work->noise,     &work->stiffness, &work->normals,
                            &report->spacing, &work->share,     &report->held_out};
    size_t *wholes[WHOLES] = {&work->faces, &report->filled, &report->dropped_pieces, &report->cut_handles};
    for (size_t k = 0; k < REALS; k++)
        *(load ? reals[k] : list + k) = *(load ? list + k : reals[k]);
    for (size_t k = 0; k < WHOLES; k++)
        if (load)
            *wholes[k] = list[REALS + k] >= 0 && list[REALS + k] < UINT32_MAX ? (size_t)list[REALS + k] : 0;
        else
            list[REALS + k] = (double)*wholes[k];
    if (load)
    {
        work->closed = list[NUMBERS - 2] != 0;
        work->has_share = list[NUMBERS - 1] != 0;
        return;
    }
    list[NUMBERS - 2] = work->closed;
    list[NUMBERS - 1] = work->has_share;
}

bat_status shell_steps_save(shell_work *work, bat_error *error)
{
    const bat_mesh *meshes[MESHES] = {&work->mesh, &work->creased};
    safetensors_array arrays[MESHES * ARRAYS + 1];
    char names[MESHES * ARRAYS][NAME_SIZE], key[NAME_SIZE];
    double numbers[NUMBERS];
    if (work->steps == NULL)
        return BAT_OK;
    for (size_t k = 0; k < MESHES; k++)
    {
        const bat_mesh *mesh = meshes[k];
        const void *values[ARRAYS] = {mesh->positions, mesh->channels, mesh->faces, mesh->creases};
        const size_t counts[ARRAYS] = {mesh->vertex_count, mesh->vertex_count, mesh->face_count, mesh->crease_count};
        for (size_t a = 0; a < ARRAYS; a++)
        {
            char *name = names[ARRAYS * k + a];
            name_array(k, a, name);
            arrays[ARRAYS * k + a] =
                (safetensors_array){name, ROWS[a].type, 2, {counts[a], ROWS[a].width}, counts[a] * ROWS[a].width, values[a]};
        }
    }
    move_numbers(work, false, numbers);
    make_key(work, key);
    arrays[MESHES * ARRAYS] = (safetensors_array){"numbers", SAFETENSORS_F64, 1, {NUMBERS}, NUMBERS, numbers};
    const safetensors_note notes[] = {{"format", FORMAT}, {"key", key}};
    const safetensors content = {.arrays = arrays, .array_count = MESHES * ARRAYS + 1, .notes = notes, .note_count = 2};
    return error_prefix(error, safetensors_write(work->steps, &content, error), "%s: ", work->steps);
}

/// Read a mesh, which owns its arrays also on failure. One without faces is empty.
static bat_status load_mesh(const safetensors *content, size_t which, bat_mesh *mesh, bat_error *error)
{
    static const char *const NAMES[] = {"normal", "normal", "normal"};
    void **values[ARRAYS] = {(void **)&mesh->positions, (void **)&mesh->channels, (void **)&mesh->faces,
                             (void **)&mesh->creases};
    size_t normals = 0, *counts[ARRAYS] = {&mesh->vertex_count, &normals, &mesh->face_count, &mesh->crease_count};
    for (size_t a = 0; a < ARRAYS; a++)
    {
        char name[NAME_SIZE];
        name_array(which, a, name);
        const safetensors_array *array = safetensors_find(content, name);
        if (array == NULL || array->type != ROWS[a].type || array->count % ROWS[a].width != 0)
            return ERROR_FILE(error, 0, "there is no array \"%s\" of the right type and size", name);
        if (array_make(values[a], array->count, safetensors_element_size(array->type), error) != BAT_OK)
            return BAT_NO_MEMORY;
        memcpy(*values[a], array->values, array->count * safetensors_element_size(array->type));
        *counts[a] = array->count / ROWS[a].width;
    }
    if (normals != mesh->vertex_count)
        return ERROR_FILE(error, 0, "there is not one normal for each vertex");
    if (mesh->face_count == 0)
    {
        bat_mesh_free(mesh);
        return BAT_OK;
    }
    return channels_set_names(mesh, NAMES, 3) ? mesh_check_triangles(mesh, error) : error_memory(error, sizeof NAMES);
}

bat_status shell_steps_load(shell_work *work, bat_error *error)
{
    safetensors content = {0};
    bat_mesh meshes[MESHES] = {{0}, {0}};
    char key[NAME_SIZE];
    double numbers[NUMBERS];
    if (work->steps == NULL || access(work->steps, F_OK) != 0)
        return BAT_OK;
    make_key(work, key);
    bat_status status = safetensors_read(work->steps, &content, error);
    const char *format = safetensors_find_note(&content, "format"), *found = safetensors_find_note(&content, "key");
    if (status == BAT_OK && (format == NULL || strcmp(format, FORMAT) != 0 || found == NULL))
        status = ERROR_FILE(error, 0, "the file keeps no steps of a shell");
    if (status == BAT_OK && strcmp(found, key) != 0)
        status = ERROR_ARGUMENT(error, "the steps are of other points or other options; without the file, all begins anew");
    if (status == BAT_OK)
        status = safetensors_doubles(&content, "numbers", NUMBERS, numbers, error);
    for (size_t k = 0; k < MESHES && status == BAT_OK; k++)
        status = load_mesh(&content, k, &meshes[k], error);
    if (status == BAT_OK && meshes[0].face_count == 0)
        status = ERROR_FILE(error, 0, "the mesh has no faces");
    if (status == BAT_OK)
    {
        SWAP(work->mesh, meshes[0]);
        SWAP(work->creased, meshes[1]);
        move_numbers(work, true, numbers);
    }
    for (size_t k = 0; k < MESHES; k++)
        bat_mesh_free(&meshes[k]);
    safetensors_free(&content);
    return error_prefix(error, status, "%s: ", work->steps);
}

#include "batten/mesh_file.h"

#include "base/error.h"
#include "learn/safetensors.h"
#include "mesh/decimate/map.h"

/// @file
/// Decimation maps as safetensors files with the arrays sizes, points, half_edges, kept and collapses.

static const char FORMAT[] = "batten mesh map 1";

enum
{
    SIZES = 6,  ///< vertices and faces of both meshes, and their digests
    SHAPE = 5,  ///< numbers of a collapse's shape
    ARRAYS = 5, ///< arrays of a file
};

bat_status bat_mesh_map_write(const char *path, const bat_mesh_map *map, bat_error *error)
{
    uint8_t *shapes = memory_array(map->collapse_count, SHAPE);
    if (shapes == NULL)
        return error_memory(error, map->collapse_count * SHAPE);
    for (size_t c = 0; c < map->collapse_count; c++)
    {
        const map_collapse *collapse = &map->collapses[c];
        const uint8_t numbers[SHAPE] = {collapse->count, collapse->vanishing, collapse->j_begin, collapse->j_end,
                                        collapse->closed};
        memcpy(shapes + SHAPE * c, numbers, sizeof numbers);
    }
    const int64_t sizes[SIZES] = {(int64_t)map->fine_vertices, (int64_t)map->fine_faces,  (int64_t)map->coarse_vertices,
                                  (int64_t)map->coarse_faces,  (int64_t)map->fine_digest, (int64_t)map->coarse_digest};
    safetensors_array arrays[ARRAYS] = {
        {"sizes", SAFETENSORS_I64, 1, {SIZES}, SIZES, sizes},
        {"points", SAFETENSORS_F64, 2, {map->point_count, 2}, 2 * map->point_count, map->points},
        {"half_edges", SAFETENSORS_U32, 1, {map->entry_count}, map->entry_count, map->half_edge},
        {"kept", SAFETENSORS_U32, 1, {map->coarse_faces}, map->coarse_faces, map->kept},
        {"collapses", SAFETENSORS_U8, 2, {map->collapse_count, SHAPE}, SHAPE * map->collapse_count, shapes},
    };
    safetensors_note note = {"format", FORMAT};
    const safetensors content = {.arrays = arrays, .array_count = ARRAYS, .notes = &note, .note_count = 1};
    bat_status status = safetensors_write(path, &content, error);
    free(shapes);
    return status;
}

/// Copy an array of a file with this name and type. The number of its elements must be a multiple of `width`.
static bat_status take_array(const safetensors *content, const char *name, safetensors_type type, size_t width,
                             void **values, size_t *rows, bat_error *error)
{
    const safetensors_array *array = safetensors_find(content, name);
    if (array == NULL || array->type != type || array->count % width != 0)
        return ERROR_FILE(error, 0, "the map has no array \"%s\" of the right type and size", name);
    size_t bytes = array->count * safetensors_element_size(type);
    *values = malloc(bytes + 1);
    if (*values == NULL)
        return error_memory(error, bytes);
    if (bytes > 0)
        memcpy(*values, array->values, bytes);
    *rows = array->count / width;
    return BAT_OK;
}

static bat_status take_sizes(const safetensors *content, bat_mesh_map *map, bat_error *error)
{
    int64_t sizes[SIZES];
    const char *format = safetensors_find_note(content, "format");
    if (format == NULL || strcmp(format, FORMAT) != 0)
        return ERROR_FILE(error, 0, "the file holds no map between meshes");
    bat_status status = safetensors_integers(content, "sizes", SIZES, sizes, error);
    if (status != BAT_OK)
        return status;
    for (int i = 0; i < 4; i++)
        if (sizes[i] < 1 || sizes[i] >= BAT_MESH_NONE)
            return ERROR_FILE(error, 0, "the map gives %lld as a number of vertices or faces", (long long)sizes[i]);
    map->fine_vertices = (size_t)sizes[0];
    map->fine_faces = (size_t)sizes[1];
    map->coarse_vertices = (size_t)sizes[2];
    map->coarse_faces = (size_t)sizes[3];
    map->fine_digest = (uint64_t)sizes[4];
    map->coarse_digest = (uint64_t)sizes[5];
    return BAT_OK;
}

/// Whether the numbers of a collapse are consistent.
static bool shape_is_right(const map_collapse *collapse)
{
    return collapse->count >= 1 && collapse->count <= COLLAPSE_MAX_FACES && collapse->vanishing >= 1 &&
           collapse->vanishing <= 2 && collapse->j_begin <= collapse->j_end && collapse->j_end <= collapse->count &&
           collapse->closed <= 1;
}

/// Set the collapses from their shapes, which must account for all entries and points.
static bat_status set_collapses(const uint8_t *shapes, bat_mesh_map *map, bat_error *error)
{
    size_t entries = 0, points = 0, vanished = 0;
    if (array_make(&map->collapses, map->collapse_count, sizeof *map->collapses, error) != BAT_OK)
        return BAT_NO_MEMORY;
    for (size_t c = 0; c < map->collapse_count; c++)
    {
        const uint8_t *shape = shapes + SHAPE * c;
        map_collapse *collapse = &map->collapses[c];
        *collapse = (map_collapse){(uint32_t)entries, (uint32_t)points, shape[0], shape[1], shape[2], shape[3], shape[4]};
        if (!shape_is_right(collapse))
            return error_set(error, BAT_BAD_FILE, c, 0, "collapse %zu of the map is invalid", c);
        entries += (size_t)collapse->count + collapse->vanishing;
        points += (size_t)FLAT_RING + collapse->count + (collapse->closed == 0);
        vanished += collapse->vanishing;
        if (entries > map->entry_count || points > map->point_count)
            break;
    }
    if (entries != map->entry_count || points != map->point_count || entries >= MAP_NONE || points >= MAP_NONE ||
        map->fine_faces != map->coarse_faces + vanished || map->fine_vertices < map->coarse_vertices + map->collapse_count)
        return ERROR_FILE(error, 0, "the map's arrays are inconsistent");
    return BAT_OK;
}

static bat_status take_arrays(const safetensors *content, bat_mesh_map *map, bat_error *error)
{
    uint8_t *shapes = NULL;
    size_t kept = 0;
    bat_status status = take_sizes(content, map, error);
    if (status == BAT_OK)
        status = take_array(content, "points", SAFETENSORS_F64, 2, (void **)&map->points, &map->point_count, error);
    if (status == BAT_OK)
        status = take_array(content, "half_edges", SAFETENSORS_U32, 1, (void **)&map->half_edge, &map->entry_count, error);
    if (status == BAT_OK)
        status = take_array(content, "kept", SAFETENSORS_U32, 1, (void **)&map->kept, &kept, error);
    if (status == BAT_OK && kept != map->coarse_faces)
        status = ERROR_FILE(error, 0, "the map's arrays are inconsistent");
    if (status == BAT_OK)
        status = take_array(content, "collapses", SAFETENSORS_U8, SHAPE, (void **)&shapes, &map->collapse_count, error);
    if (status == BAT_OK)
        status = set_collapses(shapes, map, error);
    free(shapes);
    return status;
}

bat_status bat_mesh_map_read(const char *path, const bat_mesh *fine, const bat_mesh *coarse, bat_mesh_map **map,
                             bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    bat_mesh_map *made = calloc(1, sizeof *made);
    status = made == NULL ? error_memory(error, sizeof *made) : take_arrays(&content, made, error);
    safetensors_free(&content);
    if (status == BAT_OK)
        status = map_inspect(made, error);
    if (status == BAT_OK)
        status = map_check(made, fine, coarse, error);
    if (status == BAT_OK)
        status = map_link(made, error);
    if (status == BAT_OK)
        *map = made;
    else
        bat_mesh_map_free(made);
    return status;
}

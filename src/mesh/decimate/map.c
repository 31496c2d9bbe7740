#include "mesh/decimate/map.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// A point moves through the collapses of its face in order, or in reverse order. In each it keeps its place in the plane
/// and gets new barycentric coordinates (Liu et al., 2020, section 4.2).

void bat_mesh_map_free(bat_mesh_map *map)
{
    if (map == NULL)
        return;
    free(map->collapses);
    free(map->half_edge);
    free(map->collapse);
    free(map->previous);
    free(map->next);
    free(map->points);
    free(map->first);
    free(map->last);
    free(map->kept);
    free(map);
}

bat_status map_make(size_t fine_faces, bat_mesh_map **map, bat_error *error)
{
    bat_mesh_map *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->fine_faces = fine_faces;
    made->first = memory_array(fine_faces, sizeof *made->first);
    made->last = memory_array(fine_faces, sizeof *made->last);
    if (made->first == NULL || made->last == NULL)
    {
        bat_mesh_map_free(made);
        return error_memory(error, fine_faces * sizeof *made->first);
    }
    *map = made;
    return BAT_OK;
}

/// Reallocate an array for `room` elements. False when out of memory.
static bool grow(void **array, size_t size, size_t room)
{
    void *grown = realloc(*array, room * size);
    if (grown != NULL)
        *array = grown;
    return grown != NULL;
}

static bool reserve(bat_mesh_map *map, size_t entries, size_t points)
{
    if (map->collapse_count == map->collapse_room)
    {
        map->collapse_room = map->collapse_room * 2 + 256;
        if (!grow((void **)&map->collapses, sizeof *map->collapses, map->collapse_room))
            return false;
    }
    if (map->entry_count + entries > map->entry_room)
    {
        map->entry_room = map->entry_room * 2 + entries + 1024;
        if (!grow((void **)&map->half_edge, sizeof *map->half_edge, map->entry_room))
            return false;
    }
    if (map->point_count + points > map->point_room)
    {
        map->point_room = map->point_room * 2 + points + 1024;
        if (!grow((void **)&map->points, 2 * sizeof *map->points, map->point_room))
            return false;
    }
    return true;
}

bat_status map_append(bat_mesh_map *map, const collapse_ring *ring, const double (*flat)[2], bat_error *error)
{
    size_t entries = ring->count + ring->vanishing, points = FLAT_RING + collapse_ring_vertices(ring);
    if (map->entry_count + entries >= MAP_NONE || map->point_count + points >= MAP_NONE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the map would have more than %u entries", MAP_NONE);
    if (!reserve(map, entries, points))
        return error_memory(error, map->point_room * 2 * sizeof *map->points);
    map->collapses[map->collapse_count++] = (map_collapse){.first_entry = (uint32_t)map->entry_count,
                                                           .first_point = (uint32_t)map->point_count,
                                                           .count = (uint8_t)ring->count,
                                                           .vanishing = (uint8_t)ring->vanishing,
                                                           .j_begin = (uint8_t)ring->j_begin,
                                                           .j_end = (uint8_t)ring->j_end,
                                                           .closed = ring->closed};
    memcpy(map->half_edge + map->entry_count, ring->half_edge, entries * sizeof *map->half_edge);
    memcpy(map->points + 2 * map->point_count, flat, points * sizeof *flat);
    map->entry_count += entries;
    map->point_count += points;
    return BAT_OK;
}

void map_link(bat_mesh_map *map)
{
    memset(map->first, 0xff, map->fine_faces * sizeof *map->first);
    memset(map->last, 0xff, map->fine_faces * sizeof *map->last);
    for (size_t c = 0; c < map->collapse_count; c++)
    {
        const map_collapse *collapse = &map->collapses[c];
        for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
        {
            uint32_t entry = collapse->first_entry + k, face = map->half_edge[entry] / 3, before = map->last[face];
            map->collapse[entry] = (uint32_t)c;
            map->previous[entry] = before;
            map->next[entry] = MAP_NONE;
            *(before == MAP_NONE ? &map->first[face] : &map->next[before]) = entry;
            map->last[face] = entry;
        }
    }
}

bat_status map_allocate_links(bat_mesh_map *map, bat_error *error)
{
    map->collapse = memory_array(map->entry_count, sizeof *map->collapse);
    map->previous = memory_array(map->entry_count, sizeof *map->previous);
    map->next = memory_array(map->entry_count, sizeof *map->next);
    if (map->collapse == NULL || map->previous == NULL || map->next == NULL)
        return error_memory(error, map->entry_count * sizeof *map->next);
    return BAT_OK;
}

bat_status map_finish(bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error)
{
    bat_status status = map_allocate_links(map, error);
    if (status != BAT_OK)
        return status;
    // If shrinking fails, the larger arrays remain.
    (void)(map->collapse_count > 0 && grow((void **)&map->collapses, sizeof *map->collapses, map->collapse_count) &&
           grow((void **)&map->half_edge, sizeof *map->half_edge, map->entry_count) &&
           grow((void **)&map->points, 2 * sizeof *map->points, map->point_count));
    map_link(map);
    map->fine_vertices = fine->vertex_count;
    map->fine_digest = map_digest(fine);
    map->coarse_vertices = coarse->vertex_count;
    map->coarse_faces = coarse->face_count;
    map->coarse_digest = map_digest(coarse);
    return BAT_OK;
}

uint64_t map_digest(const bat_mesh *mesh)
{
    uint64_t digest = 0xcbf29ce484222325U;
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        digest = (digest ^ mesh->faces[i]) * 0x100000001b3U;
    return digest;
}

bat_status map_check(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error)
{
    if (fine != NULL && (fine->vertex_count != map->fine_vertices || fine->face_count != map->fine_faces ||
                         map_digest(fine) != map->fine_digest))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the map does not belong to this fine mesh");
    if (coarse != NULL && (coarse->vertex_count != map->coarse_vertices || coarse->face_count != map->coarse_faces ||
                           map_digest(coarse) != map->coarse_digest))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the map does not belong to this coarse mesh");
    return BAT_OK;
}

bat_mesh_map_sizes bat_mesh_map_size(const bat_mesh_map *map)
{
    return (bat_mesh_map_sizes){map->fine_vertices, map->fine_faces, map->coarse_vertices, map->coarse_faces,
                                map->collapse_count};
}

// Carrying points

/// Find the face of a collapse that contains a point of the plane, before or after it. It is the face with the largest
/// minimal barycentric coordinate. Points that rounding leaves outside are moved inside. `barycentric` counts from the apex.
static uint32_t locate(const bat_mesh_map *map, const map_collapse *collapse, bool after, const double *point,
                       double *barycentric)
{
    uint32_t best = 0, faces = collapse->count + (after ? 0U : collapse->vanishing);
    double best_min = -INFINITY;
    barycentric[0] = barycentric[1] = barycentric[2] = 1;
    for (uint32_t k = 0; k < faces && best_min < 0; k++)
    {
        const double *corners[3];
        map_corners(map, collapse, k, after, corners);
        double a = map_area(point, corners[1], corners[2]), b = map_area(point, corners[2], corners[0]),
               c = map_area(point, corners[0], corners[1]);
        double smallest = fmin(a, fmin(b, c)) / map_area(corners[0], corners[1], corners[2]);
        if (smallest > best_min)
        {
            best = k;
            best_min = smallest;
            barycentric[0] = fmax(a, 0);
            barycentric[1] = fmax(b, 0);
            barycentric[2] = fmax(c, 0);
        }
    }
    double sum = barycentric[0] + barycentric[1] + barycentric[2];
    for (int c = 0; c < 3; c++)
        barycentric[c] /= sum;
    return best;
}

/// Move a point through one collapse, towards the fine mesh or the coarse one. Returns the entry of its new face.
static uint32_t carry(const bat_mesh_map *map, uint32_t entry, bool to_fine, double *barycentric)
{
    const map_collapse *collapse = &map->collapses[map->collapse[entry]];
    const double *corners[3];
    map_corners(map, collapse, entry - collapse->first_entry, to_fine, corners);
    uint32_t corner = map->half_edge[entry] % 3;
    double point[2] = {0};
    for (uint32_t c = 0; c < 3; c++)
    {
        double share = barycentric[(corner + c) % 3];
        point[0] += share * corners[c][0];
        point[1] += share * corners[c][1];
    }
    double turned[3];
    uint32_t found = collapse->first_entry + locate(map, collapse, !to_fine, point, turned);
    corner = map->half_edge[found] % 3;
    for (uint32_t c = 0; c < 3; c++)
        barycentric[(corner + c) % 3] = turned[c];
    return found;
}

/// Check that points lie on a mesh with `faces` faces.
/// @return BAT_OK or BAT_INVALID_POINT
static bat_status check_points(const bat_mesh_point *points, size_t count, size_t faces, bat_error *error)
{
    static const double TOLERANCE = 1e-9;
    for (size_t i = 0; i < count; i++)
    {
        const double *b = points[i].barycentric;
        if (points[i].face >= faces)
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu lies on face %u, but there are %zu", i,
                             points[i].face, faces);
        if (!(fmin(b[0], fmin(b[1], b[2])) >= -TOLERANCE && fabs(b[0] + b[1] + b[2] - 1) <= TOLERANCE))
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu lies outside of its face", i);
    }
    return BAT_OK;
}

bat_status bat_mesh_map_to_fine(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error)
{
    bat_status status = check_points(points, count, map->coarse_faces, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        uint32_t face = map->kept[points[i].face], entry = map->last[face];
        while (entry != MAP_NONE)
        {
            entry = carry(map, entry, true, points[i].barycentric);
            face = map->half_edge[entry] / 3;
            entry = map->previous[entry];
        }
        points[i].face = face;
    }
    return status;
}

/// The coarse face that a fine face became, by bisection.
static uint32_t find_kept(const bat_mesh_map *map, uint32_t face)
{
    size_t low = 0, high = map->coarse_faces;
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        *(map->kept[middle] <= face ? &low : &high) = middle;
    }
    return (uint32_t)low;
}

bat_status bat_mesh_map_to_coarse(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error)
{
    bat_status status = check_points(points, count, map->fine_faces, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        uint32_t face = points[i].face, entry = map->first[face];
        while (entry != MAP_NONE)
        {
            entry = carry(map, entry, false, points[i].barycentric);
            face = map->half_edge[entry] / 3;
            entry = map->next[entry];
        }
        points[i].face = find_kept(map, face);
    }
    return status;
}

static bat_status invalid_collapse(bat_error *error, size_t collapse, const char *what)
{
    return error_set(error, BAT_BAD_FILE, collapse, 0, "collapse %zu of the map %s", collapse, what);
}

/// Whether all faces before and after a collapse have positive areas.
static bool faces_are_upright(const bat_mesh_map *map, const map_collapse *collapse)
{
    for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
        for (int after = 0; after < (k < collapse->count ? 2 : 1); after++)
        {
            const double *corners[3];
            map_corners(map, collapse, k, after != 0, corners);
            double area = map_area(corners[0], corners[1], corners[2]);
            if (!(area > 0 && isfinite(area)))
                return false;
        }
    return true;
}

/// Mark the faces of a collapse with its number, and the vanishing ones as removed. False where a face was removed before or
/// occurs twice.
static bool mark_faces(const bat_mesh_map *map, uint32_t number, uint32_t *state)
{
    const map_collapse *collapse = &map->collapses[number];
    for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
    {
        uint32_t half_edge = map->half_edge[collapse->first_entry + k];
        if (half_edge / 3 >= map->fine_faces)
            return false;
        uint32_t *face = &state[half_edge / 3];
        if (*face == MAP_NONE || *face == number + 1)
            return false;
        *face = number + 1;
    }
    for (uint32_t k = 0; k < collapse->vanishing; k++)
        state[map->half_edge[collapse->first_entry + collapse->count + k] / 3] = MAP_NONE;
    return true;
}

/// Whether `kept` lists exactly the remaining faces.
static bool kept_is_valid(const bat_mesh_map *map, const uint32_t *state)
{
    size_t count = 0;
    for (size_t f = 0; f < map->fine_faces; f++)
        if (state[f] != MAP_NONE && (count == map->coarse_faces || map->kept[count++] != f))
            return false;
    return count == map->coarse_faces;
}

bat_status map_inspect(const bat_mesh_map *map, bat_error *error)
{
    uint32_t *state = calloc(map->fine_faces + 1, sizeof *state);
    if (state == NULL)
        return error_memory(error, map->fine_faces * sizeof *state);
    bat_status status = BAT_OK;
    for (size_t c = 0; c < map->collapse_count && status == BAT_OK; c++)
        if (!faces_are_upright(map, &map->collapses[c]))
            status = invalid_collapse(error, c, "has a face without area");
        else if (!mark_faces(map, (uint32_t)c, state))
            status = invalid_collapse(error, c, "refers to a removed face");
    if (status == BAT_OK && !kept_is_valid(map, state))
        status =
            error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the map's remaining faces differ from those that it lists");
    free(state);
    return status;
}

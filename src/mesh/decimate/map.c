#include "mesh/decimate/map.h"

#include "base/array_grow.h"
#include "base/bisect.h"
#include "base/error.h"

/// @file
/// A point moves through the collapses of its face in order, or in reverse order. In each it keeps its place in the plane
/// and gets new barycentric coordinates (Liu et al., 2020, section 4.2).

enum
{
    GROUP = 16,     ///< points that are carried in turns
    CACHE_LINE = 64 ///< bytes
};

void bat_mesh_map_free(bat_mesh_map *map)
{
    if (map == NULL)
        return;
    free(map->collapses);
    free(map->half_edge);
    free(map->steps);
    free(map->points);
    free(map->first);
    free(map->last);
    free(map->kept);
    free(map);
}

/// Release unused memory of an array. False when that fails; the array then remains.
static bool shrink(void **array, size_t size, size_t count)
{
    void *made = realloc(*array, count * size);
    if (made != NULL)
        *array = made;
    return made != NULL;
}

bat_status map_append(bat_mesh_map *map, const collapse_ring *ring, const double (*flat)[2], bat_error *error)
{
    size_t entries = ring->count + ring->vanishing, points = FLAT_RING + collapse_ring_vertices(ring);
    if (map->entry_count + entries >= MAP_NONE || map->point_count + points >= MAP_NONE)
        return ERROR_TOO_LARGE(error, "the map would have more than %u entries", MAP_NONE);
    if (!ARRAY_GROW(map->collapses, map->collapse_room, map->collapse_count + 1) ||
        !ARRAY_GROW(map->half_edge, map->entry_room, map->entry_count + entries) ||
        !ARRAY_GROW(map->points, map->point_room, 2 * (map->point_count + points)))
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

bat_status map_link(bat_mesh_map *map, bat_error *error)
{
    map->steps = memory_array(map->entry_count, sizeof *map->steps);
    map->first = memory_array(map->fine_faces, sizeof *map->first);
    map->last = memory_array(map->fine_faces, sizeof *map->last);
    if (map->steps == NULL || map->first == NULL || map->last == NULL)
        return error_memory(error, map->entry_count * sizeof *map->steps);
    memset(map->first, 0xff, map->fine_faces * sizeof *map->first);
    memset(map->last, 0xff, map->fine_faces * sizeof *map->last);
    for (size_t c = 0; c < map->collapse_count; c++)
    {
        const map_collapse *collapse = &map->collapses[c];
        for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
        {
            uint32_t entry = collapse->first_entry + k, face = map->half_edge[entry] / 3, before = map->last[face];
            map->steps[entry] = (map_step){map->half_edge[entry], before, MAP_NONE, *collapse};
            *(before == MAP_NONE ? &map->first[face] : &map->steps[before].next) = entry;
            map->last[face] = entry;
        }
    }
    return BAT_OK;
}

/// A hash of a mesh's faces in their order (FNV-1a).
static uint64_t map_digest(const bat_mesh *mesh)
{
    uint64_t digest = 0xcbf29ce484222325U;
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        digest = (digest ^ mesh->faces[i]) * 0x100000001b3U;
    return digest;
}

bat_status map_finish(bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error)
{
    // If shrinking fails, the larger arrays remain.
    (void)(map->collapse_count > 0 && shrink((void **)&map->collapses, sizeof *map->collapses, map->collapse_count) &&
           shrink((void **)&map->half_edge, sizeof *map->half_edge, map->entry_count) &&
           shrink((void **)&map->points, 2 * sizeof *map->points, map->point_count));
    map->fine_vertices = fine->vertex_count;
    map->fine_faces = fine->face_count;
    map->fine_digest = map_digest(fine);
    map->coarse_vertices = coarse->vertex_count;
    map->coarse_faces = coarse->face_count;
    map->coarse_digest = map_digest(coarse);
    return map_link(map, error);
}

bat_status map_check(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, bat_error *error)
{
    if (fine != NULL && (fine->vertex_count != map->fine_vertices || fine->face_count != map->fine_faces ||
                         map_digest(fine) != map->fine_digest))
        return ERROR_ARGUMENT(error, "the map does not belong to this fine mesh");
    if (coarse != NULL && (coarse->vertex_count != map->coarse_vertices || coarse->face_count != map->coarse_faces ||
                           map_digest(coarse) != map->coarse_digest))
        return ERROR_ARGUMENT(error, "the map does not belong to this coarse mesh");
    return BAT_OK;
}

// Carrying points

/// Find the face of a fan that contains a point of the plane: the faces from the apex to ring[k] and ring[k + 1], for
/// `begin`
/// <= k < `end`. `barycentric` receives twice the areas between the point and the face's edges, opposite to its corners.
/// Returns `end` for none.
static uint32_t find_in_fan(const double *apex, const double *ring, uint32_t begin, uint32_t end, uint32_t count,
                            bool closed, const double *point, double *barycentric)
{
    if (begin >= end)
        return end;
    double x = apex[0] - point[0], y = apex[1] - point[1];
    double from_x = ring[2 * (size_t)begin] - point[0], from_y = ring[2 * (size_t)begin + 1] - point[1];
    double from = x * from_y - y * from_x;
    for (uint32_t k = begin; k < end; k++)
    {
        const double *corner = ring + 2 * (size_t)(closed && k + 1 == count ? 0 : k + 1);
        double to_x = corner[0] - point[0], to_y = corner[1] - point[1], to = x * to_y - y * to_x;
        double outside = from_x * to_y - from_y * to_x;
        if (from >= 0 && to <= 0 && outside >= 0)
        {
            barycentric[0] = outside;
            barycentric[1] = -to;
            barycentric[2] = from;
            return k;
        }
        from = to;
        from_x = to_x;
        from_y = to_y;
    }
    return end;
}

/// Find the face of a collapse that contains a point of the plane, before or after it. Returns the number of faces where
/// rounding leaves the point outside of all.
static uint32_t find_face(const double *points, const map_collapse *collapse, bool after, const double *point,
                          double *barycentric)
{
    const double *i = points + (size_t)2 * FLAT_I, *j = points + (size_t)2 * FLAT_J, *new = points + (size_t)2 * FLAT_NEW,
                 *ring = points + (size_t)2 * FLAT_RING;
    uint32_t count = collapse->count, begin = collapse->j_begin, end = collapse->j_end, found;
    bool closed = collapse->closed != 0;
    if (after)
        return find_in_fan(new, ring, 0, count, count, closed, point, barycentric);
    found = find_in_fan(i, ring, 0, begin, count, closed, point, barycentric);
    if (found < begin)
        return found;
    found = find_in_fan(j, ring, begin, end, count, closed, point, barycentric);
    if (found < end)
        return found;
    found = find_in_fan(i, ring, end, count, count, closed, point, barycentric);
    for (uint32_t k = found; k >= count && k < count + collapse->vanishing; k++)
    {
        bool left = k == count;
        uint32_t opposite = left ? end : begin;
        const double *a = left ? i : j, *b = left ? j : i,
                     *c = ring + 2 * (size_t)(closed && opposite == count ? 0 : opposite);
        barycentric[0] = vector2_turn(point, b, c);
        barycentric[1] = vector2_turn(point, c, a);
        barycentric[2] = vector2_turn(point, a, b);
        if (barycentric[0] >= 0 && barycentric[1] >= 0 && barycentric[2] >= 0)
            return k;
        found = k + 1;
    }
    return found;
}

/// The face with the largest minimal barycentric coordinate; points that rounding leaves outside are moved inside.
static uint32_t find_nearest_face(const bat_mesh_map *map, const map_collapse *collapse, bool after, const double *point,
                                  double *barycentric)
{
    uint32_t best = 0, faces = collapse->count + (after ? 0U : collapse->vanishing);
    double best_min = -INFINITY;
    barycentric[0] = barycentric[1] = barycentric[2] = 1;
    for (uint32_t k = 0; k < faces; k++)
    {
        const double *corners[3];
        map_corners(map, collapse, k, after, corners);
        double a = vector2_turn(point, corners[1], corners[2]), b = vector2_turn(point, corners[2], corners[0]),
               c = vector2_turn(point, corners[0], corners[1]);
        double smallest = fmin(a, fmin(b, c)) / vector2_turn(corners[0], corners[1], corners[2]);
        if (smallest > best_min)
        {
            best = k;
            best_min = smallest;
            barycentric[0] = fmax(a, 0);
            barycentric[1] = fmax(b, 0);
            barycentric[2] = fmax(c, 0);
        }
    }
    return best;
}

/// Find the face of a collapse that contains a point of the plane, before or after it. `barycentric` counts from the apex.
static uint32_t locate(const bat_mesh_map *map, const map_collapse *collapse, bool after, const double *point,
                       double *barycentric)
{
    uint32_t faces = collapse->count + (after ? 0U : collapse->vanishing);
    uint32_t found = find_face(map->points + 2 * (size_t)collapse->first_point, collapse, after, point, barycentric);
    if (found >= faces)
        found = find_nearest_face(map, collapse, after, point, barycentric);
    double sum = barycentric[0] + barycentric[1] + barycentric[2];
    for (int c = 0; c < 3; c++)
        barycentric[c] /= sum;
    return found;
}

/// Move a point through one collapse, towards the fine mesh or the coarse one. Returns the entry of its new face.
static uint32_t carry(const bat_mesh_map *map, uint32_t entry, bool to_fine, double *barycentric)
{
    const map_step *step = &map->steps[entry];
    const map_collapse *collapse = &step->collapse;
    const double *corners[3];
    map_corners(map, collapse, entry - collapse->first_entry, to_fine, corners);
    uint32_t corner = step->half_edge % 3;
    double point[2] = {0};
    for (uint32_t c = 0; c < 3; c++)
    {
        double share = barycentric[(corner + c) % 3];
        vector_add(2, share, corners[c], point);
    }
    double turned[3];
    uint32_t found = collapse->first_entry + locate(map, collapse, !to_fine, point, turned);
    corner = map->steps[found].half_edge % 3;
    for (uint32_t c = 0; c < 3; c++)
        barycentric[(corner + c) % 3] = turned[c];
    return found;
}

/// Ask for the points and entries of a collapse before they are needed.
static void prefetch_collapse(const bat_mesh_map *map BAT_UNUSED, uint32_t entry BAT_UNUSED)
{
#if defined(__GNUC__)
    const map_collapse *collapse = &map->steps[entry].collapse;
    const char *points = (const char *)(map->points + 2 * (size_t)collapse->first_point),
               *steps = (const char *)(map->steps + collapse->first_entry);
    size_t point_bytes = (FLAT_RING + (size_t)collapse->count + 1) * 2 * sizeof(double),
           step_bytes = ((size_t)collapse->count + collapse->vanishing) * sizeof *map->steps;
    for (size_t at = 0; at < point_bytes; at += CACHE_LINE)
        __builtin_prefetch(points + at);
    for (size_t at = 0; at < step_bytes; at += CACHE_LINE)
        __builtin_prefetch(steps + at);
#else
#endif
}

static void prefetch_step(const bat_mesh_map *map BAT_UNUSED, uint32_t entry BAT_UNUSED)
{
#if defined(__GNUC__)
    __builtin_prefetch(&map->steps[entry]);
#else
#endif
}

/// A point on its way: what is done next is the carrying through `entry`, in alternation with prefetching.
typedef struct traveller
{
    uint32_t entry; ///< MAP_NONE at the end
    bool ready;     ///< the collapse has been asked for
} traveller;

/// Carry points from faces of the fine mesh's numbering through all their collapses. Several points go in turns, so that
/// each waits for memory while the others are carried.
static void carry_all(const bat_mesh_map *map, bool to_fine, bat_mesh_point *points, size_t count)
{
    traveller group[GROUP];
    for (size_t begin = 0; begin < count; begin += GROUP)
    {
        size_t size = count - begin < GROUP ? count - begin : GROUP, left = 0;
        for (size_t i = 0; i < size; i++)
        {
            uint32_t face = points[begin + i].face;
            group[i] = (traveller){to_fine ? map->last[face] : map->first[face], false};
            if (group[i].entry == MAP_NONE)
                continue;
            prefetch_step(map, group[i].entry);
            left++;
        }
        while (left > 0)
            for (size_t i = 0; i < size; i++)
            {
                traveller *one = &group[i];
                if (one->entry == MAP_NONE)
                    continue;
                if (!one->ready)
                {
                    if (size > 1)
                        prefetch_collapse(map, one->entry);
                    one->ready = true;
                    continue;
                }
                bat_mesh_point *point = &points[begin + i];
                uint32_t found = carry(map, one->entry, to_fine, point->barycentric);
                const map_step *step = &map->steps[found];
                point->face = step->half_edge / 3;
                *one = (traveller){to_fine ? step->previous : step->next, false};
                if (one->entry == MAP_NONE)
                    left--;
                else
                    prefetch_step(map, one->entry);
            }
    }
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
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        points[i].face = map->kept[points[i].face];
    carry_all(map, true, points, count);
    return BAT_OK;
}

bat_status bat_mesh_map_to_coarse(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error)
{
    bat_status status = check_points(points, count, map->fine_faces, error);
    if (status != BAT_OK)
        return status;
    carry_all(map, false, points, count);
    for (size_t i = 0; i < count; i++) // the coarse face that the fine one became
    {
        size_t end = 1, high = map->coarse_faces;
        BISECT(end, high, middle, map->kept[middle] <= points[i].face)
        points[i].face = (uint32_t)(end - 1);
    }
    return BAT_OK;
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
            double area = vector2_turn(corners[0], corners[1], corners[2]);
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
    uint32_t *state;
    bat_status status = array_zeros(&state, map->fine_faces, sizeof *state, error);
    for (size_t c = 0; c < map->collapse_count && status == BAT_OK; c++)
        if (!faces_are_upright(map, &map->collapses[c]))
            status = invalid_collapse(error, c, "has a face without area");
        else if (!mark_faces(map, (uint32_t)c, state))
            status = invalid_collapse(error, c, "refers to a removed face");
    if (status == BAT_OK && !kept_is_valid(map, state))
        status = ERROR_FILE(error, 0, "the map's remaining faces differ from those that it lists");
    free(state);
    return status;
}

#include "mesh/decimate/map.h"

#include "base/error.h"

#include <math.h>
#include <stdlib.h>

static bat_status bad(bat_error *error, size_t collapse, const char *what)
{
    return error_set(error, BAT_BAD_FILE, collapse, 0, "collapse %zu of the map %s", collapse, what);
}

/// Whether all faces before and after a collapse lie the right way round.
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

/// Mark the faces that a collapse works on by its number and those that vanish for good. False where one is gone, or there
/// twice.
static bool faces_are_there(const bat_mesh_map *map, uint32_t number, uint32_t *seen)
{
    const map_collapse *collapse = &map->collapses[number];
    for (uint32_t k = 0; k < (uint32_t)collapse->count + collapse->vanishing; k++)
    {
        uint32_t half_edge = map->half_edge[collapse->first_entry + k];
        if (half_edge / 3 >= map->fine_faces)
            return false;
        uint32_t *face = &seen[half_edge / 3];
        if (*face == MAP_NONE || *face == number + 1)
            return false;
        *face = number + 1;
    }
    for (uint32_t k = 0; k < collapse->vanishing; k++)
        seen[map->half_edge[collapse->first_entry + collapse->count + k] / 3] = MAP_NONE;
    return true;
}

/// Whether `kept` lists what has not vanished.
static bool kept_is_right(const bat_mesh_map *map, const uint32_t *seen)
{
    size_t count = 0;
    for (size_t f = 0; f < map->fine_faces; f++)
        if (seen[f] != MAP_NONE && (count == map->coarse_faces || map->kept[count++] != f))
            return false;
    return count == map->coarse_faces;
}

bat_status map_inspect(const bat_mesh_map *map, bat_error *error)
{
    uint32_t *seen = calloc(map->fine_faces + 1, sizeof *seen);
    if (seen == NULL)
        return error_memory(error, map->fine_faces * sizeof *seen);
    bat_status status = BAT_OK;
    for (size_t c = 0; c < map->collapse_count && status == BAT_OK; c++)
        if (!faces_are_upright(map, &map->collapses[c]))
            status = bad(error, c, "has a face without area");
        else if (!faces_are_there(map, (uint32_t)c, seen))
            status = bad(error, c, "works on a face that is not there");
    if (status == BAT_OK && !kept_is_right(map, seen))
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "the map does not end with the faces that it keeps");
    free(seen);
    return status;
}

#include "research/shapes/map_rings.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Countries cut in two by straight borders, as surveyors draw them.

/// A straight border: a line of constant `level`, longitude or latitude, with its ends along the other coordinate.
typedef struct map_cut
{
    bool meridian;
    int64_t level;
    size_t edges[2]; ///< of the outer ring, where the line ends; the line goes upwards
    int64_t ends[2]; ///< in units
    double part;     ///< the share of the area on the left of the line
} map_cut;

/// A ring in the plane, unrolled from its first vertex, with the coordinate across the cut first.
typedef struct flat_ring
{
    int64_t (*at)[2];
    size_t count;
} flat_ring;

static flat_ring flatten(const map_rings *map, const map_ring *ring, int64_t origin, bool meridian)
{
    flat_ring flat = {.at = memory_array(ring->count, sizeof *flat.at), .count = ring->count};
    int64_t longitude = origin;
    for (size_t i = 0; i < ring->count && flat.at != NULL; i++)
    {
        map_vertex vertex = map->vertices[ring->vertices[i]];
        longitude += map_step(vertex.longitude - longitude);
        flat.at[i][meridian ? 0 : 1] = longitude;
        flat.at[i][meridian ? 1 : 0] = vertex.latitude;
    }
    return flat;
}

/// Where the edge after vertex i meets the line; false when it does not.
static bool meets(const flat_ring *flat, size_t i, int64_t level, int64_t *along)
{
    const int64_t *a = flat->at[i], *b = flat->at[(i + 1) % flat->count];
    if ((a[0] < level) == (b[0] < level))
        return false;
    double share = (double)(level - a[0]) / (double)(b[0] - a[0]);
    *along = a[1] + llrint(share * (double)(b[1] - a[1]));
    return true;
}

/// Whether an edge meets the line at an angle that is not small.
static bool is_steep(const flat_ring *flat, size_t i)
{
    static const double LEAST = 0.4;
    const int64_t *a = flat->at[i], *b = flat->at[(i + 1) % flat->count];
    return fabs((double)(b[0] - a[0])) > LEAST * hypot((double)(b[0] - a[0]), (double)(b[1] - a[1]));
}

/// The longest piece of the line within the ring.
static bool longest_piece(const flat_ring *flat, map_cut *cut)
{
    static const double LEAST = 1.5 * MAP_UNITS;
    double longest = LEAST;
    for (size_t i = 0; i < flat->count; i++)
    {
        int64_t from, to, nearest = INT64_MAX;
        size_t edge = 0, below = 0;
        if (flat->at[i][0] == cut->level)
            return false;
        if (!meets(flat, i, cut->level, &from))
            continue;
        for (size_t k = 0; k < flat->count; k++)
        {
            if (k == i || !meets(flat, k, cut->level, &to))
                continue;
            below += to < from;
            if (to > from && to < nearest)
            {
                nearest = to;
                edge = k;
            }
        }
        // The line enters the ring at every other crossing.
        if (below % 2 != 0 || nearest == INT64_MAX || (double)(nearest - from) < longest)
            continue;
        longest = (double)(nearest - from);
        *cut = (map_cut){.meridian = cut->meridian, .level = cut->level, .edges = {i, edge}, .ends = {from, nearest}};
    }
    return longest > LEAST && is_steep(flat, cut->edges[0]) && is_steep(flat, cut->edges[1]);
}

/// Whether a ring stays away from the line, but for the line's ends. A great circle leaves a parallel of one degree by less
/// than a hundredth of the distance from its end.
static bool keeps_clear(const flat_ring *flat, const map_cut *cut)
{
    static const double SLOPE = 0.03, FARTHEST = MAP_UNITS;
    for (size_t i = 0; i < flat->count; i++)
    {
        double below = (double)(flat->at[i][1] - cut->ends[0]), above = (double)(cut->ends[1] - flat->at[i][1]);
        if (below > 0 && above > 0 &&
            fabs((double)(flat->at[i][0] - cut->level)) <= SLOPE * fmin(fmin(below, above), FARTHEST))
            return false;
    }
    return true;
}

/// Whether a hole is cut by the line.
static bool is_cut(const flat_ring *hole, const map_cut *cut)
{
    int64_t along;
    for (size_t i = 0; i < hole->count; i++)
        if (hole->at[i][0] == cut->level ||
            (meets(hole, i, cut->level, &along) && along >= cut->ends[0] && along <= cut->ends[1]))
            return true;
    return false;
}

/// Twice the area between the vertices first + 1, …, last of a ring and the line, or of the whole ring where they are equal.
static double area_between(const flat_ring *flat, const map_cut *cut, size_t first, size_t last)
{
    double area = 0, origin[2] = {(double)cut->level, (double)cut->ends[0]};
    size_t count = (last + flat->count - first) % flat->count;
    count = count == 0 ? flat->count + 1 : count;
    for (size_t i = 1; i < count; i++)
    {
        const int64_t *a = flat->at[(first + i) % flat->count], *b = flat->at[(first + i + 1) % flat->count];
        area += ((double)a[0] - origin[0]) * ((double)b[1] - origin[1]) -
                ((double)b[0] - origin[0]) * ((double)a[1] - origin[1]);
    }
    return fabs(area);
}

/// Whether a cut of a polygon is possible, and its place.
static bool find_cut(map_rings *map, const map_polygon *polygon, map_cut *cut)
{
    static const double LEAST = 0.2; // of the area
    const map_ring *outer = &polygon->rings[0];
    int64_t origin = map->vertices[outer->vertices[0]].longitude;
    flat_ring flat = flatten(map, outer, origin, cut->meridian);
    map->failed = map->failed || flat.at == NULL;
    bool found = flat.at != NULL && longest_piece(&flat, cut) && keeps_clear(&flat, cut);
    if (found)
    {
        double whole = area_between(&flat, cut, 0, 0);
        cut->part = area_between(&flat, cut, cut->edges[0], cut->edges[1]) / whole;
        found = cut->part > LEAST && cut->part < 1 - LEAST;
    }
    free(flat.at);
    for (size_t i = 1; i < polygon->count && found; i++)
    {
        flat = flatten(map, &polygon->rings[i], origin, cut->meridian);
        map->failed = map->failed || flat.at == NULL;
        found = flat.at != NULL && !is_cut(&flat, cut) && keeps_clear(&flat, cut);
        free(flat.at);
    }
    return found;
}

/// A whole or half degree between the bounds of a ring.
static bool choose_level(const map_rings *map, const map_ring *ring, bat_random *random, map_cut *cut)
{
    static const double MARGIN = 0.2, STEP = 0.5 * MAP_UNITS, LEAST = 4.5 * MAP_UNITS;
    int64_t origin = map->vertices[ring->vertices[0]].longitude, low = INT64_MAX, high = INT64_MIN, longitude = origin;
    for (size_t i = 0; i < ring->count; i++)
    {
        map_vertex vertex = map->vertices[ring->vertices[i]];
        longitude += map_step(vertex.longitude - longitude);
        int64_t across = cut->meridian ? longitude : vertex.latitude;
        low = across < low ? across : low;
        high = across > high ? across : high;
    }
    double share = MARGIN + (1 - 2 * MARGIN) * bat_random_uniform(random);
    cut->level = llrint(floor(((double)low + share * (double)(high - low)) / STEP) * STEP);
    return (double)(high - low) > LEAST && cut->level > low && cut->level < high;
}

/// Insert a vertex after place `index` of a ring.
static void ring_insert(map_rings *map, map_ring *ring, size_t index, uint32_t vertex)
{
    map_ring_add(map, ring, vertex);
    if (map->failed)
        return;
    memmove(ring->vertices + index + 2, ring->vertices + index + 1, (ring->count - index - 2) * sizeof *ring->vertices);
    ring->vertices[index + 1] = vertex;
}

/// Insert a vertex into the edge from `from` to `to`, wherever it is.
static void insert_everywhere(map_rings *map, uint32_t from, uint32_t to, uint32_t vertex)
{
    for (size_t a = 0; a < map->area_count; a++)
        for (size_t p = 0; p < map->areas[a].count; p++)
            for (size_t r = 0; r < map->areas[a].polygons[p].count; r++)
            {
                map_ring *ring = &map->areas[a].polygons[p].rings[r];
                for (size_t i = 0; i < ring->count; i++)
                {
                    uint32_t first = ring->vertices[i], second = ring->vertices[(i + 1) % ring->count];
                    if ((first == from && second == to) || (first == to && second == from))
                    {
                        ring_insert(map, ring, i, vertex);
                        break;
                    }
                }
            }
}

static uint32_t cut_vertex(map_rings *map, const map_cut *cut, int64_t along)
{
    double level = (double)cut->level / MAP_UNITS, at = (double)along / MAP_UNITS;
    return map_vertex_add(map, cut->meridian ? level : at, cut->meridian ? at : level);
}

/// Append the part of a ring from one vertex to another, with both.
static void copy_between(map_rings *map, const map_ring *ring, uint32_t from, uint32_t to, map_ring *part)
{
    size_t i = 0;
    while (ring->vertices[i] != from)
        i++;
    for (; ring->vertices[i] != to; i = (i + 1) % ring->count)
        map_ring_add(map, part, ring->vertices[i]);
    map_ring_add(map, part, to);
}

/// The two rings that a cut makes of one: the first ends with the line downwards, the second with it upwards.
static void cut_ring(map_rings *map, const map_ring *ring, const map_cut *cut, const uint32_t ends[2], map_ring parts[2])
{
    size_t inner = cut->meridian ? 0 : (size_t)((cut->ends[1] - cut->ends[0] - 1) / MAP_UNITS);
    uint32_t first = (uint32_t)map->vertex_count;
    for (size_t i = 1; i <= inner; i++)
        (void)cut_vertex(map, cut, cut->ends[0] + (int64_t)i * (cut->ends[1] - cut->ends[0]) / (int64_t)(inner + 1));
    if (map->failed)
        return;
    copy_between(map, ring, ends[0], ends[1], &parts[0]);
    copy_between(map, ring, ends[1], ends[0], &parts[1]);
    for (size_t i = 0; i < inner; i++)
    {
        map_ring_add(map, &parts[0], first + (uint32_t)(inner - 1 - i));
        map_ring_add(map, &parts[1], first + (uint32_t)i);
    }
}

/// Cut a polygon of an area in two. The smaller part becomes an area of its own.
static void apply_cut(map_rings *map, size_t area, size_t polygon, const map_cut *cut)
{
    map_polygon *whole = &map->areas[area].polygons[polygon];
    const map_ring *outer = &whole->rings[0];
    uint32_t bounds[2][2], ends[2];
    for (int k = 0; k < 2; k++)
    {
        bounds[k][0] = outer->vertices[cut->edges[k]];
        bounds[k][1] = outer->vertices[(cut->edges[k] + 1) % outer->count];
        ends[k] = cut_vertex(map, cut, cut->ends[k]);
    }
    for (int k = 0; k < 2 && !map->failed; k++)
        insert_everywhere(map, bounds[k][0], bounds[k][1], ends[k]);
    map_ring parts[2] = {{0}, {0}};
    if (!map->failed)
        cut_ring(map, outer, cut, ends, parts);
    map_area *added = map->failed ? NULL : map_area_add(map, MAP_COUNTRY);
    if (added == NULL)
    {
        free(parts[0].vertices);
        free(parts[1].vertices);
        return;
    }
    whole = &map->areas[area].polygons[polygon];
    int smaller = cut->part < 0.5 ? 0 : 1;
    map_polygon *piece = map_polygon_add(map, added, &parts[smaller]);
    free(whole->rings[0].vertices);
    whole->rings[0] = parts[1 - smaller];
    size_t left = 1;
    for (size_t i = 1; i < whole->count && piece != NULL; i++)
    {
        map_ring hole = whole->rings[i];
        if (map_ring_holds(map, &piece->rings[0], map->vertices[hole.vertices[0]]))
            map_hole_add(map, piece, &hole);
        else
            whole->rings[left++] = hole;
    }
    if (piece != NULL)
        whole->count = left;
}

bool map_rings_split(map_rings *map, size_t count, bat_random *random)
{
    enum
    {
        TRIES = 4000 ///< for each cut
    };
    size_t first = map->area_count;
    for (size_t tries = 0; tries < TRIES * count && map->area_count < first + count && !map->failed; tries++)
    {
        size_t area = 1 + (size_t)(bat_random_uniform(random) * (double)(map->area_count - 1));
        // Two of three are meridians.
        map_cut cut = {.meridian = (map->area_count - first) % 3 != 2};
        const map_area *at = &map->areas[area];
        if (at->kind != MAP_COUNTRY || at->count == 0 || at->polygons[0].pole)
            continue;
        if (choose_level(map, &at->polygons[0].rings[0], random, &cut) && find_cut(map, &at->polygons[0], &cut))
            apply_cut(map, area, 0, &cut);
    }
    return !map->failed;
}

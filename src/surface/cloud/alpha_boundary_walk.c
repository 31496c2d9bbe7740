#include "surface/cloud/alpha_boundary.h"

#include "batten/mesh.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "linalg/vector3.h"
#include "mesh/key_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

enum
{
    /// How often the disc is made smaller where it fits nowhere.
    MOST_SHRINKS = 6,
    LEAST_CYCLE = 3
};
static const double SHRINK = 0.85;
/// How far an arc may begin from where the disc arrives.
static const double MOST_MISS = 1.5707963267948966;

void alpha_boundary_cycles_free(alpha_boundary_cycles *cycles)
{
    for (size_t i = 0; i < cycles->count; i++)
        free(cycles->cycles[i].points);
    free(cycles->cycles);
    *cycles = (alpha_boundary_cycles){0};
}

/// A walk along the rim.
typedef struct alpha_boundary_walk
{
    alpha_boundary_search search;
    key_map steps; ///< from a step, a pair of points, to its number over all walks
    uint32_t step_count;
    uint32_t *path; ///< the points of the present walk
    size_t path_count, path_capacity;
} alpha_boundary_walk;

static bool path_add(alpha_boundary_walk *walk, uint32_t point)
{
    void *path = walk->path;
    bool grown = array_grow(&path, &walk->path_capacity, walk->path_count + 1, sizeof *walk->path);
    walk->path = path;
    if (grown)
        walk->path[walk->path_count++] = point;
    return grown;
}

/// How far one direction is from another, 0 to pi.
static double angle_apart(double a, double b)
{
    return fabs(remainder(a - b, 2 * PI));
}

/// The arc at which the disc goes on when it comes from another point; null when there is none.
static const alpha_boundary_arc *arc_from(const alpha_boundary_search *search, uint32_t before, uint32_t point,
                                          const alpha_boundary_point *here)
{
    double foot[2];
    local_plane_project(&here->plane, search->points + 3 * (size_t)point, search->points + 3 * (size_t)before, foot);
    double apart = fmin(hypot(foot[0], foot[1]) / (2 * here->radius), 1);
    double arrival = atan2(foot[1], foot[0]) + acos(apart), least = MOST_MISS;
    const alpha_boundary_arc *best = NULL;
    for (size_t i = 0; i < here->arc_count; i++)
    {
        const alpha_boundary_arc *arc = &here->arcs[i];
        if (arc->from == before)
            return arc;
        double past = remainder(arrival - arc->begin, 2 * PI);
        bool inside = (past < 0 ? past + 2 * PI : past) <= arc->end - arc->begin;
        double miss = inside ? 0 : angle_apart(arc->begin, arrival);
        if (miss < least)
        {
            least = miss;
            best = arc;
        }
    }
    return best;
}

/// Roll on from a point, where the disc came from another one; `normal` is that of the former and becomes that of the point.
/// The next point is BAT_MESH_NONE when the disc is lost.
static bat_status roll_on(alpha_boundary_walk *walk, uint32_t before, uint32_t point, double normal[3], uint32_t *next,
                          bat_error *error)
{
    double scale = 1;
    *next = BAT_MESH_NONE;
    for (int shrinks = 0; shrinks <= MOST_SHRINKS; shrinks++, scale *= SHRINK)
    {
        alpha_boundary_point here;
        bat_status status = alpha_boundary_point_find(&walk->search, point, normal, scale, &here, error);
        if (status != BAT_OK)
            return status;
        const alpha_boundary_arc *arc = arc_from(&walk->search, before, point, &here);
        if (arc == NULL)
            continue;
        *next = arc->to;
        memcpy(normal, here.plane.axes[2], sizeof here.plane.axes[2]);
        return BAT_OK;
    }
    return BAT_OK;
}

/// Walk from a point until a step repeats. `begin` receives where in the path the cycle begins; SIZE_MAX when there is none
/// or it was found before.
static bat_status walk_from(alpha_boundary_walk *walk, uint32_t start, const alpha_boundary_point *there, size_t arc,
                            size_t *begin, bat_error *error)
{
    uint32_t before = start, point = there->arcs[arc].to, first_step = walk->step_count;
    double normal[3];
    memcpy(normal, there->plane.axes[2], sizeof normal);
    walk->path_count = 0;
    *begin = SIZE_MAX;
    while (point != BAT_MESH_NONE)
    {
        uint32_t *step = key_map_at(&walk->steps, (uint64_t)before << 32 | point);
        if (step == NULL || !path_add(walk, before))
            return error_memory(error, walk->path_capacity * sizeof *walk->path);
        if (*step != UINT32_MAX)
        {
            *begin = *step >= first_step ? *step - first_step : SIZE_MAX;
            walk->path_count--;
            break;
        }
        *step = walk->step_count++;
        uint32_t next;
        bat_status status = roll_on(walk, before, point, normal, &next, error);
        if (status != BAT_OK)
            return status;
        before = point;
        point = next;
    }
    return BAT_OK;
}

static double distance_between(const double *points, uint32_t a, uint32_t b)
{
    double side[3];
    vector3_subtract(points + 3 * (size_t)a, points + 3 * (size_t)b, side);
    return sqrt(vector3_dot(side, side));
}

/// The length of the closed line through points.
static double length_of(const double *points, const uint32_t *line, size_t count)
{
    double length = 0;
    for (size_t i = 0; i < count; i++)
        length += distance_between(points, line[i], line[(i + 1) % count]);
    return length;
}

/// Where a closed line comes to a point again, keep the longer part, until it comes to none again. `last` has an entry for
/// every point, all SIZE_MAX before and afterwards.
static size_t cut_pinches(const double *points, uint32_t *line, size_t count, size_t *last)
{
    for (bool pinched = true; pinched;)
    {
        pinched = false;
        size_t i = 0;
        while (i < count && last[line[i]] == SIZE_MAX)
        {
            last[line[i]] = i;
            i++;
        }
        size_t first = i < count ? last[line[i]] : 0, reached = i;
        for (size_t k = 0; k < reached; k++)
            last[line[k]] = SIZE_MAX;
        if (i == count)
            break;
        pinched = true;
        double inner = length_of(points, line + first, i - first), whole = length_of(points, line, count);
        if (2 * inner > whole)
        {
            memmove(line, line + first, (i - first) * sizeof *line);
            count = i - first;
        }
        else
        {
            memmove(line + first, line + i, (count - i) * sizeof *line);
            count -= i - first;
        }
    }
    return count;
}

/// Take the cycle that the path ends with.
static bat_status take_cycle(alpha_boundary_walk *walk, size_t begin, size_t *last, alpha_boundary_cycles *cycles,
                             bat_error *error)
{
    uint32_t *line = walk->path + begin;
    size_t count = cut_pinches(walk->search.points, line, walk->path_count - begin, last);
    if (count < LEAST_CYCLE)
        return BAT_OK;
    const double *points = walk->search.points;
    alpha_boundary_cycle cycle = {
        .points = memory_array(count, sizeof *line), .count = count, .length = length_of(points, line, count)};
    void *room = cycles->cycles;
    bool grown = array_grow(&room, &cycles->capacity, cycles->count + 1, sizeof cycle);
    cycles->cycles = room;
    if (cycle.points == NULL || !grown)
    {
        free(cycle.points);
        return error_memory(error, count * sizeof *line);
    }
    memcpy(cycle.points, line, count * sizeof *line);
    double mean[3] = {0}, arm[3];
    for (size_t i = 0; i < 3 * count; i++)
        mean[i % 3] += points[3 * (size_t)line[i / 3] + i % 3] / (double)count;
    for (size_t i = 0; i < count; i++)
    {
        vector3_subtract(points + 3 * (size_t)line[i], mean, arm);
        cycle.extent = fmax(cycle.extent, sqrt(vector3_dot(arm, arm)));
    }
    cycles->cycles[cycles->count++] = cycle;
    return BAT_OK;
}

static bat_status is_on_rim(alpha_boundary_search *search, uint32_t point, bool *on_rim)
{
    alpha_boundary_point found = {0};
    bool inside = false;
    bat_status status = alpha_boundary_point_is_inside(search, point, &inside, NULL);
    if (status == BAT_OK && !inside)
        status = alpha_boundary_point_find(search, point, NULL, 1, &found, NULL);
    *on_rim = found.arc_count > 0;
    return status;
}

/// Mark the points that a disc can touch.
static bat_status mark_rim(const double *points, const neighbour_tree *tree, bool *on_rim, bat_error *error)
{
    bool failed = false;
#pragma omp parallel reduction(|| : failed)
    {
        alpha_boundary_search search = {.points = points, .tree = tree};
#pragma omp for schedule(dynamic, 256)
        for (size_t i = 0; i < tree->count; i++)
            failed = is_on_rim(&search, (uint32_t)i, &on_rim[i]) != BAT_OK || failed;
        alpha_boundary_search_free(&search);
    }
    return failed ? error_memory(error, tree->count) : BAT_OK;
}

/// Walk along every rim once.
static bat_status walk_all(alpha_boundary_walk *walk, bool *on_rim, size_t *last, alpha_boundary_cycles *cycles,
                           bat_error *error)
{
    size_t count = walk->search.tree->count;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count; i++)
        last[i] = SIZE_MAX;
    for (uint32_t i = 0; i < count && status == BAT_OK; i++)
    {
        alpha_boundary_point here;
        if (!on_rim[i])
            continue;
        status = alpha_boundary_point_find(&walk->search, i, NULL, 1, &here, error);
        for (size_t arc = 0; status == BAT_OK && arc < here.arc_count; arc++)
        {
            size_t begin;
            status = walk_from(walk, i, &here, arc, &begin, error);
            for (size_t k = 0; k < walk->path_count; k++)
                on_rim[walk->path[k]] = false;
            if (status == BAT_OK && begin != SIZE_MAX)
                status = take_cycle(walk, begin, last, cycles, error);
        }
    }
    return status;
}

bat_status alpha_boundary_cycles_find(const double *points, const neighbour_tree *tree, alpha_boundary_cycles *cycles,
                                      bat_error *error)
{
    *cycles = (alpha_boundary_cycles){0};
    alpha_boundary_walk walk = {.search = {.points = points, .tree = tree}};
    bool *on_rim = memory_array(tree->count, sizeof *on_rim);
    size_t *last = memory_array(tree->count, sizeof *last);
    bat_status status = BAT_OK;
    if (on_rim == NULL || last == NULL)
        status = error_memory(error, tree->count * sizeof *last);
    if (status == BAT_OK)
        status = mark_rim(points, tree, on_rim, error);
    if (status == BAT_OK)
        status = walk_all(&walk, on_rim, last, cycles, error);
    alpha_boundary_search_free(&walk.search);
    key_map_free(&walk.steps);
    free(walk.path);
    free(on_rim);
    free(last);
    return status;
}

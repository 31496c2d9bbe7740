#include "surface/cloud/alpha_boundary.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "batten/mesh.h"
#include "linalg/vector3.h"
#include "mesh/key_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// Neighbours that show the tangent plane and the spacing. They double where the points scatter across the plane, as
    /// long as that makes it flatter: noise gets flatter, curvature does not.
    LEAST_PLANE = 36,
    MOST_PLANE = 1152,
    /// Of small clouds no more than one in so many.
    PLANE_SHARE = 3,
    FEW_PLANE = 10,
    /// Neighbours that mostly are all around a point inside.
    QUICK_NEIGHBOURS = 16
};

static const double PI = 3.14159265358979323846;
/// Scatter across the plane against that along it, in variance, up to which points count as a surface.
static const double FLAT = 0.03;
/// The disc's radius in spacings. At random points the largest empty discs among thousands have about twice the spacing.
static const double RADIUS_IN_SPACINGS = 1.6;
/// The least radius of the disc in deviations across the plane: the rim of a noisy cloud is frayed by as much.
static const double RADIUS_IN_NOISE = 2.0;
static const double LESS_FLAT = 1.1;
/// Directions that are free by less than this are not.
static const double LEAST_ARC = 1e-6;

/// The directions in which a neighbour is in the way of the disc.
typedef struct alpha_boundary_shadow
{
    double begin, end;
    uint32_t item;
} alpha_boundary_shadow;

void alpha_boundary_search_free(alpha_boundary_search *search)
{
    neighbour_list_free(&search->near);
    free(search->shadows);
}

/// Find the plane around a point, and leave the neighbours that it was fitted to in the list.
static bat_status find_plane(alpha_boundary_search *search, const double *here, local_plane *plane, bat_error *error)
{
    size_t count = search->tree->count, most = count / PLANE_SHARE;
    most = most > MOST_PLANE ? MOST_PLANE : most < FEW_PLANE ? FEW_PLANE : most;
    double flattest = INFINITY;
    for (size_t wanted = LEAST_PLANE < most ? LEAST_PLANE : most;; wanted = 2 * wanted < most ? 2 * wanted : most)
    {
        bat_status status = neighbours_nearest(search->tree, here, wanted, &search->near, error);
        if (status != BAT_OK)
            return status;
        local_plane wider = local_plane_fit(search->points, &search->near);
        double flatness = wider.variance[1] > 0 ? wider.variance[2] / wider.variance[1] : INFINITY;
        if (flatness < flattest || flattest == INFINITY)
        {
            flattest = flatness;
            *plane = wider;
        }
        if (flattest <= FLAT || flatness > LESS_FLAT * flattest || wanted == most)
            return BAT_OK;
    }
}

/// Turn the plane over where its normal is on the other side.
static void orient(local_plane *plane, const double *reference)
{
    if (reference == NULL || vector3_dot(plane->axes[2], reference) >= 0)
        return;
    for (int k = 0; k < 3; k++)
    {
        plane->axes[1][k] = -plane->axes[1][k];
        plane->axes[2][k] = -plane->axes[2][k];
    }
}

static int compare_shadows(const void *a, const void *b)
{
    const alpha_boundary_shadow *p = a, *q = b;
    if (p->begin != q->begin)
        return p->begin < q->begin ? -1 : 1;
    return (p->item > q->item) - (p->item < q->item);
}

/// The shadows of the listed neighbours; returns how many, or SIZE_MAX when out of memory.
static size_t cast_shadows(alpha_boundary_search *search, uint32_t point, const alpha_boundary_point *found)
{
    void *room = search->shadows;
    bool grown = array_grow(&room, &search->shadow_capacity, search->near.count + 1, sizeof *search->shadows);
    search->shadows = room;
    if (!grown)
        return SIZE_MAX;
    size_t count = 0;
    for (size_t i = 0; i < search->near.count; i++)
    {
        uint32_t item = search->near.entries[i].item;
        double foot[2];
        local_plane_project(&found->plane, search->points + 3 * (size_t)point, search->points + 3 * (size_t)item, foot);
        double distance = hypot(foot[0], foot[1]);
        if (item == point || distance >= 2 * found->radius || !(distance > 1e-9 * found->radius))
            continue;
        double direction = atan2(foot[1], foot[0]), half = acos(distance / (2 * found->radius));
        double begin = direction - half;
        begin = begin < -PI ? begin + 2 * PI : begin;
        search->shadows[count++] = (alpha_boundary_shadow){begin, begin + 2 * half, item};
    }
    qsort(search->shadows, count, sizeof *search->shadows, compare_shadows);
    return count;
}

static void add_arc(alpha_boundary_point *found, double begin, double end, uint32_t from, uint32_t to)
{
    if (end - begin <= LEAST_ARC || found->arc_count == ALPHA_BOUNDARY_MOST_ARCS)
        return;
    double turn = begin > PI ? 2 * PI : 0;
    found->arcs[found->arc_count++] = (alpha_boundary_arc){begin - turn, end - turn, from, to};
}

/// What the sorted shadows leave free. A point that nothing is near has no arcs: it is no part of any rim.
static void find_arcs(const alpha_boundary_shadow *shadows, size_t count, alpha_boundary_point *found)
{
    found->arc_count = 0;
    if (count == 0)
        return;
    // How far shadows reach that began before the first one.
    alpha_boundary_shadow reach = shadows[0];
    for (size_t i = 0; i < count; i++)
        if (shadows[i].end - 2 * PI > reach.end)
            reach = (alpha_boundary_shadow){0, shadows[i].end - 2 * PI, shadows[i].item};
    for (size_t i = 1; i < count; i++)
    {
        if (shadows[i].begin > reach.end)
            add_arc(found, reach.end, shadows[i].begin, reach.item, shadows[i].item);
        if (shadows[i].end > reach.end)
            reach = shadows[i];
    }
    add_arc(found, reach.end, shadows[0].begin + 2 * PI, reach.item, shadows[0].item);
}

/// How large the disc is, by the neighbours in the list.
static void set_radius(const alpha_boundary_search *search, double scale, alpha_boundary_point *found)
{
    size_t count = search->near.count;
    found->spacing = sqrt(search->near.entries[count - 1].squared * PI / (double)count);
    found->radius = scale * fmax(RADIUS_IN_SPACINGS * found->spacing, RADIUS_IN_NOISE * sqrt(found->plane.variance[2]));
}

static bat_status set_arcs(alpha_boundary_search *search, uint32_t point, alpha_boundary_point *found, bat_error *error)
{
    size_t shadows = cast_shadows(search, point, found);
    if (shadows == SIZE_MAX)
        return error_memory(error, search->shadow_capacity * sizeof *search->shadows);
    find_arcs(search->shadows, shadows, found);
    return BAT_OK;
}

bat_status alpha_boundary_point_find(alpha_boundary_search *search, uint32_t point, const double *reference, double scale,
                                     alpha_boundary_point *found, bat_error *error)
{
    const double *here = search->points + 3 * (size_t)point;
    bat_status status = find_plane(search, here, &found->plane, error);
    if (status != BAT_OK)
        return status;
    orient(&found->plane, reference);
    set_radius(search, scale, found);
    double needed = hypot(2 * found->radius, 3 * sqrt(found->plane.variance[2]));
    if (search->near.entries[search->near.count - 1].squared < needed * needed)
        status = neighbours_within(search->tree, here, needed, &search->near, error);
    return status == BAT_OK ? set_arcs(search, point, found, error) : status;
}

bat_status alpha_boundary_point_is_inside(alpha_boundary_search *search, uint32_t point, bool *inside, bat_error *error)
{
    alpha_boundary_point found = {.arc_count = 1};
    bat_status status =
        neighbours_nearest(search->tree, search->points + 3 * (size_t)point, QUICK_NEIGHBOURS, &search->near, error);
    if (status != BAT_OK)
        return status;
    found.plane = local_plane_fit(search->points, &search->near);
    if (found.plane.variance[2] < FLAT * found.plane.variance[1])
    {
        set_radius(search, 1, &found);
        status = set_arcs(search, point, &found, error);
    }
    *inside = found.arc_count == 0;
    return status;
}

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

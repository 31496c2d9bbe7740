/// @file
/// Alpha-shape boundaries in tangent planes; see boundary.h.
///
/// In the tangent plane, a neighbour at distance d < 2 alpha and direction t blocks the centre directions t - acos(d / (2
/// alpha)) to t + acos(d / (2 alpha)). The complement of all blocked intervals are the free arcs; a point is on the boundary
/// if it has any.

#include "surface/cloud/boundary.h"

#include "base/array_grow.h"
#include "base/progress.h"
#include "base/threads.h"
#include "mesh/hash_table.h"

enum
{
    /// Largest number of neighbours for plane and spacing. The number doubles while the scatter across the plane is large
    /// and the larger neighbourhood is flatter: noise averages out, curvature does not.
    MAX_PLANE = 1152,
    /// In small clouds, at most one in PLANE_SHARE points is a neighbour, but at least FEW_PLANE points are.
    PLANE_SHARE = 3,
    FEW_PLANE = 10,
    /// Number of neighbours that usually surround an interior point.
    INTERIOR_NEIGHBOURS = 16
};

/// Largest ratio of the variance across the plane to the smaller one along it for points on a surface.
static const double MAX_FLATNESS = 0.03;
/// Radius of the disc, in spacings. For random points, the largest of thousands of empty discs has about twice the spacing.
static const double RADIUS_IN_SPACINGS = 1.6;
/// Minimum radius of the disc, in standard deviations across the plane: noise roughens the boundary by this much.
static const double RADIUS_IN_NOISE = 2.0;
/// The search for a plane stops when the flatness grows by more than this factor.
static const double FLATNESS_GROWTH = 1.1;
/// Shorter free arcs are ignored.
static const double MIN_ARC = 1e-6;

/// The interval of directions that a neighbour blocks.
typedef struct alpha_boundary_blocked
{
    double begin, end;
    uint32_t item;
} alpha_boundary_blocked;

static void alpha_boundary_search_free(alpha_boundary_search *search)
{
    neighbour_list_free(&search->near);
    free(search->blocked);
}

/// Fit the tangent plane at a point. The list receives the neighbours of the last fit.
static bat_status find_plane(alpha_boundary_search *search, const double *here, local_plane *plane, bat_error *error)
{
    size_t count = search->tree->count, maximum = count / PLANE_SHARE;
    maximum = maximum > MAX_PLANE ? MAX_PLANE : maximum < FEW_PLANE ? FEW_PLANE : maximum;
    double flattest = INFINITY;
    bool first = true;
    for (size_t wanted = search->plane_points < maximum ? search->plane_points : maximum;;
         wanted = 2 * wanted < maximum ? 2 * wanted : maximum)
    {
        bat_status status = neighbours_nearest(search->tree, here, wanted, &search->near, error);
        if (status != BAT_OK)
            return status;
        local_plane wider = local_plane_fit(search->points, &search->near);
        double flatness = wider.variance[1] > 0 ? wider.variance[2] / wider.variance[1] : INFINITY;
        if (first || flatness < flattest)
        {
            first = false;
            flattest = flatness;
            *plane = wider;
        }
        if (flattest <= MAX_FLATNESS || flatness > FLATNESS_GROWTH * flattest || wanted == maximum)
            return BAT_OK;
    }
}

/// Flip the plane if its normal points away from the reference.
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

DEFINE_ORDER(compare_blocked, alpha_boundary_blocked, begin, item)

/// Compute the sorted intervals that the listed neighbours block. Returns their number, SIZE_MAX when out of memory.
static size_t find_blocked(alpha_boundary_search *search, uint32_t point, const alpha_boundary_point *found)
{
    if (!ARRAY_GROW(search->blocked, search->blocked_capacity, search->near.count + 1))
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
        begin = begin < -ANGLE_PI ? begin + 2 * ANGLE_PI : begin;
        search->blocked[count++] = (alpha_boundary_blocked){begin, begin + 2 * half, item};
    }
    qsort(search->blocked, count, sizeof *search->blocked, compare_blocked);
    return count;
}

static void add_free_arc(alpha_boundary_point *found, double begin, double end, uint32_t from, uint32_t to)
{
    if (end - begin <= MIN_ARC || found->arc_count == ALPHA_BOUNDARY_MAX_ARCS)
        return;
    double turn = begin > ANGLE_PI ? 2 * ANGLE_PI : 0;
    found->arcs[found->arc_count++] = (alpha_boundary_arc){begin - turn, end - turn, from, to};
}

/// Compute the free arcs between sorted blocked intervals. A point without neighbours is not on any boundary.
static void find_free_arcs(const alpha_boundary_blocked *blocked, size_t count, alpha_boundary_point *found)
{
    found->arc_count = 0;
    if (count == 0)
        return;
    // The end of intervals that wrap around past the first one.
    alpha_boundary_blocked reach = blocked[0];
    for (size_t i = 0; i < count; i++)
        if (blocked[i].end - 2 * ANGLE_PI > reach.end)
            reach = (alpha_boundary_blocked){0, blocked[i].end - 2 * ANGLE_PI, blocked[i].item};
    for (size_t i = 1; i < count; i++)
    {
        if (blocked[i].begin > reach.end)
            add_free_arc(found, reach.end, blocked[i].begin, reach.item, blocked[i].item);
        if (blocked[i].end > reach.end)
            reach = blocked[i];
    }
    add_free_arc(found, reach.end, blocked[0].begin + 2 * ANGLE_PI, reach.item, blocked[0].item);
}

/// The mean spacing of the neighbours in the list.
static double spacing_of(const neighbour_list *near)
{
    return sqrt(near->entries[near->count - 1].squared * ANGLE_PI / (double)near->count);
}

static void set_radius(double scale, alpha_boundary_point *found)
{
    found->radius = scale * fmax(RADIUS_IN_SPACINGS * found->spacing, RADIUS_IN_NOISE * sqrt(found->plane.variance[2]));
}

static bat_status set_arcs(alpha_boundary_search *search, uint32_t point, alpha_boundary_point *found, bat_error *error)
{
    size_t blocked = find_blocked(search, point, found);
    if (blocked == SIZE_MAX)
        return error_memory(error, search->blocked_capacity * sizeof *search->blocked);
    find_free_arcs(search->blocked, blocked, found);
    return BAT_OK;
}

/// Recall the plane of a point, or find it and keep it.
static bat_status recall_plane(alpha_boundary_search *search, uint32_t point, alpha_boundary_point *found, bat_error *error)
{
    alpha_boundary_plane *kept = search->planes != NULL ? &search->planes[point] : NULL;
    if (kept == NULL || kept->spacing == 0)
    {
        bat_status status = find_plane(search, search->points + 3 * (size_t)point, &found->plane, error);
        if (status != BAT_OK)
            return status;
        found->spacing = spacing_of(&search->near);
        if (kept == NULL)
            return BAT_OK;
        memcpy(kept->axis, found->plane.axes[0], sizeof kept->axis);
        memcpy(kept->normal, found->plane.axes[2], sizeof kept->normal);
        kept->deviation = sqrt(found->plane.variance[2]);
        kept->spacing = found->spacing;
    }
    found->plane = (local_plane){.variance = {[2] = kept->deviation * kept->deviation}};
    memcpy(found->plane.axes[0], kept->axis, sizeof kept->axis);
    memcpy(found->plane.axes[2], kept->normal, sizeof kept->normal);
    vector3_cross(kept->normal, kept->axis, found->plane.axes[1]);
    found->spacing = kept->spacing;
    return BAT_OK;
}

/// Compute the local geometry at a point.
/// @param reference vector whose side the normal is oriented to; null for any
/// @param scale     factor of the radius
static bat_status alpha_boundary_point_find(alpha_boundary_search *search, uint32_t point, const double *reference,
                                            double scale, alpha_boundary_point *found, bat_error *error)
{
    bat_status status = recall_plane(search, point, found, error);
    if (status != BAT_OK)
        return status;
    orient(&found->plane, reference);
    set_radius(scale, found);
    double needed = hypot(2 * found->radius, 3 * sqrt(found->plane.variance[2]));
    status = neighbours_within(search->tree, search->points + 3 * (size_t)point, needed, &search->near, error);
    return status == BAT_OK ? set_arcs(search, point, found, error) : status;
}

/// Quick test by few neighbours whether a point is in the interior: they are coplanar and surround the point.
/// @param scale factor of the radius
static bat_status alpha_boundary_point_is_inside(alpha_boundary_search *search, uint32_t point, double scale, bool *inside,
                                                 bat_error *error)
{
    alpha_boundary_point found = {.arc_count = 1};
    bat_status status =
        neighbours_nearest(search->tree, search->points + 3 * (size_t)point, INTERIOR_NEIGHBOURS, &search->near, error);
    if (status != BAT_OK)
        return status;
    found.plane = local_plane_fit(search->points, &search->near);
    if (found.plane.variance[2] < MAX_FLATNESS * found.plane.variance[1])
    {
        found.spacing = spacing_of(&search->near);
        set_radius(scale, &found);
        status = set_arcs(search, point, &found, error);
    }
    *inside = found.arc_count == 0;
    return status;
}

enum
{
    /// Maximum number of reductions of the disc where it fits nowhere.
    MAX_SHRINKS = 6,
    MIN_CYCLE = 3
};
static const double SHRINK = 0.85;
/// Maximum angle between the arriving disc and the begin of an arc.
static const double MAX_ANGLE_ERROR = 1.5707963267948966;

typedef struct alpha_boundary_trace
{
    alpha_boundary_search search;
    double scale;  ///< factor of the radius of the disc
    key_map steps; ///< maps a step, a pair of points, to its number over all traces
    uint32_t step_count;
    uint32_t *path; ///< the points of the current trace
    size_t path_count, path_capacity;
} alpha_boundary_trace;

/// The arc along which the disc continues when it arrives from another point; null if there is none.
static const alpha_boundary_arc *arc_from(const alpha_boundary_search *search, uint32_t before, uint32_t point,
                                          const alpha_boundary_point *here)
{
    double foot[2];
    local_plane_project(&here->plane, search->points + 3 * (size_t)point, search->points + 3 * (size_t)before, foot);
    double apart = fmin(hypot(foot[0], foot[1]) / (2 * here->radius), 1);
    double arrival = atan2(foot[1], foot[0]) + acos(apart), minimum = MAX_ANGLE_ERROR;
    const alpha_boundary_arc *best = NULL;
    for (size_t i = 0; i < here->arc_count; i++)
    {
        const alpha_boundary_arc *arc = &here->arcs[i];
        if (arc->from == before)
            return arc;
        double past = remainder(arrival - arc->begin, 2 * ANGLE_PI);
        bool inside = (past < 0 ? past + 2 * ANGLE_PI : past) <= arc->end - arc->begin;
        double angle_error = inside ? 0 : fabs(remainder(arc->begin - arrival, 2 * ANGLE_PI));
        if (angle_error < minimum)
        {
            minimum = angle_error;
            best = arc;
        }
    }
    return best;
}

/// Roll the disc over `point`, arriving from `before`. `normal` is the normal at `before` on entry and at `point` on return.
/// `next` receives the next boundary point, BAT_MESH_NONE if the disc fits nowhere.
static bat_status next_point(alpha_boundary_trace *trace, uint32_t before, uint32_t point, double normal[3], uint32_t *next,
                             bat_error *error)
{
    double scale = trace->scale;
    *next = BAT_MESH_NONE;
    for (int shrinks = 0; shrinks <= MAX_SHRINKS; shrinks++, scale *= SHRINK)
    {
        alpha_boundary_point here;
        bat_status status = alpha_boundary_point_find(&trace->search, point, normal, scale, &here, error);
        if (status != BAT_OK)
            return status;
        const alpha_boundary_arc *arc = arc_from(&trace->search, before, point, &here);
        if (arc == NULL)
            continue;
        *next = arc->to;
        memcpy(normal, here.plane.axes[2], sizeof here.plane.axes[2]);
        return BAT_OK;
    }
    return BAT_OK;
}

/// Trace the boundary from a point until a step repeats. `begin` receives the index in the path at which the cycle begins;
/// SIZE_MAX if there is none, or if it was found before.
static bat_status trace_from(alpha_boundary_trace *trace, uint32_t start, const alpha_boundary_point *there, size_t arc,
                             size_t *begin, bat_error *error)
{
    uint32_t before = start, point = there->arcs[arc].to, first_step = trace->step_count;
    double normal[3];
    memcpy(normal, there->plane.axes[2], sizeof normal);
    trace->path_count = 0;
    *begin = SIZE_MAX;
    while (point != BAT_MESH_NONE)
    {
        uint32_t *step = key_map_at(&trace->steps, (uint64_t)before << 32 | point);
        if (step == NULL || !ARRAY_ADD(trace->path, trace->path_capacity, trace->path_count, before))
            return error_memory(error, trace->path_capacity * sizeof *trace->path);
        if (*step != UINT32_MAX)
        {
            *begin = *step >= first_step ? *step - first_step : SIZE_MAX;
            trace->path_count--;
            break;
        }
        *step = trace->step_count++;
        uint32_t next;
        bat_status status = next_point(trace, before, point, normal, &next, error);
        if (status != BAT_OK)
            return status;
        before = point;
        point = next;
    }
    return BAT_OK;
}

static double length_of(const double *points, const uint32_t *line, size_t count)
{
    double length = 0;
    for (size_t i = 0; i < count; i++)
        length += vector3_distance(points + 3 * (size_t)line[i], points + 3 * (size_t)line[(i + 1) % count]);
    return length;
}

/// Make a closed polygon simple: at every repeated point, keep the longer of the two parts.
/// @param last an entry for each point, SIZE_MAX on entry and on return
/// @return the number of corners that are left
static size_t cut_pinches(const double *points, uint32_t *line, size_t count, size_t *last)
{
    size_t i = 0;
    while (i < count)
    {
        size_t before = last[line[i]];
        if (before == SIZE_MAX)
        {
            last[line[i]] = i;
            i++;
            continue;
        }
        double inner = length_of(points, line + before, i - before), all = length_of(points, line, count);
        for (size_t k = 0; k < i; k++)
            last[line[k]] = SIZE_MAX;
        if (2 * inner > all)
        {
            memmove(line, line + before, (i - before) * sizeof *line);
            count = i - before;
        }
        else
        {
            memmove(line + before, line + i, (count - i) * sizeof *line);
            count -= i - before;
        }
        i = 0;
    }
    for (size_t k = 0; k < count; k++)
        last[line[k]] = SIZE_MAX;
    return count;
}

static bat_status store_cycle(alpha_boundary_trace *trace, size_t begin, size_t *last, alpha_boundary_cycles *cycles,
                              bat_error *error)
{
    uint32_t *line = trace->path + begin;
    size_t count = cut_pinches(trace->search.points, line, trace->path_count - begin, last);
    if (count < MIN_CYCLE)
        return BAT_OK;
    const double *points = trace->search.points;
    alpha_boundary_cycle cycle = {
        .points = memory_array(count, sizeof *line), .count = count, .length = length_of(points, line, count)};
    if (cycle.points == NULL || !ARRAY_GROW(cycles->cycles, cycles->capacity, cycles->count + 1))
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

static bat_status is_on_boundary(alpha_boundary_search *search, uint32_t point, double scale, bool *on_boundary)
{
    alpha_boundary_point found = {0};
    bool inside = false;
    bat_status status = alpha_boundary_point_is_inside(search, point, scale, &inside, NULL);
    if (status == BAT_OK && !inside)
        status = alpha_boundary_point_find(search, point, NULL, scale, &found, NULL);
    *on_boundary = found.arc_count > 0;
    return status;
}

static const size_t MARK_BLOCK = 65536; ///< points between two reports

static bool mark_block(const alpha_boundary_cloud *cloud, size_t begin, size_t end)
{
    bool failed = false;
#pragma omp parallel num_threads(threads_for(0, (end - begin) / 256 + 1)) reduction(|| : failed)
    {
        alpha_boundary_search search = {
            .points = cloud->points, .tree = cloud->tree, .planes = cloud->planes, .plane_points = cloud->plane_points};
#pragma omp for schedule(dynamic, 256)
        for (size_t i = begin; i < end; i++)
            failed = is_on_boundary(&search, (uint32_t)i, 1, &cloud->outer[i]) != BAT_OK || failed;
        alpha_boundary_search_free(&search);
    }
    return !failed;
}

bat_status alpha_boundary_cloud_make(const double *points, const nearest_tree *tree, size_t plane_points,
                                     bat_progress progress, alpha_boundary_cloud *cloud, bat_error *error)
{
    size_t count = tree->count;
    *cloud = (alpha_boundary_cloud){.points = points,
                                    .tree = tree,
                                    .plane_points = plane_points,
                                    .planes = memory_array(count, sizeof *cloud->planes),
                                    .outer = memory_array(count, sizeof *cloud->outer)};
    if (cloud->planes == NULL || cloud->outer == NULL)
        return error_memory(error, count * sizeof *cloud->planes);
    memset(cloud->planes, 0, count * sizeof *cloud->planes);
    for (size_t begin = 0; begin < count; begin += MARK_BLOCK)
    {
        size_t end = count - begin < MARK_BLOCK ? count : begin + MARK_BLOCK;
        if (progress_check(progress, (double)begin / (double)count, error) != BAT_OK)
            return BAT_CANCELLED;
        if (!mark_block(cloud, begin, end))
            return error_memory(error, count);
    }
    for (size_t i = 0; i < count; i++)
        cloud->outer_count += cloud->outer[i];
    return BAT_OK;
}

static bat_status trace_all(alpha_boundary_trace *trace, bool *on_boundary, size_t *last, alpha_boundary_cycles *cycles,
                            bat_error *error)
{
    size_t count = trace->search.tree->count;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count; i++)
        last[i] = SIZE_MAX;
    for (uint32_t i = 0; i < count && status == BAT_OK; i++)
    {
        alpha_boundary_point here;
        if (!on_boundary[i])
            continue;
        status = alpha_boundary_point_find(&trace->search, i, NULL, trace->scale, &here, error);
        for (size_t arc = 0; status == BAT_OK && arc < here.arc_count; arc++)
        {
            size_t begin;
            status = trace_from(trace, i, &here, arc, &begin, error);
            for (size_t k = 0; k < trace->path_count; k++)
                on_boundary[trace->path[k]] = false;
            if (status == BAT_OK && begin != SIZE_MAX)
                status = store_cycle(trace, begin, last, cycles, error);
        }
    }
    return status;
}

bat_status alpha_boundary_cycles_find(const alpha_boundary_cloud *cloud, double scale, alpha_boundary_cycles *cycles,
                                      bat_error *error)
{
    *cycles = (alpha_boundary_cycles){0};
    size_t count = cloud->tree->count;
    alpha_boundary_trace trace = {.search = {.points = cloud->points,
                                             .tree = cloud->tree,
                                             .planes = cloud->planes,
                                             .plane_points = cloud->plane_points},
                                  .scale = scale};
    memory_pool pool = {0};
    bool *on_boundary = memory_pool_array(&pool, count, sizeof *on_boundary);
    size_t *last = memory_pool_array(&pool, count, sizeof *last);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        memcpy(on_boundary, cloud->outer, count * sizeof *on_boundary);
        status = trace_all(&trace, on_boundary, last, cycles, error);
    }
    alpha_boundary_search_free(&trace.search);
    key_map_free(&trace.steps);
    free(trace.path);
    memory_pool_free(&pool);
    return status;
}

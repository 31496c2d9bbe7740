#include "surface/cloud/alpha_boundary.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "linalg/vector3.h"

#include <math.h>
#include <stdlib.h>

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

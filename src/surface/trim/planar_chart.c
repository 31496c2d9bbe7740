/// @file
/// Charts with free boundary: places of the points of a cloud in a rectangle, with little distortion. A cloud whose normals
/// are within MAX_TILT of one direction is projected along it, and so is one that is flat as a whole. Other clouds get the
/// places u that minimize
///     sum over neighbours i, j of |u_j - u_i - R_i p_ij|^2,
/// where p_ij is the projection of x_j - x_i to the tangent plane of x_i, with the length of x_j - x_i, and R_i a rotation:
/// the energy of Sorkine and Alexa, "As-rigid-as-possible surface modeling" (2007), from the tangent planes that are
/// unrolled along a tree.

#include "surface/trim/trimming.h"

#include "base/error.h"
#include "linalg/multifrontal.h"
#include "linalg/vector.h"

#include <string.h>

enum
{
    NODES = 6000, ///< of larger clouds, so many points are unrolled, the others follow their neighbours
    LINKS = 10,   ///< neighbours of a node
    ROUNDS = 200,
    FOLLOWED = 4 ///< nodes that another point follows
};

/// Cosine of the largest angle between a normal and the direction of projection, and the share of points that keep it.
static const double MAX_TILT = 0.6;
static const double TILT_SHARE = 0.98;
/// A cloud is flat when its smallest standard deviation is this share of the middle one.
static const double FLAT = 0.03;
/// Rounds end when no rotation changes by more.
static const double MIN_TURN = 1e-5;
/// Smallest ratio of the sides of a chart.
static const double MIN_RATIO = 1e-4;

void planar_chart_free(planar_chart *chart)
{
    free(chart->places);
    *chart = (planar_chart){0};
}

// Projection

/// Turn a vector so that its largest coordinate is positive.
static void set_direction(const double vector[3], double direction[3])
{
    size_t largest = 0;
    for (size_t c = 1; c < 3; c++)
        largest = fabs(vector[c]) > fabs(vector[largest]) ? c : largest;
    double sign = vector[largest] < 0 ? -1 : 1;
    for (size_t c = 0; c < 3; c++)
        direction[c] = sign * vector[c];
}

/// The direction of the mean normal, on the side of its largest coordinate; false where the normals cancel or are tilted.
static bool find_direction(const cloud_geometry *geometry, double direction[3])
{
    size_t count = geometry->order.cloud.count, upright = 0;
    memset(direction, 0, 3 * sizeof *direction);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < 3; c++)
            direction[c] += geometry->oriented.planes[i].axes[2][c];
    double length = sqrt(vector3_dot(direction, direction));
    if (!(length > 0))
        return false;
    for (size_t c = 0; c < 3; c++)
        direction[c] /= length;
    for (size_t i = 0; i < count; i++)
        upright += vector3_dot(direction, geometry->oriented.planes[i].axes[2]) >= MAX_TILT;
    set_direction(direction, direction);
    return (double)upright >= TILT_SHARE * (double)count;
}

static void project(const cloud_geometry *geometry, const double direction[3], double (*places)[2])
{
    // The coordinate axis that is farthest from the direction becomes the first axis of the plane.
    size_t least = 0;
    for (size_t c = 1; c < 3; c++)
        least = fabs(direction[c]) < fabs(direction[least]) ? c : least;
    double first[3] = {0}, second[3];
    first[least] = 1;
    for (size_t c = 0; c < 3; c++)
        first[c] -= direction[least] * direction[c];
    double length = sqrt(vector3_dot(first, first));
    for (size_t c = 0; c < 3; c++)
        first[c] /= length;
    vector3_cross(direction, first, second);
    for (size_t i = 0; i < geometry->order.cloud.count; i++)
    {
        const double *point = geometry->order.cloud.points + 3 * i;
        places[i][0] = vector3_dot(point, first);
        places[i][1] = vector3_dot(point, second);
    }
}

// Unrolling

typedef struct chart_link
{
    uint32_t from, to;
    double step[2]; ///< from `from` to `to` in the plane of `from`
} chart_link;

typedef struct unrolling
{
    const cloud_geometry *geometry;
    memory_pool pool;
    uint32_t *nodes; ///< node_count: points
    size_t node_count;
    nearest_tree tree;   ///< of the nodes
    double *positions;   ///< node_count x 3
    chart_link *links;   ///< by `from`; each pair of neighbours in both directions
    size_t *first;       ///< node_count + 1
    double *angle;       ///< node_count: of R_i
    double (*turn)[2];   ///< node_count: cosine and sine of the angle
    double (*places)[2]; ///< node_count
    multifrontal *solver;
} unrolling;

static const local_plane *plane_of(const unrolling *work, size_t node)
{
    return &work->geometry->oriented.planes[work->nodes[node]];
}

/// The step between two places in the tangent plane at the first, with its length in space.
static void flat_step(const local_plane *plane, const double *from, const double *to, double step[2])
{
    local_plane_project(plane, from, to, step);
    double flat = hypot(step[0], step[1]), length = vector3_distance(from, to);
    for (int d = 0; d < 2 && flat > 0; d++)
        step[d] *= length / flat;
}

static bat_status choose_nodes(unrolling *work, bat_error *error)
{
    size_t count = work->geometry->order.cloud.count;
    work->node_count = count < NODES ? count : NODES;
    work->nodes = memory_pool_array(&work->pool, work->node_count, sizeof *work->nodes);
    work->positions = memory_pool_array(&work->pool, work->node_count, 3 * sizeof *work->positions);
    work->links = memory_pool_array(&work->pool, work->node_count, 2 * LINKS * sizeof *work->links);
    work->first = memory_pool_zeros(&work->pool, work->node_count + 2, sizeof *work->first);
    work->angle = memory_pool_zeros(&work->pool, work->node_count, sizeof *work->angle);
    work->turn = memory_pool_zeros(&work->pool, work->node_count, sizeof *work->turn);
    work->places = memory_pool_zeros(&work->pool, work->node_count, sizeof *work->places);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < work->node_count; i++)
    {
        // The points are in spatial order, so that an even choice is even in space.
        work->nodes[i] = (uint32_t)(i * count / work->node_count);
        memcpy(work->positions + 3 * i, work->geometry->order.cloud.points + 3 * (size_t)work->nodes[i], 3 * sizeof(double));
    }
    return neighbours_build(work->positions, work->node_count, &work->tree, error);
}

DEFINE_ORDER(compare_links, chart_link, from, to)

/// Link each node with its nearest ones, in both directions.
static bat_status make_links(unrolling *work, bat_error *error)
{
    size_t count = 0, kept = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < work->node_count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(&work->tree, work->positions + 3 * i, LINKS + 1, &near, error);
        for (size_t k = 0; k < near.count && status == BAT_OK; k++)
        {
            uint32_t other = near.entries[k].item;
            if (other == i || count + 2 > 2 * LINKS * work->node_count)
                continue;
            work->links[count++] = (chart_link){.from = (uint32_t)i, .to = other};
            work->links[count++] = (chart_link){.from = other, .to = (uint32_t)i};
        }
    }
    neighbour_list_free(&near);
    qsort(work->links, count, sizeof *work->links, compare_links);
    for (size_t k = 0; k < count; k++)
        if (k == 0 || compare_links(&work->links[k], &work->links[kept - 1]) != 0)
        {
            chart_link link = work->links[k];
            flat_step(plane_of(work, link.from), work->positions + 3 * (size_t)link.from,
                      work->positions + 3 * (size_t)link.to, link.step);
            work->first[link.from + 1]++;
            work->links[kept++] = link;
        }
    for (size_t i = 0; i < work->node_count; i++)
        work->first[i + 1] += work->first[i];
    return status;
}

/// The angle of the first axis of one plane in another one, after the shortest rotation of its normal.
static double axis_angle(const local_plane *from, const local_plane *to)
{
    const double *axis = from->axes[0];
    double across[3], turned[3], cosine = vector3_dot(from->axes[2], to->axes[2]);
    vector3_cross(from->axes[2], to->axes[2], across);
    // Rodrigues' formula with sin = |across|, cos = cosine: v cos + across x v + across (across . v) / (1 + cos).
    vector3_cross(across, axis, turned);
    double along = vector3_dot(across, axis) / fmax(1 + cosine, 1e-3);
    for (size_t c = 0; c < 3; c++)
        turned[c] += cosine * axis[c] + along * across[c];
    return atan2(vector3_dot(turned, to->axes[1]), vector3_dot(turned, to->axes[0]));
}

/// Unroll the planes along a tree of fewest links from the node nearest to the mean. Fails where nodes are not linked.
static bat_status unroll_tree(unrolling *work, bat_error *error)
{
    double mean[3] = {0};
    for (size_t k = 0; k < 3 * work->node_count; k++)
        mean[k % 3] += work->positions[k] / (double)work->node_count;
    neighbour_list near = {0};
    uint32_t *queue = memory_pool_array(&work->pool, work->node_count, sizeof *queue);
    bool *reached = memory_pool_zeros(&work->pool, work->node_count, sizeof *reached);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
        status = neighbours_nearest(&work->tree, mean, 1, &near, error);
    size_t head = 0, tail = 0;
    if (status == BAT_OK)
    {
        queue[tail++] = near.entries[0].item;
        reached[near.entries[0].item] = true;
    }
    while (head < tail)
    {
        uint32_t node = queue[head++];
        double c = cos(work->angle[node]), s = sin(work->angle[node]);
        for (size_t k = work->first[node]; k < work->first[node + 1]; k++)
        {
            const chart_link *link = &work->links[k];
            if (reached[link->to])
                continue;
            reached[link->to] = true;
            queue[tail++] = link->to;
            work->angle[link->to] = work->angle[node] - axis_angle(plane_of(work, node), plane_of(work, link->to));
            work->places[link->to][0] = work->places[node][0] + c * link->step[0] - s * link->step[1];
            work->places[link->to][1] = work->places[node][1] + s * link->step[0] + c * link->step[1];
        }
    }
    if (status == BAT_OK && tail < work->node_count)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                           "the cloud has several pieces, the largest of about %.0f %% of the points; give each alone",
                           100 * fmax((double)tail, (double)(work->node_count - tail)) / (double)work->node_count);
    neighbour_list_free(&near);
    return status;
}

/// Factor the Laplacian of the links, without the last node.
static bat_status make_solver(unrolling *work, bat_error *error)
{
    size_t count = work->node_count - 1, links = work->first[work->node_count], made = 0;
    int *first = memory_pool_array(&work->pool, count + 1, sizeof *first);
    int *row = memory_pool_array(&work->pool, links + count, sizeof *row);
    double *values = memory_pool_array(&work->pool, links + count, sizeof *values), pivot = 0;
    bat_status status = memory_pool_check(&work->pool, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        first[i] = (int)made;
        row[made] = (int)i;
        values[made++] = (double)(work->first[i + 1] - work->first[i]);
        for (size_t k = work->first[i]; k < work->first[i + 1]; k++)
            if (work->links[k].to > i && work->links[k].to < count)
            {
                row[made] = (int)work->links[k].to;
                values[made++] = -1;
            }
    }
    const symmetric_pattern pattern = {count, first, row};
    if (status == BAT_OK)
    {
        first[count] = (int)made;
        status = multifrontal_make(&pattern, true, &work->solver, error);
    }
    if (status == BAT_OK)
        status = multifrontal_factor(work->solver, values, NULL, &pivot, error);
    if (status == BAT_OK && !(pivot > 0))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the chart of the cloud is singular");
    return status;
}

/// The best places for given rotations, with the last node at the origin.
static bat_status solve_places(unrolling *work, double *right, bat_error *error)
{
    size_t count = work->node_count - 1;
    bat_status status = BAT_OK;
    for (size_t i = 0; i < work->node_count; i++)
    {
        work->turn[i][0] = cos(work->angle[i]);
        work->turn[i][1] = sin(work->angle[i]);
    }
    for (int d = 0; d < 2 && status == BAT_OK; d++)
    {
        memset(right, 0, work->node_count * sizeof *right);
        for (size_t k = 0; k < work->first[work->node_count]; k++)
        {
            const chart_link *link = &work->links[k];
            double c = work->turn[link->from][0], s = work->turn[link->from][1];
            double step = d == 0 ? c * link->step[0] - s * link->step[1] : s * link->step[0] + c * link->step[1];
            right[link->from] -= step / 2;
            right[link->to] += step / 2;
        }
        status = multifrontal_solve(work->solver, 1, right, error);
        for (size_t i = 0; i < count; i++)
            work->places[i][d] = right[i];
        work->places[count][d] = 0;
    }
    return status;
}

/// The best rotations for given places. Returns the largest change.
static double solve_rotations(unrolling *work)
{
    double largest = 0;
    for (size_t i = 0; i < work->node_count; i++)
    {
        double along = 0, across = 0;
        for (size_t k = work->first[i]; k < work->first[i + 1]; k++)
        {
            const chart_link *link = &work->links[k];
            const double *p = link->step;
            double q[2] = {work->places[link->to][0] - work->places[i][0], work->places[link->to][1] - work->places[i][1]};
            along += p[0] * q[0] + p[1] * q[1];
            across += p[0] * q[1] - p[1] * q[0];
        }
        double angle = atan2(across, along);
        largest = fmax(largest, fabs(remainder(angle - work->angle[i], 2 * ANGLE_PI)));
        work->angle[i] = angle;
    }
    return largest;
}

/// The place of a point: the mean of where the nearest nodes' rotations take it, by inverse squared distances.
static void follow(const unrolling *work, const neighbour_list *near, const double *point, double place[2])
{
    double sum = 0;
    place[0] = place[1] = 0;
    for (size_t k = 0; k < near->count; k++)
    {
        size_t node = near->entries[k].item;
        double step[2], weight = 1 / fmax(near->entries[k].squared, 1e-24);
        flat_step(plane_of(work, node), work->positions + 3 * node, point, step);
        double c = cos(work->angle[node]), s = sin(work->angle[node]);
        place[0] += weight * (work->places[node][0] + c * step[0] - s * step[1]);
        place[1] += weight * (work->places[node][1] + s * step[0] + c * step[1]);
        sum += weight;
    }
    place[0] /= sum;
    place[1] /= sum;
}

static bat_status place_points(const unrolling *work, double (*places)[2], bat_error *error)
{
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = 0; i < work->geometry->order.cloud.count && status == BAT_OK; i++)
    {
        const double *point = work->geometry->order.cloud.points + 3 * i;
        status = neighbours_nearest(&work->tree, point, FOLLOWED, &near, error);
        if (status == BAT_OK)
            follow(work, &near, point, places[i]);
    }
    neighbour_list_free(&near);
    return status;
}

static bat_status unroll_cloud(const cloud_geometry *geometry, double (*places)[2], bat_error *error)
{
    unrolling work = {.geometry = geometry};
    bat_status status = choose_nodes(&work, error);
    if (status == BAT_OK)
        status = make_links(&work, error);
    if (status == BAT_OK)
        status = unroll_tree(&work, error);
    if (status == BAT_OK)
        status = make_solver(&work, error);
    if (status == BAT_OK)
    {
        double *right = memory_pool_array(&work.pool, work.node_count, sizeof *right), change = INFINITY;
        status = memory_pool_check(&work.pool, error);
        for (int round = 0; round < ROUNDS && change > MIN_TURN && status == BAT_OK; round++)
        {
            status = solve_places(&work, right, error);
            change = solve_rotations(&work);
        }
    }
    if (status == BAT_OK)
        status = place_points(&work, places, error);
    memory_pool_free(&work.pool);
    nearest_free(&work.tree);
    multifrontal_free(work.solver);
    return status;
}

// The rectangle

static int compare_places(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return p[0] != q[0] ? ORDER_OF(p[0], q[0]) : ORDER_OF(p[1], q[1]);
}

/// The convex hull of sorted places, counter-clockwise (Andrew, 1979). `hull` has room for 2 count. Returns its size.
static size_t find_hull(const double (*sorted)[2], size_t count, double (*hull)[2])
{
    size_t made = 0;
    for (int side = 0; side < 2; side++)
    {
        size_t begin = made;
        for (size_t i = 0; i < count; i++)
        {
            const double *place = sorted[side == 0 ? i : count - 1 - i];
            while (made >= begin + 2 && vector2_turn(hull[made - 2], hull[made - 1], place) <= 0)
                made--;
            memcpy(hull[made++], place, sizeof *hull);
        }
        made--;
    }
    return made;
}

/// The box of a polygon in rotated axes.
static void box_of(const double (*hull)[2], size_t count, const double axis[2], double low[2], double high[2])
{
    box_clear(2, low, high);
    for (size_t i = 0; i < count; i++)
    {
        const double turned[2] = {axis[0] * hull[i][0] + axis[1] * hull[i][1], axis[0] * hull[i][1] - axis[1] * hull[i][0]};
        box_include(2, turned, low, high);
    }
}

/// The axis of the smallest box around a polygon: along one of its sides (Freeman and Shapira, 1975).
static void best_axis(const double (*hull)[2], size_t count, double axis[2])
{
    double least = INFINITY;
    axis[0] = 1;
    axis[1] = 0;
    for (size_t i = 0; i < count; i++)
    {
        const double *a = hull[i], *b = hull[(i + 1) % count];
        double length = hypot(b[0] - a[0], b[1] - a[1]), low[2], high[2];
        if (!(length > 0))
            continue;
        const double along[2] = {(b[0] - a[0]) / length, (b[1] - a[1]) / length};
        box_of(hull, count, along, low, high);
        double area = (high[0] - low[0]) * (high[1] - low[1]);
        // Of equal boxes the first one counts, whatever the rounding.
        if (area < least * (1 - 1e-9))
        {
            least = area;
            bool tall = high[1] - low[1] > high[0] - low[0];
            axis[0] = tall ? -along[1] : along[0];
            axis[1] = tall ? along[0] : along[1];
        }
    }
}

/// Turn the chart to its smallest rectangle.
static bat_status set_rectangle(const cloud_geometry *geometry, double margin, planar_chart *chart, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    memory_pool pool = {0};
    double(*sorted)[2] = memory_pool_array(&pool, count, sizeof *sorted);
    double(*hull)[2] = memory_pool_array(&pool, count + 1, 2 * sizeof *hull);
    bat_status status = memory_pool_check(&pool, error);
    if (status != BAT_OK)
    {
        memory_pool_free(&pool);
        return status;
    }
    memcpy(sorted, chart->places, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, compare_places);
    size_t corners = find_hull((const double(*)[2])sorted, count, hull);
    double axis[2], low[2], high[2], wide = margin * geometry->middle_spacing;
    best_axis((const double(*)[2])hull, corners, axis);
    box_of((const double(*)[2])hull, corners, axis, low, high);
    memory_pool_free(&pool);
    if (!(high[1] - low[1] > MIN_RATIO * (high[0] - low[0])))
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the points are nearly on a line, which has no surface");
    for (size_t i = 0; i < count; i++)
    {
        const double x = chart->places[i][0], y = chart->places[i][1];
        chart->places[i][0] = axis[0] * x + axis[1] * y - low[0] + wide;
        chart->places[i][1] = axis[0] * y - axis[1] * x - low[1] + wide;
    }
    for (int d = 0; d < 2; d++)
        chart->sides[d] = high[d] - low[d] + 2 * wide;
    return BAT_OK;
}

bat_status planar_chart_make(const cloud_geometry *geometry, double margin, planar_chart *chart, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    bat_status status = BAT_OK;
    *chart = (planar_chart){.places = memory_array(count, sizeof *chart->places)};
    if (chart->places == NULL)
        return error_memory(error, count * sizeof *chart->places);
    local_plane plane = local_plane_fit_all(geometry->order.cloud.points, count);
    bool flat = plane.variance[2] <= FLAT * FLAT * plane.variance[1];
    if (flat)
        set_direction(plane.axes[2], chart->direction);
    if (flat || find_direction(geometry, chart->direction))
        project(geometry, chart->direction, chart->places);
    else
    {
        memset(chart->direction, 0, sizeof chart->direction);
        status = unroll_cloud(geometry, chart->places, error);
    }
    if (status == BAT_OK)
        status = set_rectangle(geometry, margin, chart, error);
    if (status != BAT_OK)
        planar_chart_free(chart);
    return status;
}

#include "base/error.h"
#include "base/memory.h"
#include "batten/cloud.h"
#include "cloud/rim.h"
#include "linalg/vector3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    LEAST_BOUNDARY = 4
};
/// Discs that a line must be away from its mean somewhere to go around more than a chance gap between points.
static const double LEAST_EXTENT = 2.2;
/// A second line of this share of the first one's length is another boundary; a shorter one is a gap.
static const double OTHER_BOUNDARY = 0.25;
/// Two lines of which at least this share of points coincides, or nearly so, are the same one.
static const double SAME_LINE = 0.5;

/// Whether a line runs mostly along another one: within two of its own steps on average.
static bool follows(const double *points, const rim_cycle *line, const rim_cycle *other)
{
    size_t near = 0;
    double step = 2 * line->length / (double)line->count;
    for (size_t i = 0; i < line->count; i++)
        for (size_t k = 0; k < other->count; k++)
        {
            double arm[3];
            vector3_subtract(points + 3 * (size_t)line->points[i], points + 3 * (size_t)other->points[k], arm);
            if (vector3_dot(arm, arm) > step * step)
                continue;
            near++;
            break;
        }
    return (double)near >= SAME_LINE * (double)line->count;
}

static bat_status no_loop(bat_error *error, const char *text)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "no boundary loop was found: %s", text);
}

/// The longest line, where no other one could be a boundary too.
static bat_status choose(const double *points, const rim_cycles *cycles, const rim_cycle **chosen, bat_error *error)
{
    const rim_cycle *longest = NULL;
    for (size_t i = 0; i < cycles->count; i++)
        if (cycles->cycles[i].extent >= LEAST_EXTENT && (longest == NULL || cycles->cycles[i].length > longest->length))
            longest = &cycles->cycles[i];
    if (longest == NULL)
        return no_loop(error, cycles->count == 0 ? "there are neighbours on all sides of every point"
                                                 : "there are only small gaps between points; the surface looks closed");
    if (longest->count < LEAST_BOUNDARY)
        return no_loop(error, "it has only three points");
    for (size_t i = 0; i < cycles->count; i++)
    {
        const rim_cycle *other = &cycles->cycles[i];
        if (other == longest || other->extent < LEAST_EXTENT || other->length < OTHER_BOUNDARY * longest->length ||
            follows(points, other, longest))
            continue;
        return error_set(error, BAT_NO_CONVERGENCE, other->points[0], 0,
                         "the cloud has several boundary loops, one of %zu points and another of %zu near point %u; a patch "
                         "has one",
                         longest->count, other->count, other->points[0]);
    }
    *chosen = longest;
    return BAT_OK;
}

/// The loop from its lowest point towards the lower of that one's neighbours, then all other points: `order` receives, for each new
/// place, the point that goes there.
static void order_points(const rim_cycle *loop, size_t count, bool *in_loop, size_t *order)
{
    size_t first = 0, size = loop->count, made = 0;
    for (size_t i = 1; i < size; i++)
        if (loop->points[i] < loop->points[first])
            first = i;
    bool forward = loop->points[(first + 1) % size] < loop->points[(first + size - 1) % size];
    memset(in_loop, 0, count * sizeof *in_loop);
    for (size_t i = 0; i < size; i++)
    {
        uint32_t point = loop->points[(first + (forward ? i : size - i)) % size];
        order[made++] = point;
        in_loop[point] = true;
    }
    for (size_t point = 0; point < count; point++)
        if (!in_loop[point])
            order[made++] = point;
}

/// Bring the loop to the front.
static bat_status reorder(bat_cloud *cloud, const rim_cycle *loop, bat_error *error)
{
    size_t count = cloud->count;
    bool *in_loop = memory_array(count, sizeof *in_loop);
    size_t *order = memory_array(count, sizeof *order), *place = memory_array(count, sizeof *place);
    double *points = memory_array(count, 3 * sizeof *points);
    if (in_loop == NULL || order == NULL || place == NULL || points == NULL)
    {
        free(in_loop);
        free(order);
        free(place);
        free(points);
        return error_memory(error, count * 3 * sizeof *points);
    }
    order_points(loop, count, in_loop, order);
    for (size_t i = 0; i < count; i++)
    {
        memcpy(points + 3 * i, cloud->points + 3 * order[i], 3 * sizeof *points);
        place[order[i]] = i;
    }
    for (size_t i = 0; i < 3 * cloud->triangle_count; i++)
        cloud->triangles[i] = (uint32_t)place[cloud->triangles[i]];
    for (size_t i = 0; i < count && cloud->order != NULL; i++)
        order[i] = cloud->order[order[i]];
    free(in_loop);
    free(place);
    free(cloud->points);
    free(cloud->order);
    cloud->points = points;
    cloud->order = order;
    cloud->boundary_count = loop->count;
    cloud->has_corners = false;
    return BAT_OK;
}

bat_status bat_cloud_find_boundary(bat_cloud *cloud, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    double *points = points_to_unit_size(cloud->points, cloud->count);
    if (points == NULL)
        return error_memory(error, cloud->count * 3 * sizeof *points);
    neighbour_tree tree = {0};
    rim_cycles cycles = {0};
    const rim_cycle *loop = NULL;
    status = neighbour_tree_build(points, cloud->count, &tree, error);
    if (status == BAT_OK)
        status = rim_cycles_find(points, &tree, &cycles, error);
    if (status == BAT_OK)
        status = choose(points, &cycles, &loop, error);
    if (status == BAT_OK)
        status = reorder(cloud, loop, error);
    rim_cycles_free(&cycles);
    neighbour_tree_free(&tree);
    free(points);
    return status;
}

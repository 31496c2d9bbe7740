#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// What the way from a point of the loop to the next counts.
static double step_between(const double *from, const double *to, bat_cloud_sides method)
{
    double side[3];
    vector3_subtract(to, from, side);
    double length = sqrt(vector3_dot(side, side));
    return method == BAT_CLOUD_SIDES_CHORD_LENGTH ? length : method == BAT_CLOUD_SIDES_CENTRIPETAL ? sqrt(length) : 1;
}

/// Spread the points of a side, from one corner to the next, over the side of the square.
static void fill_side(const double *points, size_t count, size_t from, size_t to, int side, bat_cloud_sides method,
                      double *parameters)
{
    static const double square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const double *begin = square[side], *end = square[(side + 1) % 4];
    double whole = 0, reached = 0;
    for (size_t i = from; i < to; i++)
        whole += step_between(points + 3 * (i % count), points + 3 * ((i + 1) % count), method);
    for (size_t i = from; i < to; i++)
    {
        double share = whole > 0 ? reached / whole : (double)(i - from) / (double)(to - from);
        for (int k = 0; k < 2; k++)
            parameters[2 * (i % count) + (size_t)k] = begin[k] == end[k] ? begin[k] : begin[k] < end[k] ? share : 1 - share;
        reached += step_between(points + 3 * (i % count), points + 3 * ((i + 1) % count), method);
    }
}

bat_status bat_cloud_boundary_parameters(const bat_cloud *cloud, bat_cloud_sides method, double *parameters,
                                         bat_error *error)
{
    size_t corners[4], count = cloud->boundary_count;
    if ((unsigned)method > BAT_CLOUD_SIDES_UNIFORM)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "there is no way %d of parameters along sides",
                         (int)method);
    if (count < 4)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the cloud has no boundary");
    memcpy(corners, cloud->corners, sizeof corners);
    bat_status status = cloud->has_corners ? BAT_OK : cloud_loop_corners(cloud, corners, error);
    if (status != BAT_OK)
        return status;
    double *points = points_to_unit_size(cloud->points, count);
    if (points == NULL)
        return error_memory(error, count * 3 * sizeof *points);
    for (int side = 0; side < 4; side++)
        fill_side(points, count, corners[side], side < 3 ? corners[side + 1] : corners[0] + count, side, method, parameters);
    free(points);
    return BAT_OK;
}

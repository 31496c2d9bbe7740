/// @file
/// Planes by eigenvectors of the covariance matrix  C = (1/n) sum_i (x_i - mean)(x_i - mean)^T.

#include "surface/cloud/local_plane.h"

#include "base/memory.h"
#include "linalg/symmetric.h"
#include "linalg/vector3.h"

#include <string.h>

local_plane local_plane_fit(const double *points, const neighbour_list *list)
{
    local_plane plane = {0};
    double count = (double)list->count, moment[9] = {0}, vectors[9];
    for (size_t i = 0; i < list->count; i++)
        for (int k = 0; k < 3; k++)
            plane.centre[k] += points[3 * (size_t)list->entries[i].item + (size_t)k] / count;
    for (size_t i = 0; i < list->count; i++)
    {
        double arm[3];
        vector3_subtract(points + 3 * (size_t)list->entries[i].item, plane.centre, arm);
        for (int k = 0; k < 9; k++)
            moment[k] += arm[k / 3] * arm[k % 3] / count;
    }
    symmetric_eigen(3, moment, vectors, SYMMETRIC_BY_NORM);
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            if (moment[4 * order[j]] > moment[4 * order[i]])
            {
                int swap = order[i];
                order[i] = order[j];
                order[j] = swap;
            }
    for (int i = 0; i < 3; i++)
    {
        memcpy(plane.axes[i], vectors + 3 * (ptrdiff_t)order[i], sizeof plane.axes[i]);
        plane.variance[i] = fmax(moment[4 * order[i]], 0);
    }
    vector3_cross(plane.axes[0], plane.axes[1], plane.axes[2]);
    return plane;
}

void local_plane_project(const local_plane *plane, const double origin[3], const double point[3], double foot[2])
{
    double arm[3];
    vector3_subtract(point, origin, arm);
    foot[0] = vector3_dot(arm, plane->axes[0]);
    foot[1] = vector3_dot(arm, plane->axes[1]);
}

unit_frame unit_frame_of(const double *points, size_t count)
{
    unit_frame frame = {.exponent = 1};
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, half = 0;
    for (size_t i = 0; i < 3 * count; i++)
    {
        low[i % 3] = fmin(low[i % 3], points[i]);
        high[i % 3] = fmax(high[i % 3], points[i]);
    }
    for (int k = 0; k < 3; k++)
    {
        frame.middle[k] = low[k] * 0.5 + high[k] * 0.5;
        half = fmax(half, high[k] * 0.5 - low[k] * 0.5);
    }
    int exponent = 0;
    (void)frexp(half, &exponent);
    frame.exponent = 1 - exponent;
    return frame;
}

void unit_frame_place(const unit_frame *frame, const double point[3], double place[3])
{
    for (int k = 0; k < 3; k++)
        place[k] = ldexp(point[k] * 0.5 - frame->middle[k] * 0.5, frame->exponent);
}

double *points_to_unit_size(const double *points, size_t count)
{
    double *made = memory_array(count, 3 * sizeof *made);
    if (made == NULL)
        return NULL;
    unit_frame frame = unit_frame_of(points, count);
    for (size_t i = 0; i < count; i++)
        unit_frame_place(&frame, points + 3 * i, made + 3 * i);
    return made;
}

/// Largest ratio of the variance across the plane to the smaller one along it.
static const double MAX_THICKNESS = 0.25;

bat_status neighbourhood_find(const neighbour_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error)
{
    for (;; wanted *= 2)
    {
        bat_status status = neighbours_nearest(tree, place, wanted, near, error);
        if (status != BAT_OK)
            return status;
        *plane = local_plane_fit(points, near);
        if (plane->variance[2] <= MAX_THICKNESS * plane->variance[1] || wanted >= NEIGHBOURHOOD_MAX ||
            near->count == tree->count)
            return BAT_OK;
    }
}

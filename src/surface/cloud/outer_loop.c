/// @file
/// The boundary loop of a sample, moved outwards to the points of a larger cloud: bat_surface_loop_frames() and
/// bat_surface_loop_outermost(). A random sample leaves a strip outside its loop, about half a spacing wide. The outermost
/// of the points near each point of the loop is near the edge.

#include "batten/distributed.h"
#include "batten/surface.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"
#include "surface/cloud/local_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    PLANE_POINTS = 24 ///< of the tangent plane of a point of the loop
};

/// Points up to this many edges of the loop away belong to a point of it,
static const double REACH = 1.5;
/// and up to this share of that distance off its tangent plane.
static const double OFF_PLANE = 0.5;

/// The numbers of a frame.
typedef struct loop_frame
{
    double place[3], outward[3], normal[3], reach;
} loop_frame;

_Static_assert(sizeof(loop_frame) == BAT_SURFACE_LOOP_FRAME * sizeof(double), "a frame consists of numbers");

static double length_of(const double vector[3])
{
    return sqrt(vector3_dot(vector, vector));
}

static loop_frame frame_of(const bat_cloud *cloud, size_t i, const neighbour_list *near)
{
    size_t count = cloud->boundary_count;
    const double *here = cloud->points + 3 * i, *next = cloud->points + 3 * ((i + 1) % count);
    const double *last = cloud->points + 3 * ((i + count - 1) % count);
    local_plane plane = local_plane_fit(cloud->points, near);
    loop_frame frame = {{here[0], here[1], here[2]}, {0}, {0}, 0};
    double along[3], ahead[3], back[3], inward[3];
    vector3_subtract(next, last, along);
    vector3_subtract(next, here, ahead);
    vector3_subtract(here, last, back);
    vector3_subtract(plane.centre, here, inward);
    memcpy(frame.normal, plane.axes[2], sizeof frame.normal);
    vector3_cross(along, frame.normal, frame.outward);
    double length = length_of(frame.outward), sign = vector3_dot(frame.outward, inward) > 0 ? -1 : 1;
    for (int k = 0; k < 3 && length > 0; k++)
        frame.outward[k] *= sign / length;
    frame.reach = REACH * fmax(length_of(ahead), length_of(back));
    return frame;
}

bat_status bat_surface_loop_frames(const bat_cloud *cloud, double *frames, bat_error *error)
{
    if (cloud->boundary_count < 3)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the boundary of the cloud is not known");
    neighbour_tree tree = {0};
    neighbour_list near = {0};
    bat_status status = neighbour_tree_build(cloud->points, cloud->count, &tree, error);
    for (size_t i = 0; i < cloud->boundary_count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(&tree, cloud->points + 3 * i, PLANE_POINTS, &near, error);
        if (status != BAT_OK)
            break;
        loop_frame frame = frame_of(cloud, i, &near);
        memcpy(frames + i * BAT_SURFACE_LOOP_FRAME, &frame, sizeof frame);
    }
    neighbour_list_free(&near);
    neighbour_tree_free(&tree);
    return status;
}

bat_status bat_surface_loop_outermost(const double *frames, size_t loop, const double *points, size_t count,
                                      double *outwards, size_t *outer, bat_error *error)
{
    neighbour_tree tree = {0};
    neighbour_list near = {0};
    double *places = memory_array(loop, 3 * sizeof *places);
    if (places == NULL)
        return error_memory(error, loop * 3 * sizeof *places);
    for (size_t k = 0; k < loop; k++)
    {
        memcpy(places + 3 * k, frames + k * BAT_SURFACE_LOOP_FRAME, 3 * sizeof *places);
        outwards[k] = 0;
        outer[k] = BAT_NO_INDEX;
    }
    bat_status status = neighbour_tree_build(places, loop, &tree, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(&tree, points + 3 * i, 1, &near, error);
        if (status != BAT_OK)
            break;
        size_t k = near.entries[0].item;
        loop_frame frame;
        double arm[3];
        memcpy(&frame, frames + k * BAT_SURFACE_LOOP_FRAME, sizeof frame);
        vector3_subtract(points + 3 * i, frame.place, arm);
        double outward = vector3_dot(arm, frame.outward);
        if (outward > outwards[k] && length_of(arm) <= frame.reach &&
            fabs(vector3_dot(arm, frame.normal)) <= OFF_PLANE * frame.reach)
        {
            outwards[k] = outward;
            outer[k] = i;
        }
    }
    neighbour_list_free(&near);
    neighbour_tree_free(&tree);
    free(places);
    return status;
}

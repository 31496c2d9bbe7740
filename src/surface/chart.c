/// @file
/// Charts; see candidate.h. reconstruct.c finds them.

#include "surface/candidate.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/distributed.h"
#include "batten/surface.h"
#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/part.h"
#include "surface/fit/points.h"
#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t POINTS_AT_ONCE = 1 << 16; ///< that are located

void chart_free_shared(bat_surface_chart *chart)
{
    bat_cloud_free(&chart->part);
    free(chart->of_part);
    bat_spline_surface_free(&chart->surface);
    free(chart->loop);
    free(chart->loop_parameters);
}

size_t bat_surface_chart_loop(const bat_surface_chart *chart, const double **points, const double **parameters,
                              size_t *functions)
{
    if (functions != NULL)
        *functions = chart->functions;
    *points = chart->loop;
    *parameters = chart->loop_parameters;
    return chart->loop_count;
}

bat_status bat_surface_chart_locate(const bat_surface_chart *chart, const double *points, size_t count, double *parameters,
                                    bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t begin = 0; begin < count && status == BAT_OK; begin += POINTS_AT_ONCE)
    {
        bat_surface_fit_data data = {.points = points + 3 * begin,
                                     .parameters = parameters + 2 * begin,
                                     .count = count - begin < POINTS_AT_ONCE ? count - begin : POINTS_AT_ONCE,
                                     .dimension = 3};
        status =
            cloud_part_spread(&chart->frame, &chart->part, chart->of_part, data.points, data.count, data.parameters, error);
        if (status == BAT_OK)
            status = spline_correct(&chart->surface, &data, NULL, error);
    }
    return status;
}

// Charts as bytes: the head, the parts of the cloud, the surface, the loop.

typedef struct chart_head
{
    unit_frame frame;
    bat_hierarchical_options space;
    size_t part, boxes, functions, loop, budget;
} chart_head;

/// The arrays of a chart, in the order of the bytes.
typedef struct chart_arrays
{
    void *array[6];
    size_t size[6];
} chart_arrays;

static chart_arrays arrays_of(const bat_surface_chart *chart, const chart_head *head, bat_spline_box *boxes)
{
    return (chart_arrays){
        {chart->part.points, chart->of_part, boxes, chart->surface.control, chart->loop, chart->loop_parameters},
        {3 * head->part * sizeof(double), 2 * head->part * sizeof(double), head->boxes * sizeof *boxes,
         3 * head->functions * sizeof(double), 3 * head->loop * sizeof(double), 2 * head->loop * sizeof(double)}};
}

static size_t size_of(const chart_arrays *arrays)
{
    size_t size = sizeof(chart_head);
    for (size_t k = 0; k < sizeof arrays->size / sizeof *arrays->size; k++)
        size += arrays->size[k];
    return size;
}

bat_status bat_surface_chart_pack(const bat_surface_chart *chart, void **bytes, size_t *size, bat_error *error)
{
    chart_head head;
    bat_spline_box *boxes = NULL;
    // Padding is sent too.
    memset(&head, 0, sizeof head);
    bat_status status = hierarchical_space_regions(chart->surface.space, &boxes, &head.boxes, error);
    if (status != BAT_OK)
        return status;
    head.frame = chart->frame;
    head.space = bat_hierarchical_space_options(chart->surface.space);
    head.part = chart->part.count;
    head.functions = bat_hierarchical_space_functions(chart->surface.space);
    head.loop = chart->loop_count;
    head.budget = chart->functions;
    chart_arrays arrays = arrays_of(chart, &head, boxes);
    char *made = memory_array(size_of(&arrays), 1);
    if (made == NULL)
        status = error_memory(error, size_of(&arrays));
    else
    {
        char *at = made + sizeof head;
        memcpy(made, &head, sizeof head);
        for (size_t k = 0; k < sizeof arrays.size / sizeof *arrays.size; at += arrays.size[k++])
            if (arrays.size[k] > 0)
                memcpy(at, arrays.array[k], arrays.size[k]);
        *bytes = made;
        *size = size_of(&arrays);
    }
    free(boxes);
    return status;
}

bat_status bat_surface_chart_unpack(const void *bytes, size_t size, bat_surface_chart **chart, bat_error *error)
{
    chart_head head = {0};
    if (size >= sizeof head)
        memcpy(&head, bytes, sizeof head);
    bat_surface_chart none = {0};
    chart_arrays arrays = arrays_of(&none, &head, NULL);
    if (size != size_of(&arrays))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the bytes are not those of a chart");
    bat_surface_chart *made = calloc(1, sizeof *made);
    if (made == NULL)
        return error_memory(error, sizeof *made);
    made->frame = head.frame;
    made->functions = head.budget;
    made->loop_count = head.loop;
    made->part = (bat_cloud){.points = memory_array(head.part, 3 * sizeof(double)), .count = head.part};
    made->of_part = memory_array(head.part, 2 * sizeof(double));
    made->surface = (bat_spline_surface){.control = memory_array(head.functions, 3 * sizeof(double)), .dimension = 3};
    made->loop = memory_array(head.loop, 3 * sizeof(double));
    made->loop_parameters = memory_array(head.loop, 2 * sizeof(double));
    bat_spline_box *boxes = memory_array(head.boxes, sizeof *boxes);
    bool complete = made->part.points != NULL && made->of_part != NULL && made->surface.control != NULL &&
                    made->loop != NULL && made->loop_parameters != NULL && boxes != NULL;
    bat_status status = complete ? BAT_OK : error_memory(error, size);
    if (complete)
    {
        const char *at = (const char *)bytes + sizeof head;
        arrays = arrays_of(made, &head, boxes);
        for (size_t k = 0; k < sizeof arrays.size / sizeof *arrays.size; at += arrays.size[k++])
            if (arrays.size[k] > 0)
                memcpy(arrays.array[k], at, arrays.size[k]);
        status = hierarchical_space_of_regions(&head.space, boxes, head.boxes, &made->surface.space, error);
    }
    free(boxes);
    if (status == BAT_OK)
        *chart = made;
    else
        bat_surface_chart_free(made);
    return status;
}

// The boundary loop of a sample, moved outwards to the points of a larger cloud: bat_surface_loop_frames() and
// bat_surface_loop_outermost(). A random sample leaves a strip outside its loop, about half a spacing wide. The outermost
// of the points near each point of the loop is near the edge.

static const int PLANE_POINTS = 24; ///< of the tangent plane of a point of the loop

/// Points up to this many edges of the loop away belong to a point of it,
static const double REACH = 1.5;
/// and up to this share of that distance off its tangent plane.
static const double OFF_PLANE = 0.5;

typedef struct loop_frame
{
    double place[3], outward[3], normal[3], reach;
} loop_frame;

_Static_assert(sizeof(loop_frame) == BAT_SURFACE_LOOP_FRAME * sizeof(double), "a frame consists of numbers");

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
    double length = vector3_length(frame.outward), sign = vector3_dot(frame.outward, inward) > 0 ? -1 : 1;
    for (int k = 0; k < 3 && length > 0; k++)
        frame.outward[k] *= sign / length;
    frame.reach = REACH * fmax(vector3_length(ahead), vector3_length(back));
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
        if (outward > outwards[k] && vector3_length(arm) <= frame.reach &&
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

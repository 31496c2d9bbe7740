#include "batten/research/surface_chart.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "base/progress.h"
#include "linalg/vector.h"
#include "research/surface/regions.h"
#include "surface/candidate.h"
#include "surface/cloud/boundary.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/part.h"
#include "surface/cloud/spatial_order.h"
#include "surface/fit/points.h"
#include "surface/spline/hierarchical_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t POINTS_AT_ONCE = 1 << 16; ///< that are located

struct bat_surface_chart
{
    unit_frame frame;           ///< of the whole cloud
    bat_cloud part;             ///< points whose parameters are known
    double *of_part;            ///< part.count x 2: these parameters, on the surface
    bat_spline_surface surface; ///< through the part
    double *loop;               ///< loop_count x 3: the boundary of the cloud
    double *loop_parameters;    ///< loop_count x 2
    size_t loop_count;
    size_t functions; ///< budget of the fit to all points

    // Of the process that has found the chart.

    reconstruction *work; ///< null in others
    bat_surface_reconstruct_options options;
};

bat_status bat_surface_chart_boundary(bat_cloud *cloud, bool again, bat_progress progress, bat_error *error)
{
    progress_part part = {progress, 0, SURFACE_PREPARE_SHARE};
    return cloud_find_boundary(cloud, again ? SURFACE_SMALL_DISC : 1, progress_of_part(&part), error);
}

/// Store what all processes need.
static bat_status share_chart(const reconstruction *work, bat_surface_chart *chart, bat_error *error)
{
    const bat_cloud *cloud = work->cloud;
    bat_status status = bat_cloud_copy(&work->part.cloud, &chart->part, error);
    if (status != BAT_OK)
        return status;
    chart->frame = unit_frame_of(cloud->points, cloud->count);
    chart->functions = reconstruction_last_budget(work);
    chart->loop_count = cloud->boundary_count;
    chart->of_part = work->best->corrected;
    work->best->corrected = NULL;
    chart->surface = work->best->surface;
    work->best->surface = (bat_spline_surface){0};
    bat_surface_fit_report_free(&work->best->fit);
    chart->loop = memory_array(chart->loop_count, 3 * sizeof *chart->loop);
    chart->loop_parameters = memory_array(chart->loop_count, 2 * sizeof *chart->loop);
    if (chart->loop == NULL || chart->loop_parameters == NULL)
        return error_memory(error, chart->loop_count * 5 * sizeof *chart->loop);
    memcpy(chart->loop, cloud->points, 3 * chart->loop_count * sizeof *chart->loop);
    memcpy(chart->loop_parameters, work->boundary, 2 * chart->loop_count * sizeof *chart->loop);
    return BAT_OK;
}

bat_status bat_surface_chart_find(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                  bat_surface_chart **chart, bat_error *error)
{
    const bat_surface_reconstruct_options defaults = bat_surface_reconstruct_defaults();
    bat_status status = bat_options_check(&bat_surface_reconstruct_fields, options, error);
    options = options != NULL ? options : &defaults;
    if (status == BAT_OK && (cloud->count <= BAT_SURFACE_ALL_POINTS || cloud->triangle_count > 0 || options->published ||
                             options->trim || options->parameters != BAT_SURFACE_PARAMETERS_AUTO))
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "a chart is of more than %d points without triangles, with automatic parameters",
                           BAT_SURFACE_ALL_POINTS);
    if (status != BAT_OK)
        return status;
    bat_surface_chart *made = calloc(1, sizeof *made);
    reconstruction *work = calloc(1, sizeof *work);
    if (made == NULL || work == NULL)
    {
        free(made);
        free(work);
        return error_memory(error, sizeof *work);
    }
    made->work = work;
    made->options = *options;
    *work = (reconstruction){.cloud = cloud, .options = &made->options, .disc = 1};
    status = reconstruction_find(work, error);
    if (status == BAT_OK)
        status = share_chart(work, made, error);
    if (status == BAT_OK)
        *chart = made;
    else
        bat_surface_chart_free(made);
    return status;
}

void bat_surface_chart_free(bat_surface_chart *chart)
{
    if (chart == NULL)
        return;
    if (chart->work != NULL)
        reconstruction_free(chart->work);
    free(chart->work);
    bat_cloud_free(&chart->part);
    free(chart->of_part);
    bat_spline_surface_free(&chart->surface);
    free(chart->loop);
    free(chart->loop_parameters);
    free(chart);
}

bat_status bat_surface_chart_finish(bat_surface_chart *chart, bat_spline_surface *surface, bat_surface_fit_report *report,
                                    const double *parameters, const double *distances, bat_surface_result *result,
                                    bat_error *error)
{
    reconstruction *work = chart->work;
    if (work == NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "another process has found the chart");
    size_t count = work->cloud->count;
    surface_candidate *best = work->best;
    double begin = clock_seconds();
    bat_status status = surface_judge(&work->geometry, surface, parameters, distances, count, &work->options->fit,
                                      &best->report.verdict, error);
    if (status == BAT_OK && best->report.verdict.fault != BAT_SURFACE_FAULT_NONE && !work->options->force &&
        reconstruction_is_one_sided(work))
        status = reconstruction_tell_one_sided(error);
    if (status != BAT_OK)
        return status;
    free(best->corrected);
    best->corrected = memory_array(count, 2 * sizeof *best->corrected);
    if (best->corrected == NULL)
        return error_memory(error, count * 2 * sizeof *best->corrected);
    memcpy(best->corrected, parameters, 2 * count * sizeof *best->corrected);
    best->surface = *surface;
    best->fit = *report;
    status = reconstruction_store(work, error);
    if (status != BAT_OK)
    {
        best->surface = (bat_spline_surface){0};
        best->fit = (bat_surface_fit_report){0};
        return status;
    }
    work->result.seconds[2] += clock_seconds() - begin;
    *surface = (bat_spline_surface){0};
    *report = (bat_surface_fit_report){0};
    *result = work->result;
    work->result = (bat_surface_result){0};
    return BAT_OK;
}

double bat_surface_chart_order(const double point[3], const double centre[3])
{
    return canonical_order_key(point, centre);
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
    nearest_tree tree = {0};
    neighbour_list near = {0};
    bat_status status = neighbours_build(cloud->points, cloud->count, &tree, error);
    for (size_t i = 0; i < cloud->boundary_count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(&tree, cloud->points + 3 * i, PLANE_POINTS, &near, error);
        if (status != BAT_OK)
            break;
        loop_frame frame = frame_of(cloud, i, &near);
        memcpy(frames + i * BAT_SURFACE_LOOP_FRAME, &frame, sizeof frame);
    }
    neighbour_list_free(&near);
    nearest_free(&tree);
    return status;
}

bat_status bat_surface_loop_outermost(const double *frames, size_t loop, const double *points, size_t count,
                                      double *outwards, size_t *outer, bat_error *error)
{
    nearest_tree tree = {0};
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
    bat_status status = neighbours_build(places, loop, &tree, error);
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
    nearest_free(&tree);
    free(places);
    return status;
}

bat_status bat_surface_judge(const bat_spline_surface *surface, const bat_cloud *cloud, const double *parameters,
                             const double *distances, const bat_surface_fit_options *options, bat_surface_verdict *verdict,
                             bat_error *error)
{
    const bat_surface_fit_options defaults = bat_surface_fit_defaults();
    cloud_geometry geometry = {0};
    bat_status status = bat_options_check(&bat_surface_fit_fields, options, error);
    options = options != NULL ? options : &defaults;
    if (status == BAT_OK)
        status = bat_cloud_check(cloud, error);
    if (status == BAT_OK)
        status = cloud_geometry_make(cloud, options->threads, options->progress, &geometry, error);
    if (status == BAT_OK)
        status = surface_judge(&geometry, surface, parameters, distances, cloud->count, options, verdict, error);
    cloud_geometry_free(&geometry);
    return status;
}

bat_status hierarchical_space_of_regions(const bat_hierarchical_options *options, bat_spline_box *boxes, size_t count,
                                         bat_hierarchical_space **space, bat_error *error)
{
    // A region of a level consists of cells of the level before.
    for (size_t k = 0; k < count; k++)
    {
        boxes[k].level--;
        for (int d = 0; d < 2; d++)
        {
            boxes[k].low[d] /= 2;
            boxes[k].high[d] /= 2;
        }
    }
    bat_hierarchical_space *made = NULL;
    bat_status status = bat_hierarchical_space_make(options, &made, error);
    if (status == BAT_OK && count > 0)
        status = bat_hierarchical_space_refine(made, boxes, count, error);
    if (status == BAT_OK)
        *space = made;
    else
        bat_hierarchical_space_free(made);
    return status;
}

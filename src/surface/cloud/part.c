/// @file
/// Parts of clouds; see part.h.

#include "surface/cloud/part.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "surface/cloud/even_sample.h"
#include "surface/cloud/local_plane.h"
#include "surface/cloud/spatial_order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void cloud_part_free(cloud_part *part)
{
    bat_cloud_free(&part->cloud);
    free(part->members);
    *part = (cloud_part){0};
}

static bool is_corner(const bat_cloud *cloud, size_t point)
{
    for (int k = 0; k < 4 && cloud->has_corners; k++)
        if (cloud->corners[k] == point)
            return true;
    return false;
}

/// Choose about `wanted` points at random: of the loop at equal steps, of the others by selection.
static void choose_random(const bat_cloud *cloud, size_t wanted, bool *chosen)
{
    size_t loop = cloud->boundary_count;
    double step = sqrt((double)cloud->count / (double)wanted), share = (double)wanted / (double)cloud->count;
    for (size_t i = 0; i < loop; i++)
        chosen[i] = is_corner(cloud, i) || floor((double)(i + 1) / step) > floor((double)i / step);
    bat_random random = bat_random_seed(1);
    for (size_t i = loop; i < cloud->count; i++)
        chosen[i] = bat_random_uniform(&random) < share;
}

/// Choose an even sample of scan lines: the loop, which is evenly sampled already, and points that are not near it.
static bat_status choose_even(const bat_cloud *cloud, bool *chosen, bool *is_needed, bat_error *error)
{
    double *unit = points_to_unit_size(cloud->points, cloud->count), radius = 0;
    neighbour_tree tree = {0};
    bat_status status = unit == NULL ? error_memory(error, cloud->count * 3 * sizeof *unit)
                                     : neighbour_tree_build(unit, cloud->count, &tree, error);
    if (status == BAT_OK)
        status = even_sample_radius(unit, &tree, &radius, error);
    *is_needed = radius > 0 && isfinite(radius);
    if (status == BAT_OK && *is_needed)
        status = even_sample_choose(unit, &tree, radius, chosen, error);
    for (size_t i = 0; i < cloud->boundary_count && *is_needed; i++)
        chosen[i] = chosen[i] || is_corner(cloud, i);
    neighbour_tree_free(&tree);
    free(unit);
    return status;
}

/// Copy the chosen points.
static bat_status copy_chosen(const bat_cloud *cloud, const bool *chosen, cloud_part *part, bat_error *error)
{
    size_t count = 0, made = 0;
    for (size_t i = 0; i < cloud->count; i++)
        count += chosen[i];
    bat_cloud *copy = &part->cloud;
    copy->points = memory_array(count, 3 * sizeof *copy->points);
    copy->order = memory_array(count, sizeof *copy->order);
    part->members = memory_array(count, sizeof *part->members);
    if (copy->points == NULL || copy->order == NULL || part->members == NULL)
        return error_memory(error, count * 5 * sizeof *copy->points);
    for (size_t i = 0; i < cloud->count; i++)
    {
        if (!chosen[i])
            continue;
        for (int k = 0; k < 4; k++)
            if (cloud->corners[k] == i)
                copy->corners[k] = made;
        memcpy(copy->points + 3 * made, cloud->points + 3 * i, 3 * sizeof *copy->points);
        copy->order[made] = cloud_input_index(cloud, i);
        part->members[made++] = i;
        copy->boundary_count += i < cloud->boundary_count;
    }
    copy->count = count;
    copy->has_corners = cloud->has_corners;
    return BAT_OK;
}

bat_status cloud_part_make(const bat_cloud *cloud, size_t wanted, cloud_part *part, bat_error *error)
{
    *part = (cloud_part){0};
    bool *chosen = memory_array(cloud->count, sizeof *chosen), is_needed = true;
    if (chosen == NULL)
        return error_memory(error, cloud->count);
    bat_status status = choose_even(cloud, chosen, &is_needed, error);
    part->is_even = is_needed;
    if (status == BAT_OK && !is_needed && wanted < cloud->count)
    {
        choose_random(cloud, wanted, chosen);
        is_needed = true;
    }
    if (status == BAT_OK && is_needed)
        status = copy_chosen(cloud, chosen, part, error);
    if (status != BAT_OK)
        cloud_part_free(part);
    free(chosen);
    return status;
}

bat_status cloud_part_spread(const unit_frame *frame, const bat_cloud *part, const double *of_part, const double *points,
                             size_t count, double *parameters, bat_error *error)
{
    size_t members = part->count;
    double *unit = memory_array(members, 3 * sizeof *unit);
    if (unit == NULL)
        return error_memory(error, members * 3 * sizeof *unit);
    for (size_t i = 0; i < members; i++)
        unit_frame_place(frame, part->points + 3 * i, unit + 3 * i);
    neighbour_tree tree = {0};
    bat_status status = neighbour_tree_build(unit, members, &tree, error);
    bool complete = status == BAT_OK;
#pragma omp parallel num_threads(threads_for(0, count / 1024 + 1)) if (complete) reduction(&& : complete)
    {
        neighbour_list near = {0};
#pragma omp for schedule(static)
        for (size_t i = 0; i < count; i++)
        {
            double place[3];
            unit_frame_place(frame, points + 3 * i, place);
            complete = complete && neighbours_nearest(&tree, place, 1, &near, NULL) == BAT_OK;
            if (complete)
                memcpy(parameters + 2 * i, of_part + 2 * (size_t)near.entries[0].item, 2 * sizeof *parameters);
        }
        neighbour_list_free(&near);
    }
    neighbour_tree_free(&tree);
    free(unit);
    return complete || status != BAT_OK ? status : error_memory(error, count * 2 * sizeof *parameters);
}

/// @file
/// Parts of clouds; see part.h.

#include "surface/cloud/part.h"

#include "base/error.h"
#include "base/threads.h"

#include <math.h>
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
    nearest_tree tree = {0};
    bat_status status = unit == NULL ? error_memory(error, cloud->count * 3 * sizeof *unit)
                                     : neighbours_build(unit, cloud->count, &tree, error);
    if (status == BAT_OK)
        status = even_sample_radius(unit, &tree, &radius, error);
    *is_needed = radius > 0 && isfinite(radius);
    if (status == BAT_OK && *is_needed)
        status = even_sample_choose(unit, &tree, radius, chosen, error);
    for (size_t i = 0; i < cloud->boundary_count && *is_needed; i++)
        chosen[i] = chosen[i] || is_corner(cloud, i);
    nearest_free(&tree);
    free(unit);
    return status;
}

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
    nearest_tree tree = {0};
    bat_status status = neighbours_build(unit, members, &tree, error);
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
    nearest_free(&tree);
    free(unit);
    return complete || status != BAT_OK ? status : error_memory(error, count * 2 * sizeof *parameters);
}

// Even samples. A neighbourhood is a line where the variance along its second axis is a small share of
// that along the first one.

enum
{
    LINE_NEIGHBOURS = 12,
    MAX_PLACES = 256,
    MIN_SAMPLE = 32, ///< fewest points of a sample
    MAX_TRIALS = 24
};

/// Neighbourhoods are lines where the median of the ratio of variances is less.
static const double MAX_LINE = 0.02;
/// Neighbourhoods of a sample are discs where it is at least this.
static const double MIN_DISC = 0.15;
/// A point of an even sample of a surface has about nine points, including itself, within twice the least distance; one of a
/// curve has five. So many are a surface.
static const double DISC_REACH = 2;
static const double DISC_POINTS = 6;
static const double GROWTH = 1.3;
/// One-sidedness from which a point is the end of a line.
static const double MIN_END = 0.45;

/// The median over places of the ratio of the second variance to the first, and of the distance of the nearest neighbour.
static bat_status measure(const double *points, const nearest_tree *tree, double *ratio, double *nearest, bat_error *error)
{
    double ratios[MAX_PLACES], distances[MAX_PLACES];
    size_t stride = tree->count / MAX_PLACES + 1, made = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = stride / 2; i < tree->count && status == BAT_OK; i += stride)
    {
        status = neighbours_nearest(tree, points + 3 * i, LINE_NEIGHBOURS, &near, error);
        if (status != BAT_OK)
            break;
        local_plane plane = local_plane_fit(points, &near);
        ratios[made] = plane.variance[0] > 0 ? plane.variance[1] / plane.variance[0] : 0;
        distances[made++] = sqrt(near.entries[near.count > 1 ? 1 : 0].squared);
    }
    neighbour_list_free(&near);
    *ratio = made > 0 ? sort_median(ratios, made) : 1;
    *nearest = made > 0 ? sort_median(distances, made) : 0;
    return status;
}

/// Whether the median point has the neighbours of a surface.
static bat_status has_discs(const double *points, const nearest_tree *tree, double radius, bool *discs, bat_error *error)
{
    double counts[MAX_PLACES];
    size_t stride = tree->count / MAX_PLACES + 1, made = 0;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t i = stride / 2; i < tree->count && status == BAT_OK; i += stride)
    {
        status = neighbours_within(tree, points + 3 * i, DISC_REACH * radius, &near, error);
        counts[made++] = (double)near.count;
    }
    neighbour_list_free(&near);
    *discs = made > 0 && sort_median(counts, made) >= DISC_POINTS;
    return status;
}

/// The ratio of an even sample, 0 for one of a curve; `count` receives its size.
static bat_status measure_sample(const double *points, const nearest_tree *tree, double radius, bool *chosen, double *sample,
                                 size_t *count, double *ratio, bat_error *error)
{
    nearest_tree thinned = {0};
    double nearest;
    bat_status status = even_sample_choose(points, tree, radius, chosen, error);
    *count = 0;
    for (size_t i = 0; i < tree->count && status == BAT_OK; i++)
        if (chosen[i])
            memcpy(sample + 3 * (*count)++, points + 3 * i, 3 * sizeof *sample);
    if (status == BAT_OK)
        status = neighbours_build(sample, *count, &thinned, error);
    if (status == BAT_OK)
        status = measure(sample, &thinned, ratio, &nearest, error);
    bool discs = false;
    if (status == BAT_OK)
        status = has_discs(sample, &thinned, radius, &discs, error);
    *ratio = discs ? *ratio : 0;
    nearest_free(&thinned);
    return status;
}

bat_status even_sample_radius(const double *points, const nearest_tree *tree, double *radius, bat_error *error)
{
    double ratio, nearest;
    *radius = 0;
    bat_status status = measure(points, tree, &ratio, &nearest, error);
    if (status != BAT_OK || tree->count < MIN_SAMPLE || ratio >= MAX_LINE)
        return status;
    bool *chosen = memory_array(tree->count, sizeof *chosen);
    double *sample = memory_array(tree->count, 3 * sizeof *sample);
    if (chosen == NULL || sample == NULL)
        status = error_memory(error, tree->count * 3 * sizeof *sample);
    size_t count = tree->count;
    double trial = 2 * nearest;
    ratio = 0;
    for (int k = 0; k < MAX_TRIALS && status == BAT_OK && ratio < MIN_DISC && count >= MIN_SAMPLE; k++, trial *= GROWTH)
    {
        *radius = trial;
        status = measure_sample(points, tree, trial, chosen, sample, &count, &ratio, error);
    }
    if (ratio < MIN_DISC || count < MIN_SAMPLE)
        *radius = INFINITY;
    free(chosen);
    free(sample);
    return status;
}

/// The distance of a point from the mean of its neighbours, as a share of that of the farthest: a half at the end of a line.
static double one_sidedness(const double *points, const double *here, const neighbour_list *near)
{
    double arm[3] = {0}, farthest = near->entries[near->count - 1].squared;
    for (size_t k = 0; k < near->count; k++)
        for (size_t c = 0; c < 3; c++)
            arm[c] += (points[3 * (size_t)near->entries[k].item + c] - here[c]) / (double)near->count;
    return farthest > 0 ? sqrt((arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]) / farthest) : 0;
}

bat_status even_sample_choose(const double *points, const nearest_tree *tree, double radius, bool *chosen, bat_error *error)
{
    bool *covered;
    bat_status status = array_zeros(&covered, tree->count, 2 * sizeof *covered, error);
    if (status != BAT_OK)
        return status;
    bool *is_end = covered + tree->count;
    neighbour_list near = {0};
    for (size_t i = 0; i < tree->count && status == BAT_OK; i++)
    {
        status = neighbours_nearest(tree, points + 3 * i, LINE_NEIGHBOURS, &near, error);
        is_end[i] = status == BAT_OK && one_sidedness(points, points + 3 * i, &near) > MIN_END;
        chosen[i] = false;
    }
    // Ends of lines go first: the boundary runs through them.
    for (size_t k = 0; k < 2 * tree->count && status == BAT_OK; k++)
    {
        size_t i = k % tree->count;
        if (covered[i] || is_end[i] != (k < tree->count))
            continue;
        chosen[i] = true;
        status = neighbours_within(tree, points + 3 * i, radius, &near, error);
        for (size_t n = 0; n < near.count && status == BAT_OK; n++)
            covered[near.entries[n].item] = true;
    }
    neighbour_list_free(&near);
    free(covered);
    return status;
}

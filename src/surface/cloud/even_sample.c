/// @file
/// Even samples; see even_sample.h. A neighbourhood is a line where the variance along its second axis is a small share of
/// that along the first one.

#include "surface/cloud/even_sample.h"

#include "base/ascending.h"
#include "base/error.h"
#include "base/memory.h"
#include "surface/cloud/local_plane.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
static bat_status measure(const double *points, const neighbour_tree *tree, double *ratio, double *nearest, bat_error *error)
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
    qsort(ratios, made, sizeof *ratios, ascending);
    qsort(distances, made, sizeof *distances, ascending);
    *ratio = made > 0 ? ratios[made / 2] : 1;
    *nearest = made > 0 ? distances[made / 2] : 0;
    return status;
}

/// Whether the median point has the neighbours of a surface.
static bat_status has_discs(const double *points, const neighbour_tree *tree, double radius, bool *discs, bat_error *error)
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
    qsort(counts, made, sizeof *counts, ascending);
    *discs = made > 0 && counts[made / 2] >= DISC_POINTS;
    return status;
}

/// The ratio of an even sample, 0 for one of a curve; `count` receives its size.
static bat_status measure_sample(const double *points, const neighbour_tree *tree, double radius, bool *chosen,
                                 double *sample, size_t *count, double *ratio, bat_error *error)
{
    neighbour_tree thinned = {0};
    double nearest;
    bat_status status = even_sample_choose(points, tree, radius, chosen, error);
    *count = 0;
    for (size_t i = 0; i < tree->count && status == BAT_OK; i++)
        if (chosen[i])
            memcpy(sample + 3 * (*count)++, points + 3 * i, 3 * sizeof *sample);
    if (status == BAT_OK)
        status = neighbour_tree_build(sample, *count, &thinned, error);
    if (status == BAT_OK)
        status = measure(sample, &thinned, ratio, &nearest, error);
    bool discs = false;
    if (status == BAT_OK)
        status = has_discs(sample, &thinned, radius, &discs, error);
    *ratio = discs ? *ratio : 0;
    neighbour_tree_free(&thinned);
    return status;
}

bat_status even_sample_radius(const double *points, const neighbour_tree *tree, double *radius, bat_error *error)
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

bat_status even_sample_choose(const double *points, const neighbour_tree *tree, double radius, bool *chosen,
                              bat_error *error)
{
    bool *covered = memory_array(tree->count, 2 * sizeof *covered);
    if (covered == NULL)
        return error_memory(error, 2 * tree->count);
    memset(covered, 0, tree->count * sizeof *covered);
    bool *is_end = covered + tree->count;
    neighbour_list near = {0};
    bat_status status = BAT_OK;
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

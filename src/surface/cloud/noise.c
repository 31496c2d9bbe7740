/// @file
/// Noise by local quadratic fits; see noise.h.

#include "surface/cloud/noise.h"

#include "base/ascending.h"
#include "base/error.h"
#include "base/memory.h"
#include "surface/cloud/local_quadratic.h"

#include <math.h>
#include <stdlib.h>

enum
{
    MIN_POINTS = 24,
    MAX_POINTS = 1536,
    MAX_PLACES = 1000
};

/// Neighbourhoods grow until the residual variance is at most this share of the smaller variance along the plane: in smaller
/// ones the plane follows the noise. Where none is so flat, as in thin parts, the flattest counts.
static const double MAX_FLATNESS = 0.02;

/// The variance of the neighbours' heights about a quadratic polynomial, by the median of its distribution.
static double variance_at(const double *points, const neighbour_list *near, const local_plane *plane)
{
    local_quadratic quadratic = local_quadratic_fit(points, near, plane);
    double squares = 0;
    for (size_t i = 0; i < near->count; i++)
    {
        double height = local_quadratic_height(&quadratic, points + 3 * (size_t)near->entries[i].item);
        squares += height * height;
    }
    double freedom = (double)near->count - LOCAL_QUADRATIC_TERMS, root = 1 - 2 / (9 * freedom);
    return squares / (freedom * root * root * root);
}

bat_status noise_estimate(const double *points, const neighbour_tree *tree, double *sigma, bat_error *error)
{
    size_t stride = tree->count / MAX_PLACES + 1, made = 0;
    double *variances = memory_array(tree->count / stride + 1, sizeof *variances);
    if (variances == NULL)
        return error_memory(error, tree->count * sizeof *variances);
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    *sigma = 0;
    for (size_t i = stride / 2; i < tree->count && status == BAT_OK && tree->count >= MIN_POINTS; i += stride)
    {
        double flattest = INFINITY, least = 0;
        for (size_t wanted = MIN_POINTS; status == BAT_OK; wanted *= 2)
        {
            status = neighbours_nearest(tree, points + 3 * i, wanted, &near, error);
            if (status != BAT_OK)
                break;
            local_plane plane = local_plane_fit(points, &near);
            double variance = plane.variance[1] > 0 ? variance_at(points, &near, &plane) : 0;
            double flatness = plane.variance[1] > 0 ? variance / plane.variance[1] : 0;
            if (flatness < flattest)
            {
                flattest = flatness;
                least = variance;
            }
            if (flatness <= MAX_FLATNESS || wanted >= MAX_POINTS || 4 * near.count >= tree->count)
                break;
        }
        if (status == BAT_OK)
            variances[made++] = least;
    }
    if (status == BAT_OK && made > 0)
    {
        qsort(variances, made, sizeof *variances, ascending);
        *sigma = sqrt(variances[made / 2]);
    }
    neighbour_list_free(&near);
    free(variances);
    return status;
}

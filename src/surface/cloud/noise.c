/// @file
/// Noise by local quadratic fits; see noise.h.

#include "surface/cloud/noise.h"

#include "base/ascending.h"
#include "base/error.h"
#include "base/memory.h"
#include "surface/cloud/local_plane.h"

#include <math.h>
#include <stdlib.h>

enum
{
    TERMS = 6, ///< of a quadratic polynomial of two variables
    MIN_POINTS = 24,
    MAX_POINTS = 1536,
    MAX_PLACES = 1000
};

/// Neighbourhoods grow until the residual variance is at most this share of the smaller variance along the plane: in smaller
/// ones the plane follows the noise.
static const double MAX_FLATNESS = 0.02;
/// Pivots below this fraction of the diagonal entry are skipped.
static const double MIN_PIVOT = 1e-9;

/// Solve the normal equations in place by Cholesky's method. Terms that the points do not determine get 0.
/// @return the number of terms determined
static int solve(double matrix[TERMS][TERMS], double *right)
{
    int rank = 0;
    bool determined[TERMS];
    for (int j = 0; j < TERMS; j++)
    {
        double diagonal = matrix[j][j];
        for (int k = 0; k < j; k++)
            matrix[j][j] -= determined[k] ? matrix[j][k] * matrix[j][k] : 0;
        determined[j] = matrix[j][j] > MIN_PIVOT * diagonal;
        if (!determined[j])
            continue;
        rank++;
        matrix[j][j] = sqrt(matrix[j][j]);
        for (int i = j + 1; i < TERMS; i++)
        {
            for (int k = 0; k < j; k++)
                matrix[i][j] -= determined[k] ? matrix[i][k] * matrix[j][k] : 0;
            matrix[i][j] /= matrix[j][j];
        }
    }
    for (int j = 0; j < TERMS; j++)
    {
        for (int k = 0; k < j; k++)
            right[j] -= determined[k] ? matrix[j][k] * right[k] : 0;
        right[j] = determined[j] ? right[j] / matrix[j][j] : 0;
    }
    for (int j = TERMS; j-- > 0;)
    {
        for (int i = j + 1; i < TERMS; i++)
            right[j] -= determined[j] && determined[i] ? matrix[i][j] * right[i] : 0;
        right[j] = determined[j] ? right[j] / matrix[j][j] : 0;
    }
    return rank;
}

/// The variance of the neighbours' heights about a quadratic polynomial, by the median of its distribution.
static double variance_at(const double *points, const neighbour_list *near, const local_plane *plane)
{
    double matrix[TERMS][TERMS] = {{0}}, right[TERMS] = {0}, squares = 0;
    double scale = sqrt(plane->variance[0]);
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < near->count; i++)
        {
            const double *point = points + 3 * (size_t)near->entries[i].item;
            double height = 0, foot[2];
            local_plane_project(plane, plane->centre, point, foot);
            for (int k = 0; k < 3; k++)
                height += (point[k] - plane->centre[k]) * plane->axes[2][k];
            double x = foot[0] / scale, y = foot[1] / scale, terms[TERMS] = {1, x, y, x * x, x * y, y * y};
            for (int a = 0; a < TERMS && pass == 0; a++)
            {
                right[a] += terms[a] * height;
                for (int b = 0; b <= a; b++)
                    matrix[a][b] += terms[a] * terms[b];
            }
            for (int a = 0; a < TERMS && pass == 1; a++)
                height -= terms[a] * right[a];
            if (pass == 1)
                squares += height * height;
            else if (i + 1 == near->count)
                (void)solve(matrix, right);
        }
    double freedom = (double)near->count - TERMS, root = 1 - 2 / (9 * freedom);
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
        double variance = 0;
        for (size_t wanted = MIN_POINTS; status == BAT_OK; wanted *= 2)
        {
            status = neighbours_nearest(tree, points + 3 * i, wanted, &near, error);
            if (status != BAT_OK)
                break;
            local_plane plane = local_plane_fit(points, &near);
            variance = plane.variance[1] > 0 ? variance_at(points, &near, &plane) : 0;
            if (variance <= MAX_FLATNESS * plane.variance[1] || wanted >= MAX_POINTS || 4 * near.count >= tree->count)
                break;
        }
        if (status == BAT_OK)
            variances[made++] = variance;
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

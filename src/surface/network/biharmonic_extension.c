/// @file
/// Biharmonic extension of boundary parameters, by a dense system.
///
/// The noise of the loop is estimated from the deviation of each point from the cubic through two neighbours on either side.
/// With interpolation weights g_k, the deviation x_i - sum g_k x_k has standard deviation noise sqrt(1 + sum g_k^2).

#include "surface/network/chart_network.h"

#include "base/error.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

enum
{
    AFFINE_TERMS = 4,
    /// Longer loops are subsampled, because the system is dense.
    MAX_CENTRES = 512,
    /// Neighbours on either side that predict a point of the loop.
    NEIGHBOURS_A_SIDE = 2
};

/// lambda for each unit of noise.
static const double NOISE_WEIGHT = 5;
static const double MIN_LAMBDA = 1e-6;
/// Regularizes planar loops, for which the affine part is not unique.
static const double AFFINE_RIDGE = 1e-9;
/// Median length of a vector of three standard normal numbers (median of the chi distribution).
static const double MEDIAN_LENGTH = 1.5381722544550522;

/// Arc lengths of the neighbours along the polygon through them, relative to the point itself.
static void chord_positions(const double *point, const double *const neighbours[2 * NEIGHBOURS_A_SIDE],
                            double at[2 * NEIGHBOURS_A_SIDE])
{
    double reach = 0;
    for (size_t k = NEIGHBOURS_A_SIDE; k-- > 0;)
    {
        reach += vector3_distance(k + 1 < NEIGHBOURS_A_SIDE ? neighbours[k + 1] : point, neighbours[k]);
        at[k] = -reach;
    }
    reach = 0;
    for (size_t k = NEIGHBOURS_A_SIDE; k < (size_t)2 * NEIGHBOURS_A_SIDE; k++)
    {
        reach += vector3_distance(k > NEIGHBOURS_A_SIDE ? neighbours[k - 1] : point, neighbours[k]);
        at[k] = reach;
    }
}

/// Deviation of point i from the cubic of its neighbours over sqrt(1 + sum g_k^2); negative where these coincide.
static double prediction_error(const bat_cloud *cloud, size_t i)
{
    size_t count = cloud->boundary_count;
    const double *points = cloud->points, *point = points + 3 * i;
    const double *neighbours[2 * NEIGHBOURS_A_SIDE] = {points + 3 * ((i + count - 2) % count),
                                                       points + 3 * ((i + count - 1) % count),
                                                       points + 3 * ((i + 1) % count), points + 3 * ((i + 2) % count)};
    double at[2 * NEIGHBOURS_A_SIDE], squares = 1, gap[3] = {point[0], point[1], point[2]};
    chord_positions(point, neighbours, at);
    for (size_t k = 0; k < (size_t)2 * NEIGHBOURS_A_SIDE; k++)
    {
        double factor = 1;
        for (size_t m = 0; m < (size_t)2 * NEIGHBOURS_A_SIDE; m++)
            if (m != k)
                factor *= -at[m] / (at[k] - at[m]);
        if (!isfinite(factor))
            return -1;
        squares += factor * factor;
        vector_add(3, -factor, neighbours[k], gap);
    }
    return sqrt((gap[0] * gap[0] + gap[1] * gap[1] + gap[2] * gap[2]) / squares);
}

/// The standard deviation of a coordinate of the loop's points, from the median deviation. Noise along the loop is not
/// detected, so that the estimate is about three quarters of the true value.
/// @param scratch boundary_count numbers
static double loop_noise(const bat_cloud *cloud, double *scratch)
{
    size_t count = 0;
    for (size_t i = 0; cloud->boundary_count > (size_t)2 * NEIGHBOURS_A_SIDE && i < cloud->boundary_count; i++)
    {
        double length = prediction_error(cloud, i);
        if (length >= 0)
            scratch[count++] = length;
    }
    return count > 0 ? sort_median(scratch, count) / MEDIAN_LENGTH : 0;
}

static void fill_system(const biharmonic_extension *extension, double lambda, double *matrix)
{
    size_t count = extension->count, side = count + AFFINE_TERMS;
    memset(matrix, 0, side * side * sizeof *matrix);
    for (size_t i = 0; i < count; i++)
    {
        const double *x = extension->centres + 3 * i;
        double *row = matrix + i * side;
        row[i] = lambda;
        for (size_t j = i + 1; j < count; j++)
            row[j] = -vector3_distance(x, extension->centres + 3 * j);
        row[count] = 1;
        memcpy(row + count + 1, x, 3 * sizeof *x);
    }
    for (size_t i = 0; i < side; i++)
        for (size_t j = 0; j < i; j++)
            matrix[i * side + j] = matrix[j * side + i];
    for (size_t i = count; i < side; i++)
        matrix[i * side + i] = -AFFINE_RIDGE;
}

static bat_status solve(biharmonic_extension *extension, double lambda, bat_error *error)
{
    size_t side = extension->count + AFFINE_TERMS;
    double *matrix = memory_array(side * side, sizeof *matrix);
    if (matrix == NULL)
        return error_memory(error, side * side * sizeof *matrix);
    fill_system(extension, lambda, matrix);
    bat_status status = decompose_solve(side, 2, matrix, extension->weights, error);
    free(matrix);
    if (status != BAT_NO_CONVERGENCE)
        return status;
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                     "the boundary parameters cannot be extended to the interior");
}

bat_status biharmonic_extension_make(const bat_cloud *cloud, const double *boundary, biharmonic_extension *extension,
                                     bat_error *error)
{
    size_t loop = cloud->boundary_count, step = (loop + MAX_CENTRES - 1) / MAX_CENTRES, count = (loop + step - 1) / step;
    biharmonic_extension made = {.count = count};
    made.centres = memory_pool_array(&made.pool, count, 3 * sizeof *made.centres);
    made.weights = memory_pool_array(&made.pool, count + AFFINE_TERMS, 2 * sizeof *made.weights);
    double *scratch = memory_pool_array(&made.pool, loop, sizeof *scratch);
    bat_status status = memory_pool_check(&made.pool, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < 3 * loop; i++)
            made.middle[i % 3] += cloud->points[i] / (double)loop;
        for (size_t i = 0; i < 3 * count; i++)
            made.centres[i] = cloud->points[3 * (i / 3 * step) + i % 3] - made.middle[i % 3];
        for (size_t i = 0; i < 2 * count; i++)
            made.weights[i] = boundary[2 * (i / 2 * step) + i % 2];
        memset(made.weights + 2 * count, 0, (size_t)2 * AFFINE_TERMS * sizeof *made.weights);
        made.noise = loop_noise(cloud, scratch);
        status = solve(&made, MIN_LAMBDA + NOISE_WEIGHT * made.noise, error);
    }
    if (status == BAT_OK)
        *extension = made;
    else
        biharmonic_extension_free(&made);
    return status;
}

void biharmonic_extension_free(biharmonic_extension *extension)
{
    memory_pool_free(&extension->pool);
    *extension = (biharmonic_extension){0};
}

void biharmonic_extension_evaluate(const biharmonic_extension *extension, const double *points, size_t count,
                                   double *parameters)
{
    const double *affine = extension->weights + 2 * extension->count;
    for (size_t i = 0; i < count; i++)
    {
        double x[3], u = affine[0], v = affine[1];
        for (size_t a = 0; a < 3; a++)
        {
            x[a] = points[3 * i + a] - extension->middle[a];
            u += affine[2 * a + 2] * x[a];
            v += affine[2 * a + 3] * x[a];
        }
        for (size_t k = 0; k < extension->count; k++)
        {
            double length = vector3_distance(x, extension->centres + 3 * k);
            u -= extension->weights[2 * k] * length;
            v -= extension->weights[2 * k + 1] * length;
        }
        parameters[2 * i] = fmin(fmax(u, 0), 1);
        parameters[2 * i + 1] = fmin(fmax(v, 0), 1);
    }
}

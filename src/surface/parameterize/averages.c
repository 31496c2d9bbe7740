/// @file
/// Assembly and solution of (I - W) u = W_fixed u_fixed; see weights.h.

#include "surface/parameterize/weights.h"

#include "base/choice.h"
#include "base/option.h"
#include "base/progress.h"
#include "linalg/vector.h"

#include <string.h>

/// The number of points that are not unknowns.
static const uint32_t FIXED = UINT32_MAX;

typedef struct average_problem
{
    memory_pool pool;
    uint32_t *numbers; ///< index of each point of the cloud among the unknowns, or FIXED
    uint32_t *points;  ///< count: points of the unknowns
    size_t count;
    sparse_rows weights;
    double *constant; ///< count x 2
    double *solution; ///< count x 2
} average_problem;

static bat_status number_unknowns(const bat_cloud *cloud, const bool *moved, average_problem *problem, bat_error *error)
{
    problem->numbers = memory_pool_array(&problem->pool, cloud->count, sizeof *problem->numbers);
    problem->points = memory_pool_array(&problem->pool, cloud->count, sizeof *problem->points);
    bat_status status = memory_pool_check(&problem->pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        bool unknown = i >= cloud->boundary_count && (moved == NULL || moved[i]);
        problem->numbers[i] = unknown ? (uint32_t)problem->count : FIXED;
        if (unknown)
            problem->points[problem->count++] = (uint32_t)i;
    }
    return status;
}

static bat_status allocate_system(const bat_cloud *cloud, const sparse_rows *rows, average_problem *problem,
                                  bat_error *error)
{
    size_t entries = 0;
    for (size_t n = 0; n < problem->count; n++)
    {
        size_t row = problem->points[n] - cloud->boundary_count;
        entries += rows->starts[row + 1] - rows->starts[row];
    }
    problem->constant = memory_pool_array(&problem->pool, problem->count, 2 * sizeof(double));
    problem->solution = memory_pool_array(&problem->pool, problem->count, 2 * sizeof(double));
    if (problem->constant == NULL || problem->solution == NULL)
        return memory_pool_check(&problem->pool, error);
    return sparse_rows_make(problem->count, problem->count, entries, &problem->weights, error);
}

/// Split each row into the weights of unknowns and a constant.
static void fill_system(const bat_cloud *cloud, const sparse_rows *rows, const double *parameters, average_problem *problem)
{
    sparse_rows *weights = &problem->weights;
    size_t at = 0;
    for (size_t n = 0; n < problem->count; n++)
    {
        size_t row = problem->points[n] - cloud->boundary_count;
        double given[2] = {0, 0};
        weights->starts[n] = at;
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
        {
            size_t point = rows->columns[e];
            if (problem->numbers[point] == FIXED)
                vector_add(2, rows->values[e], parameters + 2 * point, given);
            else
            {
                weights->columns[at] = problem->numbers[point];
                weights->values[at++] = rows->values[e];
            }
        }
        memcpy(problem->constant + 2 * n, given, sizeof given);
    }
    weights->starts[problem->count] = at;
}

/// Store the solution, clamped to the bounding box of the fixed parameters, which bounds it up to rounding.
static void write_solution(const bat_cloud *cloud, const average_problem *problem, double *parameters)
{
    for (size_t c = 0; c < 2; c++)
    {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < cloud->count; i++)
            if (problem->numbers[i] == FIXED)
                box_include(1, &parameters[2 * i + c], &low, &high);
        for (size_t n = 0; n < problem->count; n++)
            parameters[2 * (size_t)problem->points[n] + c] = fmin(fmax(problem->solution[2 * n + c], low), high);
    }
}

bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const bool *moved, double *parameters,
                          bat_error *error)
{
    average_problem problem = {0};
    bat_status status = number_unknowns(cloud, moved, &problem, error);
    if (status == BAT_OK)
        status = allocate_system(cloud, rows, &problem, error);
    if (status == BAT_OK)
    {
        fill_system(cloud, rows, parameters, &problem);
        status = average_solve(&problem.weights, problem.constant, problem.solution, error);
    }
    if (status == BAT_OK)
        write_solution(cloud, &problem, parameters);
    memory_pool_free(&problem.pool);
    sparse_rows_free(&problem.weights);
    return status;
}

// Stretch minimization by iterated re-weighting.

/// Relative regularization of the normal matrix of the parameter differences, for nearly collinear neighbourhoods.
static const double RIDGE = 1e-6;
/// Minimum relative decrease of the total stretch in a round.
static const double MIN_REDUCTION = 0.01;
/// Lower bound of the stretch at a point, relative to the total stretch.
static const double MIN_STRETCH = 1e-6;

static const int MAX_ROUNDS = 10;

/// The stretch at a point: root of half the squared Frobenius norm of the least-squares derivative.
static double stretch_at(const bat_cloud *cloud, const sparse_rows *rows, size_t row, const double *parameters)
{
    size_t point = cloud->boundary_count + row;
    double uu = 0, uv = 0, vv = 0, xu[3] = {0}, xv[3] = {0};
    for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
    {
        size_t other = rows->columns[e];
        double u = parameters[2 * other] - parameters[2 * point], v = parameters[2 * other + 1] - parameters[2 * point + 1];
        uu += u * u;
        uv += u * v;
        vv += v * v;
        for (size_t d = 0; d < 3; d++)
        {
            double x = cloud->points[3 * other + d] - cloud->points[3 * point + d];
            xu[d] += x * u;
            xv[d] += x * v;
        }
    }
    double minimum = RIDGE * (uu + vv);
    uu += minimum;
    vv += minimum;
    double determinant = uu * vv - uv * uv, squares = 0;
    for (size_t d = 0; d < 3; d++)
    {
        double a = (vv * xu[d] - uv * xv[d]) / determinant, b = (uu * xv[d] - uv * xu[d]) / determinant;
        squares += a * a + b * b;
    }
    return sqrt(squares / 2);
}

/// Stretch at all interior points; the largest of the others where the parameters of a neighbourhood coincide.
/// @return the total stretch
static double measure_interior(const bat_cloud *cloud, const sparse_rows *rows, const double *parameters, double *stretch)
{
    size_t interior = cloud->count - cloud->boundary_count;
    double greatest = 0, sum = 0, *at = stretch + cloud->boundary_count;
    for (size_t row = 0; row < interior; row++)
    {
        at[row] = stretch_at(cloud, rows, row, parameters);
        if (isfinite(at[row]))
            greatest = fmax(greatest, at[row]);
    }
    for (size_t row = 0; row < interior; row++)
    {
        at[row] = isfinite(at[row]) ? at[row] : greatest;
        sum += at[row] * at[row];
    }
    return interior > 0 ? sqrt(sum / (double)interior) : 0;
}

/// Stretch at all points. A boundary point receives the mean over the rows in which it occurs.
/// @param energy receives the total stretch
static bat_status measure(const bat_cloud *cloud, const sparse_rows *rows, const double *parameters, double *stretch,
                          double *energy, bat_error *error)
{
    size_t boundary_count = cloud->boundary_count;
    size_t *uses = calloc(boundary_count, sizeof *uses);
    if (uses == NULL)
        return error_memory(error, boundary_count * sizeof *uses);
    *energy = measure_interior(cloud, rows, parameters, stretch);
    memset(stretch, 0, boundary_count * sizeof *stretch);
    for (size_t row = 0; row < rows->row_count; row++)
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            if (rows->columns[e] < boundary_count)
            {
                stretch[rows->columns[e]] += stretch[boundary_count + row];
                uses[rows->columns[e]]++;
            }
    for (size_t k = 0; k < boundary_count; k++)
        stretch[k] = uses[k] > 0 ? stretch[k] / (double)uses[k] : 1;
    free(uses);
    return BAT_OK;
}

/// One round: divide the weights by the stretch at the neighbour, rescale the rows, and solve.
/// @param stretch stretch at all points, before and after the round
/// @param energy  receives the total stretch; infinite if the solver does not converge
static bat_status reweight_and_solve(const bat_cloud *cloud, sparse_rows *rows, double minimum, double *stretch,
                                     double *parameters, double *energy, bat_error *error)
{
    for (size_t row = 0; row < rows->row_count; row++)
    {
        double sum = 0;
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            sum += rows->values[e] /= fmax(stretch[rows->columns[e]], minimum);
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            rows->values[e] /= sum;
    }
    bat_status status = averages_solve(cloud, rows, NULL, parameters, error);
    *energy = INFINITY;
    if (status == BAT_NO_CONVERGENCE)
        return BAT_OK;
    return status == BAT_OK ? measure(cloud, rows, parameters, stretch, energy, error) : status;
}

bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, bat_progress progress, double *parameters,
                            bat_error *error)
{
    memory_pool pool = {0};
    double *stretch = memory_pool_array(&pool, cloud->count, sizeof *stretch);
    double *next = memory_pool_array(&pool, cloud->count, 2 * sizeof *next), energy = 0, reduced;
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = measure(cloud, rows, parameters, stretch, &energy, error);
    if (status == BAT_OK)
        memcpy(next, parameters, 2 * cloud->count * sizeof *next);
    for (int round = 0; round < MAX_ROUNDS && status == BAT_OK && energy > 0 && isfinite(energy); round++)
    {
        status = progress_check(progress, (double)round / MAX_ROUNDS, error);
        if (status == BAT_OK)
            status = reweight_and_solve(cloud, rows, MIN_STRETCH * energy, stretch, next, &reduced, error);
        if (status != BAT_OK || !(reduced < (1 - MIN_REDUCTION) * energy))
            break;
        energy = reduced;
        memcpy(parameters, next, 2 * cloud->count * sizeof *parameters);
    }
    memory_pool_free(&pool);
    return status;
}

// Classical parameterizations of clouds (bat_cloud_parameterize): u_i = sum_k w_ik u_k for interior points, u fixed on the
// boundary. The methods differ in the weights w_ik (weights.h). The option `published` selects the neighbourhoods and the
// direct solver of the literature, which may fail. By default, neighbourhoods adapt to the points, and the system is solved
// iteratively.

/// Numerator of the radius 3 / sqrt(n), eq. (7) of Giannelli et al. (2023).
static const double RADIUS_FACTOR = 3;

static const bat_choice METHODS[] = {
    CHOICE_OF_USE(UNNAMED, "auto", "shape-preserving", BAT_CLOUD_PARAMETERIZATION_AUTO),
    CHOICE("shape-preserving",
           "Floater's weights on the Delaunay neighbours in local planes; docs/algorithms/parameterization.md",
           BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING),
    CHOICE("inverse-distance", "weights by the inverse distance of neighbours", BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE),
    CHOICE("uniform", "all neighbours weigh the same", BAT_CLOUD_PARAMETERIZATION_UNIFORM),
    CHOICE("mean-value", "Floater's mean values, for clouds that are meshes", BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE),
    CHOICE("stretch-minimizing", "shape-preserving, evened out: for deep shapes",
           BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING),
    CHOICE("isometric", "least distortion of triangles, along the boundary too: for the deepest shapes",
           BAT_CLOUD_PARAMETERIZATION_ISOMETRIC),
};
const bat_family bat_cloud_parameterization_family = FAMILY("parameterization", METHODS);

bat_cloud_parameterize_options bat_cloud_parameterize_defaults(void)
{
    return (bat_cloud_parameterize_options){.method = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING};
}

static const option_field FIELDS[] = {
    OPTION_FAMILY(bat_cloud_parameterize_options, method, bat_cloud_parameterization_family),
    OPTION_FIELD(bat_cloud_parameterize_options, radius, OPTION_NUMBER, 0, INFINITY),
    OPTION_THREADS(bat_cloud_parameterize_options),
};

const bat_options_table bat_cloud_parameterize_fields = OPTIONS_TABLE(bat_cloud_parameterize_options, FIELDS, NULL);

bat_status boundary_parameters_check(const bat_cloud *cloud, const double *boundary, bat_error *error)
{
    if (cloud->boundary_count == 0)
        return ERROR_ARGUMENT(error, "the boundary of the cloud is unknown");
    for (size_t i = 0; i < 2 * cloud->boundary_count; i++)
        if (!isfinite(boundary[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i / 2, 0, "the parameters of boundary point %zu are not finite",
                             i / 2);
    return BAT_OK;
}

/// Published variant: neighbours in a ball of fixed radius, which may fail, and a direct solver.
static bat_status parameterize_published(const bat_cloud *cloud, const double *boundary,
                                         const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    double radius = options->radius > 0 ? options->radius : RADIUS_FACTOR / sqrt((double)cloud->count);
    nearest_tree tree;
    bat_status status = neighbours_build(cloud->points, cloud->count, &tree, error);
    if (status != BAT_OK)
        return status;
    weight_source source = {
        .cloud = cloud, .tree = &tree, .method = options->method, .radius = radius * weights_longest_side(cloud)};
    sparse_rows rows = {0};
    bool star = options->method == BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING;
    status = weights_build(&source, star ? weights_of_triangulated_ball : weights_of_ball, options->threads, &rows, error);
    size_t unjoined = BAT_NO_INDEX;
    if (status == BAT_OK)
        status = weights_find_unjoined(cloud, &rows, &unjoined, error);
    if (status == BAT_OK && unjoined != BAT_NO_INDEX)
    {
        size_t place = cloud_input_index(cloud, unjoined);
        status = error_set(error, BAT_NO_CONVERGENCE, place, 0, "no chain of neighbours connects point %zu to the boundary",
                           place);
    }
    if (status == BAT_OK)
    {
        memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
        status = averages_solve(cloud, &rows, NULL, parameters, error);
    }
    sparse_rows_free(&rows);
    nearest_free(&tree);
    return status;
}

static bat_status parameterize_adaptive(const bat_cloud *cloud, const double *boundary,
                                        const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    spatial_order order = {0};
    sparse_rows rows = {0};
    double *ordered = memory_array(cloud->count, 2 * sizeof *ordered);
    bat_status status =
        ordered != NULL ? spatial_order_make(cloud, &order, error) : error_memory(error, cloud->count * 2 * sizeof *ordered);
    if (status == BAT_OK)
        status = weights_make(&order.cloud, &order.tree, options, &rows, error);
    if (status == BAT_OK)
    {
        memcpy(ordered, boundary, 2 * cloud->boundary_count * sizeof *ordered);
        status = averages_solve(&order.cloud, &rows, NULL, ordered, error);
    }
    if (status == BAT_OK && options->method == BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING)
        status = stretch_minimize(&order.cloud, &rows, options->progress, ordered, error);
    if (status == BAT_OK && options->method == BAT_CLOUD_PARAMETERIZATION_ISOMETRIC)
        status = isometric_minimize(&order.cloud, &rows, options->progress, ordered, error);
    for (size_t i = 0; status == BAT_OK && i < cloud->count; i++)
        memcpy(parameters + 2 * order.places[i], ordered + 2 * i, 2 * sizeof *parameters);
    sparse_rows_free(&rows);
    spatial_order_free(&order);
    free(ordered);
    return status;
}

bat_status bat_cloud_parameterize(const bat_cloud *cloud, const double *boundary,
                                  const bat_cloud_parameterize_options *options, double *parameters, bat_error *error)
{
    bat_cloud_parameterize_options chosen = options != NULL ? *options : bat_cloud_parameterize_defaults();
    bat_status status = bat_options_check(&bat_cloud_parameterize_fields, options, error);
    options = &chosen;
    if (chosen.method == BAT_CLOUD_PARAMETERIZATION_AUTO)
        chosen.method = BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING;
    if (status == BAT_OK)
        status = bat_cloud_check(cloud, error);
    if (status == BAT_OK)
        status = boundary_parameters_check(cloud, boundary, error);
    if (status == BAT_OK && options->method == BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE && cloud->triangle_count == 0)
        status = ERROR_UNSUPPORTED(error, 0, "mean values need the triangles of a mesh");
    if (status != BAT_OK)
        return status;
    if (options->published && options->method < BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE)
        return parameterize_published(cloud, boundary, options, parameters, error);
    return parameterize_adaptive(cloud, boundary, options, parameters, error);
}

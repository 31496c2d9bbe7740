/// @file
/// Assembly and solution of (I - W) u = W_fixed u_fixed; see weights.h.

#include "surface/parameterize/weights.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "linalg/sparse.h"

#include <math.h>
#include <stdlib.h>
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

static void problem_free(average_problem *problem)
{
    memory_pool_free(&problem->pool);
    sparse_rows_free(&problem->weights);
}

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
                for (size_t c = 0; c < 2; c++)
                    given[c] += rows->values[e] * parameters[2 * point + c];
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
            {
                low = fmin(low, parameters[2 * i + c]);
                high = fmax(high, parameters[2 * i + c]);
            }
        for (size_t n = 0; n < problem->count; n++)
            parameters[2 * (size_t)problem->points[n] + c] = fmin(fmax(problem->solution[2 * n + c], low), high);
    }
}

bat_status averages_solve(const bat_cloud *cloud, const sparse_rows *rows, const bool *moved, average_solver solver,
                          double *parameters, bat_error *error)
{
    average_problem problem = {0};
    bat_status status = number_unknowns(cloud, moved, &problem, error);
    if (status == BAT_OK)
        status = allocate_system(cloud, rows, &problem, error);
    if (status == BAT_OK)
    {
        fill_system(cloud, rows, parameters, &problem);
        status = solver.direct
                     ? average_solve_direct(&problem.weights, problem.constant, problem.solution, error)
                     : average_solve_iterative(&problem.weights, problem.constant, solver.threads, problem.solution, error);
    }
    if (status == BAT_OK)
        write_solution(cloud, &problem, parameters);
    problem_free(&problem);
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

/// Stretch at all interior points. Where the parameters of a neighbourhood coincide, as in deep shapes, the largest stretch
/// of the others is used.
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

/// Divide the weights by the stretch at the neighbour, and rescale the rows.
static void reweight(const double *stretch, double minimum, sparse_rows *rows)
{
    for (size_t row = 0; row < rows->row_count; row++)
    {
        double sum = 0;
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            sum += rows->values[e] /= fmax(stretch[rows->columns[e]], minimum);
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            rows->values[e] /= sum;
    }
}

/// One round.
/// @param stretch stretch at all points, before and after the round
/// @param energy  receives the total stretch; infinite if the solver does not converge
static bat_status reweight_and_solve(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double minimum,
                                     double *stretch, double *parameters, double *energy, bat_error *error)
{
    reweight(stretch, minimum, rows);
    bat_status status = averages_solve(cloud, rows, NULL, solver, parameters, error);
    *energy = INFINITY;
    if (status == BAT_NO_CONVERGENCE)
        return BAT_OK;
    return status == BAT_OK ? measure(cloud, rows, parameters, stretch, energy, error) : status;
}

bat_status stretch_minimize(const bat_cloud *cloud, sparse_rows *rows, average_solver solver, double *parameters,
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
        if (!progress_goes_on(solver.progress, (double)round / MAX_ROUNDS))
        {
            status = error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
            break;
        }
        status = reweight_and_solve(cloud, rows, solver, MIN_STRETCH * energy, stretch, next, &reduced, error);
        if (status != BAT_OK || !(reduced < (1 - MIN_REDUCTION) * energy))
            break;
        energy = reduced;
        memcpy(parameters, next, 2 * cloud->count * sizeof *parameters);
    }
    memory_pool_free(&pool);
    return status;
}

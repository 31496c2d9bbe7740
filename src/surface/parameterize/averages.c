/// @file
/// Assembly and solution of (I - W) u = W_fixed u_fixed; see averages.h.

#include "surface/parameterize/averages.h"

#include "linalg/average_system.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The number of points that are not unknowns.
static const uint32_t FIXED = UINT32_MAX;

/// The unknowns and the linear system.
typedef struct average_problem
{
    uint32_t *numbers; ///< index of each point of the cloud among the unknowns, or FIXED
    uint32_t *points;  ///< count: points of the unknowns
    size_t count;
    sparse_rows weights;
    double *constant; ///< count x 2
    double *solution; ///< count x 2
} average_problem;

static void problem_free(average_problem *problem)
{
    free(problem->numbers);
    free(problem->points);
    free(problem->constant);
    free(problem->solution);
    sparse_rows_free(&problem->weights);
}

static bat_status number_unknowns(const bat_cloud *cloud, const bool *moved, average_problem *problem, bat_error *error)
{
    problem->numbers = memory_array(cloud->count, sizeof *problem->numbers);
    problem->points = memory_array(cloud->count, sizeof *problem->points);
    if (problem->numbers == NULL || problem->points == NULL)
        return error_memory(error, cloud->count * 2 * sizeof *problem->points);
    for (size_t i = 0; i < cloud->count; i++)
    {
        bool unknown = i >= cloud->boundary_count && (moved == NULL || moved[i]);
        problem->numbers[i] = unknown ? (uint32_t)problem->count : FIXED;
        if (unknown)
            problem->points[problem->count++] = (uint32_t)i;
    }
    return BAT_OK;
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
    problem->constant = memory_array(problem->count, 2 * sizeof(double));
    problem->solution = memory_array(problem->count, 2 * sizeof(double));
    if (problem->constant == NULL || problem->solution == NULL)
        return error_memory(error, problem->count * 4 * sizeof(double));
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

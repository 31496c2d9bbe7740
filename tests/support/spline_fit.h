#ifndef TESTS_SUPPORT_SPLINE_FIT_H
#define TESTS_SUPPORT_SPLINE_FIT_H

#include "check.h"

#include "surface/fit/system.h"

#include <float.h>

/// Add the fit of what is left of the points to `control`: K dc = A^T W r - 2 lambda M c (Bjorck, "Numerical methods for
/// least squares problems", 1996, section 2.9.3).
/// @param given the positions, in the order of the rows of `points`
/// @return the relative change in the maximum norm
static inline double spline_fit_refine(fit_system *system, fit_solver *solver, fit_points *points, const double *given,
                                       double lambda, double *control)
{
    size_t dimension = points->dimension, numbers = system->functions * dimension;
    double *change = calloc(2 * numbers, sizeof *change), *plate = change + numbers, largest = 0, most = 0;
    assert_non_null(change);
    bat_spline_surface surface = {
        .space = (bat_hierarchical_space *)system->space, .control = control, .dimension = dimension};
    check_status(bat_spline_surface_evaluate(&surface, points->parameter, points->count, 0, points->position, NULL), BAT_OK);
    for (size_t k = 0; k < points->count * dimension; k++)
        points->position[k] = given[k] - points->position[k];
    check_status(fit_system_gather(system, points, NULL), BAT_OK);
    fit_system_multiply(system, system->plate, dimension, control, plate);
    for (size_t k = 0; k < numbers; k++)
        change[k] = system->right[k / dimension * system->columns + k % dimension] - 2 * lambda * plate[k];
    check_status(fit_solver_solve(solver, dimension, change, change, NULL), BAT_OK);
    for (size_t k = 0; k < numbers; k++)
    {
        control[k] += change[k];
        largest = fmax(largest, fabs(control[k]));
        most = fmax(most, fabs(change[k]));
    }
    free(change);
    return largest > 0 ? most / largest : 0;
}

/// One fit over a given space with given weights, then refined to the accuracy of a solution by orthogonal factors.
/// @param weights null: 1
/// @param lambda  receives the weight of smoothing used
static inline bat_status spline_fit(const bat_hierarchical_space *space, const bat_surface_fit_data *data,
                                    const double *weights, double *lambda, double *control, bat_error *error)
{
    bat_status status = fit_points_check(NULL, data, NULL, error);
    if (status != BAT_OK)
        return status;
    fit_points points;
    fit_system system;
    fit_solver *solver;
    check_status(fit_points_make(NULL, data, NULL, bat_hierarchical_space_options(space).truncated, &points, error), BAT_OK);
    for (size_t row = 0; weights != NULL && row < points.count; row++)
        points.weight[row] = weights[points.number[row]];
    fit_points_locate(&points, space, 0);
    check_status(fit_points_sort(&points, space, error), BAT_OK);
    check_status(fit_system_make(space, NULL, data->dimension, false, 0, &system, error), BAT_OK);
    check_status(fit_system_gather(&system, &points, error), BAT_OK);
    check_status(fit_solver_make(&system.pattern, &solver, error), BAT_OK);
    size_t size = points.count * points.dimension * sizeof(double);
    double *given = malloc(size), used = *lambda, before = INFINITY, change = DBL_MAX;
    assert_non_null(given);
    memcpy(given, points.position, size);
    status = fit_weight_solve(&system, solver, &used, control, error);
    for (int k = 0; k < 4 && status == BAT_OK && change > 4 * DBL_EPSILON && change < before; k++)
    {
        before = change;
        change = spline_fit_refine(&system, solver, &points, given, used, control);
    }
    if (status == BAT_OK)
    {
        fit_points_restore(&points, system.functions, control);
        *lambda = used;
    }
    free(given);
    fit_solver_free(solver);
    fit_system_free(&system);
    fit_points_free(&points);
    return status;
}

#endif

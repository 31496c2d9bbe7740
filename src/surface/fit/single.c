/// @file
/// One penalized least-squares fit with given weights and lambda (spline_fit), and one parameter correction
/// (spline_correct).
///
/// The solution of the normal equations is refined with residuals r = x - A c of the points,
///     K dc = A^T W r - 2 lambda M c,   c <- c + dc,
/// so that the error grows with the condition number of A instead of its square (Bjorck, "Numerical methods for least
/// squares problems", 1996, section 2.9.3).

#include "batten/surface_fit.h"
#include "surface/fit/system.h"

#include "base/error.h"
#include "surface/fit/foot_points.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum
{
    MAX_REFINEMENTS = 4 ///< maximum number of refinements of a solution
};

// Refinement stops when the relative change is at most this.
static const double CHANGE_TOLERANCE = 4 * DBL_EPSILON;

static bat_status check_weights(const bat_surface_fit_data *data, const double *weights, double lambda, bat_error *error)
{
    if (!(lambda >= 0 && isfinite(lambda)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the weight of smoothing must be finite and not negative");
    for (size_t i = 0; weights != NULL && i < data->count; i++)
        if (!(weights[i] >= 0 && isfinite(weights[i])))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "weight %zu must be finite and not negative", i);
    return BAT_OK;
}

typedef struct single_fit
{
    fit_points points;
    fit_system system;
    fit_solver *solver;
    memory_pool pool;
    double *residual;   ///< count x dimension
    double *change;     ///< functions x dimension
    double *thin_plate; ///< functions x dimension
} single_fit;

static void single_free(single_fit *fit)
{
    fit_points_free(&fit->points);
    fit_system_free(&fit->system);
    fit_solver_free(fit->solver);
    memory_pool_free(&fit->pool);
}

static bat_status single_make(const bat_hierarchical_space *space, const bat_surface_fit_data *data, const double *weights,
                              single_fit *fit, bat_error *error)
{
    bat_status status = fit_points_make(data, weights, bat_hierarchical_space_options(space).truncated, &fit->points, error);
    if (status == BAT_OK)
    {
        fit_points_locate(&fit->points, space, 0);
        status = fit_points_sort(&fit->points, space, error);
    }
    if (status == BAT_OK)
        status = fit_system_make(space, NULL, data->dimension, false, 0, &fit->system, error);
    if (status == BAT_OK)
        status = fit_system_gather(&fit->system, &fit->points, error);
    if (status == BAT_OK)
        status = fit_solver_make(&fit->system.pattern, &fit->solver, error);
    if (status != BAT_OK)
        return status;
    size_t numbers = fit->system.functions * data->dimension;
    fit->residual = memory_pool_array(&fit->pool, data->count * data->dimension, sizeof *fit->residual);
    fit->change = memory_pool_array(&fit->pool, numbers, sizeof *fit->change);
    fit->thin_plate = memory_pool_array(&fit->pool, numbers, sizeof *fit->thin_plate);
    return memory_pool_check(&fit->pool, error);
}

static bat_status find_residual(single_fit *fit, const double *control, bat_error *error)
{
    fit_nets nets;
    bat_status status = fit_nets_make(fit->system.space, control, fit->points.dimension, 0, &nets, error);
    if (status == BAT_OK)
        status = fit_nets_measure(&nets, &fit->points, fit->residual, 0, error);
    fit_nets_free(&nets);
    return status;
}

/// One step of iterative refinement.
/// @param relative receives the relative change in the maximum norm
static bat_status refine_solution(single_fit *fit, double lambda, double *control, double *relative, bat_error *error)
{
    size_t numbers = fit->system.functions * fit->points.dimension;
    bat_status status = find_residual(fit, control, error);
    if (status == BAT_OK)
        status = fit_system_gather_residual(&fit->system, &fit->points, fit->residual, fit->change, error);
    if (status != BAT_OK)
        return status;
    fit_system_multiply(&fit->system, fit->system.plate, fit->points.dimension, control, fit->thin_plate);
    for (size_t k = 0; k < numbers; k++)
        fit->change[k] -= 2 * lambda * fit->thin_plate[k];
    status = fit_solver_solve(fit->solver, fit->points.dimension, fit->change, fit->change, error);
    double largest = 0, change = 0;
    for (size_t k = 0; k < numbers && status == BAT_OK; k++)
    {
        control[k] += fit->change[k];
        largest = fmax(largest, fabs(control[k]));
        change = fmax(change, fabs(fit->change[k]));
    }
    *relative = largest > 0 ? change / largest : 0;
    return status;
}

bat_status spline_fit(const bat_hierarchical_space *space, const bat_surface_fit_data *data, const double *weights,
                      double *lambda, double *control, bat_error *error)
{
    bat_status status = fit_points_check(data, error);
    if (status == BAT_OK)
        status = check_weights(data, weights, *lambda, error);
    if (status != BAT_OK)
        return status;
    single_fit fit = {0};
    double used = *lambda, before = INFINITY, change = DBL_MAX;
    status = single_make(space, data, weights, &fit, error);
    if (status == BAT_OK)
        status = fit_weight_solve(&fit.system, fit.solver, &used, control, error);
    for (int k = 0; k < MAX_REFINEMENTS && status == BAT_OK && change > CHANGE_TOLERANCE && change < before; k++)
    {
        before = change;
        status = refine_solution(&fit, used, control, &change, error);
    }
    if (status == BAT_OK)
    {
        fit_points_restore(&fit.points, fit.system.functions, control);
        *lambda = used;
    }
    single_free(&fit);
    return status;
}

bat_status spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved, bat_error *error)
{
    bat_status status = fit_points_check(data, error);
    if (status == BAT_OK && data->dimension != surface->dimension)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "the points have %zu coordinates, the surface has %zu", data->dimension, surface->dimension);
    if (status != BAT_OK)
        return status;
    fit_points points;
    fit_nets nets = {0};
    size_t count = 0;
    status = fit_points_make(data, NULL, false, &points, error);
    if (status == BAT_OK)
        fit_points_locate(&points, surface->space, 0);
    if (status == BAT_OK)
        status = fit_nets_make(surface->space, surface->control, surface->dimension, 0, &nets, error);
    if (status == BAT_OK)
        status = fit_correct(&nets, &points, fit_correction_full(), 0, &count, error);
    if (status == BAT_OK)
        (void)fit_points_return(&points, data);
    if (status == BAT_OK && moved != NULL)
        *moved = count;
    fit_points_free(&points);
    fit_nets_free(&nets);
    return status;
}

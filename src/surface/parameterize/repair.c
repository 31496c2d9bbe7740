/// @file
/// Repair of faulty parameters (bat_cloud_parameters_repair).
///
/// Faulty points and a ring of neighbours around them are replaced by the solution of u_i = sum_k w_ik u_k with
/// shape-preserving weights, or mean-value weights in a cloud with triangles. The width of the ring doubles in every round.
/// If folds remain when the whole interior has been replaced, u = (1 - s) u_shape + s u_uniform is tried for s = 1/4, …, 1.
/// The best parameters are the result.

#include "surface/parameterize/averages.h"
#include "surface/parameterize/faults.h"
#include "surface/parameterize/weights.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    ROUNDS = 10,    ///< maximum number of rounds
    LARGE = 100000, ///< clouds with more points get one round only, because more would take longer than a fit
    BLENDS = 4      ///< number of steps s
};

/// State of a repair, in the order of the finder.
typedef struct repair
{
    const fold_finder *finder;
    sparse_rows rows; ///< the weights w_ik
    parameter_faults faults;
    bat_cloud_parameters_report report;
    bool *moved;     ///< points to be replaced
    double *current; ///< count x 2 each
    double *best;
    double *uniform;
    bat_cloud_parameters_report best_report;
} repair;

static void repair_free(repair *work)
{
    sparse_rows_free(&work->rows);
    parameter_faults_free(&work->faults);
    free(work->moved);
    free(work->current);
    free(work->best);
    free(work->uniform);
}

static bat_status repair_make(const fold_finder *finder, repair *work, bat_error *error)
{
    const bat_cloud *cloud = &finder->order.cloud;
    size_t count = cloud->count;
    *work = (repair){.finder = finder,
                     .moved = memory_array(count, sizeof *work->moved),
                     .current = memory_array(count, 2 * sizeof *work->current),
                     .best = memory_array(count, 2 * sizeof *work->best),
                     .uniform = memory_array(count, 2 * sizeof *work->uniform)};
    if (work->moved == NULL || work->current == NULL || work->best == NULL || work->uniform == NULL)
        return error_memory(error, count * 6 * sizeof *work->current);
    memset(work->moved, 0, count * sizeof *work->moved);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    if (cloud->triangle_count > 0)
        options.method = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE;
    bat_status status = parameter_faults_make(count, &work->faults, error);
    if (status == BAT_OK)
        status = weights_make(cloud, &finder->order.tree, &options, &work->rows, error);
    return status;
}

static size_t fault_count(const bat_cloud_parameters_report *report)
{
    return report->folded + report->outside + report->coincident;
}

/// Lexicographic comparison: number of folds, then of points outside, then of coincident points.
static bool is_better(const bat_cloud_parameters_report *report, const bat_cloud_parameters_report *than)
{
    if (report->folded != than->folded)
        return report->folded < than->folded;
    return report->outside != than->outside ? report->outside < than->outside : report->coincident < than->coincident;
}

/// Find the faults of the current parameters, and store the parameters if they are the best so far.
static bat_status evaluate(repair *work, bool first, bat_error *error)
{
    size_t count = work->finder->order.cloud.count;
    bat_status status = parameter_faults_find(work->finder, work->current, &work->faults, &work->report, error);
    if (status == BAT_OK && (first || is_better(&work->report, &work->best_report)))
    {
        work->best_report = work->report;
        memcpy(work->best, work->current, 2 * count * sizeof *work->best);
    }
    return status;
}

/// Add faulty points and `rings` rings of neighbours to the points to be replaced. Returns whether any were added.
static bool grow_moved(repair *work, size_t rings)
{
    const bat_cloud *cloud = &work->finder->order.cloud;
    const sparse_rows *rows = &work->rows;
    size_t first = cloud->boundary_count, before = 0, after = 0;
    for (size_t i = first; i < cloud->count; i++)
    {
        before += work->moved[i];
        work->moved[i] = work->moved[i] || work->faults.folded[i] || work->faults.outside[i] || work->faults.coincident[i];
    }
    bool *ring = work->faults.folded; // reused as workspace
    for (size_t r = 0; r < rings; r++)
    {
        memcpy(ring, work->moved, cloud->count * sizeof *ring);
        for (size_t i = first; i < cloud->count; i++)
            for (size_t e = rows->starts[i - first]; work->moved[i] && e < rows->starts[i - first + 1]; e++)
                ring[rows->columns[e]] = rows->columns[e] >= first;
        memcpy(work->moved, ring, cloud->count * sizeof *ring);
    }
    for (size_t i = first; i < cloud->count; i++)
        after += work->moved[i];
    return after > before;
}

/// Blend the solutions with shape-preserving and with uniform weights for the whole interior.
static bat_status blend(repair *work, bat_error *error)
{
    const bat_cloud *cloud = &work->finder->order.cloud;
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = BAT_CLOUD_PARAMETERIZATION_UNIFORM;
    sparse_rows rows = {0};
    bat_status status = weights_make(cloud, &work->finder->order.tree, &options, &rows, error);
    memcpy(work->uniform, work->current, 2 * cloud->boundary_count * sizeof *work->uniform);
    if (status == BAT_OK)
        status = averages_solve(cloud, &rows, NULL, (average_solver){.threads = 0}, work->uniform, error);
    if (status == BAT_OK)
        status = averages_solve(cloud, &work->rows, NULL, (average_solver){.threads = 0}, work->current, error);
    sparse_rows_free(&rows);
    for (size_t step = 1; step <= BLENDS && status == BAT_OK && work->best_report.folded > 0; step++)
    {
        double share = 1 / (double)(BLENDS + 1 - step);
        for (size_t k = 2 * cloud->boundary_count; k < 2 * cloud->count; k++)
            work->current[k] += share * (work->uniform[k] - work->current[k]);
        status = evaluate(work, false, error);
    }
    return status;
}

static bat_status unfold(repair *work, bat_error *error)
{
    const bat_cloud *cloud = &work->finder->order.cloud;
    bat_status status = evaluate(work, true, error);
    bool large = cloud->count > LARGE;
    for (size_t round = 0; round < (large ? 1 : ROUNDS) && status == BAT_OK && fault_count(&work->report) > 0; round++)
    {
        if (!grow_moved(work, (size_t)1 << round))
            break;
        status = averages_solve(cloud, &work->rows, work->moved, (average_solver){.threads = 0}, work->current, error);
        if (status == BAT_OK)
            status = evaluate(work, false, error);
    }
    if (status == BAT_OK && work->best_report.folded > 0 && !large)
        status = blend(work, error);
    // If the solver does not converge, the best parameters so far are the result.
    return status == BAT_NO_CONVERGENCE ? BAT_OK : status;
}

static bat_status check_boundary(const bat_cloud *cloud, const double *parameters, bat_error *error)
{
    for (size_t i = 0; i < 2 * cloud->boundary_count; i++)
        if (!isfinite(parameters[i]))
            return error_set(error, BAT_INVALID_ARGUMENT, i / 2, 0, "the parameters of boundary point %zu are not finite",
                             i / 2);
    return BAT_OK;
}

bat_status bat_cloud_parameters_repair(const bat_cloud *cloud, double *parameters, bat_cloud_parameters_report *report,
                                       bat_error *error)
{
    fold_finder finder = {0};
    repair work = {0};
    bat_status status = parameters_check_cloud(cloud, error);
    if (status == BAT_OK)
        status = check_boundary(cloud, parameters, error);
    if (status == BAT_OK)
        status = fold_finder_make(cloud, &finder, error);
    if (status == BAT_OK)
        status = repair_make(&finder, &work, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        memcpy(work.current + 2 * i, parameters + 2 * (size_t)finder.order.places[i], 2 * sizeof *parameters);
    if (status == BAT_OK)
        status = unfold(&work, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        memcpy(parameters + 2 * (size_t)finder.order.places[i], work.best + 2 * i, 2 * sizeof *parameters);
    if (status == BAT_OK && report != NULL)
        *report = work.best_report;
    repair_free(&work);
    fold_finder_free(&finder);
    return status;
}

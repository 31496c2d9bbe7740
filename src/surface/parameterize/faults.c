/// @file
/// Faults of parameters: folds, parameters outside the square, coincident parameters. A point is folded when the map from
/// its local plane to the parameters reverses orientation.
///
/// For coordinates x in the local plane of a point and parameters u, the least-squares affine map has the matrix
///     A = (sum u x^T) (sum x x^T)^-1,   with x and u relative to their means.
/// The point is folded when det A has the wrong sign; sum x x^T is positive definite, so that det(sum u x^T) decides. The
/// ratio of the singular values of A measures the stretch.

#include "base/error.h"
#include "base/threads.h"
#include "linalg/vector.h"
#include "surface/cloud/local_plane.h"
#include "surface/parameterize/weights.h"

#include <string.h>

/// A cloud prepared for fold detection with any number of parameterizations.
typedef struct fold_finder
{
    spatial_order order; ///< the order in which parameters are given
    oriented_planes oriented;
} fold_finder;

static void fold_finder_free(fold_finder *finder)
{
    spatial_order_free(&finder->order);
    oriented_planes_free(&finder->oriented);
}

/// Prepare a cloud. `finder` is all zero on failure.
static bat_status fold_finder_make(const bat_cloud *cloud, fold_finder *finder, bat_error *error)
{
    *finder = (fold_finder){0};
    bat_status status = spatial_order_make(cloud, &finder->order, error);
    if (status == BAT_OK)
        status = oriented_planes_make(&finder->order.cloud, &finder->order.tree, &finder->oriented, error);
    if (status != BAT_OK)
        fold_finder_free(finder);
    return status;
}

double boundary_area(const bat_cloud *cloud, const double *parameters)
{
    size_t count = cloud->boundary_count;
    double area = 0;
    for (size_t i = 0; i < count; i++)
    {
        const double *a = parameters + 2 * i, *b = parameters + 2 * ((i + 1) % count);
        area += a[0] * b[1] - a[1] * b[0];
    }
    return area;
}

/// Sums for the affine map; its matrix is `ux` times the inverse of `xx`.
typedef struct map_sums
{
    double xx[2][2]; ///< sum of x x^T, centred
    double ux[2][2]; ///< sum of u x^T, centred
} map_sums;

static map_sums sum_map(const fold_finder *finder, const neighbour_list *near, size_t point, const double *parameters)
{
    const double *points = finder->order.cloud.points, *middle = parameters + 2 * point;
    double count = (double)near->count, sum_x[2] = {0}, sum_u[2] = {0};
    map_sums sums = {0};
    for (size_t k = 0; k < near->count; k++)
    {
        double x[2], u[2];
        size_t item = near->entries[k].item;
        local_plane_project(&finder->oriented.planes[point], points + 3 * point, points + 3 * item, x);
        for (size_t a = 0; a < 2; a++)
        {
            u[a] = parameters[2 * item + a] - middle[a];
            sum_x[a] += x[a];
            sum_u[a] += u[a];
        }
        for (size_t a = 0; a < 2; a++)
            for (size_t b = 0; b < 2; b++)
            {
                sums.xx[a][b] += x[a] * x[b];
                sums.ux[a][b] += u[a] * x[b];
            }
    }
    for (size_t a = 0; a < 2; a++)
        for (size_t b = 0; b < 2; b++)
        {
            sums.xx[a][b] -= sum_x[a] * sum_x[b] / count;
            sums.ux[a][b] -= sum_u[a] * sum_x[b] / count;
        }
    return sums;
}

/// The ratio of the singular values of a matrix, at least 1.
static double ratio_of(const double a[2][2])
{
    double sum = hypot(a[0][0] + a[1][1], a[1][0] - a[0][1]), difference = hypot(a[0][0] - a[1][1], a[1][0] + a[0][1]);
    double larger = sum + difference, smaller = fabs(sum - difference);
    return smaller > 0 ? larger / smaller : INFINITY;
}

/// Ratio of the singular values of ux xx^-1.
static double stretch_of(const map_sums *sums)
{
    const double(*p)[2] = sums->xx, (*m)[2] = sums->ux;
    // The adjugate replaces the inverse, because the ratio does not depend on the determinant.
    double map[2][2];
    for (size_t a = 0; a < 2; a++)
    {
        map[a][0] = m[a][0] * p[1][1] - m[a][1] * p[1][0];
        map[a][1] = m[a][1] * p[0][0] - m[a][0] * p[0][1];
    }
    return ratio_of((const double(*)[2])map);
}

/// Orientation of the triangles: 1 if they agree with the boundary, else -1.
static int triangle_orientation(const bat_cloud *cloud)
{
    size_t count = cloud->boundary_count;
    int with = 0, against = 0;
    for (size_t t = 0; t < cloud->triangle_count; t++)
        for (size_t c = 0; c < 3; c++)
        {
            size_t a = cloud->triangles[3 * t + c], b = cloud->triangles[3 * t + (c + 1) % 3];
            with += a < count && b < count && (a + 1) % count == b;
            against += a < count && b < count && (b + 1) % count == a;
        }
    return with >= against ? 1 : -1;
}

static void find_by_triangles(const bat_cloud *cloud, const double *parameters, bool positive, bool *folded)
{
    int orientation = positive ? triangle_orientation(cloud) : -triangle_orientation(cloud);
    memset(folded, 0, cloud->count * sizeof *folded);
    for (size_t t = 0; t < cloud->triangle_count; t++)
    {
        const uint32_t *corner = cloud->triangles + 3 * t;
        const double *a = parameters + 2 * (size_t)corner[0], *b = parameters + 2 * (size_t)corner[1],
                     *c = parameters + 2 * (size_t)corner[2];
        double area = vector2_turn(a, b, c);
        bool flipped = !(orientation > 0 ? area > 0 : area < 0);
        for (size_t k = 0; k < 3; k++)
            folded[corner[k]] = folded[corner[k]] || (flipped && corner[k] >= cloud->boundary_count);
    }
}

/// Find the folded interior points.
///
/// With triangles: the corners of degenerate and of flipped triangles. Without: the points at which the affine map from the
/// local plane to the parameters, fitted to the neighbourhood by least squares, is singular or reverses orientation. The
/// boundary determines the correct orientation.
/// @param parameters count x 2, in spatial order
/// @param folded     receives count; false on the boundary
/// @param stretches  receives the ratio of the singular values of the map for each interior point; may be null
static bat_status fold_finder_find(const fold_finder *finder, const double *parameters, bool *folded, double *stretches,
                                   bat_error *error)
{
    const bat_cloud *cloud = &finder->order.cloud;
    bool positive = boundary_area(cloud, parameters) >= 0;
    bat_status status = BAT_OK;
    memset(folded, 0, cloud->boundary_count * sizeof *folded);
#pragma omp parallel num_threads(threads_for(0, cloud->count / 256 + 1))
    {
        neighbour_list near = {0};
#pragma omp for schedule(dynamic, 256)
        for (size_t i = cloud->boundary_count; i < cloud->count; i++)
        {
            bat_status own =
                neighbours_nearest(&finder->order.tree, cloud->points + 3 * i, finder->oriented.reach[i], &near, NULL);
            if (own == BAT_OK)
            {
                map_sums sums = sum_map(finder, &near, i, parameters);
                double area = sums.ux[0][0] * sums.ux[1][1] - sums.ux[0][1] * sums.ux[1][0];
                folded[i] = !(positive ? area > 0 : area < 0);
                if (stretches != NULL)
                    stretches[i - finder->order.cloud.boundary_count] = stretch_of(&sums);
            }
            else
#pragma omp atomic write
                status = own;
        }
        neighbour_list_free(&near);
    }
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "out of memory for neighbourhoods");
    if (cloud->triangle_count > 0)
        find_by_triangles(cloud, parameters, positive, folded);
    return BAT_OK;
}

/// Parameters coincide when they agree after rounding to multiples of the inverse of this.
static const double COINCIDENCE = 1e12;

/// Faults by point, in spatial order.
typedef struct parameter_faults
{
    memory_pool pool;
    bool *folded;     ///< count each; on the boundary only `outside` may be true
    bool *outside;    ///< not in the unit square, or NaN
    bool *coincident; ///< equal to those of another point, rounded to twelve decimals
} parameter_faults;

static bat_status parameter_faults_make(size_t count, parameter_faults *faults, bat_error *error)
{
    *faults = (parameter_faults){0};
    faults->folded = memory_pool_array(&faults->pool, count, sizeof(bool));
    faults->outside = memory_pool_array(&faults->pool, count, sizeof(bool));
    faults->coincident = memory_pool_array(&faults->pool, count, sizeof(bool));
    return memory_pool_check(&faults->pool, error);
}

static size_t find_outside(const double *parameters, size_t count, bool *outside)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
    {
        double u = parameters[2 * i], v = parameters[2 * i + 1];
        outside[i] = !(u >= 0 && u <= 1 && v >= 0 && v <= 1);
        found += outside[i];
    }
    return found;
}

typedef struct rounded_parameters
{
    double at[2];
    size_t point;
} rounded_parameters;

static int compare_rounded(const void *a, const void *b)
{
    const rounded_parameters *first = a, *second = b;
    for (size_t c = 0; c < 2; c++)
        if (first->at[c] != second->at[c])
            return first->at[c] < second->at[c] ? -1 : 1;
    return (first->point > second->point) - (first->point < second->point);
}

/// Find interior points with the parameters of another point, of the boundary too. Ignores those that are not finite.
static bat_status find_coincident(const bat_cloud *cloud, const double *parameters, bool *coincident, size_t *found,
                                  bat_error *error)
{
    rounded_parameters *sorted = memory_array(cloud->count, sizeof *sorted);
    if (sorted == NULL)
        return error_memory(error, cloud->count * sizeof *sorted);
    size_t count = 0;
    *found = 0;
    memset(coincident, 0, cloud->count * sizeof *coincident);
    for (size_t i = 0; i < cloud->count; i++)
        if (isfinite(parameters[2 * i]) && isfinite(parameters[2 * i + 1]))
            sorted[count++] = (rounded_parameters){
                .at = {rint(parameters[2 * i] * COINCIDENCE), rint(parameters[2 * i + 1] * COINCIDENCE)}, .point = i};
    qsort(sorted, count, sizeof *sorted, compare_rounded);
    for (size_t k = 1; k < count; k++)
        if (sorted[k].at[0] == sorted[k - 1].at[0] && sorted[k].at[1] == sorted[k - 1].at[1])
            coincident[sorted[k].point] = coincident[sorted[k - 1].point] = true;
    for (size_t i = 0; i < cloud->count; i++)
    {
        coincident[i] = coincident[i] && i >= cloud->boundary_count;
        *found += coincident[i];
    }
    free(sorted);
    return BAT_OK;
}

/// The median, 1 for no values. Sorts the values; NaN counts as infinite.
static double median(double *values, size_t count)
{
    if (count == 0)
        return 1;
    for (size_t i = 0; i < count; i++)
        values[i] = isnan(values[i]) ? INFINITY : values[i];
    qsort(values, count, sizeof *values, ascending);
    return count % 2 == 1 ? values[count / 2] : 0.5 * (values[count / 2 - 1] + values[count / 2]);
}

/// Find and count all faults.
/// @param parameters count x 2, in the order of the finder
static bat_status parameter_faults_find(const fold_finder *finder, const double *parameters, parameter_faults *faults,
                                        bat_cloud_parameters_report *report, bat_error *error)
{
    const bat_cloud *cloud = &finder->order.cloud;
    size_t interior = cloud->count - cloud->boundary_count;
    double *stretches = memory_array(interior, sizeof *stretches);
    bat_cloud_parameters_report found = {.first = BAT_NO_INDEX};
    bat_status status = stretches != NULL ? fold_finder_find(finder, parameters, faults->folded, stretches, error)
                                          : error_memory(error, interior * sizeof *stretches);
    if (status == BAT_OK)
        status = find_coincident(cloud, parameters, faults->coincident, &found.coincident, error);
    for (size_t i = cloud->boundary_count; i < cloud->count && status == BAT_OK; i++)
        if (faults->folded[i])
        {
            found.folded++;
            found.first = found.first < finder->order.places[i] ? found.first : finder->order.places[i];
        }
    if (status == BAT_OK)
    {
        found.outside = find_outside(parameters, cloud->count, faults->outside);
        found.stretch = median(stretches, interior);
        *report = found;
    }
    free(stretches);
    return status;
}

bat_status bat_cloud_parameters_check(const bat_cloud *cloud, const double *parameters, bat_cloud_parameters_report *report,
                                      bat_error *error)
{
    fold_finder finder = {0};
    parameter_faults faults = {0};
    double *ordered = memory_array(cloud->count, 2 * sizeof *ordered);
    bat_status status =
        ordered != NULL ? bat_cloud_check(cloud, error) : error_memory(error, cloud->count * 2 * sizeof *ordered);
    if (status == BAT_OK && cloud->boundary_count == 0)
        status = ERROR_ARGUMENT(error, "the boundary of the cloud is unknown");
    if (status == BAT_OK)
        status = fold_finder_make(cloud, &finder, error);
    if (status == BAT_OK)
        status = parameter_faults_make(cloud->count, &faults, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        memcpy(ordered + 2 * i, parameters + 2 * (size_t)finder.order.places[i], 2 * sizeof *ordered);
    if (status == BAT_OK)
        status = parameter_faults_find(&finder, ordered, &faults, report, error);
    fold_finder_free(&finder);
    memory_pool_free(&faults.pool);
    free(ordered);
    return status;
}

// Repair: faulty points and a ring of neighbours around them are replaced by the solution of u_i = sum_k w_ik u_k with
// shape-preserving weights, or mean-value weights in a cloud with triangles. The width of the ring doubles in every round.
// If folds remain when the whole interior has been replaced, u = (1 - s) u_shape + s u_uniform is tried for s = 1/4, …, 1.
// The best parameters are the result.

enum
{
    ROUNDS = 10,    ///< maximum number of rounds
    LARGE = 100000, ///< clouds with more points get one round only, because more would take longer than a fit
    BLENDS = 4      ///< number of steps s
};

/// State of a repair, in the order of the finder.
typedef struct repair
{
    memory_pool pool;
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

static bat_status repair_make(const fold_finder *finder, repair *work, bat_error *error)
{
    const bat_cloud *cloud = &finder->order.cloud;
    size_t count = cloud->count;
    *work = (repair){.finder = finder};
    work->moved = memory_pool_zeros(&work->pool, count, sizeof *work->moved);
    work->current = memory_pool_array(&work->pool, count, 2 * sizeof *work->current);
    work->best = memory_pool_array(&work->pool, count, 2 * sizeof *work->best);
    work->uniform = memory_pool_array(&work->pool, count, 2 * sizeof *work->uniform);
    bat_status status = memory_pool_check(&work->pool, error);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    if (cloud->triangle_count > 0)
        options.method = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE;
    if (status == BAT_OK)
        status = parameter_faults_make(count, &work->faults, error);
    return status == BAT_OK ? weights_make(cloud, &finder->order.tree, &options, &work->rows, error) : status;
}

size_t fault_count(const bat_cloud_parameters_report *report)
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
        status = averages_solve(cloud, &rows, NULL, work->uniform, error);
    if (status == BAT_OK)
        status = averages_solve(cloud, &work->rows, NULL, work->current, error);
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
        status = averages_solve(cloud, &work->rows, work->moved, work->current, error);
        if (status == BAT_OK)
            status = evaluate(work, false, error);
    }
    if (status == BAT_OK && work->best_report.folded > 0 && !large)
        status = blend(work, error);
    // If the solver does not converge, the best parameters so far are the result.
    return status == BAT_NO_CONVERGENCE ? BAT_OK : status;
}

bat_status bat_cloud_parameters_repair(const bat_cloud *cloud, double *parameters, bat_cloud_parameters_report *report,
                                       bat_error *error)
{
    fold_finder finder = {0};
    repair work = {0};
    bat_status status = bat_cloud_check(cloud, error);
    if (status == BAT_OK)
        status = boundary_parameters_check(cloud, parameters, error);
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
    sparse_rows_free(&work.rows);
    memory_pool_free(&work.faults.pool);
    memory_pool_free(&work.pool);
    fold_finder_free(&finder);
    return status;
}

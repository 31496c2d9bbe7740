#include "batten/curve_measure.h"

#include "base/error.h"
#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/polygon.h"
#include "curve/topology/edge_tree.h"
#include "curve/topology/keep_simple.h"

/// Edges need a unique geodesic.
static bat_status check_edges(const bat_curve *curve, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t edges = polygon_edges(curve->count, curve->closed);
    for (size_t i = 0; i < edges; i++)
    {
        size_t next = i + 1 == curve->count ? 0 : i + 1;
        double tangent[3];
        if (space->log(space, curve->points + i * space->point_dim, curve->points + next * space->point_dim, tangent) !=
            BAT_OK)
            return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    }
    return BAT_OK;
}

bat_status bat_curve_is_simple(const bat_curve *curve, bool *simple, bat_error *error)
{
    surface_kind kind;
    if (!surface_of_space(curve->space, &kind))
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                         "curves cross only in surfaces (plane, sphere in R^3, disk), not in the %s of dimension %zu",
                         curve->space->name, curve->space->dimension);
    if (curve->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a curve without points");
    bat_status status = bat_space_check(curve->space, curve->points, curve->count, error);
    if (status == BAT_OK && kind == SURFACE_SPHERE)
        status = check_edges(curve, error);
    return status == BAT_OK ? curve_edges_are_apart(curve, simple, error) : status;
}

bat_status bat_curves_are_simple(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                                 bool *simple, size_t *failed_curve, bat_error *error)
{
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    const bat_curve_measure_options own = options != NULL ? *options : bat_curve_measure_defaults();
    shared_work work = shared_work_make(count, own.progress);
    int threads = threads_for(own.threads, count);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error fault;
        bat_status one = bat_curve_is_simple(&curves[i], &simple[i], &fault);
        shared_work_finish(&work, i, one, &fault);
    }
    if (failed_curve != NULL && work.failed < count)
        *failed_curve = work.failed;
    return shared_work_end(&work, error);
}

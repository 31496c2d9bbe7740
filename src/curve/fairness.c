#include "batten/measure.h"

#include "base/error.h"
#include "base/shared_work.h"
#include "base/threads.h"

#include <math.h>

static const double *row(const bat_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

/// The angle between two tangent vectors at p, by half angles: exact near 0 and near pi.
static double angle_between(const bat_space *space, const double *p, const double *u, const double *v)
{
    double u_length = sqrt(space->inner(space, p, u, u)), v_length = sqrt(space->inner(space, p, v, v));
    double difference[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        difference[i] = u[i] / u_length - v[i] / v_length;
        sum[i] = u[i] / u_length + v[i] / v_length;
    }
    return 2 * atan2(sqrt(space->inner(space, p, difference, difference)), sqrt(space->inner(space, p, sum, sum)));
}

/// The absolute exterior angle at p between its neighbours.
static bat_status exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                 double *angle)
{
    if (space->exterior_angle != NULL)
    {
        *angle = fabs(space->exterior_angle(space, before, p, after));
        return BAT_OK;
    }
    double back[BAT_SPACE_MAX_DIM], forth[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, before, back);
    if (status == BAT_OK)
        status = space->log(space, p, after, forth);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < space->tangent_dim; i++)
        back[i] = -back[i];
    *angle = angle_between(space, p, back, forth);
    return BAT_OK;
}

/// A walk along the vertices that differ from the one before.
typedef struct walk
{
    size_t before, here;  ///< the last two vertices
    double length_before; ///< of the edge between them
    size_t angles;        ///< vertices that had an angle
    double bending, g1;   ///< sum and maximum over them
    double length;        ///< of all edges so far
} walk;

static bat_status edge_length(const bat_curve *curve, size_t i, size_t next, double *length, bat_error *error)
{
    const bat_space *space = curve->space;
    *length = space->distance(space, row(curve, i), row(curve, next));
    if (*length >= space->injectivity)
        return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    return BAT_OK;
}

/// Go on to a vertex; the one left behind then has both its edges.
static bat_status walk_to(walk *walker, const bat_curve *curve, size_t next, double offset, bat_error *error)
{
    double length, angle;
    bat_status status = edge_length(curve, walker->here, next, &length, error);
    if (status != BAT_OK || length == 0)
        return status;
    walker->length += length;
    if (walker->length_before > 0)
    {
        status =
            exterior_angle(curve->space, row(curve, walker->before), row(curve, walker->here), row(curve, next), &angle);
        if (status != BAT_OK)
            return error_set(error, status, walker->here, 0, "no unique geodesic at point %zu", walker->here);
        double curvature = angle / ((walker->length_before + length) / 2 + offset);
        walker->bending += curvature * curvature;
        walker->g1 = fmax(walker->g1, angle);
        walker->angles++;
    }
    walker->before = walker->here;
    walker->here = next;
    walker->length_before = length;
    return BAT_OK;
}

/// The first vertex that differs from vertex 0; 0 when there is none.
static size_t second_vertex(const bat_curve *curve)
{
    for (size_t i = 1; i < curve->count; i++)
        if (curve->space->distance(curve->space, row(curve, 0), row(curve, i)) > 0)
            return i;
    return 0;
}

bat_status bat_curve_fairness(const bat_curve *curve, const bat_measure_options *options, bat_fairness *fairness,
                              bat_error *error)
{
    double offset = options == NULL ? BAT_BENDING_OFFSET : options->bending_offset;
    if (curve->count == 0 || !(offset >= 0) || !isfinite(offset))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         curve->count == 0 ? "the curve has no points" : "the bending offset must be 0 or more");
    bat_status status = bat_space_check(curve->space, curve->points, curve->count, error);
    walk walker = {0};
    for (size_t i = 1; i < curve->count && status == BAT_OK; i++)
        status = walk_to(&walker, curve, i, offset, error);
    if (curve->closed && status == BAT_OK)
        status = walk_to(&walker, curve, 0, offset, error);
    double total = walker.length;
    if (curve->closed && status == BAT_OK)
        status = walk_to(&walker, curve, second_vertex(curve), offset, error);
    if (status != BAT_OK)
        return status;
    double angles = walker.angles > 0 ? (double)walker.angles : 1;
    *fairness = (bat_fairness){.bending = walker.bending / angles, .g1 = walker.g1, .length = total};
    return BAT_OK;
}

bat_status bat_curves_fairness(const bat_curve *curves, size_t count, const bat_measure_options *options,
                               bat_fairness *fairness, size_t *failed_curve, bat_error *error)
{
    shared_work work = shared_work_make(count, (bat_progress){0});
    int threads = threads_for(options == NULL ? 0 : options->threads, count);
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        bat_status status = bat_curve_fairness(&curves[i], options, &fairness[i], &own);
        shared_work_finish(&work, i, status, &own);
    }
    if (failed_curve != NULL && work.failed < count)
        *failed_curve = work.failed;
    return shared_work_end(&work, error);
}

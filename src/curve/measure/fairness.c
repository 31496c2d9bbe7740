#include "batten/curve_measure.h"

#include "base/error.h"
#include "curve/polygon.h"

#include <math.h>

static const double *row(const bat_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

/// Spaces multiply the lengths of the two edges on their way to a signed angle; outside of this range they lose digits.
static const double MIN_PRODUCT = 1e-250, MAX_PRODUCT = 1e250;

/// The absolute exterior angle at p between its neighbours; `product` is that of the lengths of its edges.
static bat_status exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                 double product, double *angle)
{
    if (space->exterior_angle != NULL && product >= MIN_PRODUCT && product <= MAX_PRODUCT)
    {
        *angle = fabs(space->exterior_angle(space, before, p, after));
        return BAT_OK;
    }
    return polygon_exterior_angle(space, before, p, after, angle);
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
    if (!isfinite(*length))
        return error_set(error, BAT_INVALID_POINT, next, 0,
                         "the distance of point %zu from point %zu is too large for a double", next, i);
    double tangent[BAT_SPACE_MAX_DIM];
    if (*length >= space->injectivity && space->log(space, row(curve, i), row(curve, next), tangent) != BAT_OK)
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
        status = exterior_angle(curve->space, row(curve, walker->before), row(curve, walker->here), row(curve, next),
                                walker->length_before * length, &angle);
        if (status != BAT_OK)
            return error_set(error, status, walker->here, 0, "no unique geodesic at point %zu", walker->here);
        double curvature = angle / (walker->length_before / 2 + length / 2 + offset);
        walker->bending += curvature * curvature;
        walker->g1 = fmax(walker->g1, angle);
        walker->angles++;
    }
    if (!isfinite(walker->length) || !isfinite(walker->bending))
        return error_set(error, BAT_INVALID_POINT, walker->here, 0, "at point %zu the %s becomes too large for a double",
                         walker->here, isfinite(walker->length) ? "bending energy" : "length");
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

bat_status bat_curve_fairness(const bat_curve *curve, const bat_curve_measure_options *options,
                              bat_curve_fairness_values *fairness, bat_error *error)
{
    double offset = options == NULL ? BAT_CURVE_BENDING_OFFSET : options->bending_offset;
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status == BAT_OK && curve->count == 0)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the curve has no points");
    if (status == BAT_OK)
        status = bat_space_check(curve->space, curve->points, curve->count, error);
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
    *fairness = (bat_curve_fairness_values){.bending = walker.bending / angles, .g1 = walker.g1, .length = total};
    return BAT_OK;
}

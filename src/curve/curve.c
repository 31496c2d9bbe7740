#include "batten/curve.h"

#include "base/error.h"

#include <math.h>
#include <stdlib.h>

void bat_curve_free(bat_curve *curve)
{
    free(curve->points);
    free(curve->channels);
    free(curve->corners);
    *curve = (bat_curve){.space = curve->space};
}

static const double *row(const bat_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

/// Whether the edge from point i to the next has a direction.
static bat_status check_edge(const bat_curve *curve, size_t i, size_t next, bat_error *error)
{
    const bat_space *space = curve->space;
    if (!(space->distance(space, row(curve, i), row(curve, next)) > 0))
        return error_set(error, BAT_INVALID_POINT, next, 0, "point %zu repeats point %zu", next, i);
    double tangent[BAT_SPACE_MAX_DIM];
    if (isfinite(space->injectivity) && space->log(space, row(curve, i), row(curve, next), tangent) != BAT_OK)
        return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    return BAT_OK;
}

bat_status bat_curve_check(const bat_curve *curve, bat_error *error)
{
    size_t least = curve->closed ? 3 : 2;
    if (curve->count < least)
        return error_operand(error,
                             error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                                       "%s curve needs at least %zu points, not %zu", curve->closed ? "a closed" : "an open",
                                       least, curve->count),
                             0);
    if (curve->channel_count > BAT_SPACE_MAX_DIM || (curve->channel_count > 0 && curve->channels == NULL))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "a curve carries up to %d channels, and has their values", BAT_SPACE_MAX_DIM);
    bat_status status = bat_space_check(curve->space, curve->points, curve->count, error);
    for (size_t i = 0; i + 1 < curve->count && status == BAT_OK; i++)
        status = check_edge(curve, i, i + 1, error);
    if (status == BAT_OK && curve->closed)
        status = check_edge(curve, curve->count - 1, 0, error);
    for (size_t i = 0; i < curve->count * curve->channel_count && status == BAT_OK; i++)
        if (!isfinite(curve->channels[i]))
            status = error_set(error, BAT_INVALID_POINT, i / curve->channel_count, 0,
                               "point %zu carries a value that is not finite", i / curve->channel_count);
    return status;
}

bat_status bat_curve_exterior_angles(const bat_curve *curve, double *angles, bat_error *error)
{
    const bat_space *space = curve->space;
    size_t n = curve->count;
    if (space->exterior_angle == NULL)
        return error_set(error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0, "the %s space of dimension %zu has no signed angles",
                         space->name, space->dimension);
    for (size_t i = 0; i < n; i++)
    {
        bool end = !curve->closed && (i == 0 || i + 1 == n);
        angles[i] = end ? 0
                        : space->exterior_angle(space, row(curve, i == 0 ? n - 1 : i - 1), row(curve, i),
                                                row(curve, i + 1 == n ? 0 : i + 1));
    }
    return BAT_OK;
}

void bat_curve_edge_lengths(const bat_curve *curve, double *lengths)
{
    size_t edges = curve->closed || curve->count == 0 ? curve->count : curve->count - 1;
    for (size_t i = 0; i < edges; i++)
        lengths[i] = curve->space->distance(curve->space, row(curve, i), row(curve, i + 1 == curve->count ? 0 : i + 1));
}

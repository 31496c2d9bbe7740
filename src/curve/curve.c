#include "base/error.h"
#include "base/memory.h"
#include "curve/polygon.h"

#include <math.h>
#include <string.h>

void bat_curve_free(bat_curve *curve)
{
    free(curve->points);
    free(curve->channels);
    free(curve->corners);
    *curve = (bat_curve){.space = curve->space};
}

bat_status curve_room(const bat_curve *like, size_t count, bool corners, bat_curve *made, bat_error *error)
{
    size_t channels = like->channel_count, point_size = like->space->point_dim * sizeof(double);
    *made = (bat_curve){.space = like->space, .count = count, .closed = like->closed, .channel_count = channels};
    made->points = memory_array(count, point_size);
    made->channels = channels > 0 ? memory_array(count, channels * sizeof(double)) : NULL;
    made->corners = corners ? calloc(count > 0 ? count : 1, 1) : NULL;
    bool whole = made->points != NULL && (channels == 0 || made->channels != NULL) && (!corners || made->corners != NULL);
    return whole ? BAT_OK : error_memory(error, count * point_size);
}

void curves_free(bat_curve *curves, size_t count)
{
    for (size_t i = 0; i < count && curves != NULL; i++)
        bat_curve_free(&curves[i]);
    free(curves);
}

void curve_copy_row(const bat_curve *from, size_t i, bat_curve *to, size_t row)
{
    size_t dim = from->space->point_dim, channels = from->channel_count;
    memmove(to->points + row * dim, from->points + i * dim, dim * sizeof(double));
    if (channels > 0)
        memmove(to->channels + row * channels, from->channels + i * channels, channels * sizeof(double));
    if (from->corners != NULL && to->corners != NULL)
        to->corners[row] = from->corners[i];
}

/// Whether the edge from point i to the next has a direction.
static bat_status check_edge(const bat_curve *curve, size_t i, size_t next, bat_error *error)
{
    const bat_space *space = curve->space;
    if (!(space->distance(space, curve_point(curve, i), curve_point(curve, next)) > 0))
        return error_set(error, BAT_INVALID_POINT, next, 0, "point %zu repeats point %zu", next, i);
    double tangent[BAT_SPACE_MAX_DIM];
    if (isfinite(space->injectivity) &&
        space->log(space, curve_point(curve, i), curve_point(curve, next), tangent) != BAT_OK)
        return error_set(error, BAT_CUT_LOCUS, next, 0, "point %zu is antipodal to point %zu", next, i);
    return BAT_OK;
}

bat_status bat_curve_check(const bat_curve *curve, bat_error *error)
{
    size_t least = curve->closed ? 3 : 2;
    if (curve->count < least)
        return error_operand(error,
                             ERROR_ARGUMENT(error, "%s curve needs at least %zu points, not %zu",
                                            curve->closed ? "a closed" : "an open", least, curve->count),
                             0);
    if (curve->channel_count > BAT_SPACE_MAX_DIM || (curve->channel_count > 0 && curve->channels == NULL))
        return ERROR_ARGUMENT(error, "a curve carries up to %d channels, and has their values", BAT_SPACE_MAX_DIM);
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
        return ERROR_UNSUPPORTED(error, 0, "the %s space of dimension %zu has no signed angles", space->name,
                                 space->dimension);
    for (size_t i = 0; i < n; i++)
    {
        bool end = !curve->closed && (i == 0 || i + 1 == n);
        angles[i] = end ? 0
                        : space->exterior_angle(space, curve_point(curve, i == 0 ? n - 1 : i - 1), curve_point(curve, i),
                                                curve_point(curve, i + 1 == n ? 0 : i + 1));
    }
    return BAT_OK;
}

void bat_curve_edge_lengths(const bat_curve *curve, double *lengths)
{
    size_t edges = curve->closed || curve->count == 0 ? curve->count : curve->count - 1;
    for (size_t i = 0; i < edges; i++)
        lengths[i] = curve->space->distance(curve->space, curve_point(curve, i),
                                            curve_point(curve, i + 1 == curve->count ? 0 : i + 1));
}

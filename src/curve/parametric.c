#include "curve/parametric.h"

#include "base/error.h"
#include "curve/polygon.h"
#include "space/builtin.h"

#include <string.h>

#define CUBIC_DEGREE 3

bat_status row_space_make(const bat_space *points, size_t channel_count, row_space *rows, bat_error *error)
{
    *rows = (row_space){.space = *points};
    if (channel_count == 0)
        return BAT_OK;
    if (points->point_dim + channel_count > BAT_SPACE_MAX_DIM || points->tangent_dim + channel_count > BAT_SPACE_MAX_DIM)
        return ERROR_TOO_LARGE(error, "a scheme with parameters takes up to %d numbers a point, channels included",
                               BAT_SPACE_MAX_DIM);
    if (space_is_euclidean(points))
    {
        rows->space = bat_euclidean(points->point_dim + channel_count);
        return BAT_OK;
    }
    rows->factors[0] = *points;
    rows->factors[1] = bat_euclidean(channel_count);
    rows->product = (bat_product_factors){.spaces = rows->factors, .count = 2};
    return bat_product(&rows->product, &rows->space, error);
}

void rows_join(const bat_curve *curve, size_t channel_count, double *rows)
{
    size_t dim = curve->space->point_dim, row = dim + channel_count;
    for (size_t i = 0; i < curve->count; i++)
    {
        memcpy(rows + i * row, curve->points + i * dim, dim * sizeof *rows);
        if (channel_count > 0)
            memcpy(rows + i * row + dim, curve->channels + i * channel_count, channel_count * sizeof *rows);
    }
}

void rows_split(const double *rows, size_t count, size_t point_dim, size_t channel_count, double *points, double *channels)
{
    size_t row = point_dim + channel_count;
    for (size_t i = 0; i < count; i++)
    {
        memcpy(points + i * point_dim, rows + i * row, point_dim * sizeof *points);
        memcpy(channels + i * channel_count, rows + i * row + point_dim, channel_count * sizeof *channels);
    }
}

double parametric_increment(bat_curve_parameters parameters, double length)
{
    bool centripetal = parameters == BAT_CURVE_PARAMETERS_CENTRIPETAL;
    return centripetal ? sqrt(length) : parameters == BAT_CURVE_PARAMETERS_CHORDAL ? length : 1;
}

/// The parameters of the end point and the points before it, from 0 on; `knots` receives `degree` + 1 of them.
static void end_knots(const bat_space *points, bat_curve_parameters parameters, const double *end, ptrdiff_t step,
                      size_t degree, double *knots)
{
    knots[0] = 0;
    double unit = points->distance(points, end, end + step);
    for (size_t k = 1; k <= degree; k++)
    {
        const double *row = end + (ptrdiff_t)k * step;
        knots[k] = knots[k - 1] + parametric_increment(parameters, points->distance(points, row - step, row) / unit);
    }
}

static bat_status extend_end(const bat_space *rows, const bat_space *points, bat_curve_parameters parameters, double *end,
                             ptrdiff_t step, size_t count, size_t wanted)
{
    size_t degree = count > CUBIC_DEGREE ? CUBIC_DEGREE : count - 1;
    double knots[CUBIC_DEGREE + 1], at = 0;
    if (degree == 0)
        return BAT_INVALID_ARGUMENT;
    end_knots(points, parameters, end, step, degree, knots);
    bat_status status = BAT_OK;
    for (size_t k = 1; k <= wanted && status == BAT_OK; k++)
    {
        size_t mirrored = k < degree ? k : degree;
        at += knots[mirrored] - knots[mirrored - 1];
        status = polygon_value_beyond(rows, end, step, knots, degree, at, end - (ptrdiff_t)k * step);
    }
    return status;
}

bat_status parametric_extend(const bat_space *rows, const bat_space *points, bat_curve_parameters parameters, double *buffer,
                             size_t count, size_t before, size_t after, bat_error *error)
{
    ptrdiff_t step = (ptrdiff_t)rows->point_dim;
    size_t at = 0;
    bat_status status = extend_end(rows, points, parameters, buffer, step, count, before);
    if (status == BAT_OK)
    {
        at = count - 1;
        status = extend_end(rows, points, parameters, buffer + (ptrdiff_t)at * step, -step, count, after);
    }
    if (status != BAT_OK)
        return error_point(error, status, at, "the open curve cannot be continued beyond its end point", " (%s)",
                           bat_status_name(status));
    return BAT_OK;
}

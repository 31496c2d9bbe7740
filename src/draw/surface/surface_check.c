#include "draw/surface/surface_check.h"

#include "base/error.h"
#include "draw/common/text.h"

#include <math.h>

#define LEAST_WIDTH 60
#define MOST_WIDTH 4000

/// The first number that is not finite; BAT_NO_INDEX for none.
static size_t find_not_finite(const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(numbers[i]))
            return i;
    return BAT_NO_INDEX;
}

static bat_status check_options(const bat_surface_picture_options *options, bat_error *error)
{
    const char *wrong = NULL;
    if (options->width != 0 && (options->width < LEAST_WIDTH || options->width > MOST_WIDTH))
        wrong = "panels are 60 to 4000 pixels wide";
    else if (!(options->largest_error >= 0 && isfinite(options->largest_error)))
        wrong = "the end of the scale of errors is finite and not below zero";
    else if (find_not_finite(options->view, 3) != BAT_NO_INDEX || find_not_finite(options->up, 3) != BAT_NO_INDEX)
        wrong = "the view's directions are finite";
    if (wrong != NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "%s", wrong);
    return BAT_OK;
}

/// What a row has must fit together.
static bat_status check_parts(const bat_surface_picture_row *row, size_t index, bat_error *error)
{
    const char *wrong = NULL;
    if (!text_is_valid(row->title))
        wrong = "has a title that is not UTF-8 without control characters";
    else if (row->cloud == NULL && row->surface == NULL)
        wrong = "has neither a cloud nor a surface";
    else if (row->cloud == NULL && (row->distances != NULL || row->parameters != NULL))
        wrong = "has distances or parameters but no cloud";
    else if (row->cloud != NULL && (row->cloud->count == 0 || row->cloud->boundary_count > row->cloud->count))
        wrong = "has a cloud without points, or with more on the boundary than there are";
    else if (row->surface != NULL && row->surface->dimension != 3)
        wrong = "has a surface that is not in space";
    if (wrong != NULL)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "row %zu %s", index, wrong);
    return BAT_OK;
}

/// The numbers of a row's points.
static bat_status check_points(const bat_surface_picture_row *row, size_t index, bat_error *error)
{
    size_t count = row->cloud->count, wrong = find_not_finite(row->cloud->points, 3 * count);
    if (wrong != BAT_NO_INDEX)
        return error_set(error, BAT_INVALID_POINT, wrong / 3, 0, "row %zu: point %zu is not finite", index, wrong / 3);
    for (size_t i = 0; row->distances != NULL && i < count; i++)
        if (!(row->distances[i] >= 0 && isfinite(row->distances[i])))
            return error_set(error, BAT_INVALID_POINT, i, 0, "row %zu: the distance of point %zu is not a finite length",
                             index, i);
    for (size_t i = 0; row->parameters != NULL && i < 2 * count; i++)
        if (!(row->parameters[i] >= 0 && row->parameters[i] <= 1))
            return error_set(error, BAT_INVALID_POINT, i / 2, 0,
                             "row %zu: the parameters of point %zu are not in the unit square", index, i / 2);
    return BAT_OK;
}

static bat_status check_surface(const bat_spline_surface *surface, size_t index, bat_error *error)
{
    size_t wrong = find_not_finite(surface->control, 3 * bat_hierarchical_space_functions(surface->space));
    if (wrong != BAT_NO_INDEX)
        return error_set(error, BAT_INVALID_POINT, wrong / 3, 0, "row %zu: control point %zu is not finite", index,
                         wrong / 3);
    return BAT_OK;
}

bat_status surface_picture_check(const bat_surface_picture_row *rows, size_t count,
                                 const bat_surface_picture_options *options, bat_error *error)
{
    bat_status status = check_options(options, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = check_parts(&rows[i], i, error);
        if (status == BAT_OK && rows[i].cloud != NULL)
            status = check_points(&rows[i], i, error);
        if (status == BAT_OK && rows[i].surface != NULL)
            status = check_surface(rows[i].surface, i, error);
    }
    return status;
}

#include "base/error.h"
#include "draw/common/text.h"
#include "draw/curve/plot.h"

#include <math.h>

/// Room between the numbers and the ends of an axis, as a share of the range.
#define PADDING 0.04

double plot_number(const plot_axis *axis, double value)
{
    return axis->logarithmic ? log10(value) : value;
}

static bat_status check_numbers(const double *numbers, size_t count, bool logarithmic, const char *name, size_t series,
                                bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        if (!isfinite(numbers[i]) || fabs(numbers[i]) > 1e300)
        {
            return error_set(error, BAT_INVALID_POINT, i, 0, "series %zu: %s of point %zu is not finite, or too large",
                             series, name, i);
        }
        if (logarithmic && numbers[i] <= 0.0)
        {
            return error_set(error, BAT_INVALID_POINT, i, 0,
                             "series %zu: %s of point %zu is not positive on a logarithmic axis", series, name, i);
        }
    }
    return BAT_OK;
}

static bat_status check_bars(const bat_chart_series *series, bool logarithmic, size_t index, bat_error *error)
{
    if (series->count < 2 || logarithmic)
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0,
                         "series %zu: bars need at least two numbers and a linear y axis", index);
    }
    for (size_t i = 1; i < series->count; i++)
    {
        if (!(series->x[i - 1] < series->x[i]))
        {
            return error_set(error, BAT_INVALID_POINT, i, 0, "series %zu: the x of bar %zu does not increase", index, i);
        }
    }
    return BAT_OK;
}

static bat_status check_texts(const bat_chart_series *series, size_t index, bat_error *error)
{
    bool valid = text_is_valid(series->label);
    for (size_t i = 0; series->point_labels != NULL && i < series->count; i++)
    {
        valid = valid && text_is_valid(series->point_labels[i]);
    }
    return valid ? BAT_OK
                 : error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu: a label is not plain UTF-8 text", index);
}

static bat_status check_series(const bat_chart *chart, size_t index, bat_error *error)
{
    const bat_chart_series *series = &chart->series[index];
    if (series->x == NULL || series->y == NULL || series->count == 0)
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu has no numbers", index);
    }
    if (series->mark < BAT_CHART_LINE || series->mark > BAT_CHART_BARS || series->colour < 0)
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu: no such mark or colour", index);
    }
    bat_status status = check_texts(series, index, error);
    status = status == BAT_OK ? check_numbers(series->x, series->count, chart->log_x, "x", index, error) : status;
    status = status == BAT_OK ? check_numbers(series->y, series->count, chart->log_y, "y", index, error) : status;
    return status == BAT_OK && series->mark == BAT_CHART_BARS ? check_bars(series, chart->log_y, index, error) : status;
}

static void include(plot_axis *axis, double number)
{
    axis->low = fmin(axis->low, number);
    axis->high = fmax(axis->high, number);
}

static void include_series(const bat_chart_series *series, plot_axis *x, plot_axis *y)
{
    for (size_t i = 0; i < series->count; i++)
    {
        include(x, plot_number(x, series->x[i]));
        include(y, plot_number(y, series->y[i]));
    }
    if (series->mark == BAT_CHART_BARS)
    {
        size_t last = series->count - 1;
        double first_half = 0.5 * (plot_number(x, series->x[1]) - plot_number(x, series->x[0]));
        double last_half = 0.5 * (plot_number(x, series->x[last]) - plot_number(x, series->x[last - 1]));
        include(x, plot_number(x, series->x[0]) - first_half);
        include(x, plot_number(x, series->x[last]) + last_half);
        include(y, 0.0);
    }
}

/// Pad a range found from the numbers and put the caller's ends in place. With `grounded`, an end at 0 stays there.
static bool settle(plot_axis *axis, double low, double high, bool grounded)
{
    double range = axis->high - axis->low;
    double room = range > 0.0 ? PADDING * range : fmax(0.1 * fabs(axis->low), 0.5);
    axis->low -= grounded && axis->low == 0.0 ? 0.0 : room;
    axis->high += grounded && axis->high == 0.0 ? 0.0 : room;
    if (axis->logarithmic && ((!isnan(low) && low <= 0.0) || (!isnan(high) && high <= 0.0)))
    {
        return false;
    }
    axis->low = isnan(low) ? axis->low : plot_number(axis, low);
    axis->high = isnan(high) ? axis->high : plot_number(axis, high);
    return isfinite(axis->low) && isfinite(axis->high) && axis->low < axis->high;
}

bat_status plot_measure(const bat_chart *chart, size_t index, plot_axis *x, plot_axis *y, bat_error *error)
{
    *x = (plot_axis){.low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_x};
    *y = (plot_axis){.low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_y};
    if (chart->series == NULL || chart->series_count == 0)
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "chart %zu has no series", index);
    }
    if (!text_is_valid(chart->title) || !text_is_valid(chart->x_label) || !text_is_valid(chart->y_label))
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "a text of chart %zu is not plain UTF-8", index);
    }
    bool bars = false;
    for (size_t i = 0; i < chart->series_count; i++)
    {
        bat_status status = check_series(chart, i, error);
        if (status != BAT_OK)
        {
            return status;
        }
        include_series(&chart->series[i], x, y);
        bars = bars || chart->series[i].mark == BAT_CHART_BARS;
    }
    if (!settle(x, chart->x_low, chart->x_high, false) || !settle(y, chart->y_low, chart->y_high, bars))
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "chart %zu: the range of an axis is empty or not positive",
                         index);
    }
    return BAT_OK;
}

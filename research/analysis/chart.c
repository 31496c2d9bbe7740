#include "research/analysis/chart.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "draw/common/sheet.h"
#include "draw/curve/scene.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Charts: the ranges of their axes, their content, and pages of them.

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
        if (!(series->x[i - 1] < series->x[i]))
            return error_set(error, BAT_INVALID_POINT, i, 0, "series %zu: the x of bar %zu does not increase", index, i);
    return BAT_OK;
}

static bat_status check_series(const bat_chart *chart, size_t index, bat_error *error)
{
    const bat_chart_series *series = &chart->series[index];
    if (series->x == NULL || series->y == NULL || series->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu has no numbers", index);
    if (series->mark < BAT_CHART_MARK_AUTO || series->mark > BAT_CHART_MARK_BARS || series->colour < 0)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu: no such mark or colour", index);
    if (!text_is_valid(series->label))
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "series %zu: the label is not plain UTF-8 text", index);
    bat_status status = check_numbers(series->x, series->count, chart->log_x, "x", index, error);
    status = status == BAT_OK ? check_numbers(series->y, series->count, chart->log_y, "y", index, error) : status;
    return status == BAT_OK && series->mark == BAT_CHART_MARK_BARS ? check_bars(series, chart->log_y, index, error) : status;
}

static void include_series(const bat_chart_series *series, plot_axis *x, plot_axis *y)
{
    for (size_t i = 0; i < series->count; i++)
    {
        plot_include(x, plot_number(x, series->x[i]));
        plot_include(y, plot_number(y, series->y[i]));
    }
    if (series->mark == BAT_CHART_MARK_BARS)
    {
        size_t last = series->count - 1;
        double first_half = 0.5 * (plot_number(x, series->x[1]) - plot_number(x, series->x[0]));
        double last_half = 0.5 * (plot_number(x, series->x[last]) - plot_number(x, series->x[last - 1]));
        plot_include(x, plot_number(x, series->x[0]) - first_half);
        plot_include(x, plot_number(x, series->x[last]) + last_half);
        plot_include(y, 0.0);
    }
}

/// Check a chart and find the ranges of its axes.
static bat_status measure(const bat_chart *chart, size_t index, plot_axes *axes, bat_error *error)
{
    plot_axis *x = &axes->x, *y = &axes->y;
    *x = (plot_axis){
        .low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_x ? ticks_logarithmic : NULL, .label = chart->x_label};
    *y = (plot_axis){
        .low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_y ? ticks_logarithmic : NULL, .label = chart->y_label};
    if (chart->series == NULL || chart->series_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "chart %zu has no series", index);
    if (!text_is_valid(chart->title) || !text_is_valid(chart->x_label) || !text_is_valid(chart->y_label))
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "a text of chart %zu is not plain UTF-8", index);
    bool bars = false;
    for (size_t i = 0; i < chart->series_count; i++)
    {
        bat_status status = check_series(chart, i, error);
        if (status != BAT_OK)
            return status;
        include_series(&chart->series[i], x, y);
        bars = bars || chart->series[i].mark == BAT_CHART_MARK_BARS;
    }
    // Bars stand on the end of the axis.
    double low = bars && isnan(chart->y_low) && y->low == 0.0 ? 0.0 : chart->y_low;
    double high = bars && isnan(chart->y_high) && y->high == 0.0 ? 0.0 : chart->y_high;
    if (!plot_set_range(x, chart->x_low, chart->x_high) || !plot_set_range(y, low, high))
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "chart %zu: the range of an axis is empty or not positive",
                         index);
    }
    return BAT_OK;
}

static int colour_of(const bat_chart *chart, size_t index)
{
    return chart->series[index].colour > 0 ? chart->series[index].colour : (int)(index % 1000) + 1;
}

static legend_item legend_item_of(const bat_chart *chart, size_t index)
{
    const bat_chart_series *series = &chart->series[index];
    legend_item item = {series->label, style_curve(colour_of(chart, index)), LEGEND_NO_MARK};
    if (series->mark == BAT_CHART_MARK_POINTS || series->mark == BAT_CHART_MARK_BARS)
        item.line.width = 0.0;
    if (series->mark > BAT_CHART_MARK_LINE)
        item.mark = series->mark == BAT_CHART_MARK_BARS ? LEGEND_BAR : LEGEND_DOT;
    return item;
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static void draw_bars(cairo_t *cairo, const plot_axes *axes, const plot_series *series)
{
    const plot_axis *x = &axes->x, *y = &axes->y;
    double ground = clamp(plot_place(y, 0.0), y->end, y->start);
    for (size_t i = 0; i < series->count; i++)
    {
        double centre[2], next[2], before[2];
        plot_point(axes, series, i, centre);
        plot_point(axes, series, i + 1 < series->count ? i + 1 : i - 1, next);
        plot_point(axes, series, i > 0 ? i - 1 : 1, before);
        double left = clamp(centre[0] - 0.5 * fabs(centre[0] - before[0]), x->start, x->end);
        double right = clamp(centre[0] + 0.5 * fabs(next[0] - centre[0]), x->start, x->end);
        double top = clamp(centre[1], y->end, y->start);
        cairo_rectangle(cairo, left, fmin(top, ground), right - left, fabs(ground - top));
    }
    legend_fill_bars(cairo, style_palette(series->colour));
}

/// Draw bars, then lines, then dots.
static void draw_series(cairo_t *cairo, const bat_chart *chart, const plot_axes *axes)
{
    for (int layer = 0; layer < 3; layer++)
    {
        for (size_t i = 0; i < chart->series_count; i++)
        {
            const bat_chart_series *given = &chart->series[i];
            const plot_series series = {given->x, given->y, given->count, colour_of(chart, i)};
            bool line = given->mark <= BAT_CHART_MARK_LINE || given->mark == BAT_CHART_MARK_LINE_POINTS;
            bool dots =
                given->mark == BAT_CHART_MARK_POINTS || given->mark == BAT_CHART_MARK_LINE_POINTS || given->count == 1;
            if (layer == 0 && given->mark == BAT_CHART_MARK_BARS)
                draw_bars(cairo, axes, &series);
            if (layer == 1 && line)
                plot_line(cairo, axes, &series);
            if (layer == 2 && dots)
                plot_dots(cairo, axes, &series);
        }
    }
}

// Pages of charts.

/// The aspect ratio of a chart, height over width.
#define ASPECT 0.68
/// The width that a chart needs for its numbers.
#define MIN_WIDTH 180.0

bat_chart bat_chart_defaults(void)
{
    return (bat_chart){.x_low = NAN, .x_high = NAN, .y_low = NAN, .y_high = NAN};
}

typedef struct chart_set
{
    const bat_chart *charts;
    const bat_curve_picture_options *options;
    plot_axes *axes; ///< of each chart
    const chart_overlay *overlay;
} chart_set;

static double content_height(const void *context BAT_UNUSED, size_t index BAT_UNUSED, double width)
{
    return ASPECT * width;
}

static const char *content_caption(const void *context, size_t index)
{
    const chart_set *set = context;
    return set->charts[index].title;
}

static bat_status content_draw(const void *context, cairo_t *cairo, size_t index, const double box[4], bat_error *error)
{
    const chart_set *set = context;
    const bat_chart *chart = &set->charts[index];
    plot_axes axes = set->axes[index];
    plot_begin(cairo, &axes, box, set->options->grid);
    draw_series(cairo, chart, &axes);
    plot_end(cairo, &axes, box);
    return set->overlay != NULL ? set->overlay->draw(set->overlay->context, cairo, chart, &axes, error) : BAT_OK;
}

/// Collect the labelled series of all charts without repetitions. Release the items with free().
static bat_status collect_legend(const chart_set *set, size_t charts, legend_item **items, size_t *count, bat_error *error)
{
    size_t max_count = 0;
    for (size_t i = 0; i < charts; i++)
        max_count += set->charts[i].series_count;
    *count = 0;
    *items = memory_array(max_count, sizeof **items);
    if (*items == NULL)
        return error_memory(error, max_count * sizeof **items);
    for (size_t i = 0; i < charts && set->options->legend; i++)
    {
        for (size_t k = 0; k < set->charts[i].series_count; k++)
            if (text_given(set->charts[i].series[k].label))
                legend_add(*items, count, legend_item_of(&set->charts[i], k));
    }
    return BAT_OK;
}

static double natural_width(size_t columns)
{
    return columns == 1 ? 400.0 : columns == 2 ? 660.0 : 900.0;
}

static bat_status write_set(const char *path, chart_set *set, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        bat_status status = measure(&set->charts[i], i, &set->axes[i], error);
        if (status != BAT_OK)
            return status;
    }
    legend_item *items;
    size_t item_count;
    bat_status status = collect_legend(set, count, &items, &item_count, error);
    if (status == BAT_OK)
    {
        size_t columns = scene_columns(set->options, count, MIN_WIDTH);
        sheet_content content = {.count = count,
                                 .columns = columns,
                                 .options = set->options,
                                 .items = items,
                                 .item_count = item_count,
                                 .natural_width = natural_width(columns),
                                 .context = set,
                                 .height = content_height,
                                 .caption = content_caption,
                                 .draw = content_draw};
        status = sheet_write(path, &content, error);
        free(items);
    }
    return status;
}

bat_status chart_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                       const chart_overlay *overlay, bat_error *error)
{
    bat_curve_picture_options defaults = bat_curve_picture_defaults();
    if (path == NULL || charts == NULL || count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "charts need a file name and at least one chart");
    chart_set set = {charts, options != NULL ? options : &defaults, NULL, overlay};
    bat_status status = bat_options_check(&bat_curve_picture_fields, set.options, error);
    if (status != BAT_OK)
        return status;
    set.axes = memory_array(count, sizeof *set.axes);
    if (set.axes == NULL)
        return error_memory(error, count * sizeof *set.axes);
    status = write_set(path, &set, count, error);
    free(set.axes);
    return status;
}

bat_status bat_chart_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                           bat_error *error)
{
    return chart_write(path, charts, count, options, NULL, error);
}

#include "base/error.h"

#include "base/memory.h"
#include "draw/common/sheet.h"
#include "draw/curve/scene.h"

#include <stdio.h>
#include <stdlib.h>

/// @file
/// Charts: the ranges of their axes, their drawing, and pages of them.

/// The margin between the numbers and the ends of an axis, relative to the range.
#define PADDING 0.04

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
    if (series->mark == BAT_CHART_MARK_BARS)
    {
        size_t last = series->count - 1;
        double first_half = 0.5 * (plot_number(x, series->x[1]) - plot_number(x, series->x[0]));
        double last_half = 0.5 * (plot_number(x, series->x[last]) - plot_number(x, series->x[last - 1]));
        include(x, plot_number(x, series->x[0]) - first_half);
        include(x, plot_number(x, series->x[last]) + last_half);
        include(y, 0.0);
    }
}

/// Add margins to a range and apply the prescribed ends. With `grounded` an end at 0 remains there.
static bool finish_range(plot_axis *axis, double low, double high, bool grounded)
{
    double range = axis->high - axis->low;
    double room = range > 0.0 ? PADDING * range : fmax(0.1 * fabs(axis->low), 0.5);
    axis->low -= grounded && axis->low == 0.0 ? 0.0 : room;
    axis->high += grounded && axis->high == 0.0 ? 0.0 : room;
    if (axis->logarithmic && ((!isnan(low) && low <= 0.0) || (!isnan(high) && high <= 0.0)))
        return false;
    axis->low = isnan(low) ? axis->low : plot_number(axis, low);
    axis->high = isnan(high) ? axis->high : plot_number(axis, high);
    return isfinite(axis->low) && isfinite(axis->high) && axis->low < axis->high;
}

bat_status plot_measure(const bat_chart *chart, size_t index, plot_axis *x, plot_axis *y, bat_error *error)
{
    *x = (plot_axis){.low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_x};
    *y = (plot_axis){.low = INFINITY, .high = -INFINITY, .logarithmic = chart->log_y};
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
    if (!finish_range(x, chart->x_low, chart->x_high, false) || !finish_range(y, chart->y_low, chart->y_high, bars))
    {
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "chart %zu: the range of an axis is empty or not positive",
                         index);
    }
    return BAT_OK;
}

// Drawing of one chart: axes, bars, lines and dots.

static const double TURN = 6.28318530717958647693;

#define TOLERANCE 0.05
#define TICK_LENGTH 3.0
#define TICK_GAP 3.0
#define AXIS_LABEL_SPACE 14.0
#define BOTTOM 14.0
#define TOP 6.0
#define RIGHT 12.0
#define DOT_RADIUS 2.3
#define AXIS_TEXT_SIZE 512

static int plot_colour(const bat_chart *chart, size_t index)
{
    return chart->series[index].colour > 0 ? chart->series[index].colour : (int)(index % 1000) + 1;
}

static legend_item plot_legend_item(const bat_chart *chart, size_t index)
{
    const bat_chart_series *series = &chart->series[index];
    legend_item item = {series->label, style_curve(plot_colour(chart, index)), LEGEND_NO_MARK};
    if (series->mark == BAT_CHART_MARK_POINTS || series->mark == BAT_CHART_MARK_BARS)
        item.line.width = 0.0;
    if (series->mark > BAT_CHART_MARK_LINE)
        item.mark = series->mark == BAT_CHART_MARK_BARS ? LEGEND_BAR : LEGEND_DOT;
    return item;
}

static tick_list axis_ticks(const plot_axis *axis, double spacing)
{
    double wanted = fabs(axis->end - axis->start) / spacing;
    if (axis->logarithmic)
        return ticks_logarithmic(pow(10.0, axis->low), pow(10.0, axis->high), wanted);
    tick_list ticks = ticks_linear(axis->low, axis->high, wanted);
    ticks_use_scale(&ticks, ticks_scale(axis->low, axis->high));
    return ticks;
}

/// The text of an axis: its label with the offset and exponent of its ticks, as in "error (×10⁻⁶)".
static void axis_text(const plot_axis *axis, const char *label, char *text, size_t size)
{
    char left_out[TICK_SCALE_SIZE] = "";
    const char *given = text_given(label) ? label : "";
    if (!axis->logarithmic)
        tick_scale_text(ticks_scale(axis->low, axis->high), left_out);
    bool both = *given != '\0' && *left_out != '\0';
    (void)snprintf(text, size, both ? "%s (%s)" : "%s%s", given, left_out);
}

static double widest_label(cairo_t *cairo, const tick_list *ticks)
{
    double width = 0.0;
    for (size_t i = 0; i < ticks->count; i++)
        width = fmax(width, ticks->labelled[i] ? tick_width(cairo, ticks, i) : 0.0);
    return width;
}

static double tick_place(const plot_axis *axis, const tick_list *ticks, size_t index)
{
    return plot_place(axis, plot_number(axis, ticks->values[index]));
}

static void draw_grid(cairo_t *cairo, const plot_axis *x, const plot_axis *y, const tick_list *across,
                      const tick_list *upwards)
{
    for (size_t i = 0; i < across->count; i++)
    {
        cairo_move_to(cairo, tick_place(x, across, i), y->start);
        cairo_line_to(cairo, tick_place(x, across, i), y->end);
    }
    for (size_t i = 0; i < upwards->count; i++)
    {
        cairo_move_to(cairo, x->start, tick_place(y, upwards, i));
        cairo_line_to(cairo, x->end, tick_place(y, upwards, i));
    }
    style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
}

static void draw_axes(cairo_t *cairo, const plot_axis *x, const plot_axis *y, const tick_list *across,
                      const tick_list *upwards)
{
    cairo_move_to(cairo, x->start, y->end);
    cairo_line_to(cairo, x->start, y->start);
    cairo_line_to(cairo, x->end, y->start);
    for (size_t i = 0; i < across->count; i++)
    {
        cairo_move_to(cairo, tick_place(x, across, i), y->start);
        cairo_rel_line_to(cairo, 0.0, across->labelled[i] ? TICK_LENGTH : 0.5 * TICK_LENGTH);
    }
    for (size_t i = 0; i < upwards->count; i++)
    {
        cairo_move_to(cairo, x->start, tick_place(y, upwards, i));
        cairo_rel_line_to(cairo, upwards->labelled[i] ? -TICK_LENGTH : -0.5 * TICK_LENGTH, 0.0);
    }
    style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
}

static void draw_tick_labels(cairo_t *cairo, const plot_axis *x, const plot_axis *y, const tick_list *across,
                             const tick_list *upwards)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    double taken = -INFINITY;
    for (size_t i = 0; i < across->count; i++)
    {
        double place = tick_place(x, across, i);
        double half = 0.5 * tick_width(cairo, across, i);
        if (across->labelled[i] && place - half > taken + 4.0)
        {
            tick_draw(cairo, across, i, place, y->start + TICK_LENGTH + TICK_GAP + 0.5 * TEXT_TICK, 0.5);
            taken = place + half;
        }
    }
    taken = INFINITY;
    for (size_t i = 0; i < upwards->count; i++)
    {
        double place = tick_place(y, upwards, i);
        if (upwards->labelled[i] && place + TEXT_TICK < taken)
        {
            tick_draw(cairo, upwards, i, x->start - TICK_LENGTH - TICK_GAP, place, 1.0);
            taken = place;
        }
    }
}

static void draw_axis_names(cairo_t *cairo, const bat_chart *chart, const plot_axis *x, const plot_axis *y,
                            const double box[4])
{
    char text[AXIS_TEXT_SIZE];
    style_use_colour(cairo, COLOUR_FOREGROUND);
    axis_text(x, chart->x_label, text, sizeof text);
    text_draw_fitted(cairo, text, TEXT_LEGEND, false, 0.5 * (x->start + x->end), box[1] + box[3] - 4.0, x->end - x->start);
    axis_text(y, chart->y_label, text, sizeof text);
    cairo_save(cairo);
    cairo_translate(cairo, box[0] + TEXT_LEGEND, 0.5 * (y->start + y->end));
    cairo_rotate(cairo, -TURN / 4.0);
    text_draw_fitted(cairo, text, TEXT_LEGEND, false, 0.0, 0.0, y->start - y->end);
    cairo_restore(cairo);
}

/// Reduce [*enter, *leave], fractions of a segment, to where from + fraction * step is between low and high.
static void clip_share(double from, double step, double low, double high, double *enter, double *leave)
{
    if (step == 0.0)
    {
        *leave = from < low || from > high ? -1.0 : *leave;
        return;
    }
    double a = (low - from) / step;
    double b = (high - from) / step;
    *enter = fmax(*enter, fmin(a, b));
    *leave = fmin(*leave, fmax(a, b));
}

/// Append the visible part of a segment to the path (Liang and Barsky, 1984). `joined`: the path has reached p.
/// @return whether the path has reached q
static bool add_segment(path_simplifier *path, const plot_axis *x, const plot_axis *y, const double p[2], const double q[2],
                        bool joined)
{
    double enter = 0.0, leave = 1.0;
    clip_share(p[0], q[0] - p[0], x->start, x->end, &enter, &leave);
    clip_share(p[1], q[1] - p[1], y->end, y->start, &enter, &leave);
    if (enter > leave)
        return false;
    if (!joined || enter > 0.0)
        simplifier_move(path, p[0] + enter * (q[0] - p[0]), p[1] + enter * (q[1] - p[1]));
    simplifier_line(path, leave < 1.0 ? p[0] + leave * (q[0] - p[0]) : q[0],
                    leave < 1.0 ? p[1] + leave * (q[1] - p[1]) : q[1]);
    return leave >= 1.0;
}

static void place(const plot_axis *x, const plot_axis *y, const bat_chart_series *series, size_t index, double point[2])
{
    point[0] = plot_place(x, plot_number(x, series->x[index]));
    point[1] = plot_place(y, plot_number(y, series->y[index]));
}

static void draw_line(cairo_t *cairo, const bat_chart_series *series, const plot_axis *x, const plot_axis *y, int colour)
{
    path_simplifier path = simplifier_begin(canvas_sink(cairo), TOLERANCE);
    double p[2];
    bool joined = false;
    place(x, y, series, 0, p);
    for (size_t i = 1; i < series->count; i++)
    {
        double q[2];
        place(x, y, series, i, q);
        joined = add_segment(&path, x, y, p, q, joined);
        p[0] = q[0];
        p[1] = q[1];
    }
    simplifier_flush(&path);
    style_stroke(cairo, style_curve(colour));
}

static void draw_dots(cairo_t *cairo, const bat_chart_series *series, const plot_axis *x, const plot_axis *y, int colour)
{
    double radius = series->count > 1000 ? 0.4 * DOT_RADIUS : series->count > 200 ? 0.7 * DOT_RADIUS : DOT_RADIUS;
    for (size_t i = 0; i < series->count; i++)
    {
        double p[2];
        place(x, y, series, i, p);
        if (p[0] >= x->start && p[0] <= x->end && p[1] >= y->end && p[1] <= y->start)
            legend_dot(cairo, p[0], p[1], radius, style_palette(colour));
    }
}

static double clamp(double value, double low, double high)
{
    return fmin(fmax(value, low), high);
}

static void draw_bars(cairo_t *cairo, const bat_chart_series *series, const plot_axis *x, const plot_axis *y, int colour)
{
    double ground = clamp(plot_place(y, 0.0), y->end, y->start);
    for (size_t i = 0; i < series->count; i++)
    {
        double centre[2], next[2], before[2];
        place(x, y, series, i, centre);
        place(x, y, series, i + 1 < series->count ? i + 1 : i - 1, next);
        place(x, y, series, i > 0 ? i - 1 : 1, before);
        double left = clamp(centre[0] - 0.5 * fabs(centre[0] - before[0]), x->start, x->end);
        double right = clamp(centre[0] + 0.5 * fabs(next[0] - centre[0]), x->start, x->end);
        double top = clamp(centre[1], y->end, y->start);
        cairo_rectangle(cairo, left, fmin(top, ground), right - left, fabs(ground - top));
    }
    legend_fill_bars(cairo, style_palette(colour));
}

/// Draw bars, then lines, then dots.
static void draw_series(cairo_t *cairo, const bat_chart *chart, const plot_axis *x, const plot_axis *y)
{
    for (int layer = 0; layer < 3; layer++)
    {
        for (size_t i = 0; i < chart->series_count; i++)
        {
            const bat_chart_series *series = &chart->series[i];
            bool line = series->mark <= BAT_CHART_MARK_LINE || series->mark == BAT_CHART_MARK_LINE_POINTS;
            bool dots =
                series->mark == BAT_CHART_MARK_POINTS || series->mark == BAT_CHART_MARK_LINE_POINTS || series->count == 1;
            if (layer == 0 && series->mark == BAT_CHART_MARK_BARS)
                draw_bars(cairo, series, x, y, plot_colour(chart, i));
            if (layer == 1 && line)
                draw_line(cairo, series, x, y, plot_colour(chart, i));
            if (layer == 2 && dots)
                draw_dots(cairo, series, x, y, plot_colour(chart, i));
        }
    }
}

/// Place the y axis, with room below for the x axis. Returns the room to its left.
static double set_upright(cairo_t *cairo, const bat_chart *chart, const double box[4], const plot_axis *x, plot_axis *y,
                          tick_list *upwards)
{
    char text[AXIS_TEXT_SIZE];
    axis_text(x, chart->x_label, text, sizeof text);
    double below = BOTTOM + (text_given(text) ? AXIS_LABEL_SPACE : 0.0);
    axis_text(y, chart->y_label, text, sizeof text);
    double beside = text_given(text) ? AXIS_LABEL_SPACE : 0.0;
    text_use(cairo, TEXT_TICK, false);
    y->end = box[1] + TOP;
    y->start = fmax(y->end + 10.0, box[1] + box[3] - below);
    *upwards = axis_ticks(y, 36.0);
    return beside + widest_label(cairo, upwards) + TICK_LENGTH + TICK_GAP;
}

double plot_margin(cairo_t *cairo, const bat_chart *chart, plot_axis x, plot_axis y, const double box[4])
{
    tick_list upwards;
    return set_upright(cairo, chart, box, &x, &y, &upwards);
}

/// Place the axes: y first, because its labels determine the start of x.
static void set_axes(cairo_t *cairo, const bat_chart *chart, const double box[4], plot_axis *x, plot_axis *y,
                     tick_list *across, tick_list *upwards)
{
    x->start = box[0] + set_upright(cairo, chart, box, x, y, upwards);
    x->end = fmax(x->start + 10.0, box[0] + box[2] - RIGHT);
    *across = axis_ticks(x, 52.0);
}

bat_status plot_draw(cairo_t *cairo, const bat_chart *chart, const bat_curve_picture_options *options, plot_axis x,
                     plot_axis y, const double box[4], const plot_overlay *overlay, bat_error *error)
{
    tick_list across, upwards;
    set_axes(cairo, chart, box, &x, &y, &across, &upwards);
    if (options->grid)
        draw_grid(cairo, &x, &y, &across, &upwards);
    draw_series(cairo, chart, &x, &y);
    draw_axes(cairo, &x, &y, &across, &upwards);
    draw_tick_labels(cairo, &x, &y, &across, &upwards);
    draw_axis_names(cairo, chart, &x, &y, box);
    return overlay != NULL ? overlay->draw(overlay->context, cairo, chart, &x, &y, error) : BAT_OK;
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
    plot_axis *axes; ///< x and y for each chart
    const plot_overlay *overlay;
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
    return plot_draw(cairo, &set->charts[index], set->options, set->axes[2 * index], set->axes[2 * index + 1], box,
                     set->overlay, error);
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
                legend_add(*items, count, plot_legend_item(&set->charts[i], k));
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
        bat_status status = plot_measure(&set->charts[i], i, &set->axes[2 * i], &set->axes[2 * i + 1], error);
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

bat_status plot_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                      const plot_overlay *overlay, bat_error *error)
{
    bat_curve_picture_options defaults = bat_curve_picture_defaults();
    if (path == NULL || charts == NULL || count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "charts need a file name and at least one chart");
    chart_set set = {charts, options != NULL ? options : &defaults, NULL, overlay};
    bat_status status = bat_options_check(&bat_curve_picture_fields, set.options, error);
    if (status != BAT_OK)
        return status;
    set.axes = memory_array(2 * count, sizeof *set.axes);
    if (set.axes == NULL)
        return error_memory(error, 2 * count * sizeof *set.axes);
    status = write_set(path, &set, count, error);
    free(set.axes);
    return status;
}

bat_status bat_chart_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                           bat_error *error)
{
    return plot_write(path, charts, count, options, NULL, error);
}

#include "draw/curve/plot.h"

#include "draw/common/sheet.h"

#include <stdio.h>

/// The margin between the numbers and the ends of an axis, relative to the range.
#define PADDING 0.04

bool plot_set_range(plot_axis *axis, double low, double high)
{
    double range = axis->high - axis->low;
    double room = range > 0.0 ? PADDING * range : fmax(0.1 * fabs(axis->low), 0.5);
    axis->low = isnan(low) ? axis->low - room : plot_number(axis, low);
    axis->high = isnan(high) ? axis->high + room : plot_number(axis, high);
    return isfinite(axis->low) && isfinite(axis->high) && axis->low < axis->high;
}

#define TOLERANCE 0.05
#define TICK_LENGTH 3.0
#define TICK_GAP 3.0
#define AXIS_LABEL_SPACE 14.0
#define BOTTOM 14.0
#define TOP 6.0
#define RIGHT 12.0
#define DOT_RADIUS 2.3
#define AXIS_TEXT_SIZE 512

static tick_list axis_ticks(const plot_axis *axis, double spacing)
{
    double wanted = fabs(axis->end - axis->start) / spacing;
    if (axis->logarithmic != NULL)
        return axis->logarithmic(pow(10.0, axis->low), pow(10.0, axis->high), wanted);
    tick_list ticks = ticks_linear(axis->low, axis->high, wanted);
    ticks_use_scale(&ticks, ticks_scale(axis->low, axis->high));
    return ticks;
}

/// The text of an axis: its label with the offset and exponent of its ticks, as in "error (×10⁻⁶)".
static const char *axis_text(const plot_axis *axis, char text[AXIS_TEXT_SIZE])
{
    char left_out[TICK_SCALE_SIZE] = "";
    const char *given = text_given(axis->label) ? axis->label : "";
    if (axis->logarithmic == NULL)
        tick_scale_text(ticks_scale(axis->low, axis->high), left_out);
    bool both = *given != '\0' && *left_out != '\0';
    (void)snprintf(text, AXIS_TEXT_SIZE, both ? "%s (%s)" : "%s%s", given, left_out);
    return text;
}

static double tick_place(const plot_axis *axis, size_t index)
{
    return plot_place(axis, plot_number(axis, axis->ticks.values[index]));
}

static void draw_axes(cairo_t *cairo, const plot_axis *x, const plot_axis *y)
{
    cairo_move_to(cairo, x->start, y->end);
    cairo_line_to(cairo, x->start, y->start);
    cairo_line_to(cairo, x->end, y->start);
    for (size_t i = 0; i < x->ticks.count; i++)
    {
        cairo_move_to(cairo, tick_place(x, i), y->start);
        cairo_rel_line_to(cairo, 0.0, x->ticks.labelled[i] ? TICK_LENGTH : 0.5 * TICK_LENGTH);
    }
    for (size_t i = 0; i < y->ticks.count; i++)
    {
        cairo_move_to(cairo, x->start, tick_place(y, i));
        cairo_rel_line_to(cairo, y->ticks.labelled[i] ? -TICK_LENGTH : -0.5 * TICK_LENGTH, 0.0);
    }
    style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
}

static void draw_tick_labels(cairo_t *cairo, const plot_axis *x, const plot_axis *y)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    double taken = -INFINITY;
    for (size_t i = 0; i < x->ticks.count; i++)
    {
        double place = tick_place(x, i);
        double half = 0.5 * tick_width(cairo, &x->ticks, i);
        if (x->ticks.labelled[i] && place - half > taken + 4.0)
        {
            tick_draw(cairo, &x->ticks, i, place, y->start + TICK_LENGTH + TICK_GAP + 0.5 * TEXT_TICK, 0.5);
            taken = place + half;
        }
    }
    taken = INFINITY;
    for (size_t i = 0; i < y->ticks.count; i++)
    {
        double place = tick_place(y, i);
        if (y->ticks.labelled[i] && place + TEXT_TICK < taken)
        {
            tick_draw(cairo, &y->ticks, i, x->start - TICK_LENGTH - TICK_GAP, place, 1.0);
            taken = place;
        }
    }
}

/// Reduce [*enter, *leave], fractions of a segment, to where from + fraction * step is between low and high.
static void clip_share(double from, double step, double low, double high, double *enter, double *leave)
{
    if (step == 0.0)
    {
        *leave = from < low || from > high ? -1.0 : *leave;
        return;
    }
    double a = (low - from) / step, b = (high - from) / step;
    *enter = fmax(*enter, fmin(a, b));
    *leave = fmin(*leave, fmax(a, b));
}

/// Append the visible part of a segment to the path (Liang and Barsky, 1984). `joined`: the path has reached p.
/// @return whether the path has reached q
static bool add_segment(path_simplifier *path, const plot_axes *axes, const double p[2], const double q[2], bool joined)
{
    double enter = 0.0, leave = 1.0;
    clip_share(p[0], q[0] - p[0], axes->x.start, axes->x.end, &enter, &leave);
    clip_share(p[1], q[1] - p[1], axes->y.end, axes->y.start, &enter, &leave);
    if (enter > leave)
        return false;
    if (!joined || enter > 0.0)
        simplifier_move(path, p[0] + enter * (q[0] - p[0]), p[1] + enter * (q[1] - p[1]));
    simplifier_line(path, leave < 1.0 ? p[0] + leave * (q[0] - p[0]) : q[0],
                    leave < 1.0 ? p[1] + leave * (q[1] - p[1]) : q[1]);
    return leave >= 1.0;
}

void plot_line(cairo_t *cairo, const plot_axes *axes, const plot_series *series)
{
    path_simplifier path = simplifier_begin(canvas_sink(cairo), TOLERANCE);
    double p[2];
    bool joined = false;
    plot_point(axes, series, 0, p);
    for (size_t i = 1; i < series->count; i++)
    {
        double q[2];
        plot_point(axes, series, i, q);
        joined = add_segment(&path, axes, p, q, joined);
        p[0] = q[0];
        p[1] = q[1];
    }
    simplifier_flush(&path);
    style_stroke(cairo, style_curve(series->colour));
}

void plot_dots(cairo_t *cairo, const plot_axes *axes, const plot_series *series)
{
    double radius = series->count > 1000 ? 0.4 * DOT_RADIUS : series->count > 200 ? 0.7 * DOT_RADIUS : DOT_RADIUS;
    for (size_t i = 0; i < series->count; i++)
    {
        double p[2];
        plot_point(axes, series, i, p);
        if (p[0] >= axes->x.start && p[0] <= axes->x.end && p[1] >= axes->y.end && p[1] <= axes->y.start)
            legend_dot(cairo, p[0], p[1], radius, style_palette(series->colour));
    }
}

/// Place the y axis, with room below for the x axis. Returns the room to its left.
static double set_upright(cairo_t *cairo, const plot_axis *x, plot_axis *y, const double box[4])
{
    char text[AXIS_TEXT_SIZE];
    double below = BOTTOM + (text_given(axis_text(x, text)) ? AXIS_LABEL_SPACE : 0.0);
    double beside = text_given(axis_text(y, text)) ? AXIS_LABEL_SPACE : 0.0, widest = 0.0;
    text_use(cairo, TEXT_TICK, false);
    y->end = box[1] + TOP;
    y->start = fmax(y->end + 10.0, box[1] + box[3] - below);
    y->ticks = axis_ticks(y, 36.0);
    for (size_t i = 0; i < y->ticks.count; i++)
        widest = fmax(widest, y->ticks.labelled[i] ? tick_width(cairo, &y->ticks, i) : 0.0);
    return beside + widest + TICK_LENGTH + TICK_GAP;
}

double plot_margin(cairo_t *cairo, plot_axes axes, const double box[4])
{
    return set_upright(cairo, &axes.x, &axes.y, box);
}

void plot_begin(cairo_t *cairo, plot_axes *axes, const double box[4], bool grid)
{
    plot_axis *x = &axes->x;
    x->start = box[0] + set_upright(cairo, x, &axes->y, box); // the labels of y determine the start of x
    x->end = fmax(x->start + 10.0, box[0] + box[2] - RIGHT);
    x->ticks = axis_ticks(x, 52.0);
    if (grid)
    {
        for (size_t i = 0; i < x->ticks.count; i++)
            style_segment(cairo, tick_place(x, i), axes->y.start, tick_place(x, i), axes->y.end);
        for (size_t i = 0; i < axes->y.ticks.count; i++)
            style_segment(cairo, x->start, tick_place(&axes->y, i), x->end, tick_place(&axes->y, i));
        style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    }
}

void plot_end(cairo_t *cairo, const plot_axes *axes, const double box[4])
{
    draw_axes(cairo, &axes->x, &axes->y);
    draw_tick_labels(cairo, &axes->x, &axes->y);
    char text[AXIS_TEXT_SIZE];
    style_use_colour(cairo, COLOUR_FOREGROUND);
    text_draw_fitted(cairo, axis_text(&axes->x, text), TEXT_LEGEND, false, 0.5 * (axes->x.start + axes->x.end),
                     box[1] + box[3] - 4.0, axes->x.end - axes->x.start);
    cairo_save(cairo);
    cairo_translate(cairo, box[0] + TEXT_LEGEND, 0.5 * (axes->y.start + axes->y.end));
    cairo_rotate(cairo, -ANGLE_TURN / 4.0);
    text_draw_fitted(cairo, axis_text(&axes->y, text), TEXT_LEGEND, false, 0.0, 0.0, axes->y.start - axes->y.end);
    cairo_restore(cairo);
}

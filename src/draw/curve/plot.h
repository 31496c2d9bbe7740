#ifndef DRAW_CURVE_PLOT_H
#define DRAW_CURVE_PLOT_H

#include "batten/curve_picture.h"
#include "draw/common/legend.h"
#include "draw/common/ticks.h"

#include <cairo.h>

/// @file
/// One chart on paper.

/// An axis: numbers (their decimal logarithms when `logarithmic`) from low to high along paper coordinates from start to
/// end.
typedef struct plot_axis
{
    double low, high;
    double start, end;
    bool logarithmic;
} plot_axis;

static inline double plot_place(const plot_axis *axis, double number)
{
    return axis->start + (number - axis->low) / (axis->high - axis->low) * (axis->end - axis->start);
}

/// Check a chart and find the ranges of its axes.
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT
bat_status plot_measure(const bat_chart *chart, size_t index, plot_axis *x, plot_axis *y, bat_error *error);
/// Draw a chart into the box (x, y, width, height).
bat_status plot_draw(cairo_t *cairo, const bat_chart *chart, const bat_curve_picture_options *options, plot_axis x,
                     plot_axis y, const double box[4], bat_error *error);
/// How a series looks in the legend; the label may be null.
legend_item plot_legend_item(const bat_chart *chart, size_t index);

/// A number on an axis: its logarithm where the axis is logarithmic.
double plot_number(const plot_axis *axis, double value);
/// The palette's index of a series.
int plot_colour(const bat_chart *chart, size_t index);
/// Write the points' labels beside them, where they hide least.
bat_status plot_draw_labels(cairo_t *cairo, const bat_chart *chart, const plot_axis *x, const plot_axis *y,
                            bat_error *error);

#endif

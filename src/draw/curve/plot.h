#ifndef DRAW_CURVE_PLOT_H
#define DRAW_CURVE_PLOT_H

#include "batten/curve_picture.h"
#include "draw/common/legend.h"
#include "draw/common/ticks.h"

#include <cairo.h>

/// @file
/// One chart of a page.

/// An axis that maps [low, high] to [start, end] on the page; logarithmic axes use decimal logarithms.
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
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_INVALID_POINT
bat_status plot_measure(const bat_chart *chart, size_t index, plot_axis *x, plot_axis *y, bat_error *error);
/// The room to the left of a chart's y axis in the box (x, y, width, height), to align charts.
double plot_margin(cairo_t *cairo, const bat_chart *chart, plot_axis x, plot_axis y, const double box[4]);
bat_status plot_draw(cairo_t *cairo, const bat_chart *chart, const bat_curve_picture_options *options, plot_axis x,
                     plot_axis y, const double box[4], bat_error *error);

#endif

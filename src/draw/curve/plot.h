#pragma once

#include "draw/common/ticks.h"

#include <math.h>

/// @file
/// The axes of a plot, and lines and dots along them.

/// An axis that maps [low, high] to [start, end] on the page; logarithmic axes use decimal logarithms.
typedef struct plot_axis
{
    double low, high;
    double start, end;
    const char *label; ///< null or "" for none
    /// The ticks between two values on a logarithmic axis; null: the axis is linear.
    tick_list (*logarithmic)(double low, double high, double wanted);
    tick_list ticks;
} plot_axis;

typedef struct plot_axes
{
    plot_axis x, y;
} plot_axes;

/// A value on an axis: its decimal logarithm if the axis is logarithmic.
static inline double plot_number(const plot_axis *axis, double value)
{
    return axis->logarithmic != NULL ? log10(value) : value;
}

static inline double plot_place(const plot_axis *axis, double number)
{
    return axis->start + (number - axis->low) / (axis->high - axis->low) * (axis->end - axis->start);
}

/// Extend the range of an axis to a number.
static inline void plot_include(plot_axis *axis, double number)
{
    axis->low = fmin(axis->low, number);
    axis->high = fmax(axis->high, number);
}

/// Add margins to a range, or set its ends where `low` or `high` is no NaN.
/// @return whether the range is one
bool plot_set_range(plot_axis *axis, double low, double high);

/// The room to the left of the y axis in the box (x, y, width, height), to align plots.
double plot_margin(cairo_t *cairo, plot_axes axes, const double box[4]);
/// Place axes that have ranges in a box, and draw the grid.
void plot_begin(cairo_t *cairo, plot_axes *axes, const double box[4], bool grid);
/// Draw the axes over the content.
void plot_end(cairo_t *cairo, const plot_axes *axes, const double box[4]);

typedef struct plot_series
{
    const double *x, *y;
    size_t count;
    int colour; ///< of style_palette()
} plot_series;

/// The place of a point on the page.
static inline void plot_point(const plot_axes *axes, const plot_series *series, size_t index, double point[2])
{
    point[0] = plot_place(&axes->x, plot_number(&axes->x, series->x[index]));
    point[1] = plot_place(&axes->y, plot_number(&axes->y, series->y[index]));
}

/// Draw what is between the ends of the axes.
void plot_line(cairo_t *cairo, const plot_axes *axes, const plot_series *series);
void plot_dots(cairo_t *cairo, const plot_axes *axes, const plot_series *series);

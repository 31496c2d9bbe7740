#pragma once

#include "batten/research/chart_picture.h"
#include "draw/curve/plot.h"

/// Draws over a chart, whose axes have their places.
typedef struct chart_overlay
{
    bat_status (*draw)(const void *context, cairo_t *cairo, const bat_chart *chart, const plot_axes *axes, bat_error *error);
    const void *context;
} chart_overlay;

/// The ticks of a logarithmic axis: powers of ten, and their multiples where there are few powers; 0 < low < high.
tick_list ticks_logarithmic(double low, double high, double wanted);
/// A multiple of a power of ten without its exponent: "10" or "2×10".
void power_label(double value, char label[TICK_LABEL_SIZE]);

/// bat_chart_write() with an overlay on each chart; null for none.
bat_status chart_write(const char *path, const bat_chart *charts, size_t count, const bat_curve_picture_options *options,
                       const chart_overlay *overlay, bat_error *error);

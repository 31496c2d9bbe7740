#pragma once

#include "batten/base.h"
#include "draw/common/style.h"

/// @file
/// A colour scale for numbers, from pale yellow through orange and red to deep violet, with uniform steps of perceived
/// lightness.

/// The colour at a position on the scale, clamped to 0 … 1, in linear light.
draw_colour colour_scale_at(double share);
/// Convert linear light to sRGB, which cairo uses.
double colour_encode(double linear);
/// Convert sRGB to linear light.
double colour_decode(double encoded);

/// A scale of colours: that of a share from 0 to 1, in linear light.
typedef draw_colour colour_scale(double share);
/// From blue for 0 through a pale grey to red for 1.
draw_colour colour_scale_diverging(double share);

double colour_bar_height(void);
/// Draw a scale from `low` to `high`, centred in the box (x, y, width, height): a bar, round numbers below it, the label.
void colour_bar_draw(cairo_t *cairo, colour_scale *scale, double low, double high, const char *label, const double box[4]);

// The legend of lines and marks below a picture.

typedef enum legend_mark
{
    LEGEND_NO_MARK,
    LEGEND_RING, ///< an open circle, for control points
    LEGEND_DOT,
    LEGEND_BAR
} legend_mark;

typedef struct legend_item
{
    const char *label;
    line_style line; ///< width 0: no line; its colour also fills dots and bars
    legend_mark mark;
} legend_item;

/// Append an item unless an equal one exists. `items` must have space for it.
void legend_add(legend_item *items, size_t *count, legend_item item);
double legend_height(cairo_t *cairo, const legend_item *items, size_t count, double width);
/// Draw the items from (x, y) downwards, centred, in one row or, where that is too long, in columns.
void legend_draw(cairo_t *cairo, const legend_item *items, size_t count, double x, double y, double width);

/// Draw an open circle, as for control points.
void legend_ring(cairo_t *cairo, double x, double y, double radius, draw_colour colour);
/// Draw a disk with a thin white edge.
void legend_dot(cairo_t *cairo, double x, double y, double radius, draw_colour colour);
/// Fill and outline the current path in the style of bars, which are translucent.
void legend_fill_bars(cairo_t *cairo, draw_colour colour);

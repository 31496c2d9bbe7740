#ifndef DRAW_COMMON_LEGEND_H
#define DRAW_COMMON_LEGEND_H

#include "batten/base.h"
#include "draw/common/style.h"

/// @file
/// The explanation of lines and marks below a picture.

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
    line_style line; ///< width 0 for none; its colour also fills dots and bars
    legend_mark mark;
} legend_item;

/// Add an item unless one with the same label and look is there. `items` has room for it.
void legend_add(legend_item *items, size_t *count, legend_item item);
/// The height of the legend in a picture of that width, 0 without items.
double legend_height(cairo_t *cairo, const legend_item *items, size_t count, double width);
/// Draw the items from (x, y) downwards, centred: in one row, or in columns where one row is too long.
void legend_draw(cairo_t *cairo, const legend_item *items, size_t count, double x, double y, double width);

/// An open circle as control points have it.
void legend_ring(cairo_t *cairo, double x, double y, double radius, draw_colour colour);
/// A disk with a thin white edge.
void legend_dot(cairo_t *cairo, double x, double y, double radius, draw_colour colour);
/// Fill and outline the current path as bars are; what lies behind shines through.
void legend_fill_bars(cairo_t *cairo, draw_colour colour);

#endif

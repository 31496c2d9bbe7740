#ifndef DRAW_CURVE_COMB_LINES_H
#define DRAW_CURVE_COMB_LINES_H

#include "draw/curve/comb.h"
#include "draw/curve/stroke.h"

/// @file
/// Combs on paper.

/// Draw the teeth of a comb and the line through their tips. The ends of an open curve, where curvature is not known, have
/// neither.
bat_status comb_lines_draw(cairo_t *cairo, const draw_view *view, const comb *teeth, double scale, draw_colour colour,
                           bat_error *error);

#endif

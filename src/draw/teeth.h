#ifndef DRAW_TEETH_H
#define DRAW_TEETH_H

#include "draw/comb.h"
#include "draw/stroke.h"

/// @file
/// Combs on paper.

/// Draw the teeth of a comb and the line through their tips. The ends of an open curve, where curvature is not known, have
/// neither.
bat_status teeth_draw(cairo_t *cairo, const draw_view *view, const comb *teeth, double scale, draw_colour colour,
                      bat_error *error);

#endif

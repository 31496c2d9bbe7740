#ifndef DRAW_COMMON_COLOUR_SCALE_H
#define DRAW_COMMON_COLOUR_SCALE_H

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

double colour_bar_height(void);
/// Draw the scale from `low` to `high`, centred in the box (x, y, width, height): a bar with round numbers below it and the
/// label beside it.
void colour_bar_draw(cairo_t *cairo, double low, double high, const char *label, const double box[4]);

#endif

#ifndef DRAW_COMMON_COLOUR_SCALE_H
#define DRAW_COMMON_COLOUR_SCALE_H

#include "draw/common/style.h"

/// @file
/// Colours for numbers: from pale yellow through orange and red to deep violet, in even steps of perceived lightness.

/// The colour of a share of the scale, 0 to 1 (beyond: the ends), in linear light.
draw_colour colour_scale_at(double share);
/// From linear light to the sRGB values that cairo takes.
double colour_encode(double linear);
/// And back.
double colour_decode(double encoded);

/// The height of a bar with its numbers and label.
double colour_bar_height(void);
/// Draw the scale from low to high, centred in the box (x, y, width, height): a bar, round numbers below it, the label
/// beside.
void colour_bar_draw(cairo_t *cairo, double low, double high, const char *label, const double box[4]);

#endif

#ifndef DRAW_COMMON_TEXT_H
#define DRAW_COMMON_TEXT_H

#include "draw/common/style.h"

#include <stddef.h>

/// @file
/// Short texts in the sans-serif font of the system. All texts are UTF-8 and were checked with text_is_valid().

/// The smallest size to which text_draw_fitted() shrinks.
#define TEXT_SMALLEST 6.0

/// True for null and for well-formed UTF-8 without control characters.
bool text_is_valid(const char *text);
/// True when there is something to draw.
bool text_given(const char *text);

void text_use(cairo_t *cairo, double size, bool bold);
double text_width(cairo_t *cairo, const char *text);
/// Draw with the point (x, y) at share `align` of the text's width (0 left, 1/2 middle, 1 right) on its baseline.
void text_draw(cairo_t *cairo, const char *text, double x, double y, double align);
/// The same with the middle of the digits' height at y.
void text_draw_middle(cairo_t *cairo, const char *text, double x, double y, double align);
/// Draw centred at (x, y) in the current colour, smaller or cut with an ellipsis where it is wider than `width`.
void text_draw_fitted(cairo_t *cairo, const char *text, double size, bool bold, double x, double y, double width);
/// Copy `text` into `buffer` of `capacity` bytes, cut with an ellipsis so that it is at most `width` wide in the current
/// font.
void text_cut(cairo_t *cairo, const char *text, double width, char *buffer, size_t capacity);

/// The height of digits of a font of that size, for centring.
static inline double text_digit_height(double size)
{
    return 0.72 * size;
}

#endif

#ifndef DRAW_COMMON_TEXT_H
#define DRAW_COMMON_TEXT_H

#include "draw/common/style.h"

#include <stddef.h>

/// @file
/// Short texts in the system's sans-serif font. All texts are UTF-8 that passed text_is_valid().

/// The smallest size that text_draw_fitted() uses.
#define TEXT_SMALLEST 6.0

/// Whether a text is null or well-formed UTF-8 without control characters.
bool text_is_valid(const char *text);
bool text_given(const char *text);

void text_use(cairo_t *cairo, double size, bool bold);
double text_width(cairo_t *cairo, const char *text);
/// Draw a text with the point (x, y) on its baseline, at the fraction `align` of its width: 0 left, 1/2 centre, 1 right.
void text_draw(cairo_t *cairo, const char *text, double x, double y, double align);
/// Draw a text with y in the middle of the digits' height.
void text_draw_middle(cairo_t *cairo, const char *text, double x, double y, double align);
/// Draw a text centred at (x, y) in the current colour. A text wider than `width` is reduced, or truncated with an ellipsis.
void text_draw_fitted(cairo_t *cairo, const char *text, double size, bool bold, double x, double y, double width);
/// Copy `text` into `buffer` of `capacity` bytes, truncated with an ellipsis to `width` in the current font.
void text_cut(cairo_t *cairo, const char *text, double width, char *buffer, size_t capacity);

static inline double text_digit_height(double size)
{
    return 0.72 * size;
}

#endif

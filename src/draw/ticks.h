#ifndef DRAW_TICKS_H
#define DRAW_TICKS_H

#include "draw/style.h"

#include <stddef.h>

/// @file
/// Round numbers along an axis.

#define TICKS_MAX 24
#define TICK_LABEL_SIZE 32

/// The ticks of an axis, in increasing order.
typedef struct tick_list
{
    double values[TICKS_MAX];
    bool labelled[TICKS_MAX]; ///< the others are small
    size_t count;
    int decimals; ///< of the labels; negative: as many as each needs
    bool powers;  ///< labels are (multiples of) powers of ten, with an exponent
    int exponent; ///< labels are to be multiplied by this power of ten
} tick_list;

/// Multiples of 1, 2 or 5 times a power of ten within [low, high], about `wanted` of them.
tick_list ticks_linear(double low, double high, double wanted);
/// Take a power of ten out of the labels, a multiple of three, when the numbers are very large or very small.
void ticks_take_exponent(tick_list *ticks, double low, double high);
/// The exponent that ticks_take_exponent() takes out.
int ticks_exponent(double low, double high);
/// Ticks of a logarithmic axis: powers of ten, multiples of these where few powers fit; 0 < low < high.
tick_list ticks_logarithmic(double low, double high, double wanted);

/// The number without the exponent of powers; "10" or "2×10" for those. A true minus sign, no negative zero.
void tick_label(const tick_list *ticks, size_t index, char *label);
/// Width of a label in the current font.
double tick_width(cairo_t *cairo, const tick_list *ticks, size_t index);
/// Draw the label with the point (x, y) at share `align` of its width and the middle of its height.
void tick_draw(cairo_t *cairo, const tick_list *ticks, size_t index, double x, double y, double align);

#endif

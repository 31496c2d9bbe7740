#ifndef DRAW_COMMON_TICKS_H
#define DRAW_COMMON_TICKS_H

#include "draw/common/style.h"

#include <stddef.h>

/// @file
/// Round numbers along an axis.

#define TICKS_MAX 24
#define TICK_LABEL_SIZE 32
#define TICK_SCALE_SIZE 64

/// What labels leave out so that they are short: they show (value - offset) / 10^exponent.
typedef struct tick_scale
{
    double offset;
    int exponent;
} tick_scale;

/// The ticks of an axis, in increasing order.
typedef struct tick_list
{
    double values[TICKS_MAX];
    bool labelled[TICKS_MAX]; ///< the others are small
    size_t count;
    double step;  ///< of linear ticks
    int decimals; ///< of the labels; negative: as many as each needs
    bool powers;  ///< labels are (multiples of) powers of ten, with an exponent
    tick_scale scale;
} tick_list;

/// Multiples of 1, 2 or 5 times a power of ten within [low, high], about `wanted` of them.
tick_list ticks_linear(double low, double high, double wanted);
/// What to leave out of the labels from low to high: a round number where all of them agree in many digits, and a power of
/// ten, a multiple of three, where they are very large or very small.
tick_scale ticks_scale(double low, double high);
/// Leave it out of linear ticks.
void ticks_use_scale(tick_list *ticks, tick_scale scale);
/// What to put beside an axis with such labels: "×10⁻⁶", "+1000000", "×10³ − 5000000"; "" where nothing is left out. `text`
/// has room for TICK_SCALE_SIZE.
void tick_scale_text(tick_scale scale, char *text);
/// Ticks of a logarithmic axis: powers of ten, multiples of these where few powers fit; 0 < low < high.
tick_list ticks_logarithmic(double low, double high, double wanted);

/// The number without the exponent of powers; "10" or "2×10" for those. A true minus sign, no negative zero.
void tick_label(const tick_list *ticks, size_t index, char *label);
/// Width of a label in the current font.
double tick_width(cairo_t *cairo, const tick_list *ticks, size_t index);
/// Draw the label with the point (x, y) at share `align` of its width and the middle of its height.
void tick_draw(cairo_t *cairo, const tick_list *ticks, size_t index, double x, double y, double align);

#endif

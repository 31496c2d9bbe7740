#pragma once

#include "draw/common/style.h"

/// @file
/// Ticks of an axis: round numbers and their labels.

#define TICKS_MAX 24
#define TICK_LABEL_SIZE 32
#define TICK_SCALE_SIZE 64

/// Offset and exponent common to all labels: a label shows (value - offset) / 10^exponent.
typedef struct tick_scale
{
    double offset;
    int exponent;
} tick_scale;

typedef struct tick_list
{
    double values[TICKS_MAX];
    bool labelled[TICKS_MAX]; ///< ticks without labels are short
    size_t count;
    double step;
    int decimals; ///< of the labels
    tick_scale scale;
    /// Draws the label of a value with the middle of its left side at a place, unless that is null. Returns its width. Null:
    /// tick_label().
    double (*label)(cairo_t *cairo, double value, const double place[2]);
} tick_list;

/// About `wanted` ticks within [low, high], at multiples of 1, 2 or 5 times a power of ten.
tick_list ticks_linear(double low, double high, double wanted);
/// The common offset and exponent of labels from `low` to `high`. The offset is a round number if all labels agree in many
/// digits. The exponent is a multiple of three if they are very large or very small.
tick_scale ticks_scale(double low, double high);
/// Apply an offset and an exponent to linear ticks.
void ticks_use_scale(tick_list *ticks, tick_scale scale);
/// The text beside an axis for its offset and exponent: "×10⁻⁶", "+1000000", "×10³ – 5000000", or "". `text` has space for
/// TICK_SCALE_SIZE bytes.
void tick_scale_text(tick_scale scale, char *text);
/// The number 1, 2 or 5 times a power of ten that is nearest to `step` on a logarithmic scale.
double ticks_step(double step);
/// Append a tick, unless there are TICKS_MAX.
void ticks_add(tick_list *ticks, double value, bool labelled);

/// The label of a tick, with an en dash for a minus, no negative zero.
void tick_label(const tick_list *ticks, size_t index, char *label);
double tick_width(cairo_t *cairo, const tick_list *ticks, size_t index);
/// Draw a label with y in the middle of its height and x at the fraction `align` of its width.
void tick_draw(cairo_t *cairo, const tick_list *ticks, size_t index, double x, double y, double align);

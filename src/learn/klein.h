#pragma once

#include "learn/real.h"

#include <stddef.h>

/// @file
/// Layers that commute with two reflections.
///
/// Each of two commuting reflections preserves a number or changes its sign. This gives the four characters of the Klein
/// four-group: preserved by both, by the first alone, by the second alone, by neither. The columns of an array are in four
/// blocks, one per character, in the order of klein_character. A linear layer that commutes with the reflections is one
/// matrix per block, with a bias in the first block alone. A function of single numbers commutes with them when it is
/// applied in the four-group's regular representation; a Hadamard matrix transforms the blocks to it and back (Cohen and
/// Welling 2016, for the smallest group with two generators).

typedef enum klein_character
{
    KLEIN_KEPT,   ///< both preserve it
    KLEIN_SECOND, ///< the second changes its sign
    KLEIN_FIRST,  ///< the first changes its sign
    KLEIN_BOTH,   ///< each changes its sign, so that their product preserves it
    KLEIN_COUNT
} klein_character;

/// The columns of the blocks.
typedef struct klein_widths
{
    size_t of[KLEIN_COUNT];
} klein_widths;

static inline klein_widths klein_equal(size_t width)
{
    return (klein_widths){{width, width, width, width}};
}

static inline size_t klein_total(klein_widths widths)
{
    return widths.of[0] + widths.of[1] + widths.of[2] + widths.of[3];
}

/// GELU in the regular representation for `width` numbers of each block, in place.
__attribute__((always_inline)) static inline void klein_gelu_forward(size_t width, const real *restrict x, real *restrict y)
{
    for (size_t c = 0; c < width; c++)
    {
        real a = x[c], b = x[width + c], d = x[2 * width + c], e = x[3 * width + c];
        real p = (real)0.5 * (a + b), q = (real)0.5 * (a - b), r = (real)0.5 * (d + e), s = (real)0.5 * (d - e);
        real pr = real_gelu(p + r), ps = real_gelu(p - r), qr = real_gelu(q + s), qs = real_gelu(q - s);
        y[c] = (real)0.5 * ((pr + ps) + (qr + qs));
        y[width + c] = (real)0.5 * ((pr + ps) - (qr + qs));
        y[2 * width + c] = (real)0.5 * ((pr - ps) + (qr - qs));
        y[3 * width + c] = (real)0.5 * ((pr - ps) - (qr - qs));
    }
}

#include "curve/network/learned_inference.h"

#include <string.h>

enum
{
    C = LEARNED_CHANNELS,
    FIRST_LAYER = LEARNED_FEATURES * C + C, ///< numbers of a layer: its four weights and its bias
    OTHER_LAYER = LEARNED_WIDTH * C + C,
    OUTPUT_AT = FIRST_LAYER + (LEARNED_LAYERS - 1) * OTHER_LAYER,
};

_Static_assert(LEARNED_CHANNELS % LEARN_PANEL == 0, "a block is whole panels");

/// A layer's block k: inputs x C. In these arrays a block's rows lie together, `rows` x C, and block behind block.
static void linear(const real *weights, klein_widths in, size_t rows, const real *x, size_t stride, bool blocks, real *y)
{
    static const real ZEROS[C];
    const real *bias = weights + klein_total(in) * C;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        learn_packed layer = learn_packed_plain(in.of[k], C, weights, k == KLEIN_KEPT ? bias : ZEROS);
        learn_packed_linear(&layer, rows, x, stride, y + k * rows * C);
        weights += in.of[k] * C;
        x += blocks ? rows * C : in.of[k];
    }
}

/// Whole tiles of rows. Returns the input of the output layer: for each block rows x C.
static const real *forward(const real *weights, size_t rows, learned_scratch *s)
{
    real *x = s->x, *inner = s->inner, *next = s->next;
    size_t size = rows * LEARNED_WIDTH;
    linear(weights, learned_widths(), rows, s->features, LEARNED_FEATURES, false, inner);
    learn_packed_klein_gelu(rows * C, inner, x);
    weights += FIRST_LAYER;
    for (size_t block = 0; block < LEARNED_BLOCKS; block++, weights += 2 * OTHER_LAYER)
    {
        linear(weights, klein_equal(C), rows, x, C, true, inner);
        learn_packed_klein_gelu(rows * C, inner, next);
        linear(weights + OTHER_LAYER, klein_equal(C), rows, next, C, true, inner);
        for (size_t i = 0; i < size; i++)
            x[i] += inner[i];
    }
    learn_packed_klein_gelu(rows * C, x, next);
    return next;
}

static double product(const real *weights, const real *row)
{
    double sum = 0;
    for (size_t c = 0; c < C; c++)
        sum += (double)weights[c] * (double)row[c];
    return sum;
}

void learned_inference_angles(const real *weights, size_t count, const double *angles, const double *lengths,
                              learned_setting setting, double *chosen, learned_scratch *scratch)
{
    const double parity = setting.parity;
    for (size_t done = 0; done < count; done += LEARNED_ROWS)
    {
        size_t rows = count - done < LEARNED_ROWS ? count - done : LEARNED_ROWS, whole = learn_whole_tiles(rows);
        memset(scratch->features + rows * LEARNED_FEATURES, 0, (whole - rows) * LEARNED_FEATURES * sizeof(real));
        for (size_t r = 0; r < rows; r++)
        {
            double features[LEARNED_FEATURES];
            size_t j = done + r;
            setting.parity = j % 2 == 0 ? parity : -parity;
            scratch->edges[r] = learned_features_of(angles + j, lengths + j, setting, features);
            for (size_t i = 0; i < LEARNED_FEATURES; i++)
                scratch->features[r * LEARNED_FEATURES + i] = (real)features[i];
        }
        const real *last = forward(weights, whole, scratch);
        const real *kept = last + KLEIN_KEPT * whole * C, *first = last + KLEIN_FIRST * whole * C;
        for (size_t r = 0; r < rows; r++)
        {
            double correction = product(weights + OUTPUT_AT, first + r * C);
            double gate = product(weights + OUTPUT_AT + C, kept + r * C);
            double angle = learned_angle(scratch->edges[r], correction, gate);
            chosen[done + r] = isnan(angle) ? scratch->edges[r].base : angle;
        }
    }
}

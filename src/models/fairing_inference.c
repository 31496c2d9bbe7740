#include "models/fairing_inference.h"

#include <string.h>

enum
{
    C = FAIRING_CHANNELS,
    FIRST_LAYER = FAIRING_SEEN * C + C, ///< numbers of a layer: its four weights and its bias
    OTHER_LAYER = FAIRING_WIDTH * C + C,
    OUTPUT_AT = FIRST_LAYER + (FAIRING_LAYERS - 1) * OTHER_LAYER,
};

_Static_assert(FAIRING_CHANNELS % LEARN_PANEL == 0, "a block is whole panels");

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

/// Whole tiles of rows. Returns what the output layer sees: rows x C.
static const real *forward(const real *weights, size_t rows, fairing_scratch *s)
{
    real *x = s->x, *inner = s->inner, *next = s->next;
    size_t size = rows * FAIRING_WIDTH;
    linear(weights, fairing_widths(), rows, s->features, FAIRING_SEEN, false, inner);
    learn_packed_klein_gelu(rows * C, inner, x);
    weights += FIRST_LAYER;
    for (size_t block = 0; block < FAIRING_BLOCKS; block++, weights += 2 * OTHER_LAYER)
    {
        linear(weights, klein_equal(C), rows, x, C, true, inner);
        learn_packed_klein_gelu(rows * C, inner, next);
        linear(weights + OTHER_LAYER, klein_equal(C), rows, next, C, true, inner);
        for (size_t i = 0; i < size; i++)
            x[i] += inner[i];
    }
    learn_packed_klein_gelu(rows * C, x, next);
    return next + KLEIN_FIRST * rows * C;
}

static double choose(fairing_sight sight, const real *weights, const real *row)
{
    double said = 0;
    for (size_t c = 0; c < C; c++)
        said += (double)weights[c] * (double)row[c];
    double share = tanh(said);
    return isnan(share) ? sight.base : sight.base + sight.scale * share;
}

void fairing_inference_angles(const real *weights, size_t count, const double *angles, const double *lengths,
                              double curvature, double fairness, double *chosen, fairing_scratch *scratch)
{
    for (size_t done = 0; done < count; done += FAIRING_ROWS)
    {
        size_t rows = count - done < FAIRING_ROWS ? count - done : FAIRING_ROWS, whole = learn_whole_tiles(rows);
        memset(scratch->features + rows * FAIRING_SEEN, 0, (whole - rows) * FAIRING_SEEN * sizeof(real));
        for (size_t r = 0; r < rows; r++)
        {
            double seen[FAIRING_SEEN];
            size_t j = done + r;
            scratch->sights[r] = fairing_see(angles + j, lengths + j, curvature, fairness, seen);
            for (size_t i = 0; i < FAIRING_SEEN; i++)
                scratch->features[r * FAIRING_SEEN + i] = (real)seen[i];
        }
        const real *last = forward(weights, whole, scratch);
        for (size_t r = 0; r < rows; r++)
            chosen[done + r] = choose(scratch->sights[r], weights + OUTPUT_AT, last + r * C);
    }
}

#include "curve/kernel.h"

#include "base/lanes.h"

#include <string.h>

enum
{
    /// Numbers made at a time for each parity: two blocks and what they read stay in the first-level cache.
    BLOCK = 512
};

/// The coefficients of one parity, in the order of the old points: block[t] = sum over k of weights[k] points[t + k dim + start].
typedef struct taps
{
    double weights[BAT_MASK_MAX];
    size_t count;
    ptrdiff_t start; ///< old point that the first weight belongs to, relative to j
} taps;

/// New point 2 j + parity is the sum over m of a(2 m + parity) times old point j - m.
static taps taps_of_parity(const bat_mask *mask, int parity)
{
    taps result = {.count = 0};
    int last = mask->first + (int)mask->count - 1;
    for (int index = last; index >= mask->first; index--)
    {
        double weight = mask->coefficients[index - mask->first];
        if (((index - parity) & 1) != 0 || (weight == 0 && result.count == 0))
            continue;
        if (result.count == 0)
            result.start = -(index - parity) / 2;
        result.weights[result.count++] = weight;
    }
    while (result.count > 0 && result.weights[result.count - 1] == 0)
        result.count--;
    return result;
}

/// block = sum of shifted rows; the common short sums are written out so that a block is written once.
static inline void sum_rows(const taps *t, size_t dim, const double *restrict points, size_t count, double *restrict block)
{
    const double *w = t->weights;
    const double *p = points + t->start * (ptrdiff_t)dim;
    switch (t->count)
    {
    case 1:
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i];
        return;
    case 2:
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i] + w[1] * p[i + dim];
        return;
    case 3:
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i] + w[1] * p[i + dim] + w[2] * p[i + 2 * dim];
        return;
    case 4:
        for (size_t i = 0; i < count; i++)
            block[i] = (w[0] * p[i] + w[3] * p[i + 3 * dim]) + (w[1] * p[i + dim] + w[2] * p[i + 2 * dim]);
        return;
    case 6:
        for (size_t i = 0; i < count; i++)
            block[i] = (w[0] * p[i] + w[5] * p[i + 5 * dim]) + (w[1] * p[i + dim] + w[4] * p[i + 4 * dim]) +
                       (w[2] * p[i + 2 * dim] + w[3] * p[i + 3 * dim]);
        return;
    default:
        memset(block, 0, count * sizeof *block);
        for (size_t k = 0; k < t->count; k++)
            for (size_t i = 0; i < count; i++)
                block[i] += w[k] * p[i + k * dim];
        return;
    }
}

/// Rows of even and odd in turn; a constant dim lets the compiler use whole registers.
static inline void interleave(const double *restrict even, const double *restrict odd, size_t rows, size_t dim,
                              double *restrict fine)
{
    for (size_t j = 0; j < rows; j++)
        for (size_t c = 0; c < dim; c++)
        {
            fine[2 * j * dim + c] = even[j * dim + c];
            fine[(2 * j + 1) * dim + c] = odd[j * dim + c];
        }
}

LANES_CLONES
static void refine_block(const taps *even_taps, const taps *odd_taps, size_t dim, const double *points, size_t rows,
                         double *fine)
{
    double even[BLOCK], odd[BLOCK];
    size_t count = rows * dim;
    sum_rows(even_taps, dim, points, count, even);
    sum_rows(odd_taps, dim, points, count, odd);
    switch (dim)
    {
    case 1:
        interleave(even, odd, rows, 1, fine);
        return;
    case 2:
        interleave(even, odd, rows, 2, fine);
        return;
    case 3:
        interleave(even, odd, rows, 3, fine);
        return;
    default:
        interleave(even, odd, rows, dim, fine);
        return;
    }
}

/// Spaces of more than BLOCK dimensions: one row at a time, straight into place.
static void refine_wide_rows(const taps *even_taps, const taps *odd_taps, size_t dim, const double *points, size_t rows,
                             double *fine)
{
    for (size_t j = 0; j < rows; j++)
    {
        sum_rows(even_taps, dim, points + j * dim, dim, fine + 2 * j * dim);
        sum_rows(odd_taps, dim, points + j * dim, dim, fine + (2 * j + 1) * dim);
    }
}

static bat_status run(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, size_t *fault)
{
    (void)fault;
    size_t dim = kernel->dim;
    taps even = taps_of_parity(&kernel->scheme->mask, 0), odd = taps_of_parity(&kernel->scheme->mask, 1);
    if (dim > BLOCK)
    {
        refine_wide_rows(&even, &odd, dim, points, pairs, fine);
        return BAT_OK;
    }
    size_t rows_at_once = BLOCK / dim;
    for (size_t done = 0; done < pairs; done += rows_at_once)
    {
        size_t rows = pairs - done < rows_at_once ? pairs - done : rows_at_once;
        refine_block(&even, &odd, dim, points + done * dim, rows, fine + 2 * done * dim);
    }
    return BAT_OK;
}

refine_kernel kernel_linear(const bat_scheme *scheme, size_t dim)
{
    return (refine_kernel){
        .scheme = scheme,
        .dim = dim,
        .first = scheme->mask.first,
        .last = scheme->mask.first + (int)scheme->mask.count - 1,
        .run = run,
    };
}

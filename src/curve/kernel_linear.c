#include "curve/kernel.h"

#include "base/lanes.h"

/// Numbers made at a time for each parity: two blocks and what they read stay in the first-level cache.
#define BLOCK 512

/// block = sum of shifted rows; the common short sums are written out so that a block is written once.
static inline void sum_rows(const mask_taps *t, size_t dim, const double *restrict points, size_t count,
                            double *restrict block)
{
    const double *w = t->weights;
    const double *p = points + t->start * (ptrdiff_t)dim;
    if (t->count == 1)
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i];
    else if (t->count == 2)
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i] + w[1] * p[i + dim];
    else if (t->count == 3)
        for (size_t i = 0; i < count; i++)
            block[i] = w[0] * p[i] + w[1] * p[i + dim] + w[2] * p[i + 2 * dim];
    else if (t->count == 4)
        for (size_t i = 0; i < count; i++)
            block[i] = (w[0] * p[i] + w[3] * p[i + 3 * dim]) + (w[1] * p[i + dim] + w[2] * p[i + 2 * dim]);
    else if (t->count == 6)
        for (size_t i = 0; i < count; i++)
            block[i] = (w[0] * p[i] + w[5] * p[i + 5 * dim]) + (w[1] * p[i + dim] + w[4] * p[i + 4 * dim]) +
                       (w[2] * p[i + 2 * dim] + w[3] * p[i + 3 * dim]);
    else
    {
        memset(block, 0, count * sizeof *block);
        for (size_t k = 0; k < t->count; k++)
            for (size_t i = 0; i < count; i++)
                block[i] += w[k] * p[i + k * dim];
    }
}

/// Rows of even and odd in turn.
static inline void interleave(const double *restrict even, const double *restrict odd, size_t rows, size_t dim,
                              double *restrict fine)
{
    for (size_t j = 0; j < rows; j++)
        for (size_t c = 0; c < dim; c++)
        {
            // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): sum_rows() has written rows * dim numbers
            fine[2 * j * dim + c] = even[j * dim + c];
            // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): the same
            fine[(2 * j + 1) * dim + c] = odd[j * dim + c];
        }
}

typedef double vector8 __attribute__((vector_size(64)));

// Where arithmetic is done in a wider type (x87), compilers do not multiply a vector by a number.
#if __FLT_EVAL_METHOD__ == 0
#define SCALED(number, vector) ((number) * (vector))
#else
#define SCALED(x, vector) ((vector8){(x), (x), (x), (x), (x), (x), (x), (x)} * (vector))
#endif

/// Four rows of two numbers at once; `count` is a constant where this is inlined.
static inline void sum_pairs(const double *w, const double *p, size_t count, vector8 *sum)
{
    vector8 term;
    memcpy(&term, p, sizeof term);
    *sum = SCALED(w[0], term);
    for (size_t k = 1; k < count; k++)
    {
        memcpy(&term, p + 2 * k, sizeof term);
        *sum += SCALED(w[k], term);
    }
}

/// Both parities of points of the plane, from registers straight into place, four old points at a time.
static inline void refine_pairs(const mask_taps *even, const mask_taps *odd, size_t even_count, size_t odd_count,
                                const double *restrict points, size_t rows, double *restrict fine)
{
    const double *even_points = points + 2 * even->start, *odd_points = points + 2 * odd->start;
    for (size_t j = 0; j < rows; j += 4)
    {
        vector8 e, o;
        sum_pairs(even->weights, even_points + 2 * j, even_count, &e);
        sum_pairs(odd->weights, odd_points + 2 * j, odd_count, &o);
        vector8 low = __builtin_shufflevector(e, o, 0, 1, 8, 9, 2, 3, 10, 11);
        vector8 high = __builtin_shufflevector(e, o, 4, 5, 12, 13, 6, 7, 14, 15);
        memcpy(fine + 4 * j, &low, sizeof low);
        memcpy(fine + 4 * j + 8, &high, sizeof high);
    }
}

/// refine_pairs() for the masks that people use most: Chaikin and corner cutting, four-point, six-point, cubic B-spline.
/// @return the rows done, a multiple of 4; 0 for other masks
LANES_CLONES
static size_t refine_common_pairs(const mask_taps *even, const mask_taps *odd, const double *points, size_t rows,
                                  double *fine)
{
    size_t whole = rows / 4 * 4;
    if (even->count == 2 && odd->count == 2)
        refine_pairs(even, odd, 2, 2, points, whole, fine);
    else if (even->count == 1 && odd->count == 4)
        refine_pairs(even, odd, 1, 4, points, whole, fine);
    else if (even->count == 1 && odd->count == 6)
        refine_pairs(even, odd, 1, 6, points, whole, fine);
    else if (even->count == 3 && odd->count == 2)
        refine_pairs(even, odd, 3, 2, points, whole, fine);
    else
        return 0;
    return whole;
}

LANES_CLONES
static void refine_block(const mask_taps *even_taps, const mask_taps *odd_taps, size_t dim, const double *points,
                         size_t rows, double *fine)
{
    double even[BLOCK], odd[BLOCK];
    size_t count = rows * dim;
    sum_rows(even_taps, dim, points, count, even);
    sum_rows(odd_taps, dim, points, count, odd);
    if (dim == 1)
        interleave(even, odd, rows, 1, fine);
    else if (dim == 2)
        interleave(even, odd, rows, 2, fine);
    else if (dim == 3)
        interleave(even, odd, rows, 3, fine);
    else
        interleave(even, odd, rows, dim, fine);
}

typedef struct linear_data
{
    mask_taps even, odd;
} linear_data;
_Static_assert(sizeof(linear_data) <= KERNEL_DATA, "a kernel has room for its data");

static bat_status run(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                      void *scratch BAT_UNUSED, size_t *fault BAT_UNUSED)
{
    size_t dim = kernel->dim;
    const linear_data *data = kernel_data_of(kernel);
    const mask_taps *even = &data->even, *odd = &data->odd;
    for (size_t j = 0; j < pairs && dim > BLOCK; j++) // one row at a time, straight into place
    {
        sum_rows(even, dim, points + j * dim, dim, fine + 2 * j * dim);
        sum_rows(odd, dim, points + j * dim, dim, fine + (2 * j + 1) * dim);
    }
    if (dim > BLOCK)
        return BAT_OK;
    size_t rows_at_once = BLOCK / dim;
    for (size_t done = dim == 2 ? refine_common_pairs(even, odd, points, pairs, fine) : 0; done < pairs;
         done += rows_at_once)
    {
        size_t rows = pairs - done < rows_at_once ? pairs - done : rows_at_once;
        refine_block(even, odd, dim, points + done * dim, rows, fine + 2 * done * dim);
    }
    return BAT_OK;
}

refine_kernel kernel_linear(const bat_curve_scheme *scheme, size_t dim)
{
    bat_mask mask = mask_trimmed(&scheme->mask);
    refine_kernel kernel = {.dim = dim, .first = mask.first, .last = mask.first + (int)mask.count - 1, .run = run};
    linear_data *data = kernel_data(&kernel);
    *data = (linear_data){mask_taps_of(&mask, 0), mask_taps_of(&mask, 1)};
    return kernel;
}

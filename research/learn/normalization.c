#include "research/learn/dropout.h"
#include "research/learn/functions.h"
#include "research/learn/operations.h"

#include <assert.h>

/// The context of the backward passes. The statistics of layer norm are those of rows, of batch norm those of columns.
typedef struct normalization
{
    learn_array *x, *gain, *shift, *skip, *y;
    real *mean;
    real *rate;    ///< 1 / deviation
    real *slope;   ///< d y / d (skip + normalized row), rows x columns, where the gelu follows and there is a derivative
    real *scratch; ///< two rows
    bool gelu;     ///< whether it follows
    dropout_mask mask;
} normalization;

// Layer norm: y = (x - mean) rate gain + shift, row by row
//   x and y rows x columns, gain and shift 1 x columns, mean and rate rows

static inline void layer_norm_row(const normalization *n, size_t r)
{
    size_t columns = n->x->columns;
    const real *restrict x = n->x->value + r * columns, *restrict gain = n->gain->value, *restrict shift = n->shift->value;
    real *restrict y = n->y->value + r * columns;
    real mean, rate;
    row_statistics(x, columns, &mean, &rate);
    for (size_t c = 0; c < columns; c++)
        y[c] = (x[c] - mean) * rate * gain[c] + shift[c];
    n->mean[r] = mean;
    n->rate[r] = rate;
}

LANES_CLONES
static void layer_norm_forward(const normalization *n)
{
    for (size_t r = 0; r < n->x->rows; r++)
        layer_norm_row(n, r);
}

/// With du the derivative by the normalized row times gain plus shift, and h the normalized row: dgain += du h,
/// dshift += du, and dx += rate (g - mean(g) - h mean(g h)) for g = du gain. `du` is overwritten, `h` is scratch.
static inline void layer_norm_row_back(size_t columns, const real *restrict x, real mean, real rate,
                                       const real *restrict gain, real *restrict du, real *restrict h, real *restrict dgain,
                                       real *restrict dshift, real *restrict dx)
{
    real sum = 0, sum_h = 0;
#pragma omp simd reduction(+ : sum, sum_h)
    for (size_t c = 0; c < columns; c++)
    {
        real normal = (x[c] - mean) * rate, g = du[c] * gain[c];
        h[c] = normal;
        dgain[c] += du[c] * normal;
        dshift[c] += du[c];
        du[c] = g;
        sum += g;
        sum_h += g * normal;
    }
    real mean_g = sum / (real)columns, mean_gh = sum_h / (real)columns;
    for (size_t c = 0; c < columns; c++)
        dx[c] += rate * (du[c] - mean_g - h[c] * mean_gh);
}

LANES_CLONES
static void layer_norm_backward(void *context)
{
    const normalization *n = context;
    size_t columns = n->x->columns;
    real *du = n->scratch, *h = n->scratch + columns;
    real *dx = learn_gradient(n->x), *dgain = learn_gradient(n->gain), *dshift = learn_gradient(n->shift);
    for (size_t r = 0; r < n->x->rows; r++)
    {
        memcpy(du, n->y->gradient + r * columns, columns * sizeof *du);
        layer_norm_row_back(columns, n->x->value + r * columns, n->mean[r], n->rate[r], n->gain->value, du, h, dgain, dshift,
                            dx + r * columns);
    }
}

// Layer norm with the end of a residual block: y = mask gelu(skip + (x - mean) rate gain + shift)
//   skip rows x columns

/// gelu in place, and its slope if `slope` is not null.
static inline void gelu_rows(size_t count, real *restrict y, real *restrict slope)
{
    if (slope != NULL)
        for (size_t i = 0; i < count; i++)
        {
            real density, u = y[i], below = real_normal(u, &density);
            y[i] = u * below;
            slope[i] = below + u * density;
        }
    else
        for (size_t i = 0; i < count; i++)
            y[i] = real_gelu(y[i]);
}

/// The mask in place, for numbers from `first` on.
static inline void mask_rows(dropout_mask mask, size_t first, size_t count, real *restrict y)
{
    for (size_t i = 0; i < count; i++)
        y[i] *= dropout_factor(mask, (uint32_t)(first + i));
}

LANES_CLONES
static void layer_norm_gelu_forward(const normalization *n)
{
    enum
    {
        RUN = 8 ///< rows that stay in the nearest cache from one stage to the next
    };
    size_t columns = n->x->columns, rows = n->x->rows;
    for (size_t begin = 0; begin < rows; begin += RUN)
    {
        size_t end = rows - begin < RUN ? rows : begin + RUN, first = begin * columns, count = (end - begin) * columns;
        for (size_t r = begin; r < end; r++)
            layer_norm_row(n, r);
        real *restrict y = n->y->value + first;
        if (n->skip != NULL)
            for (size_t i = 0; i < count; i++)
                y[i] += n->skip->value[first + i];
        gelu_rows(count, y, n->slope != NULL ? n->slope + first : NULL);
        if (n->mask.threshold > 0)
            mask_rows(n->mask, first, count, y);
        if (n->mask.threshold > 0 && n->slope != NULL)
            mask_rows(n->mask, first, count, n->slope + first);
    }
}

LANES_CLONES
static void layer_norm_gelu_backward(void *context)
{
    const normalization *n = context;
    size_t columns = n->x->columns;
    real *restrict du = n->scratch, *h = n->scratch + columns;
    real *dx = learn_gradient(n->x), *dgain = learn_gradient(n->gain), *dshift = learn_gradient(n->shift);
    real *dskip = n->skip != NULL && learn_wants(n->skip) ? learn_gradient(n->skip) : NULL;
    for (size_t r = 0; r < n->x->rows; r++)
    {
        const real *restrict dy = n->y->gradient + r * columns, *restrict slope = n->slope + r * columns;
        for (size_t c = 0; c < columns; c++)
            du[c] = dy[c] * slope[c];
        if (dskip != NULL)
            for (size_t c = 0; c < columns; c++)
                dskip[r * columns + c] += du[c];
        layer_norm_row_back(columns, n->x->value + r * columns, n->mean[r], n->rate[r], n->gain->value, du, h, dgain, dshift,
                            dx + r * columns);
    }
}

// Batch norm: the same as layer norm, but the statistics are those of columns
//   mean and rate columns

LANES_CLONES
static void batch_norm_forward(const normalization *n)
{
    size_t rows = n->x->rows, columns = n->x->columns;
    const real *restrict x = n->x->value, *restrict gain = n->gain->value, *restrict shift = n->shift->value;
    real *restrict mean = n->mean, *restrict rate = n->rate, *restrict y = n->y->value;
    memset(mean, 0, columns * sizeof *mean);
    memset(rate, 0, columns * sizeof *rate);
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            mean[c] += x[r * columns + c];
    for (size_t c = 0; c < columns; c++)
        mean[c] /= (real)rows;
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            rate[c] += (x[r * columns + c] - mean[c]) * (x[r * columns + c] - mean[c]);
    for (size_t c = 0; c < columns; c++)
        rate[c] = 1 / real_sqrt(rate[c] / (real)rows + NORMALIZATION_EPSILON);
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
            y[r * columns + c] = (x[r * columns + c] - mean[c]) * rate[c] * gain[c] + shift[c];
}

/// With h the normalized column: sums dy and dy h, then dx += rate gain (dy - mean(dy) - h mean(dy h)).
LANES_CLONES
static void batch_norm_backward(void *context)
{
    const normalization *n = context;
    size_t rows = n->x->rows, columns = n->x->columns;
    const real *restrict x = n->x->value, *restrict dy = n->y->gradient, *restrict gain = n->gain->value;
    const real *restrict mean = n->mean, *restrict rate = n->rate;
    real *restrict sum = n->scratch, *restrict sum_h = n->scratch + columns, *restrict dx = learn_gradient(n->x);
    memset(sum, 0, 2 * columns * sizeof *sum);
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
        {
            size_t i = r * columns + c;
            sum[c] += dy[i];
            sum_h[c] += dy[i] * ((x[i] - mean[c]) * rate[c]);
        }
    real *dgain = learn_gradient(n->gain), *dshift = learn_gradient(n->shift);
    for (size_t c = 0; c < columns; c++)
    {
        dgain[c] += sum_h[c];
        dshift[c] += sum[c];
        sum[c] /= (real)rows;
        sum_h[c] /= (real)rows;
    }
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++)
        {
            size_t i = r * columns + c;
            dx[i] += rate[c] * gain[c] * (dy[i] - sum[c] - (x[i] - mean[c]) * rate[c] * sum_h[c]);
        }
}

// Common to the three. If one derivative is needed, all are computed; `unused` receives the others.

static learn_array *with_gradient(learn_tape *tape, learn_array *x)
{
    if (learn_wants(x))
        return x;
    learn_array *unused = learn_tape_memory(tape, 1, sizeof *unused);
    real *gradient = learn_tape_memory(tape, learn_size(x), sizeof *gradient);
    if (gradient == NULL)
        return &tape->nothing;
    *unused = *x;
    unused->gradient = gradient;
    unused->begun = false;
    return unused;
}

static learn_array *normalize(learn_tape *tape, normalization n, size_t statistics, void (*forward)(const normalization *),
                              learn_backward *backward)
{
    bool wants = learn_wants(n.x) || learn_wants(n.gain) || learn_wants(n.shift) || (n.skip != NULL && learn_wants(n.skip));
    size_t rows = n.x->rows, columns = n.x->columns;
    n.y = learn_array_make(tape, rows, columns, wants);
    n.mean = learn_tape_memory(tape, statistics, sizeof *n.mean);
    n.rate = learn_tape_memory(tape, statistics, sizeof *n.rate);
    n.scratch = learn_tape_memory(tape, columns, 2 * sizeof *n.scratch);
    n.slope = n.gelu && wants ? learn_tape_memory(tape, learn_size(n.y), sizeof *n.slope) : NULL;
    if (tape->status != BAT_OK)
        return &tape->nothing;
    assert(columns > 0 && n.gain->columns == columns && n.shift->columns == columns);
    assert(n.skip == NULL || (n.skip->rows == rows && n.skip->columns == columns));
    if (rows == 0)
        return n.y;
    forward(&n);
    if (!wants)
        return n.y;
    n.x = with_gradient(tape, n.x);
    n.gain = with_gradient(tape, n.gain);
    n.shift = with_gradient(tape, n.shift);
    normalization *context = learn_tape_memory(tape, 1, sizeof *context);
    if (context == NULL)
        return &tape->nothing;
    *context = n;
    learn_tape_record(tape, n.y, backward, context);
    return n.y;
}

learn_array *learn_layer_norm(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift)
{
    return normalize(tape, (normalization){.x = x, .gain = gain, .shift = shift}, x->rows, layer_norm_forward,
                     layer_norm_backward);
}

learn_array *learn_layer_norm_gelu(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift,
                                   learn_array *skip, double dropout)
{
    assert(dropout >= 0 && dropout < 1);
    normalization n = {
        .x = x, .gain = gain, .shift = shift, .skip = skip, .gelu = true, .mask = dropout_next(tape, dropout)};
    return normalize(tape, n, x->rows, layer_norm_gelu_forward, layer_norm_gelu_backward);
}

learn_array *learn_batch_norm(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift)
{
    return normalize(tape, (normalization){.x = x, .gain = gain, .shift = shift}, x->columns, batch_norm_forward,
                     batch_norm_backward);
}

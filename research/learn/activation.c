#include "research/learn/dropout.h"
#include "research/learn/functions.h"
#include "research/learn/operations.h"

#include <assert.h>

// Functions of one number, element by element. Each has y = f(x) forward and dx += dy f'(x) backward, for `count` numbers.

typedef struct unary
{
    learn_array *x, *y;
    real low, high; ///< of an interval; `low` is the factor of a scale, the number that is added
    dropout_mask mask;
} unary;

typedef void unary_kernel(const unary *u, size_t count, const real *x, real *y);
typedef void unary_slope(const unary *u, size_t count, const real *x, const real *y, const real *dy, real *dx);

static learn_array *apply(learn_tape *tape, unary u, unary_kernel *forward, learn_backward *backward)
{
    learn_array *y = learn_array_make(tape, u.x->rows, u.x->columns, learn_wants(u.x));
    if (tape->status != BAT_OK)
        return y;
    forward(&u, learn_size(y), u.x->value, y->value);
    unary *context = learn_wants(y) ? learn_tape_memory(tape, 1, sizeof *context) : NULL;
    if (context == NULL)
        return y;
    *context = u;
    context->y = y;
    learn_tape_record(tape, y, backward, context);
    return y;
}

static void apply_back(const unary *u, unary_slope *slope)
{
    slope(u, learn_size(u->x), u->x->value, u->y->value, u->y->gradient, learn_gradient(u->x));
}

LANES_CLONES
static void gelu_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    (void)u;
    for (size_t i = 0; i < count; i++)
        y[i] = real_gelu(x[i]);
}

LANES_CLONES
static void gelu_slope(const unary *u, size_t count, const real *restrict x, const real *y, const real *restrict dy,
                       real *restrict dx)
{
    (void)u;
    (void)y;
    for (size_t i = 0; i < count; i++)
        dx[i] += dy[i] * real_gelu_slope(x[i]);
}

static void gelu_back(void *context)
{
    apply_back(context, gelu_slope);
}

learn_array *learn_gelu(learn_tape *tape, learn_array *x)
{
    return apply(tape, (unary){.x = x}, gelu_forward, gelu_back);
}

LANES_CLONES
static void relu_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    (void)u;
    for (size_t i = 0; i < count; i++)
        y[i] = x[i] > 0 ? x[i] : 0;
}

LANES_CLONES
static void relu_slope(const unary *u, size_t count, const real *restrict x, const real *y, const real *restrict dy,
                       real *restrict dx)
{
    (void)u;
    (void)y;
    for (size_t i = 0; i < count; i++)
        dx[i] += x[i] > 0 ? dy[i] : 0;
}

static void relu_back(void *context)
{
    apply_back(context, relu_slope);
}

learn_array *learn_relu(learn_tape *tape, learn_array *x)
{
    return apply(tape, (unary){.x = x}, relu_forward, relu_back);
}

LANES_CLONES
static void tanh_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    (void)u;
    for (size_t i = 0; i < count; i++)
        y[i] = real_tanh(x[i]);
}

LANES_CLONES
static void tanh_slope(const unary *u, size_t count, const real *x, const real *restrict y, const real *restrict dy,
                       real *restrict dx)
{
    (void)u;
    (void)x;
    for (size_t i = 0; i < count; i++)
        dx[i] += dy[i] * (1 - y[i] * y[i]);
}

static void tanh_back(void *context)
{
    apply_back(context, tanh_slope);
}

learn_array *learn_tanh(learn_tape *tape, learn_array *x)
{
    return apply(tape, (unary){.x = x}, tanh_forward, tanh_back);
}

LANES_CLONES
static void interval_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    real low = u->low, width = u->high - u->low;
    for (size_t i = 0; i < count; i++)
        y[i] = low + width * real_sigmoid(x[i]);
}

LANES_CLONES
static void interval_slope(const unary *u, size_t count, const real *restrict x, const real *y, const real *restrict dy,
                           real *restrict dx)
{
    (void)y;
    real width = u->high - u->low;
    for (size_t i = 0; i < count; i++)
    {
        real s = real_sigmoid(x[i]);
        dx[i] += dy[i] * (width * s * (1 - s));
    }
}

static void interval_back(void *context)
{
    apply_back(context, interval_slope);
}

learn_array *learn_interval(learn_tape *tape, learn_array *x, real low, real high)
{
    return apply(tape, (unary){.x = x, .low = low, .high = high}, interval_forward, interval_back);
}

learn_array *learn_sigmoid(learn_tape *tape, learn_array *x)
{
    return learn_interval(tape, x, 0, 1);
}

LANES_CLONES
static void dropout_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    dropout_mask mask = u->mask;
    for (size_t i = 0; i < count; i++)
        y[i] = x[i] * dropout_factor(mask, (uint32_t)i);
}

LANES_CLONES
static void dropout_slope(const unary *u, size_t count, const real *x, const real *y, const real *restrict dy,
                          real *restrict dx)
{
    (void)x;
    (void)y;
    dropout_mask mask = u->mask;
    for (size_t i = 0; i < count; i++)
        dx[i] += dy[i] * dropout_factor(mask, (uint32_t)i);
}

static void dropout_back(void *context)
{
    apply_back(context, dropout_slope);
}

learn_array *learn_dropout(learn_tape *tape, learn_array *x, double rate)
{
    assert(rate >= 0 && rate < 1);
    dropout_mask mask = dropout_next(tape, rate);
    return mask.threshold == 0 ? x : apply(tape, (unary){.x = x, .mask = mask}, dropout_forward, dropout_back);
}

LANES_CLONES
static void scale_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    real factor = u->low;
    for (size_t i = 0; i < count; i++)
        y[i] = factor * x[i];
}

LANES_CLONES
static void scale_slope(const unary *u, size_t count, const real *x, const real *y, const real *restrict dy,
                        real *restrict dx)
{
    (void)x;
    (void)y;
    real factor = u->low;
    for (size_t i = 0; i < count; i++)
        dx[i] += factor * dy[i];
}

static void scale_back(void *context)
{
    apply_back(context, scale_slope);
}

learn_array *learn_scale(learn_tape *tape, learn_array *x, real factor)
{
    return apply(tape, (unary){.x = x, .low = factor}, scale_forward, scale_back);
}

static void add_number_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = x[i] + u->low;
}

static void add_number_slope(const unary *u, size_t count, const real *x, const real *y, const real *restrict dy,
                             real *restrict dx)
{
    (void)u;
    (void)x;
    (void)y;
    for (size_t i = 0; i < count; i++)
        dx[i] += dy[i];
}

static void add_number_back(void *context)
{
    apply_back(context, add_number_slope);
}

learn_array *learn_add_number(learn_tape *tape, learn_array *x, real number)
{
    return apply(tape, (unary){.x = x, .low = number}, add_number_forward, add_number_back);
}

static void log_forward(const unary *u, size_t count, const real *restrict x, real *restrict y)
{
    (void)u;
    for (size_t i = 0; i < count; i++)
        y[i] = (real)log((double)x[i]);
}

static void log_slope(const unary *u, size_t count, const real *restrict x, const real *y, const real *restrict dy,
                      real *restrict dx)
{
    (void)u;
    (void)y;
    for (size_t i = 0; i < count; i++)
        dx[i] += dy[i] / x[i];
}

static void log_back(void *context)
{
    apply_back(context, log_slope);
}

learn_array *learn_log(learn_tape *tape, learn_array *x)
{
    return apply(tape, (unary){.x = x}, log_forward, log_back);
}

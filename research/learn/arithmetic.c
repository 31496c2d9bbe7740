#include "research/learn/functions.h"
#include "research/learn/operations.h"

#include <assert.h>

// Two arrays of the same shape, element by element: z = x + factor y, and z = x y. Then sums over whole arrays and rows.

typedef struct binary
{
    learn_array *x, *y, *z;
    real factor;
} binary;

/// z += factor x, `count` numbers.
LANES_CLONES
static void add_scaled(size_t count, real factor, const real *restrict x, real *restrict z)
{
    for (size_t i = 0; i < count; i++)
        z[i] += factor * x[i];
}

/// z += x y
LANES_CLONES
static void add_product(size_t count, const real *x, const real *restrict y, real *restrict z)
{
    for (size_t i = 0; i < count; i++)
        z[i] += x[i] * y[i];
}

static learn_array *combine(learn_tape *tape, binary b, void (*forward)(const binary *), learn_backward *backward)
{
    bool wants = learn_wants(b.x) || (b.y != NULL && learn_wants(b.y));
    if (tape->status != BAT_OK)
        return &tape->nothing;
    forward(&b);
    binary *context = wants ? learn_tape_memory(tape, 1, sizeof *context) : NULL;
    if (context != NULL)
    {
        *context = b;
        learn_tape_record(tape, b.z, backward, context);
    }
    return b.z;
}

static learn_array *same_shape(learn_tape *tape, const learn_array *x, const learn_array *y)
{
    assert(tape->status != BAT_OK || (x->rows == y->rows && x->columns == y->columns));
    return learn_array_make(tape, x->rows, x->columns, learn_wants(x) || learn_wants(y));
}

// z = x + factor y

static void sum_forward(const binary *b)
{
    memcpy(b->z->value, b->x->value, learn_size(b->z) * sizeof *b->z->value);
    add_scaled(learn_size(b->z), b->factor, b->y->value, b->z->value);
}

static void sum_backward(void *context)
{
    const binary *b = context;
    if (learn_wants(b->x))
        add_scaled(learn_size(b->z), 1, b->z->gradient, learn_gradient(b->x));
    if (learn_wants(b->y))
        add_scaled(learn_size(b->z), b->factor, b->z->gradient, learn_gradient(b->y));
}

learn_array *learn_add(learn_tape *tape, learn_array *x, learn_array *y)
{
    return combine(tape, (binary){.x = x, .y = y, .z = same_shape(tape, x, y), .factor = 1}, sum_forward, sum_backward);
}

learn_array *learn_subtract(learn_tape *tape, learn_array *x, learn_array *y)
{
    return combine(tape, (binary){.x = x, .y = y, .z = same_shape(tape, x, y), .factor = -1}, sum_forward, sum_backward);
}

// z = x y

static void product_forward(const binary *b)
{
    memset(b->z->value, 0, learn_size(b->z) * sizeof *b->z->value);
    add_product(learn_size(b->z), b->x->value, b->y->value, b->z->value);
}

static void product_backward(void *context)
{
    const binary *b = context;
    if (learn_wants(b->x))
        add_product(learn_size(b->z), b->z->gradient, b->y->value, learn_gradient(b->x));
    if (learn_wants(b->y))
        add_product(learn_size(b->z), b->z->gradient, b->x->value, learn_gradient(b->y));
}

learn_array *learn_multiply(learn_tape *tape, learn_array *x, learn_array *y)
{
    return combine(tape, (binary){.x = x, .y = y, .z = same_shape(tape, x, y)}, product_forward, product_backward);
}

// z = factor times the sum of x: 1 x 1

static void total_forward(const binary *b)
{
    double sum = 0;
    for (size_t i = 0; i < learn_size(b->x); i++)
        sum += (double)b->x->value[i];
    *b->z->value = (real)sum;
}

static void total_backward(void *context)
{
    const binary *b = context;
    real *dx = learn_gradient(b->x), dz = *b->z->gradient;
    for (size_t i = 0; i < learn_size(b->x); i++)
        dx[i] += dz;
}

learn_array *learn_sum(learn_tape *tape, learn_array *x)
{
    return combine(tape, (binary){.x = x, .z = learn_array_make(tape, 1, 1, learn_wants(x))}, total_forward, total_backward);
}

// z = factor times the sum of (x - y)^2: 1 x 1; y is 0 if it is missing

static void squares_forward(const binary *b)
{
    double sum = 0;
    for (size_t i = 0; i < learn_size(b->x); i++)
    {
        double difference = (double)b->x->value[i] - (b->y != NULL ? (double)b->y->value[i] : 0);
        sum += difference * difference;
    }
    *b->z->value = (real)((double)b->factor * sum);
}

static void squares_backward(void *context)
{
    const binary *b = context;
    real slope = 2 * b->factor * *b->z->gradient;
    size_t count = learn_size(b->x);
    if (learn_wants(b->x))
    {
        add_scaled(count, slope, b->x->value, learn_gradient(b->x));
        if (b->y != NULL)
            add_scaled(count, -slope, b->y->value, learn_gradient(b->x));
    }
    if (b->y != NULL && learn_wants(b->y))
    {
        add_scaled(count, slope, b->y->value, learn_gradient(b->y));
        add_scaled(count, -slope, b->x->value, learn_gradient(b->y));
    }
}

static learn_array *squares(learn_tape *tape, learn_array *x, learn_array *y, real factor)
{
    assert(y == NULL || tape->status != BAT_OK || (x->rows == y->rows && x->columns == y->columns));
    learn_array *z = learn_array_make(tape, 1, 1, learn_wants(x) || (y != NULL && learn_wants(y)));
    return combine(tape, (binary){.x = x, .y = y, .z = z, .factor = factor}, squares_forward, squares_backward);
}

learn_array *learn_sum_of_squares(learn_tape *tape, learn_array *x)
{
    return squares(tape, x, NULL, 1);
}

/// 1 / size, and 0 for nothing.
static real share_of(const learn_array *x)
{
    return learn_size(x) > 0 ? 1 / (real)learn_size(x) : 0;
}

learn_array *learn_mean_of_squares(learn_tape *tape, learn_array *x)
{
    return squares(tape, x, NULL, share_of(x));
}

learn_array *learn_mean_squared_error(learn_tape *tape, learn_array *x, learn_array *y)
{
    return squares(tape, x, y, share_of(x));
}

// z = the norms of the rows of x: rows x 1

static void norms_forward(const binary *b)
{
    size_t columns = b->x->columns;
    for (size_t r = 0; r < b->x->rows; r++)
    {
        const real *x = b->x->value + r * columns;
        real squares = 0;
        for (size_t c = 0; c < columns; c++)
            squares += x[c] * x[c];
        b->z->value[r] = real_sqrt(squares);
    }
}

static void norms_backward(void *context)
{
    const binary *b = context;
    size_t columns = b->x->columns;
    real *dx = learn_gradient(b->x);
    for (size_t r = 0; r < b->x->rows; r++)
    {
        real norm = b->z->value[r];
        if (norm > 0)
            add_scaled(columns, b->z->gradient[r] / norm, b->x->value + r * columns, dx + r * columns);
    }
}

learn_array *learn_row_norms(learn_tape *tape, learn_array *x)
{
    learn_array *z = learn_array_make(tape, x->rows, 1, learn_wants(x));
    return combine(tape, (binary){.x = x, .z = z}, norms_forward, norms_backward);
}

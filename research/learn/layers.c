#include "learn/blas.h"
#include "research/learn/operations.h"

#include <assert.h>

// Linear layer: y = x W^T + b
//   x rows x inputs, W outputs x inputs, b 1 x outputs, y rows x outputs

typedef struct linear
{
    learn_array *x, *weight, *bias, *y;
    bool rectified; ///< y = max(0, x W^T + b)
} linear;

LANES_CLONES
static void rectify(size_t count, real *y)
{
    for (size_t i = 0; i < count; i++)
        y[i] = y[i] > 0 ? y[i] : 0;
}

/// The gradient before rectify().
LANES_CLONES
static void rectify_back(size_t count, const real *restrict y, real *restrict gradient)
{
    for (size_t i = 0; i < count; i++)
        gradient[i] = y[i] > 0 ? gradient[i] : 0;
}

static void linear_forward(const linear *l)
{
    int rows = (int)l->x->rows, inputs = (int)l->x->columns, outputs = (int)l->y->columns;
    const real *x = l->x->value, *weight = l->weight->value;
    real *y = l->y->value;
    // The product is added to the bias in place.
    if (l->bias != NULL)
        for (size_t r = 0; r < l->y->rows; r++)
            memcpy(y + r * l->y->columns, l->bias->value, l->y->columns * sizeof *y);
    real beta = l->bias != NULL ? 1 : 0;
    if (outputs == 1)
        REAL_GEMV(CblasRowMajor, CblasNoTrans, rows, inputs, 1, x, inputs, weight, 1, beta, y, 1);
    else
        REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, rows, outputs, inputs, 1, x, inputs, weight, inputs, beta, y,
                  outputs);
    if (l->rectified)
        rectify(learn_size(l->y), y);
}

/// sums[c] += the sum of column c
LANES_CLONES
static void add_column_sums(size_t rows, size_t columns, const real *restrict x, real *restrict sums)
{
    size_t r = 0;
    for (; r + 4 <= rows; r += 4)
    {
        const real *a = x + r * columns, *b = a + columns, *c = b + columns, *d = c + columns;
        for (size_t k = 0; k < columns; k++)
            sums[k] += (a[k] + b[k]) + (c[k] + d[k]);
    }
    for (; r < rows; r++)
        for (size_t k = 0; k < columns; k++)
            sums[k] += x[r * columns + k];
}

/// dW += dy^T x, db += column sums of dy, dx += dy W
static void linear_backward(void *context)
{
    const linear *l = context;
    int rows = (int)l->x->rows, inputs = (int)l->x->columns, outputs = (int)l->y->columns;
    const real *x = l->x->value, *weight = l->weight->value, *dy = l->y->gradient;
    // The gradient of y is not used after this.
    if (l->rectified)
        rectify_back(learn_size(l->y), l->y->value, l->y->gradient);
    if (learn_wants(l->weight))
    {
        real *dweight = learn_gradient(l->weight);
        if (outputs == 1)
            REAL_GEMV(CblasRowMajor, CblasTrans, rows, inputs, 1, x, inputs, dy, 1, 1, dweight, 1);
        else
            REAL_GEMM(CblasRowMajor, CblasTrans, CblasNoTrans, outputs, inputs, rows, 1, dy, outputs, x, inputs, 1, dweight,
                      inputs);
    }
    if (l->bias != NULL && learn_wants(l->bias))
        add_column_sums(l->y->rows, l->y->columns, dy, learn_gradient(l->bias));
    if (!learn_wants(l->x))
        return;
    // The first contribution to this gradient is written, not added to zeros.
    real beta = l->x->begun ? 1 : 0;
    l->x->begun = true;
    REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, inputs, outputs, 1, dy, outputs, weight, inputs, beta,
              l->x->gradient, inputs);
}

static learn_array *apply(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias, bool rectified)
{
    bool wants = learn_wants(x) || learn_wants(weight) || (bias != NULL && learn_wants(bias));
    learn_array *y = learn_array_make(tape, x->rows, weight->rows, wants);
    if (tape->status != BAT_OK)
        return y;
    assert(x->columns == weight->columns && (bias == NULL || bias->columns == weight->rows));
    linear l = {.x = x, .weight = weight, .bias = bias, .y = y, .rectified = rectified};
    if (learn_size(y) > 0)
        linear_forward(&l);
    linear *context = wants && learn_size(y) > 0 ? learn_tape_memory(tape, 1, sizeof *context) : NULL;
    if (context != NULL)
    {
        *context = l;
        learn_tape_record(tape, y, linear_backward, context);
    }
    return y;
}

learn_array *learn_linear(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias)
{
    return apply(tape, x, weight, bias, false);
}

learn_array *learn_linear_relu(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias)
{
    return apply(tape, x, weight, bias, true);
}

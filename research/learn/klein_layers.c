#include "research/learn/klein_layers.h"

#include "learn/blas.h"
#include "research/learn/functions.h"

#include <assert.h>

// Linear layer: y_k = x_k W_k for the blocks k, y_0 += b
//   x_k rows x in_k, W_k in_k x out_k, b 1 x out_0, y_k rows x out_k

typedef struct klein_linear
{
    learn_array *x, *y, *bias, *weights[KLEIN_COUNT];
    klein_widths in, out;
} klein_linear;

static void linear_forward(const klein_linear *l)
{
    int rows = (int)l->x->rows, x_stride = (int)l->x->columns, y_stride = (int)l->y->columns;
    const real *x = l->x->value;
    real *y = l->y->value;
    if (l->bias != NULL)
        for (size_t r = 0; r < l->y->rows; r++)
            memcpy(y + r * l->y->columns, l->bias->value, l->bias->columns * sizeof *y);
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        int in = (int)l->in.of[k], out = (int)l->out.of[k];
        real beta = k == KLEIN_KEPT && l->bias != NULL ? 1 : 0;
        if (in > 0 && out > 0)
            REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, out, in, 1, x, x_stride, l->weights[k]->value, out,
                      beta, y, y_stride);
        x += in;
        y += out;
    }
}

/// dW_k += x_k^T dy_k, db += column sums of dy_0, dx_k += dy_k W_k^T
static void linear_backward(void *context)
{
    const klein_linear *l = context;
    int rows = (int)l->x->rows, x_stride = (int)l->x->columns, y_stride = (int)l->y->columns;
    const real *x = l->x->value, *dy = l->y->gradient;
    if (l->bias != NULL && learn_wants(l->bias))
    {
        real *dbias = learn_gradient(l->bias);
        for (size_t r = 0; r < l->y->rows; r++)
            for (size_t c = 0; c < l->bias->columns; c++)
                dbias[c] += dy[r * l->y->columns + c];
    }
    real *dx = learn_wants(l->x) ? l->x->gradient : NULL, beta = l->x->begun ? 1 : 0;
    l->x->begun = true;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        int in = (int)l->in.of[k], out = (int)l->out.of[k];
        if (in > 0 && out > 0 && learn_wants(l->weights[k]))
            REAL_GEMM(CblasRowMajor, CblasTrans, CblasNoTrans, in, out, rows, 1, x, x_stride, dy, y_stride, 1,
                      learn_gradient(l->weights[k]), out);
        if (dx != NULL && in > 0)
        {
            if (out > 0)
                REAL_GEMM(CblasRowMajor, CblasNoTrans, CblasTrans, rows, in, out, 1, dy, y_stride, l->weights[k]->value, out,
                          beta, dx, x_stride);
            dx += in;
        }
        x += in;
        dy += out;
    }
}

learn_array *learn_klein_linear(learn_tape *tape, learn_array *x, klein_widths in, klein_widths out,
                                learn_array *const weights[KLEIN_COUNT], learn_array *bias)
{
    learn_array *y = learn_array_make(tape, x->rows, klein_total(out), true);
    if (tape->status != BAT_OK)
        return y;
    assert(x->columns == klein_total(in) && (bias == NULL || bias->columns == out.of[KLEIN_KEPT]));
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        assert(weights[k]->rows == in.of[k] && weights[k]->columns == out.of[k] && in.of[k] > 0 && out.of[k] > 0);
    klein_linear l = {.x = x, .y = y, .bias = bias, .in = in, .out = out};
    memcpy(l.weights, weights, sizeof l.weights);
    linear_forward(&l);
    klein_linear *context = learn_tape_memory(tape, 1, sizeof *context);
    if (context == NULL)
        return y;
    *context = l;
    learn_tape_record(tape, y, linear_backward, context);
    return y;
}

// GELU in the regular representation: y = H gelu(H x) with the Hadamard matrix H = H^-1 = H^T of each channel's four numbers

typedef struct klein_gelu
{
    learn_array *x, *y;
} klein_gelu;

LANES_CLONES
static void gelu_forward(size_t rows, size_t width, const real *restrict x, real *restrict y)
{
    for (size_t r = 0; r < rows; r++)
        klein_gelu_forward(width, x + r * KLEIN_COUNT * width, y + r * KLEIN_COUNT * width);
}

LANES_CLONES
static void gelu_slope(size_t rows, size_t width, const real *restrict all_x, const real *restrict all_dy,
                       real *restrict all_dx)
{
    const real half = (real)0.5;
    for (size_t row = 0; row < rows; row++)
    {
        const real *x = all_x + row * KLEIN_COUNT * width, *dy = all_dy + row * KLEIN_COUNT * width;
        real *dx = all_dx + row * KLEIN_COUNT * width;
        for (size_t c = 0; c < width; c++)
        {
            real a = x[c], b = x[width + c], d = x[2 * width + c], e = x[3 * width + c];
            real p = half * (a + b), q = half * (a - b), r = half * (d + e), s = half * (d - e);
            real da = dy[c], db = dy[width + c], dd = dy[2 * width + c], de = dy[3 * width + c];
            real dp = half * (da + db), dq = half * (da - db), dr = half * (dd + de), ds = half * (dd - de);
            real pr = (dp + dr) * real_gelu_slope(p + r), ps = (dp - dr) * real_gelu_slope(p - r);
            real qr = (dq + ds) * real_gelu_slope(q + s), qs = (dq - ds) * real_gelu_slope(q - s);
            dx[c] += half * ((pr + ps) + (qr + qs));
            dx[width + c] += half * ((pr + ps) - (qr + qs));
            dx[2 * width + c] += half * ((pr - ps) + (qr - qs));
            dx[3 * width + c] += half * ((pr - ps) - (qr - qs));
        }
    }
}

static void gelu_backward(void *context)
{
    const klein_gelu *g = context;
    gelu_slope(g->x->rows, g->x->columns / KLEIN_COUNT, g->x->value, g->y->gradient, learn_gradient(g->x));
}

learn_array *learn_klein_gelu(learn_tape *tape, learn_array *x)
{
    learn_array *y = learn_array_make(tape, x->rows, x->columns, learn_wants(x));
    if (tape->status != BAT_OK)
        return y;
    assert(x->columns % KLEIN_COUNT == 0);
    gelu_forward(x->rows, x->columns / KLEIN_COUNT, x->value, y->value);
    klein_gelu *context = learn_wants(y) ? learn_tape_memory(tape, 1, sizeof *context) : NULL;
    if (context == NULL)
        return y;
    *context = (klein_gelu){x, y};
    learn_tape_record(tape, y, gelu_backward, context);
    return y;
}

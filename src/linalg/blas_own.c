#include "linalg/blas.h"

#include "batten/base.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>

// A matrix from the left is read by rows, so that the inner loop runs over contiguous numbers in vector instructions.

static size_t row_step(CBLAS_TRANSPOSE trans, int stride)
{
    return trans == CblasNoTrans ? (size_t)stride : 1;
}

static size_t column_step(CBLAS_TRANSPOSE trans, int stride)
{
    return trans == CblasNoTrans ? 1 : (size_t)stride;
}

// `number` is a type, which parentheses cannot enclose.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define DEFINE_PRODUCTS(number, own_gemm, own_gemv, scale_row, add_row)                                                     \
    static void scale_row(size_t n, number factor, number *y)                                                               \
    {                                                                                                                       \
        for (size_t i = 0; i < n; i++)                                                                                      \
            y[i] = factor == 0 ? 0 : factor * y[i];                                                                         \
    }                                                                                                                       \
    static void add_row(size_t n, number factor, const number *x, size_t step, number *y)                                   \
    {                                                                                                                       \
        for (size_t i = 0; i < n; i++)                                                                                      \
            y[i] += factor * x[i * step];                                                                                   \
    }                                                                                                                       \
    void own_gemm(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans_a, CBLAS_TRANSPOSE trans_b, int m, int n, int k, number alpha, \
                  const number *a, int stride_a, const number *b, int stride_b, number beta, number *c, int stride_c)       \
    {                                                                                                                       \
        (void)layout;                                                                                                       \
        size_t a_row = row_step(trans_a, stride_a), a_step = column_step(trans_a, stride_a);                                \
        size_t b_row = row_step(trans_b, stride_b), b_step = column_step(trans_b, stride_b);                                \
        for (size_t i = 0; i < (size_t)m; i++)                                                                              \
        {                                                                                                                   \
            number *row = c + i * (size_t)stride_c;                                                                         \
            scale_row((size_t)n, beta, row);                                                                                \
            for (size_t l = 0; l < (size_t)k; l++)                                                                          \
                add_row((size_t)n, alpha *a[i * a_row + l * a_step], b + l * b_row, b_step, row);                           \
        }                                                                                                                   \
    }                                                                                                                       \
    void own_gemv(CBLAS_LAYOUT layout, CBLAS_TRANSPOSE trans, int m, int n, number alpha, const number *a, int stride,      \
                  const number *x, int x_increment, number beta, number *y, int y_increment)                                \
    {                                                                                                                       \
        (void)layout;                                                                                                       \
        assert(x_increment == 1 && y_increment == 1);                                                                       \
        (void)x_increment;                                                                                                  \
        (void)y_increment;                                                                                                  \
        scale_row((size_t)(trans == CblasNoTrans ? m : n), beta, y);                                                        \
        for (size_t i = 0; i < (size_t)m; i++)                                                                              \
        {                                                                                                                   \
            const number *row = a + i * (size_t)stride;                                                                     \
            number sum = 0;                                                                                                 \
            if (trans == CblasTrans)                                                                                        \
                add_row((size_t)n, alpha *x[i], row, 1, y);                                                                 \
            for (size_t j = 0; trans == CblasNoTrans && j < (size_t)n; j++)                                                 \
                sum += row[j] * x[j];                                                                                       \
            if (trans == CblasNoTrans)                                                                                      \
                y[i] += alpha * sum;                                                                                        \
        }                                                                                                                   \
    }
// NOLINTEND(bugprone-macro-parentheses)

DEFINE_PRODUCTS(float, own_sgemm, own_sgemv, scale_floats, add_floats)
DEFINE_PRODUCTS(double, own_dgemm, own_dgemv, scale_doubles, add_doubles)

void own_daxpy(int n, double alpha, const double *x, int x_increment BAT_UNUSED, double *y, int y_increment BAT_UNUSED)
{
    assert(x_increment == 1 && y_increment == 1);
    add_doubles((size_t)n, alpha, x, 1, y);
}

double own_dnrm2(int n, const double *x, int increment BAT_UNUSED)
{
    assert(increment == 1);
    double largest = 0, sum = 0;
    for (int i = 0; i < n; i++)
        largest = fmax(largest, fabs(x[i]));
    if (largest == 0)
        return 0;
    for (int i = 0; i < n; i++)
        sum += x[i] / largest * (x[i] / largest);
    return largest * sqrt(sum);
}

void own_dscal(int n, double alpha, double *x, int increment BAT_UNUSED)
{
    assert(increment == 1);
    scale_doubles((size_t)n, alpha, x);
}

#include "linalg/blas.h"

#include <stddef.h>

// The inner loop runs over contiguous numbers in vector instructions.
void own_dgemm(CBLAS_LAYOUT layout BAT_UNUSED, CBLAS_TRANSPOSE trans_a BAT_UNUSED, CBLAS_TRANSPOSE trans_b BAT_UNUSED, int m,
               int n, int k, double alpha, const double *a, int stride_a, const double *b, int stride_b, double beta,
               double *c, int stride_c)
{
    for (size_t i = 0; i < (size_t)m; i++)
    {
        double *row = c + i * (size_t)stride_c;
        for (size_t j = 0; j < (size_t)n; j++)
            row[j] = beta == 0 ? 0 : beta * row[j];
        for (size_t l = 0; l < (size_t)k; l++)
        {
            double factor = alpha * a[i * (size_t)stride_a + l];
            for (size_t j = 0; j < (size_t)n; j++)
                row[j] += factor * b[l * (size_t)stride_b + j];
        }
    }
}

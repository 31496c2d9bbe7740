#include "research/studies/spectral_norm.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas.h"

#include <math.h>
#include <stdlib.h>

enum
{
    MAX_ITERATIONS = 100000
};

/// The norm counts as settled when a step changes it by less, relatively.
static const double SETTLED = 1e-14;

/// v becomes a^T a v, of length 1. Returns the length of a v for v of length 1: the estimate.
static double iterate(int rows, int columns, const double *a, double *v, double *image)
{
    double length = cblas_dnrm2(columns, v, 1);
    if (length == 0)
        return 0;
    cblas_dscal(columns, 1 / length, v, 1);
    cblas_dgemv(CblasRowMajor, CblasNoTrans, rows, columns, 1, a, columns, v, 1, 0, image, 1);
    double estimate = cblas_dnrm2(rows, image, 1);
    if (estimate > 0)
        cblas_dscal(rows, 1 / estimate, image, 1);
    cblas_dgemv(CblasRowMajor, CblasTrans, rows, columns, 1, a, columns, image, 1, 0, v, 1);
    return estimate;
}

bat_status spectral_norm(size_t rows, size_t columns, const double *a, double *norm, bat_error *error)
{
    bat_status status = blas_load(error);
    if (status != BAT_OK)
        return status;
    double *v = memory_array(columns + rows, sizeof *v);
    if (v == NULL)
        return error_memory(error, (columns + rows) * sizeof *v);
    // A direction that no matrix of ours is made to avoid.
    bat_random random = bat_random_seed(1);
    for (size_t i = 0; i < columns; i++)
        v[i] = bat_random_normal(&random);
    double last = INFINITY, estimate = 0;
    size_t done = 0;
    for (; done < MAX_ITERATIONS && fabs(estimate - last) > SETTLED * estimate; done++)
    {
        last = estimate;
        estimate = iterate((int)rows, (int)columns, a, v, v + columns);
        if (estimate == 0)
            break;
    }
    free(v);
    if (done == MAX_ITERATIONS)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the power iteration did not settle");
    *norm = estimate;
    return BAT_OK;
}

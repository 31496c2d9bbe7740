#include "linalg/decompose.h"

#include "base/error.h"
#include "base/memory.h"

#include <lapacke.h>
#include <stdlib.h>

static bat_status lapack_status(lapack_int info, bat_error *error)
{
    if (info == 0)
        return BAT_OK;
    if (info == LAPACK_WORK_MEMORY_ERROR || info == LAPACK_TRANSPOSE_MEMORY_ERROR)
        return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory in a dense eigenvalue problem");
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a dense eigenvalue problem did not converge");
}

bat_status decompose_eigenvalues(size_t n, double *a, double *real, double *imaginary, bat_error *error)
{
    const lapack_int side = (lapack_int)n;
    return lapack_status(LAPACKE_dgeev(LAPACK_ROW_MAJOR, 'N', 'N', side, a, side, real, imaginary, NULL, 1, NULL, 1), error);
}

bat_status decompose_eigenvectors(size_t n, double *a, double *real, double *imaginary, double *right, double *cosine,
                                  bat_error *error)
{
    const size_t numbers = n * n + 2 * n;
    double *left = memory_array(numbers, sizeof *left);
    if (left == NULL)
        return error_memory(error, numbers * sizeof *left);
    double *scale = left + n * n, *separation = scale + n;
    const lapack_int side = (lapack_int)n;
    lapack_int low, high;
    double norm;
    const lapack_int info = LAPACKE_dgeevx(LAPACK_ROW_MAJOR, 'P', 'V', 'V', 'E', side, a, side, real, imaginary, left, side,
                                           right, side, &low, &high, scale, &norm, cosine, separation);
    free(left);
    return lapack_status(info, error);
}

bat_status decompose_least_squares(size_t rows, size_t columns, double *a, double *b, bat_error *error)
{
    return lapack_status(
        LAPACKE_dgels(LAPACK_ROW_MAJOR, 'N', (lapack_int)rows, (lapack_int)columns, 1, a, (lapack_int)columns, b, 1), error);
}

bat_status decompose_symmetric(size_t n, double *a, double *values, bat_error *error)
{
    return lapack_status(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', (lapack_int)n, a, (lapack_int)n, values), error);
}

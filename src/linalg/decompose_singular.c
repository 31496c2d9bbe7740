#include "linalg/dense.h"

#include "base/error.h"
#include "base/memory.h"

#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Singular values by Hestenes's one-sided Jacobi method: rotations of its columns make them orthogonal, a V = U
/// diag(values). The matrices are small, and small singular values come out to full relative accuracy. LAPACK's zgesvd() is
/// not used: under OpenBLAS 0.3.21 its zgemv kernel for Cooperlake reads beyond the matrix. Columns are contiguous here.

static const int MAX_SWEEPS = 60;

/// Rotate two columns of two matrices so that those of `a` become orthogonal; false where they are, or where one of them is
/// shorter than `rounding`.
static bool rotate_pair(size_t n, double rounding, double complex *a, double complex *v, size_t p, size_t q)
{
    double p_square = 0, q_square = 0;
    double complex product = 0;
    for (size_t i = 0; i < n; i++)
    {
        double complex x = a[p * n + i], y = a[q * n + i];
        p_square += creal(x) * creal(x) + cimag(x) * cimag(x);
        q_square += creal(y) * creal(y) + cimag(y) * cimag(y);
        product += conj(x) * y;
    }
    double size = cabs(product);
    if (!(size > (double)n * DBL_EPSILON * sqrt(p_square * q_square)) || sqrt(fmin(p_square, q_square)) <= rounding)
        return false;
    double ratio = (q_square - p_square) / (2 * size);
    double tangent = copysign(1, ratio) / (fabs(ratio) + hypot(1, ratio)), cosine = 1 / hypot(1, tangent);
    double complex phase = conj(product) / size;
    double complex *matrices[] = {a, v};
    for (size_t m = 0; m < 2; m++)
        for (size_t i = 0; i < n; i++)
        {
            double complex x = matrices[m][p * n + i], y = matrices[m][q * n + i] * phase;
            matrices[m][p * n + i] = cosine * (x - tangent * y);
            matrices[m][q * n + i] = cosine * (tangent * x + y);
        }
    return true;
}

/// The columns' lengths in descending order, and with each the column of V.
static void read_singular(size_t n, const double complex *a, const double complex *v, double *values, double *adjoint)
{
    for (size_t k = 0; k < n; k++)
    {
        double length = 0;
        for (size_t i = 0; i < n; i++)
            length = hypot(length, cabs(a[k * n + i]));
        size_t place = k;
        for (; place > 0 && values[place - 1] < length; place--)
        {
            values[place] = values[place - 1];
            memcpy(adjoint + 2 * n * place, adjoint + 2 * n * (place - 1), 2 * n * sizeof *adjoint);
        }
        values[place] = length;
        for (size_t i = 0; i < n; i++)
        {
            adjoint[2 * (n * place + i)] = creal(v[k * n + i]);
            adjoint[2 * (n * place + i) + 1] = -cimag(v[k * n + i]);
        }
    }
}

bat_status decompose_singular(size_t n, double *a, double *values, double *adjoint, bat_error *error)
{
    double complex *columns = memory_array(2 * n * n, sizeof *columns), *v = columns + n * n;
    if (columns == NULL)
        return error_memory(error, 2 * n * n * sizeof *columns);
    for (size_t i = 0; i < n * n; i++)
    {
        columns[i % n * n + i / n] = a[2 * i] + a[2 * i + 1] * I;
        v[i] = i % (n + 1) == 0;
    }
    double largest = 0;
    for (size_t i = 0; i < 2 * n * n; i++)
        largest = fmax(largest, fabs(a[i]));
    const double rounding = DBL_EPSILON * largest;
    bool turned = true;
    int sweep = 0;
    for (; turned && sweep < MAX_SWEEPS; sweep++)
    {
        turned = false;
        for (size_t p = 0; p + 1 < n; p++)
            for (size_t q = p + 1; q < n; q++)
                turned = rotate_pair(n, rounding, columns, v, p, q) || turned;
    }
    read_singular(n, columns, v, values, adjoint);
    free(columns);
    bool finite = isfinite(largest);
    for (size_t k = 0; k < n; k++)
        finite = finite && isfinite(values[k]);
    return !turned && finite
               ? BAT_OK
               : error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the singular values of a matrix did not converge");
}

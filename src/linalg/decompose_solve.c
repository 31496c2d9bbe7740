#include "linalg/dense.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Linear systems by elimination with row exchanges, P a = L U, a block of columns at a time: the products of blocks are
/// BLAS's (Golub and Van Loan 2013, algorithm 3.2.1 and section 3.4.1).

static const size_t BLOCK = 48;

static void swap_rows(size_t count, double *a, double *b)
{
    for (size_t j = 0; j < count; j++)
    {
        double kept = a[j];
        a[j] = b[j];
        b[j] = kept;
    }
}

static void subtract_row(size_t count, double factor, const double *from, double *row)
{
    for (size_t j = 0; j < count; j++)
        row[j] -= factor * from[j];
}

/// Factor the columns begin … end - 1, exchanging whole rows. False where a pivot is zero or not finite.
static bool factor_panel(size_t n, size_t begin, size_t end, double *a, size_t *pivots)
{
    for (size_t k = begin; k < end; k++)
    {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k]))
                pivot = i;
        double divisor = a[pivot * n + k];
        pivots[k] = pivot;
        if (divisor == 0 || !isfinite(divisor))
            return false;
        if (pivot != k)
            swap_rows(n, a + k * n, a + pivot * n);
        for (size_t i = k + 1; i < n; i++)
        {
            a[i * n + k] /= divisor;
            subtract_row(end - k - 1, a[i * n + k], a + k * n + k + 1, a + i * n + k + 1);
        }
    }
    return true;
}

bool decompose_factor(size_t n, double *a, size_t *pivots)
{
    for (size_t begin = 0; begin < n; begin += BLOCK)
    {
        size_t end = begin + BLOCK < n ? begin + BLOCK : n, rest = n - end;
        if (!factor_panel(n, begin, end, a, pivots))
            return false;
        for (size_t i = begin + 1; i < end; i++)
            for (size_t k = begin; k < i; k++)
                subtract_row(rest, a[i * n + k], a + k * n + end, a + i * n + end);
        if (rest > 0)
            cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)rest, (int)rest, (int)(end - begin), -1,
                        a + end * n + begin, (int)n, a + begin * n + end, (int)n, 1, a + end * n + end, (int)n);
    }
    return true;
}

void decompose_substitute(size_t n, size_t columns, const double *a, const size_t *pivots, double *b)
{
    for (size_t k = 0; k < n; k++)
        if (pivots[k] != k)
            swap_rows(columns, b + k * columns, b + pivots[k] * columns);
    for (size_t i = 1; i < n; i++)
        for (size_t k = 0; k < i; k++)
            subtract_row(columns, a[i * n + k], b + k * columns, b + i * columns);
    for (size_t i = n; i-- > 0;)
    {
        for (size_t k = i + 1; k < n; k++)
            subtract_row(columns, a[i * n + k], b + k * columns, b + i * columns);
        for (size_t j = 0; j < columns; j++)
            b[i * columns + j] /= a[i * n + i];
    }
}

bat_status decompose_solve(size_t n, size_t columns, double *a, double *b, bat_error *error)
{
    size_t *pivots = memory_array(n, sizeof *pivots);
    if (pivots == NULL)
        return error_memory(error, n * sizeof *pivots);
    bool regular = decompose_factor(n, a, pivots);
    if (regular)
        decompose_substitute(n, columns, a, pivots, b);
    free(pivots);
    for (size_t i = 0; i < n * columns && regular; i++)
        regular = isfinite(b[i]);
    return regular ? BAT_OK : error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a linear system is singular");
}

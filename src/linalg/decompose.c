#include "linalg/dense.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas.h"
#include "linalg/symmetric.h"

#include <string.h>

static bat_status no_convergence(bat_error *error)
{
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a dense eigenvalue problem did not converge");
}

double dense_reflector(size_t m, double *v)
{
    double rest = 0, first = v[0];
    for (size_t i = 1; i < m; i++)
        rest += v[i] * v[i];
    v[0] = 1;
    if (rest == 0)
        return 0;
    double length = sqrt(first * first + rest);
    double lead = first <= 0 ? first - length : -rest / (first + length);
    for (size_t i = 1; i < m; i++)
        v[i] /= lead;
    return 2 * lead * lead / (rest + lead * lead);
}

void dense_reflect_rows(size_t n, double *a, size_t at, size_t m, const double *v, double beta, size_t from)
{
    for (size_t j = from; j < n; j++)
    {
        double sum = 0;
        for (size_t i = 0; i < m; i++)
            sum += v[i] * a[(at + i) * n + j];
        for (size_t i = 0; i < m; i++)
            a[(at + i) * n + j] -= beta * sum * v[i];
    }
}

bat_status decompose_least_squares(size_t rows, size_t columns, double *a, double *b, bat_error *error)
{
    double *v = memory_array(rows, sizeof *v);
    if (v == NULL)
        return error_memory(error, rows * sizeof *v);
    bool regular = vector_is_finite(rows * columns, a) && vector_is_finite(rows, b);
    for (size_t k = 0; k < columns && regular; k++)
    {
        for (size_t i = k; i < rows; i++)
            v[i - k] = a[i * columns + k];
        double beta = dense_reflector(rows - k, v);
        dense_reflect_rows(columns, a, k, rows - k, v, beta, k);
        dense_reflect_rows(1, b, k, rows - k, v, beta, 0);
        regular = a[k * columns + k] != 0;
    }
    free(v);
    if (!regular)
        return no_convergence(error);
    for (size_t k = columns; k-- > 0;)
    {
        for (size_t j = k + 1; j < columns; j++)
            b[k] -= a[k * columns + j] * b[j];
        b[k] /= a[k * columns + k];
    }
    return BAT_OK;
}

bat_status decompose_symmetric(size_t n, double *a, double *values, bat_error *error)
{
    double *vectors = memory_array(n * n, sizeof *vectors);
    if (vectors == NULL)
        return error_memory(error, n * n * sizeof *vectors);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            a[i * n + j] = a[j * n + i];
    symmetric_eigen(n, a, vectors, SYMMETRIC_BY_NORM);
    for (size_t i = 0; i < n; i++)
        values[i] = a[i * (n + 1)];
    // Selection sort: values ascending, vectors as columns.
    for (size_t k = 0; k < n; k++)
    {
        size_t least = k;
        for (size_t i = k + 1; i < n; i++)
            if (values[i] < values[least])
                least = i;
        SWAP(values[least], values[k]);
        for (size_t i = 0; i < n; i++)
        {
            double entry = vectors[least * n + i];
            vectors[least * n + i] = vectors[k * n + i];
            vectors[k * n + i] = a[i * n + k] = entry;
        }
    }
    free(vectors);
    return vector_is_finite(n, values) ? BAT_OK : no_convergence(error);
}

// Linear systems by elimination with row exchanges, P a = L U, a block of columns at a time: the products of blocks are
// BLAS's (Golub and Van Loan 2013, algorithm 3.2.1 and section 3.4.1).

static const size_t BLOCK = 48;

static void swap_rows(size_t count, double *a, double *b)
{
    for (size_t j = 0; j < count; j++)
        SWAP(a[j], b[j]);
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
            vector_add(end - k - 1, -a[i * n + k], a + k * n + k + 1, a + i * n + k + 1);
        }
    }
    return true;
}

/// P a = L U by elimination in place: row k was exchanged with row pivots[k]. False for a singular matrix.
static bool eliminate(size_t n, double *a, size_t *pivots)
{
    for (size_t begin = 0; begin < n; begin += BLOCK)
    {
        size_t end = begin + BLOCK < n ? begin + BLOCK : n, rest = n - end;
        if (!factor_panel(n, begin, end, a, pivots))
            return false;
        for (size_t i = begin + 1; i < end; i++)
            for (size_t k = begin; k < i; k++)
                vector_add(rest, -a[i * n + k], a + k * n + end, a + i * n + end);
        if (rest > 0)
            cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, (int)rest, (int)rest, (int)(end - begin), -1,
                        a + end * n + begin, (int)n, a + begin * n + end, (int)n, 1, a + end * n + end, (int)n);
    }
    return true;
}

/// Solve a x = b by the factors. `b` is n x columns and receives x.
static void substitute(size_t n, size_t columns, const double *a, const size_t *pivots, double *b)
{
    for (size_t k = 0; k < n; k++)
        if (pivots[k] != k)
            swap_rows(columns, b + k * columns, b + pivots[k] * columns);
    for (size_t i = 1; i < n; i++)
        for (size_t k = 0; k < i; k++)
            vector_add(columns, -a[i * n + k], b + k * columns, b + i * columns);
    for (size_t i = n; i-- > 0;)
    {
        for (size_t k = i + 1; k < n; k++)
            vector_add(columns, -a[i * n + k], b + k * columns, b + i * columns);
        for (size_t j = 0; j < columns; j++)
            b[i * columns + j] /= a[i * n + i];
    }
}

bat_status decompose_solve(size_t n, size_t columns, double *a, double *b, bat_error *error)
{
    bat_status status = n > BLOCK ? blas_load(error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    size_t *pivots = memory_array(n, sizeof *pivots);
    if (pivots == NULL)
        return error_memory(error, n * sizeof *pivots);
    bool regular = eliminate(n, a, pivots);
    if (regular)
        substitute(n, columns, a, pivots, b);
    free(pivots);
    return regular && vector_is_finite(n * columns, b)
               ? BAT_OK
               : error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "a linear system is singular");
}

bat_status dense_left_vector(size_t n, const double *a, double eigenvalue, const double *constraint, double *vector,
                             bat_error *error)
{
    const size_t numbers = (n + 1) * (n + 1);
    double *memory = memory_array(numbers, sizeof *memory);
    if (memory == NULL)
        return error_memory(error, numbers * sizeof *memory);
    double *right = memory + (n + 1) * n;
    for (size_t i = 0; i < n; i++)
    {
        for (size_t j = 0; j < n; j++)
            memory[i * n + j] = a[j * n + i] - (i == j ? eigenvalue : 0.0);
        right[i] = 0.0;
    }
    memcpy(memory + n * n, constraint, n * sizeof *memory);
    right[n] = 1.0;
    const bat_status status = decompose_least_squares(n + 1, n, memory, right, error);
    if (status == BAT_OK)
        memcpy(vector, right, n * sizeof *vector);
    free(memory);
    return status;
}

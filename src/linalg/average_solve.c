#include "linalg/multifrontal.h"
#include "linalg/sparse.h"

#include "base/error.h"

#include <limits.h>
#include <string.h>

/// I - W in the pattern of W + W^T: the lower triangle by columns, and the upper one by rows.
typedef struct average_matrix
{
    int *first; ///< count + 1
    int *row;
    double *lower, *upper;
    int *slot;        ///< of each row in the column at work, or before it
    memory_pool pool; ///< of all arrays
} average_matrix;

static bat_status average_matrix_allocate(size_t count, size_t entries, average_matrix *matrix, bat_error *error)
{
    *matrix = (average_matrix){0};
    if (entries > INT_MAX)
        return ERROR_TOO_LARGE(error, "a system of %zu averages is too large to factor", count);
    memory_pool *pool = &matrix->pool;
    matrix->first = memory_pool_array(pool, count + 1, sizeof(int));
    matrix->row = memory_pool_array(pool, entries, sizeof(int));
    matrix->lower = memory_pool_array(pool, entries, sizeof(double));
    matrix->upper = memory_pool_array(pool, entries, sizeof(double));
    matrix->slot = memory_pool_array(pool, count, sizeof(int));
    return memory_pool_check(pool, error);
}

/// Add an entry to a column, unless the column has it.
/// @return its place
static int column_entry(average_matrix *matrix, size_t column, size_t row)
{
    if (matrix->slot[row] < matrix->first[column])
    {
        int place = matrix->first[column + 1]++;
        matrix->slot[row] = place;
        matrix->row[place] = (int)row;
        matrix->lower[place] = matrix->upper[place] = row == column ? 1 : 0;
    }
    return matrix->slot[row];
}

static void average_matrix_fill(const sparse_rows *weights, const sparse_rows *transposed, average_matrix *matrix)
{
    for (size_t i = 0; i < weights->row_count; i++)
        matrix->slot[i] = -1;
    matrix->first[0] = 0;
    for (size_t j = 0; j < weights->row_count; j++)
    {
        matrix->first[j + 1] = matrix->first[j];
        (void)column_entry(matrix, j, j);
        for (size_t e = weights->starts[j]; e < weights->starts[j + 1]; e++)
            if (weights->columns[e] >= j)
                matrix->upper[column_entry(matrix, j, weights->columns[e])] -= weights->values[e];
        for (size_t e = transposed->starts[j]; e < transposed->starts[j + 1]; e++)
            if (transposed->columns[e] >= j)
                matrix->lower[column_entry(matrix, j, transposed->columns[e])] -= transposed->values[e];
    }
}

bat_status average_solve(const sparse_rows *weights, const double *constant, double *x, bat_error *error)
{
    if (weights->row_count == 0)
        return BAT_OK;
    average_matrix matrix;
    multifrontal *solver = NULL;
    double pivot = 0;
    size_t count = weights->row_count;
    sparse_rows transposed = {0};
    bat_status status = average_matrix_allocate(count, weights->starts[count] + count, &matrix, error);
    if (status == BAT_OK)
        status = sparse_rows_transpose(weights, &transposed, error);
    if (status == BAT_OK)
        average_matrix_fill(weights, &transposed, &matrix);
    sparse_rows_free(&transposed);
    symmetric_pattern pattern = {weights->row_count, matrix.first, matrix.row};
    if (status == BAT_OK)
        status = multifrontal_make(&pattern, false, &solver, error);
    if (status == BAT_OK)
        status = multifrontal_factor(solver, matrix.lower, matrix.upper, &pivot, error);
    if (status == BAT_OK && !(pivot > 0))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the system of averages is singular");
    if (status == BAT_OK)
    {
        memcpy(x, constant, 2 * weights->row_count * sizeof *x);
        status = multifrontal_solve(solver, 2, x, error);
    }
    multifrontal_free(solver);
    memory_pool_free(&matrix.pool);
    return status;
}

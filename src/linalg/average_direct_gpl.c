// Built with BATTEN_GPL alone: UMFPACK is published under the GPL.

#include "linalg/average_system.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas_single.h"

#include <stdlib.h>
#include <umfpack.h>

/// The columns of a matrix as UMFPACK wants them.
typedef struct direct_matrix
{
    SuiteSparse_long count;
    SuiteSparse_long *starts;
    SuiteSparse_long *rows;
    double *values;
} direct_matrix;

static void direct_matrix_free(direct_matrix *matrix)
{
    free(matrix->starts);
    free(matrix->rows);
    free(matrix->values);
    *matrix = (direct_matrix){0};
}

static bat_status direct_matrix_allocate(size_t count, size_t entries, direct_matrix *matrix, bat_error *error)
{
    *matrix = (direct_matrix){.count = (SuiteSparse_long)count,
                              .starts = memory_array(count + 1, sizeof(SuiteSparse_long)),
                              .rows = memory_array(entries, sizeof(SuiteSparse_long)),
                              .values = memory_array(entries, sizeof(double))};
    if (matrix->starts == NULL || matrix->rows == NULL || matrix->values == NULL)
        return error_memory(error, entries * (sizeof(SuiteSparse_long) + sizeof(double)));
    return BAT_OK;
}

static bat_status direct_status(SuiteSparse_long result, bat_error *error)
{
    if (result == UMFPACK_OK)
        return BAT_OK;
    if (result == UMFPACK_ERROR_out_of_memory)
        return error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory while decomposing a sparse matrix");
    return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the system of averages is singular");
}

/// I - W by columns.
static bat_status direct_matrix_make(const sparse_rows *weights, direct_matrix *matrix, bat_error *error)
{
    size_t count = weights->row_count, entries = weights->starts[count] + count, at = 0;
    SuiteSparse_long *places = memory_array(entries, 2 * sizeof *places),
                     *columns = places != NULL ? places + entries : NULL;
    double *values = memory_array(entries, sizeof *values);
    bat_status status = direct_matrix_allocate(count, entries, matrix, error);
    if (status == BAT_OK && (places == NULL || values == NULL))
        status = error_memory(error, entries * (2 * sizeof *places + sizeof *values));
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        places[at] = columns[at] = (SuiteSparse_long)i;
        values[at++] = 1;
        for (size_t e = weights->starts[i]; e < weights->starts[i + 1]; e++, at++)
        {
            places[at] = (SuiteSparse_long)i;
            columns[at] = (SuiteSparse_long)weights->columns[e];
            values[at] = -weights->values[e];
        }
    }
    if (status == BAT_OK)
        status =
            direct_status(umfpack_dl_triplet_to_col(matrix->count, matrix->count, (SuiteSparse_long)entries, places, columns,
                                                    values, matrix->starts, matrix->rows, matrix->values, NULL),
                          error);
    free(places);
    free(values);
    return status;
}

static bat_status direct_solve_columns(const direct_matrix *matrix, void *numeric, const double *constant, double *x,
                                       bat_error *error)
{
    size_t count = (size_t)matrix->count;
    double *right = memory_array(2 * count, sizeof *right), *column = right != NULL ? right + count : NULL;
    if (right == NULL)
        return error_memory(error, 2 * count * sizeof *right);
    bat_status status = BAT_OK;
    for (size_t c = 0; c < 2 && status == BAT_OK; c++)
    {
        for (size_t i = 0; i < count; i++)
            right[i] = constant[2 * i + c];
        status = direct_status(
            umfpack_dl_solve(UMFPACK_A, matrix->starts, matrix->rows, matrix->values, column, right, numeric, NULL, NULL),
            error);
        for (size_t i = 0; i < count && status == BAT_OK; i++)
            x[2 * i + c] = column[i];
    }
    free(right);
    return status;
}

bat_status average_solve_umfpack(const sparse_rows *weights, const double *constant, double *x, bat_error *error)
{
    if (weights->row_count == 0)
        return BAT_OK;
    direct_matrix matrix = {0};
    bat_status status = direct_matrix_make(weights, &matrix, error);
    void *symbolic = NULL, *numeric = NULL;
    blas_single_begin();
    if (status == BAT_OK)
        status = direct_status(umfpack_dl_symbolic(matrix.count, matrix.count, matrix.starts, matrix.rows, matrix.values,
                                                   &symbolic, NULL, NULL),
                               error);
    if (status == BAT_OK)
        status = direct_status(umfpack_dl_numeric(matrix.starts, matrix.rows, matrix.values, symbolic, &numeric, NULL, NULL),
                               error);
    if (status == BAT_OK)
        status = direct_solve_columns(&matrix, numeric, constant, x, error);
    blas_single_end();
    umfpack_dl_free_symbolic(&symbolic);
    umfpack_dl_free_numeric(&numeric);
    direct_matrix_free(&matrix);
    return status;
}

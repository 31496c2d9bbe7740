#include "linalg/sparse.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"

#include <stdlib.h>
#include <string.h>

static const size_t ROWS_FOR_THREAD = 16384; ///< fewer are not worth a thread

bat_status sparse_rows_make(size_t row_count, size_t column_count, size_t entries, sparse_rows *matrix, bat_error *error)
{
    sparse_rows made = {.row_count = row_count,
                        .column_count = column_count,
                        .starts = row_count < SIZE_MAX ? memory_array(row_count + 1, sizeof(size_t)) : NULL,
                        .columns = memory_array(entries, sizeof(uint32_t)),
                        .values = memory_array(entries, sizeof(double))};
    if (made.starts == NULL || made.columns == NULL || made.values == NULL)
    {
        sparse_rows_free(&made);
        return error_memory(error, entries);
    }
    made.starts[0] = 0;
    made.starts[row_count] = entries;
    *matrix = made;
    return BAT_OK;
}

void sparse_rows_free(sparse_rows *matrix)
{
    free(matrix->starts);
    free(matrix->columns);
    free(matrix->values);
    *matrix = (sparse_rows){0};
}

void sparse_rows_apply_pairs(const sparse_rows *matrix, int threads, const double *x, double *product)
{
#pragma omp parallel for num_threads(threads_for(threads, matrix->row_count / ROWS_FOR_THREAD + 1)) schedule(static)
    for (size_t i = 0; i < matrix->row_count; i++)
    {
        double first = 0, second = 0;
        for (size_t e = matrix->starts[i]; e < matrix->starts[i + 1]; e++)
        {
            const double *at = x + 2 * (size_t)matrix->columns[e];
            first += matrix->values[e] * at[0];
            second += matrix->values[e] * at[1];
        }
        product[2 * i] = first;
        product[2 * i + 1] = second;
    }
}

bat_status sparse_rows_transpose(const sparse_rows *matrix, sparse_rows *transposed, bat_error *error)
{
    size_t entries = matrix->starts[matrix->row_count];
    bat_status status = sparse_rows_make(matrix->column_count, matrix->row_count, entries, transposed, error);
    if (status != BAT_OK)
        return status;
    size_t *starts = transposed->starts, rows = transposed->row_count;
    memset(starts, 0, (rows + 1) * sizeof *starts);
    for (size_t e = 0; e < entries; e++)
        starts[matrix->columns[e] + 1]++;
    for (size_t j = 0; j < rows; j++)
        starts[j + 1] += starts[j];
    for (size_t i = 0; i < matrix->row_count; i++)
        for (size_t e = matrix->starts[i]; e < matrix->starts[i + 1]; e++)
        {
            size_t to = starts[matrix->columns[e]]++;
            transposed->columns[to] = (uint32_t)i;
            transposed->values[to] = matrix->values[e];
        }
    // Each start has moved to the next one's place.
    memmove(starts + 1, starts, rows * sizeof *starts);
    starts[0] = 0;
    return BAT_OK;
}

/// The number of entries of row i of a b. `seen` marks columns with i + 1.
static size_t count_product_row(const sparse_rows *a, const sparse_rows *b, size_t i, size_t *seen)
{
    size_t count = 0;
    for (size_t e = a->starts[i]; e < a->starts[i + 1]; e++)
    {
        size_t k = a->columns[e];
        for (size_t f = b->starts[k]; f < b->starts[k + 1]; f++)
        {
            size_t *mark = &seen[b->columns[f]];
            count += *mark != i + 1;
            *mark = i + 1;
        }
    }
    return count;
}

/// Row i of the product; `place` holds each column's place in the product where it is at or after the row's start.
static void fill_product_row(const sparse_rows *a, const sparse_rows *b, size_t i, size_t *place, sparse_rows *product)
{
    size_t start = product->starts[i], end = start;
    for (size_t e = a->starts[i]; e < a->starts[i + 1]; e++)
    {
        size_t k = a->columns[e];
        for (size_t f = b->starts[k]; f < b->starts[k + 1]; f++)
        {
            uint32_t column = b->columns[f];
            size_t at = place[column];
            if (at < start || at >= end || product->columns[at] != column)
            {
                at = place[column] = end++;
                product->columns[at] = column;
                product->values[at] = 0;
            }
            product->values[at] += a->values[e] * b->values[f];
        }
    }
    product->starts[i + 1] = end;
}

static void bring_diagonal_first(sparse_rows *matrix)
{
    for (size_t i = 0; i < matrix->row_count; i++)
        for (size_t e = matrix->starts[i] + 1; e < matrix->starts[i + 1]; e++)
            if (matrix->columns[e] == i)
            {
                size_t first = matrix->starts[i];
                double value = matrix->values[e];
                matrix->columns[e] = matrix->columns[first];
                matrix->values[e] = matrix->values[first];
                matrix->columns[first] = (uint32_t)i;
                matrix->values[first] = value;
                break;
            }
}

bat_status sparse_rows_multiply(const sparse_rows *a, const sparse_rows *b, bool diagonal_first, sparse_rows *product,
                                bat_error *error)
{
    size_t *scratch = memory_array(b->column_count, sizeof *scratch);
    if (scratch == NULL)
        return error_memory(error, b->column_count * sizeof *scratch);
    memset(scratch, 0, b->column_count * sizeof *scratch);
    size_t entries = 0;
    for (size_t i = 0; i < a->row_count; i++)
        entries += count_product_row(a, b, i, scratch);
    bat_status status = sparse_rows_make(a->row_count, b->column_count, entries, product, error);
    if (status == BAT_OK)
    {
        memset(scratch, 0, b->column_count * sizeof *scratch);
        for (size_t i = 0; i < a->row_count; i++)
            fill_product_row(a, b, i, scratch, product);
    }
    free(scratch);
    if (status == BAT_OK && diagonal_first)
        bring_diagonal_first(product);
    return status;
}

#include "linalg/sparse.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

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

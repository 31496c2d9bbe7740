#include "io/curve/rows.h"

#include "base/error.h"

/// @file
/// Rows of all curves of a set, formatted in blocks.

static const size_t ROWS_PER_BLOCK = 1 << 15;

/// The points of all curves of a set, partitioned into blocks of equal size.
typedef struct row_job
{
    const bat_curve_set *set;
    size_t *first_rows; ///< for each curve, then the number of all rows
    row_format *format;
    const void *context;
} row_job;

static size_t curve_of_row(const row_job *job, size_t row)
{
    size_t low = 0, high = job->set->count;
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (job->first_rows[middle] <= row)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    const row_job *job = context;
    const size_t *first_rows = job->first_rows;
    size_t row = block * ROWS_PER_BLOCK, last = first_rows[job->set->count];
    if (last - row > ROWS_PER_BLOCK)
        last = row + ROWS_PER_BLOCK;
    bat_status status = BAT_OK;
    for (size_t i = curve_of_row(job, row); row < last && status == BAT_OK; i++)
    {
        size_t end = first_rows[i + 1] < last ? first_rows[i + 1] : last;
        row_span span = {&job->set->curves[i], i, first_rows[i], row - first_rows[i], end - first_rows[i]};
        status = job->format(job->context, &span, text, error);
        row = end;
    }
    return status;
}

bat_status rows_write(const bat_curve_set *set, text_sink *sink, int threads, row_format *format, const void *context,
                      bat_error *error)
{
    size_t *rows = memory_array(set->count + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, set->count * sizeof *rows);
    rows[0] = 0;
    for (size_t i = 0; i < set->count; i++)
        rows[i + 1] = rows[i] + set->curves[i].count;
    const row_job job = {set, rows, format, context};
    size_t blocks = (rows[set->count] + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    bat_status status = blocks_write(sink, blocks, threads, format_block, &job, error);
    free(rows);
    return status;
}

bat_status row_not_finite(const row_span *span, size_t point, bat_error *error)
{
    return error_set(error, BAT_INVALID_POINT, point, 0, "point %zu of curve %zu is not finite", point, span->curve_index);
}

#include "io/curve/rows.h"

#include "base/error.h"

/// @file
/// Rows of all curves of a set, formatted in blocks.

enum
{
    ROWS_PER_BLOCK = 1 << 15
};

bat_status row_blocks_begin(const bat_curve_set *set, row_blocks *blocks, bat_error *error)
{
    size_t *rows = memory_array(set->count + 1, sizeof *rows);
    if (rows == NULL)
        return error_memory(error, set->count * sizeof *rows);
    rows[0] = 0;
    for (size_t i = 0; i < set->count; i++)
        rows[i + 1] = rows[i] + set->curves[i].count;
    *blocks = (row_blocks){set, rows, (rows[set->count] + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK};
    return BAT_OK;
}

void row_blocks_end(row_blocks *blocks)
{
    free(blocks->first_rows);
    *blocks = (row_blocks){0};
}

/// The curve of a row, by bisection.
static size_t curve_of_row(const row_blocks *blocks, size_t row)
{
    size_t low = 0, high = blocks->set->count;
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (blocks->first_rows[middle] <= row)
            low = middle;
        else
            high = middle;
    }
    return low;
}

typedef struct row_job
{
    const row_blocks *blocks;
    row_format *format;
    const void *context;
} row_job;

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    const row_job *job = context;
    const row_blocks *blocks = job->blocks;
    const size_t *first_rows = blocks->first_rows;
    size_t row = block * ROWS_PER_BLOCK;
    size_t last = first_rows[blocks->set->count];
    if (last - row > ROWS_PER_BLOCK)
        last = row + ROWS_PER_BLOCK;
    bat_status status = BAT_OK;
    for (size_t i = curve_of_row(blocks, row); row < last && status == BAT_OK; i++)
    {
        size_t end = first_rows[i + 1] < last ? first_rows[i + 1] : last;
        row_span span = {&blocks->set->curves[i], i, row - first_rows[i], end - first_rows[i]};
        status = job->format(job->context, &span, text, error);
        row = end;
    }
    return status;
}

bat_status row_blocks_write(const row_blocks *blocks, text_sink *sink, int threads, row_format *format, const void *context,
                            bat_error *error)
{
    row_job job = {blocks, format, context};
    return blocks_write(sink, blocks->block_count, threads, format_block, &job, error);
}

bat_status row_not_finite(const row_span *span, size_t point, bat_error *error)
{
    return error_set(error, BAT_INVALID_POINT, point, 0, "point %zu of curve %zu is not finite", point, span->curve_index);
}

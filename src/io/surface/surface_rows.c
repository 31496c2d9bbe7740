#include "io/surface/surface_rows.h"

#include "io/common/number_text.h"

#include <stdarg.h>
#include <stdio.h>

enum
{
    ROWS_PER_BLOCK = 1 << 12
};

typedef struct rows_job
{
    size_t count;
    row_text *append;
    const void *context;
} rows_job;

static bat_status format_block(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    (void)error; // the sink reports a lack of memory
    const rows_job *job = context;
    size_t begin = block * ROWS_PER_BLOCK, left = job->count - begin;
    size_t end = begin + (left < ROWS_PER_BLOCK ? left : ROWS_PER_BLOCK);
    for (size_t row = begin; row < end; row++)
        job->append(job->context, row, text);
    return BAT_OK;
}

bat_status rows_write(text_sink *sink, size_t count, row_text *append, const void *context, bat_error *error)
{
    const rows_job job = {count, append, context};
    return blocks_write(sink, count / ROWS_PER_BLOCK + (count % ROWS_PER_BLOCK > 0), 0, format_block, &job, error);
}

void rows_append_numbers(text_buffer *text, const double *numbers, size_t count)
{
    for (size_t i = 0; i < count; i++)
    {
        char *out = text_reserve(text, NUMBER_TEXT_SIZE + 1);
        if (out == NULL)
            return;
        out = number_write(out, numbers[i]);
        *out++ = i + 1 < count ? ' ' : '\n';
        text_advance(text, out);
    }
}

bat_status rows_heading(text_sink *sink, bat_error *error, const char *format, ...)
{
    char line[256];
    text_buffer text = {0};
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    text_append_string(&text, line);
    bat_status status = sink_write(sink, &text, error);
    text_free(&text);
    return status;
}

#include "io/common/block_writer.h"

#include "base/error.h"
#include "base/threads.h"

#include <errno.h>
#include <stdarg.h>

/// @file
/// Parallel formatting with ordered output: threads format blocks in any order and write them in the order of their numbers.

bat_status sink_write(text_sink *sink, const text_buffer *text, bat_error *error)
{
    if (text->failed)
        return error_memory(error, text->size);
    if (sink->stream == NULL)
    {
        text_append(sink->buffer, text->data, text->size);
        return sink->buffer->failed ? error_memory(error, sink->buffer->size) : BAT_OK;
    }
    if (text->size == 0 || fwrite(text->data, 1, text->size, sink->stream) == text->size)
        return BAT_OK;
    return error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: %s", strerror(errno));
}

bat_status sink_take(text_sink *sink, text_buffer *text, bat_status status, bat_error *error)
{
    status = status == BAT_OK ? sink_write(sink, text, error) : status;
    text_free(text);
    return status;
}

bat_status sink_format(text_sink *sink, bat_error *error, const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    int size = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    return sink_write(sink, &(text_buffer){.data = line, .size = (size_t)size}, error);
}

bat_status blocks_write(text_sink *sink, size_t count, int threads, block_format *format, const void *context,
                        bat_error *error)
{
    bat_status outcome = BAT_OK;
    (void)threads; // unused without OpenMP
#pragma omp parallel num_threads(threads_for(threads, count))
    {
        text_buffer text = {0};
#pragma omp for ordered schedule(dynamic, 1)
        for (size_t block = 0; block < count; block++)
        {
            bat_status before, status = BAT_OK;
            bat_error fault = {0};
            text.size = 0;
#pragma omp atomic read
            before = outcome;
            if (before == BAT_OK)
                status = format(context, block, &text, &fault);
#pragma omp ordered
            {
                if (outcome == BAT_OK)
                {
                    if (status == BAT_OK)
                        status = sink_write(sink, &text, &fault);
                    if (status != BAT_OK && error != NULL)
                        *error = fault;
#pragma omp atomic write
                    outcome = status;
                }
            }
        }
        text_free(&text);
    }
    return outcome;
}

/// Lines of equal weight.
typedef struct lines_job
{
    size_t count;
    line_format *format;
    const void *context;
} lines_job;

static const size_t LINES_PER_BLOCK = 1 << 12;

static bat_status format_lines(const void *context, size_t block, text_buffer *text, bat_error *error)
{
    (void)error; // the sink reports a lack of memory
    const lines_job *job = context;
    for (size_t line = block * LINES_PER_BLOCK; line < job->count && line / LINES_PER_BLOCK == block; line++)
        job->format(job->context, line, text);
    return BAT_OK;
}

bat_status text_lines_write(text_sink *sink, size_t count, int threads, line_format *format, const void *context,
                            bat_error *error)
{
    const lines_job job = {count, format, context};
    return blocks_write(sink, count / LINES_PER_BLOCK + (count % LINES_PER_BLOCK > 0), threads, format_lines, &job, error);
}

bat_status blocks_cut(size_t count, size_t (*weigh)(const void *context, size_t job), const void *context, size_t weight,
                      block_cut *cut, bat_error *error)
{
    size_t *starts = NULL, capacity = 0, blocks = 0, collected = weight;
    for (size_t job = 0; job <= count; job++)
    {
        if (collected >= weight || job == count)
        {
            if (!ARRAY_ADD(starts, capacity, blocks, job))
            {
                free(starts);
                return error_memory(error, capacity * sizeof(size_t));
            }
            collected = 0;
        }
        if (job < count)
            collected += weigh(context, job);
    }
    *cut = (block_cut){starts, blocks - 1};
    return BAT_OK;
}

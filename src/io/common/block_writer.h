#ifndef IO_COMMON_BLOCK_WRITER_H
#define IO_COMMON_BLOCK_WRITER_H

#include "base/text_buffer.h"

#include <stdio.h>

/// Where text goes: a stream, or a buffer when `stream` is null.
typedef struct text_sink
{
    FILE *stream;
    text_buffer *buffer;
} text_sink;

/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status sink_write(text_sink *sink, const text_buffer *text, bat_error *error);

/// Appends the text of block number `block` to a buffer.
typedef bat_status block_format(const void *context, size_t block, text_buffer *text, bat_error *error);

/// Format `count` blocks on several threads and write them in order; the bytes do not depend on the number of threads. After
/// a failure, which is the one of the first block that failed, nothing more is written.
bat_status blocks_write(text_sink *sink, size_t count, int threads, block_format *format, const void *context,
                        bat_error *error);

/// Several jobs of uneven size cut into blocks of about equal weight: block b is the jobs starts[b] … starts[b + 1] - 1.
typedef struct block_cut
{
    size_t *starts;
    size_t count;
} block_cut;

/// Cut `count` jobs whose weights are given by a function into blocks of at least `weight`, except for the last.
bat_status blocks_cut(size_t count, size_t (*weigh)(const void *context, size_t job), const void *context, size_t weight,
                      block_cut *cut, bat_error *error);

/// The number of threads that an option asks for: itself, or as many as OpenMP gives where it is 0.
int thread_count(int option);

#endif

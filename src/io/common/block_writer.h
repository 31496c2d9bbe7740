#pragma once

#include "base/text_buffer.h"

#include <stdio.h>

/// @file
/// Output of text in blocks that several threads format.

/// The destination of text: a stream, or a buffer when `stream` is null.
typedef struct text_sink
{
    FILE *stream;
    text_buffer *buffer;
} text_sink;

/// Write text to a sink.
/// @return BAT_OK, BAT_FILE_ACCESS or BAT_NO_MEMORY
bat_status sink_write(text_sink *sink, const text_buffer *text, bat_error *error);

/// Write a text where `status` is BAT_OK, and release it. Hands the status on.
bat_status sink_take(text_sink *sink, text_buffer *text, bat_status status, bat_error *error);

/// Write a text of at most 511 characters, without floating-point numbers: printf() depends on the locale.
/// @return as sink_write()
bat_status sink_format(text_sink *sink, bat_error *error, const char *format, ...) __attribute__((format(printf, 3, 4)));

/// Append the text of block number `block` to a buffer.
typedef bat_status block_format(const void *context, size_t block, text_buffer *text, bat_error *error);

/// Format `count` blocks on several threads and write them in order. The output does not depend on the number of threads.
/// After a failure nothing more is written; the failure is that of the first block that failed.
bat_status blocks_write(text_sink *sink, size_t count, int threads, block_format *format, const void *context,
                        bat_error *error);

/// Append the text of a line.
typedef void line_format(const void *context, size_t row, text_buffer *text);

/// blocks_write() of `count` lines.
bat_status text_lines_write(text_sink *sink, size_t count, int threads, line_format *format, const void *context,
                            bat_error *error);

/// A partition of jobs into blocks of similar weight: block b has the jobs starts[b], …, starts[b + 1] - 1.
typedef struct block_cut
{
    size_t *starts;
    size_t count;
} block_cut;

/// Partition `count` jobs with the given weights into blocks of at least `weight`, except for the last block.
bat_status blocks_cut(size_t count, size_t (*weigh)(const void *context, size_t job), const void *context, size_t weight,
                      block_cut *cut, bat_error *error);

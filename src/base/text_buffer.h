#pragma once

#include "base/array_grow.h"

/// @file
/// A growing buffer of bytes for writers.

/// A growing buffer of bytes. All zero: empty. After a failed allocation `failed` stays set, and nothing is appended.
typedef struct text_buffer
{
    char *data;
    size_t size;
    size_t capacity;
    bool failed;
} text_buffer;

/// Reserve `size` more bytes at the end, which text_advance() counts; `size` may be 0. Null when out of memory.
static inline char *text_reserve(text_buffer *buffer, size_t size)
{
    void *data = buffer->data;
    if (buffer->failed || size >= SIZE_MAX - buffer->size ||
        !array_grow(&data, &buffer->capacity, buffer->size + size + 1, 1))
    {
        buffer->failed = true;
        return NULL;
    }
    buffer->data = data;
    return buffer->data + buffer->size;
}

/// Set the end of the text, within the reserved bytes.
static inline void text_advance(text_buffer *buffer, const char *end)
{
    buffer->size = (size_t)(end - buffer->data);
}

static inline void text_append(text_buffer *buffer, const char *bytes, size_t size)
{
    char *out = text_reserve(buffer, size);
    if (out != NULL && size > 0)
    {
        memcpy(out, bytes, size);
        buffer->size += size;
    }
}

static inline void text_append_string(text_buffer *buffer, const char *string)
{
    text_append(buffer, string, strlen(string));
}

/// Append strings up to a null pointer.
static inline void text_append_strings(text_buffer *buffer, const char *const *strings)
{
    for (; *strings != NULL; strings++)
        text_append_string(buffer, *strings);
}

/// Append some strings.
#define TEXT_APPEND(buffer, ...) text_append_strings(buffer, (const char *const[]){__VA_ARGS__, NULL})

static inline void text_free(text_buffer *buffer)
{
    free(buffer->data);
    *buffer = (text_buffer){0};
}

#ifndef LEARN_SAFETENSORS_TYPE_H
#define LEARN_SAFETENSORS_TYPE_H

#include "learn/safetensors.h"

#include <string.h>

/// What the element types are called in files, and their sizes in bytes.
static const struct
{
    const char *name;
    size_t size;
} safetensors_types[SAFETENSORS_TYPE_COUNT] = {
    [SAFETENSORS_BOOL] = {"BOOL", 1}, [SAFETENSORS_U8] = {"U8", 1},   [SAFETENSORS_I8] = {"I8", 1},
    [SAFETENSORS_U16] = {"U16", 2},   [SAFETENSORS_I16] = {"I16", 2}, [SAFETENSORS_F16] = {"F16", 2},
    [SAFETENSORS_BF16] = {"BF16", 2}, [SAFETENSORS_U32] = {"U32", 4}, [SAFETENSORS_I32] = {"I32", 4},
    [SAFETENSORS_F32] = {"F32", 4},   [SAFETENSORS_U64] = {"U64", 8}, [SAFETENSORS_I64] = {"I64", 8},
    [SAFETENSORS_F64] = {"F64", 8}};

/// The member of the header that holds the notes.
static const char SAFETENSORS_NOTES[] = "__metadata__";

/// Bytes of the header's length.
enum
{
    SAFETENSORS_LENGTH_BYTES = 8
};

/// Copy elements between the file's byte order, which is little-endian, and the machine's.
static inline void safetensors_copy(void *to, const void *from, size_t count, size_t size)
{
    if (count == 0)
        return;
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    memcpy(to, from, count * size);
#else
    const unsigned char *source = from;
    unsigned char *target = to;
    for (size_t i = 0; i < count; i++)
        for (size_t byte = 0; byte < size; byte++)
            target[i * size + byte] = source[i * size + size - 1 - byte];
#endif
}

#endif

#pragma once

#include "base/text_buffer.h"

/// @file
/// Named arrays in a file, in the safetensors format of Hugging Face: 8 bytes with the length of a header, the header in
/// JSON (name, element type, shape and place of each array, and notes), then the arrays' elements; all little-endian.

/// The most dimensions of an array.
#define SAFETENSORS_MAX_RANK 8
/// The longest header that is read, which is the format's own limit.
#define SAFETENSORS_MAX_HEADER 100000000

/// The element types of the format.
typedef enum safetensors_type
{
    SAFETENSORS_BOOL,
    SAFETENSORS_U8,
    SAFETENSORS_I8,
    SAFETENSORS_U16,
    SAFETENSORS_I16,
    SAFETENSORS_F16,
    SAFETENSORS_BF16,
    SAFETENSORS_U32,
    SAFETENSORS_I32,
    SAFETENSORS_F32,
    SAFETENSORS_U64,
    SAFETENSORS_I64,
    SAFETENSORS_F64,
    SAFETENSORS_TYPE_COUNT
} safetensors_type;

/// One array, row-major.
typedef struct safetensors_array
{
    const char *name;
    safetensors_type type;
    size_t rank; ///< 0 for a single number
    size_t shape[SAFETENSORS_MAX_RANK];
    size_t count;       ///< elements: the product of the shape
    const void *values; ///< the elements in the machine's own byte order; aligned to 64 bytes in a file that was read
} safetensors_array;

/// A remark that travels with the arrays.
typedef struct safetensors_note
{
    const char *key, *value;
} safetensors_note;

/// The content of a file. Arrays stand in the order of their elements in the file. What safetensors_parse() makes owns all
/// it refers to and is released with safetensors_free(); to write, fill one in with pointers to your own.
typedef struct safetensors
{
    const safetensors_array *arrays;
    size_t array_count;
    const safetensors_note *notes;
    size_t note_count;
    void *memory; ///< all elements and names, one block
} safetensors;

/// Bytes of an element.
size_t safetensors_element_size(safetensors_type type);

/// Take the content of a file apart. Strict: the header must be an object with each name once, every array must have a known
/// type and a place that fits its shape, and the places must cover the data without gap or overlap.
/// @return BAT_OK, BAT_BAD_FILE, BAT_UNSUPPORTED (too many dimensions) or BAT_NO_MEMORY; `content` is untouched on failure
bat_status safetensors_parse(const void *bytes, size_t size, safetensors *content, bat_error *error);
/// Read a file.
/// @return BAT_FILE_ACCESS, or what safetensors_parse() returns; BAT_UNSUPPORTED in a build without files
bat_status safetensors_read(const char *path, safetensors *content, bat_error *error);
void safetensors_free(safetensors *content);

/// The array of a name, or null.
const safetensors_array *safetensors_find(const safetensors *content, const char *name);
/// The note of a key, or null.
const char *safetensors_find_note(const safetensors *content, const char *key);

/// The array of a name as array->count doubles in `values`; it must be F64, F32 or of integers of at most 32 bits.
/// @return BAT_OK, or BAT_BAD_FILE when there is no array of that name, type and count
bat_status safetensors_doubles(const safetensors *content, const char *name, size_t count, double *values, bat_error *error);
/// The array of a name as whole numbers; it must be of integers, U64 excepted.
/// @return as safetensors_doubles()
bat_status safetensors_integers(const safetensors *content, const char *name, size_t count, int64_t *values,
                                bat_error *error);

/// Append a file with this content to a buffer. The data begin at a multiple of 8 bytes.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (a name twice or not UTF-8, a count unlike the shape's product) or BAT_NO_MEMORY
bat_status safetensors_encode(const safetensors *content, text_buffer *bytes, bat_error *error);
/// Write a file, whole or not at all.
/// @return BAT_FILE_ACCESS, or what safetensors_encode() returns
bat_status safetensors_write(const char *path, const safetensors *content, bat_error *error);

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
#define SAFETENSORS_LENGTH_BYTES 8

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

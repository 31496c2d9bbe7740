#pragma once

#include "io/mesh/builder.h"

/// @file
/// The structure of PLY files (Turk, "The PLY polygon file format", 1994).

typedef enum ply_encoding
{
    PLY_TEXT,
    PLY_LITTLE_ENDIAN,
    PLY_BIG_ENDIAN
} ply_encoding;

typedef enum ply_type
{
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64,
    PLY_TYPE_COUNT
} ply_type;

static inline size_t ply_type_size(ply_type type)
{
    static const unsigned char sizes[PLY_TYPE_COUNT] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

typedef struct ply_property
{
    label_name name; ///< within the text of the file
    ply_type type;   ///< of the number or of the list's elements
    bool list;
    ply_type count_type; ///< of the list's length
} ply_property;

typedef struct ply_element
{
    label_name name; ///< within the text of the file
    size_t count;
    ply_property *properties;
    size_t property_count, property_capacity;
} ply_element;

typedef struct ply_header
{
    ply_encoding encoding;
    ply_element *elements;
    size_t element_count, element_capacity;
} ply_header;

/// Read the header and move `scan` to the data. Release the header with ply_header_free(), also on failure.
/// @return BAT_OK, BAT_BAD_FILE, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status ply_header_read(word_scan *scan, ply_header *header, bat_error *error);
void ply_header_free(ply_header *header);

/// The element with this name, or null.
const ply_element *ply_header_find(const ply_header *header, const char *name);
/// The index of a property in an element; property_count when there is none.
size_t ply_property_find(const ply_element *element, const char *name);

/// Pairs of property names for texture coordinates.
#define PLY_TEXTURE_NAMES 3
extern const char *const ply_texture_names[PLY_TEXTURE_NAMES][2];

/// The source of numbers: lines of words, or bytes.
typedef struct ply_source
{
    ply_encoding encoding;
    word_scan scan; ///< `at` is the next byte for every encoding
    bool lenient;   ///< numbers need not be finite
} ply_source;

/// Read the next number. False when it is missing, invalid, not finite (unless `lenient`) or, in text, out of the range of
/// its type.
bool ply_number(ply_source *source, ply_type type, double *value);

/// Skip `count` numbers. False when there are fewer.
bool ply_skip(ply_source *source, ply_type type, size_t count);

// Labels in PLY: the face property `label`, a number from 0, and for each label a header line such as
//
//     comment label {"object":"house","material":"brick"}

/// The name of the property.
#define PLY_LABEL "label"

/// Read the labels and the files of materials from the comments of a header.
/// @param numbers receives for each comment the number of its label in the builder; release them with free()
/// @return BAT_OK, BAT_BAD_FILE or BAT_NO_MEMORY
bat_status ply_labels_read(const char *header, size_t size, mesh_builder *builder, uint32_t **numbers, size_t *count,
                           bat_error *error);

/// Append the comments of a mesh.
void ply_labels_write(const bat_mesh *mesh, text_buffer *text);

#include "io/mesh/ply.h"

#include "io/common/bytes.h"
#include "io/common/json.h"

#include <math.h>

/// @file
/// The header of a PLY file, and numbers as text or bytes.

const char *const ply_texture_names[PLY_TEXTURE_NAMES][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};

void ply_header_free(ply_header *header)
{
    for (size_t i = 0; i < header->element_count; i++)
        free(header->elements[i].properties);
    free(header->elements);
    *header = (ply_header){0};
}

const ply_element *ply_header_find(const ply_header *header, const char *name)
{
    for (size_t i = 0; i < header->element_count; i++)
        if (label_name_is(header->elements[i].name, name))
            return &header->elements[i];
    return NULL;
}

size_t ply_property_find(const ply_element *element, const char *name)
{
    size_t i = 0;
    while (i < element->property_count && !label_name_is(element->properties[i].name, name))
        i++;
    return i;
}

/// The next word of the line; empty when there is none.
static label_name next_name(word_scan *scan)
{
    scan_skip_blanks(scan);
    label_name name = {scan->at, (size_t)(scan_word_end(scan) - scan->at)};
    scan->at += name.size;
    return name;
}

static bat_status read_encoding(word_scan *scan, ply_header *header, bat_error *error)
{
    static const char *const names[] = {
        [PLY_TEXT] = "ascii", [PLY_LITTLE_ENDIAN] = "binary_little_endian", [PLY_BIG_ENDIAN] = "binary_big_endian"};
    if (!scan_word(scan, "format"))
        return scan_word_fault(scan, BAT_NO_INDEX, "was found where 'format' is expected", error);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (scan_word(scan, names[i]))
        {
            header->encoding = (ply_encoding)i;
            return scan_word(scan, "1.0") ? BAT_OK : scan_word_fault(scan, BAT_NO_INDEX, "is not version 1.0 of PLY", error);
        }
    return scan_word_fault(scan, BAT_NO_INDEX, "is not ascii, binary_little_endian or binary_big_endian", error);
}

static bat_status read_type(word_scan *scan, ply_type *type, bat_error *error)
{
    static const char *const names[PLY_TYPE_COUNT][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                         {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                         {"float", "float32"}, {"double", "float64"}};
    for (int i = 0; i < PLY_TYPE_COUNT; i++)
        if (scan_word(scan, names[i][0]) || scan_word(scan, names[i][1]))
        {
            *type = (ply_type)i;
            return BAT_OK;
        }
    return scan_word_fault(scan, BAT_NO_INDEX, "is not a type of numbers", error);
}

static bat_status read_element(word_scan *scan, ply_header *header, bat_error *error)
{
    ply_element element = {.name = next_name(scan)};
    uint64_t count;
    if (element.name.size == 0)
        return scan_word_fault(scan, BAT_NO_INDEX, "was found where the element's name is expected", error);
    if (!scan_count(scan, (uint64_t)1 << 60, &count))
        return scan_word_fault(scan, BAT_NO_INDEX, "is not the number of elements", error);
    for (size_t i = 0; i < header->element_count; i++)
        if (label_names_equal(header->elements[i].name, element.name))
            return ERROR_FILE(error, scan->line, "the element's name is used already");
    element.count = size_clipped(count);
    return ARRAY_ADD(header->elements, header->element_capacity, header->element_count, element)
               ? BAT_OK
               : error_memory(error, header->element_count * sizeof element);
}

static bat_status read_property(word_scan *scan, ply_header *header, bat_error *error)
{
    if (header->element_count == 0)
        return ERROR_FILE(error, scan->line, "the property belongs to no element");
    ply_property property = {.list = scan_word(scan, "list")};
    bat_status status = property.list ? read_type(scan, &property.count_type, error) : BAT_OK;
    if (status == BAT_OK && property.list && property.count_type >= PLY_FLOAT32)
        status = ERROR_FILE(error, scan->line, "a list's length must be a whole number");
    if (status == BAT_OK)
        status = read_type(scan, &property.type, error);
    if (status != BAT_OK)
        return status;
    property.name = next_name(scan);
    if (property.name.size == 0)
        return scan_word_fault(scan, BAT_NO_INDEX, "was found where the property's name is expected", error);
    ply_element *element = &header->elements[header->element_count - 1];
    for (size_t i = 0; i < element->property_count; i++)
        if (label_names_equal(element->properties[i].name, property.name))
            return ERROR_FILE(error, scan->line, "the property's name is used already");
    return ARRAY_ADD(element->properties, element->property_capacity, element->property_count, property)
               ? BAT_OK
               : error_memory(error, element->property_count * sizeof property);
}

/// Read a header line after the format; `done` is set at the last one.
static bat_status read_line(word_scan *scan, ply_header *header, bool *done, bat_error *error)
{
    bat_status status = BAT_OK;
    if (scan_word(scan, "comment") || scan_word(scan, "obj_info"))
        return BAT_OK;
    if (scan_word(scan, "end_header"))
        *done = true;
    else if (scan_word(scan, "element"))
        status = read_element(scan, header, error);
    else if (scan_word(scan, "property"))
        status = read_property(scan, header, error);
    else
        return scan_word_fault(scan, BAT_NO_INDEX, "is not comment, obj_info, element, property or end_header", error);
    if (status == BAT_OK && !scan_line_done(scan))
        return scan_word_fault(scan, BAT_NO_INDEX, "is superfluous on this line of the header", error);
    return status;
}

bat_status ply_header_read(word_scan *scan, ply_header *header, bat_error *error)
{
    *header = (ply_header){0};
    if (!scan_word(scan, "ply") || !scan_line_done(scan))
        return ERROR_FILE(error, 1, "the file does not begin with a line 'ply'");
    bat_status status;
    do
    {
        if (!scan_next_line(scan))
            return ERROR_FILE(error, scan->line, "the file ends in its header");
    } while (scan_word(scan, "comment") || scan_word(scan, "obj_info"));
    status = read_encoding(scan, header, error);
    for (bool done = false; status == BAT_OK && !done;)
    {
        if (!scan_next_line(scan))
            return ERROR_FILE(error, scan->line, "the file ends in its header");
        status = read_line(scan, header, &done, error);
    }
    if (status == BAT_OK)
        (void)scan_next_line(scan);
    return status;
}

/// The number at some bytes.
static double number_of(ply_type type, const char *bytes, bool big_endian)
{
    switch (type)
    {
    case PLY_INT8:
        return (int8_t)*bytes;
    case PLY_INT16:
        return (int16_t)bytes_whole(bytes, 2, big_endian);
    case PLY_UINT16:
        return (double)bytes_whole(bytes, 2, big_endian);
    case PLY_INT32:
        return (int32_t)bytes_whole(bytes, 4, big_endian);
    case PLY_UINT32:
        return (double)bytes_whole(bytes, 4, big_endian);
    case PLY_FLOAT32:
        return bytes_real(bytes, 4, big_endian);
    case PLY_FLOAT64:
        return bytes_real(bytes, 8, big_endian);
    default:
        return (unsigned char)*bytes;
    }
}

/// Whether a number from a text file fits its type.
static bool fits_type(ply_type type, double value)
{
    static const double low[] = {INT8_MIN, 0, INT16_MIN, 0, INT32_MIN, 0};
    static const double high[] = {INT8_MAX, UINT8_MAX, INT16_MAX, UINT16_MAX, INT32_MAX, UINT32_MAX};
    return type >= PLY_FLOAT32 || (value == floor(value) && value >= low[type] && value <= high[type]);
}

static bool read_word(ply_source *source, ply_type type, double *value)
{
    word_scan scan = source->scan;
    bool lenient = source->lenient && type >= PLY_FLOAT32;
    if (!(scan_number(&scan, value) && fits_type(type, *value)) && !(lenient && scan_not_finite(&scan, value)))
        return false;
    source->scan = scan;
    return true;
}

bool ply_number(ply_source *source, ply_type type, double *value)
{
    if (source->encoding == PLY_TEXT)
        return read_word(source, type, value);
    size_t size = ply_type_size(type);
    if ((size_t)(source->scan.end - source->scan.at) < size)
        return false;
    double number = number_of(type, source->scan.at, source->encoding == PLY_BIG_ENDIAN);
    if (!isfinite(number) && !source->lenient)
        return false;
    *value = number;
    source->scan.at += size;
    return true;
}

bool ply_skip(ply_source *source, ply_type type, size_t count)
{
    size_t left = (size_t)(source->scan.end - source->scan.at);
    if (source->encoding != PLY_TEXT)
    {
        bool enough = count <= left / ply_type_size(type);
        source->scan.at += enough ? count * ply_type_size(type) : 0;
        return enough;
    }
    double ignored;
    for (size_t i = 0; i < count; i++)
        if (!read_word(source, type, &ignored))
            return false;
    return true;
}

// Names of faces in the comments of a PLY header. The names are JSON, since they may hold any character.

static const char *const KEYS[MESH_LABEL_NAMES] = {"object", "group", "material", "smoothing"};
static const char FILES_KEY[] = "material_files";

/// Read the string of a member, which may be missing. False for another value.
static bool read_name(const json_t *object, const char *key, label_name *name)
{
    const json_t *value = json_object_get(object, key);
    *name = (label_name){json_string_value(value), json_string_length(value)};
    return value == NULL || json_is_string(value);
}

/// Add the label of a parsed comment.
static bat_status add_label(const json_t *object, size_t line, mesh_builder *builder, uint32_t *number, bat_error *error)
{
    label_name names[MESH_LABEL_NAMES];
    for (int k = 0; k < MESH_LABEL_NAMES; k++)
        if (!read_name(object, KEYS[k], &names[k]))
            return ERROR_FILE(error, line, "'%s' of a label is no text", KEYS[k]);
    *number = label_table_add(&builder->labels, names);
    return *number != BAT_MESH_NONE ? BAT_OK : error_memory(error, sizeof *builder->labels.labels);
}

static bat_status set_files(const json_t *object, size_t line, mesh_builder *builder, bat_error *error)
{
    label_name files;
    if (!read_name(object, FILES_KEY, &files))
        return ERROR_FILE(error, line, "'%s' is no text", FILES_KEY);
    if (files.begin == NULL)
        return BAT_OK;
    free(builder->mesh.material_files);
    builder->mesh.material_files = label_name_copy(files);
    return builder->mesh.material_files != NULL ? BAT_OK : error_memory(error, files.size);
}

/// Read the JSON after `comment label` to the end of its line.
static bat_status read_comment(word_scan *scan, mesh_builder *builder, uint32_t **numbers, size_t *count, size_t *capacity,
                               bat_error *error)
{
    const char *newline = memchr(scan->at, '\n', (size_t)(scan->end - scan->at));
    json_t *object;
    bat_status status =
        json_parse(scan->at, (size_t)((newline != NULL ? newline : scan->end) - scan->at), 0, scan->line, &object, error);
    if (status != BAT_OK)
        return status;
    if (!json_is_object(object))
        status = ERROR_FILE(error, scan->line, "a label is no JSON object");
    else if (json_object_get(object, FILES_KEY) != NULL)
        status = set_files(object, scan->line, builder, error);
    else if (!ARRAY_GROW(*numbers, *capacity, *count + 1))
        status = error_memory(error, *count * sizeof **numbers);
    else
    {
        status = add_label(object, scan->line, builder, *numbers + *count, error);
        *count += status == BAT_OK;
    }
    json_decref(object);
    return status;
}

bat_status ply_labels_read(const char *header, size_t size, mesh_builder *builder, uint32_t **numbers, size_t *count,
                           bat_error *error)
{
    word_scan scan = word_scan_start(header, size);
    size_t capacity = 0, found = 0;
    uint32_t *made = NULL;
    bat_status status = BAT_OK;
    do
        if (scan_word(&scan, "comment") && scan_word(&scan, PLY_LABEL) && !scan_line_done(&scan) && *scan.at == '{')
            status = read_comment(&scan, builder, &made, &found, &capacity, error);
    while (status == BAT_OK && scan_next_line(&scan));
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    *numbers = made;
    *count = found;
    return BAT_OK;
}

static void append_member(text_buffer *text, const char **separator, const char *key, const char *value)
{
    text_append_string(text, *separator);
    json_text_string(text, key, strlen(key));
    text_append(text, ":", 1);
    json_text_string(text, value, strlen(value));
    *separator = ",";
}

void ply_labels_write(const bat_mesh *mesh, text_buffer *text)
{
    const char *separator = "comment " PLY_LABEL " {";
    if (mesh->material_files != NULL)
    {
        append_member(text, &separator, FILES_KEY, mesh->material_files);
        text_append_string(text, "}\n");
    }
    for (size_t i = 0; mesh->face_labels != NULL && i < mesh->label_count; i++)
    {
        separator = "";
        text_append_string(text, "comment " PLY_LABEL " {");
        for (int k = 0; k < MESH_LABEL_NAMES; k++)
            if (mesh_label_text(&mesh->labels[i], k) != NULL)
                append_member(text, &separator, KEYS[k], mesh_label_text(&mesh->labels[i], k));
        text_append_string(text, "}\n");
    }
}

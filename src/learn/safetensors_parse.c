#include "base/error.h"
#include "base/file_bytes.h"
#include "base/json_scan.h"
#include "learn/safetensors.h"

/// An array as the header has it.
typedef struct header_entry
{
    safetensors_array array;
    size_t begin, end; ///< its place in the data
} header_entry;

/// The file in its parts, while it is taken apart.
typedef struct parts
{
    json_t *header;
    const unsigned char *data;
    size_t data_size;
    header_entry *entries;
    size_t entry_count;
} parts;

static bat_status fault(bat_error *error, const char *name, const char *what)
{
    return ERROR_FILE(error, 0, "array '%s' of the header %s", name, what);
}

/// A whole number of 0 or more.
static bool size_of(const json_t *value, size_t *size)
{
    json_int_t number = json_integer_value(value);
    *size = (size_t)number;
    return json_is_integer(value) && number >= 0 && (uint64_t)number <= SIZE_MAX;
}

static bat_status parse_type(const json_t *value, safetensors_array *array, bat_error *error)
{
    for (int type = 0; json_is_string(value) && type < SAFETENSORS_TYPE_COUNT; type++)
        if (strcmp(json_string_value(value), safetensors_types[type].name) == 0)
        {
            array->type = (safetensors_type)type;
            return BAT_OK;
        }
    return fault(error, array->name, "has no known dtype");
}

static bat_status parse_shape(const json_t *value, safetensors_array *array, bat_error *error)
{
    if (!json_is_array(value))
        return fault(error, array->name, "has no shape");
    array->rank = json_array_size(value);
    if (array->rank > SAFETENSORS_MAX_RANK)
        return ERROR_UNSUPPORTED(error, 0, "array '%s' has %zu dimensions, more than %d", array->name, array->rank,
                                 SAFETENSORS_MAX_RANK);
    array->count = 1;
    for (size_t i = 0; i < array->rank; i++)
        if (!size_of(json_array_get(value, i), &array->shape[i]) ||
            size_multiply_overflows(array->count, array->shape[i], &array->count))
            return fault(error, array->name, "has an impossible shape");
    return BAT_OK;
}

static bat_status parse_place(const json_t *value, size_t data_size, header_entry *entry, bat_error *error)
{
    const safetensors_array *array = &entry->array;
    if (!json_is_array(value) || json_array_size(value) != 2 || !size_of(json_array_get(value, 0), &entry->begin) ||
        !size_of(json_array_get(value, 1), &entry->end))
        return fault(error, array->name, "has no data_offsets");
    if (entry->begin > entry->end || entry->end > data_size)
        return fault(error, array->name, "has data_offsets outside the file");
    size_t bytes;
    if (size_multiply_overflows(array->count, safetensors_element_size(array->type), &bytes) ||
        bytes != entry->end - entry->begin)
        return fault(error, array->name, "has data_offsets that do not fit its shape");
    return BAT_OK;
}

static bat_status parse_entry(const char *name, const json_t *value, size_t data_size, header_entry *entry, bat_error *error)
{
    entry->array.name = name;
    if (!json_is_object(value) || json_object_size(value) != 3)
        return fault(error, name, "does not consist of dtype, shape and data_offsets");
    bat_status status = parse_type(json_object_get(value, "dtype"), &entry->array, error);
    if (status == BAT_OK)
        status = parse_shape(json_object_get(value, "shape"), &entry->array, error);
    return status == BAT_OK ? parse_place(json_object_get(value, "data_offsets"), data_size, entry, error) : status;
}

DEFINE_ORDER(compare_places, header_entry, begin, end)

/// Sort the arrays by place and see that they cover the data.
static bat_status check_cover(parts *file, bat_error *error)
{
    if (file->entry_count > 1)
        qsort(file->entries, file->entry_count, sizeof *file->entries, compare_places);
    size_t end = 0;
    for (size_t i = 0; i < file->entry_count; i++)
    {
        if (file->entries[i].begin != end)
            return fault(error, file->entries[i].array.name, "leaves a gap before it or overlaps another");
        end = file->entries[i].end;
    }
    if (end != file->data_size)
        return ERROR_FILE(error, 0, "%zu bytes at the end belong to no array", file->data_size - end);
    return BAT_OK;
}

static bat_status parse_entries(parts *file, bat_error *error)
{
    size_t members = json_object_size(file->header);
    if (array_zeros(&file->entries, members + 1, sizeof *file->entries, error) != BAT_OK)
        return BAT_NO_MEMORY;
    const char *name;
    json_t *value;
    json_object_foreach(file->header, name, value)
    {
        if (strcmp(name, SAFETENSORS_NOTES) == 0)
            continue;
        bat_status status = parse_entry(name, value, file->data_size, &file->entries[file->entry_count++], error);
        if (status != BAT_OK)
            return status;
    }
    return check_cover(file, error);
}

/// Find the header and read its JSON.
static bat_status open_header(const unsigned char *bytes, size_t size, parts *file, bat_error *error)
{
    if (size < SAFETENSORS_LENGTH_BYTES)
        return ERROR_FILE(error, 0, "the file is too short to have a header");
    uint64_t length;
    safetensors_copy(&length, bytes, 1, sizeof length);
    size_t rest = size - SAFETENSORS_LENGTH_BYTES;
    if (length > SAFETENSORS_MAX_HEADER || length > rest)
        return ERROR_FILE(error, 0, "a header of %llu bytes does not fit the file", (unsigned long long)length);
    const char *text = (const char *)bytes + SAFETENSORS_LENGTH_BYTES;
    if (length == 0 || text[0] != '{')
        return ERROR_FILE(error, 0, "the header is no JSON object");
    bat_error cause;
    bat_status status = json_parse(text, (size_t)length, 0, 1, &file->header, &cause);
    if (status == BAT_NO_MEMORY)
        return error_memory(error, (size_t)length);
    if (status != BAT_OK)
        return error_set(error, status, BAT_NO_INDEX, 0, "the header is no JSON object: %s", cause.text);
    file->data = bytes + SAFETENSORS_LENGTH_BYTES + length;
    file->data_size = rest - (size_t)length;
    return BAT_OK;
}

static bat_status check_notes(const json_t *notes, bat_error *error)
{
    const char *key;
    json_t *value;
    if (notes != NULL && !json_is_object(notes))
        return ERROR_FILE(error, 0, "%s of the header is no object", SAFETENSORS_NOTES);
    json_object_foreach((json_t *)notes, key, value)
    {
        if (!json_is_string(value))
            return ERROR_FILE(error, 0, "note '%s' of the header is no string", key);
    }
    return BAT_OK;
}

static const size_t ALIGNMENT = 64;

static size_t aligned(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/// Copy a string to *next, which moves on behind it.
static const char *keep_string(unsigned char **next, const char *string)
{
    size_t size = strlen(string) + 1;
    char *kept = memcpy(*next, string, size);
    *next += size;
    return kept;
}

/// Bytes of everything that the content keeps: elements first, each array aligned, then strings.
static size_t memory_size(const parts *file, const json_t *notes)
{
    size_t size = 0;
    for (size_t i = 0; i < file->entry_count; i++)
        size += aligned(file->entries[i].end - file->entries[i].begin) + strlen(file->entries[i].array.name) + 1;
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)notes, key, value) size += strlen(key) + json_string_length(value) + 2;
    return size;
}

/// Copy what the file says into memory of its own.
static bat_status keep(const parts *file, safetensors *content, bat_error *error)
{
    const json_t *notes = json_object_get(file->header, SAFETENSORS_NOTES);
    size_t size = memory_size(file, notes);
    safetensors_array *arrays = memory_array(file->entry_count, sizeof *arrays);
    safetensors_note *note = memory_array(json_object_size(notes), sizeof *note);
    safetensors kept = {arrays, file->entry_count, note, json_object_size(notes), memory_array(size, 1)};
    if (arrays == NULL || note == NULL || kept.memory == NULL)
    {
        safetensors_free(&kept);
        return error_memory(error, size);
    }
    unsigned char *next = kept.memory;
    for (size_t i = 0; i < file->entry_count; i++)
    {
        const header_entry *entry = &file->entries[i];
        arrays[i] = entry->array;
        arrays[i].values = next;
        safetensors_copy(next, file->data + entry->begin, entry->array.count, safetensors_element_size(entry->array.type));
        next += aligned(entry->end - entry->begin);
    }
    for (size_t i = 0; i < file->entry_count; i++)
        arrays[i].name = keep_string(&next, arrays[i].name);
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)notes, key, value)
    {
        note->key = keep_string(&next, key);
        note->value = keep_string(&next, json_string_value(value));
        note++;
    }
    *content = kept;
    return BAT_OK;
}

bat_status safetensors_parse(const void *bytes, size_t size, safetensors *content, bat_error *error)
{
    parts file = {0};
    bat_status status = open_header(bytes, size, &file, error);
    if (status == BAT_OK)
        status = parse_entries(&file, error);
    if (status == BAT_OK)
        status = check_notes(json_object_get(file.header, SAFETENSORS_NOTES), error);
    if (status == BAT_OK)
        status = keep(&file, content, error);
    if (status != BAT_OK && error != NULL)
        json_printable(error->text); // which may have a name from the file
    free(file.entries);
    json_decref(file.header);
    return status;
}

bat_status safetensors_read(const char *path, safetensors *content, bat_error *error)
{
    text_buffer bytes = {0};
    bat_status status = file_bytes_read(path, FILE_MAX_BYTES, &bytes, error);
    if (status == BAT_OK)
        status = safetensors_parse(bytes.data, bytes.size, content, error);
    text_free(&bytes);
    return status;
}

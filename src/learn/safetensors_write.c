#include "base/atomic_file.h"
#include "base/error.h"
#include "learn/safetensors.h"

#include <jansson.h>

static const char SPACES[] = "        ";

/// What was wrong with a string that Jansson did not take: it says the same for want of memory as for what is not UTF-8.
static bat_status string_fault(const char *string)
{
    json_t *unchecked = json_string_nocheck(string);
    bat_status status = unchecked != NULL ? BAT_INVALID_ARGUMENT : BAT_NO_MEMORY;
    json_decref(unchecked);
    return status;
}

/// Put a new member into an object, which takes it. A value of null means that there was no memory for it.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (the name is there already or is not UTF-8) or BAT_NO_MEMORY
static bat_status add_member(json_t *object, const char *name, json_t *value)
{
    bool taken = json_object_get(object, name) != NULL;
    if (object == NULL || value == NULL || taken)
    {
        json_decref(value);
        return taken ? BAT_INVALID_ARGUMENT : BAT_NO_MEMORY;
    }
    return json_object_set_new(object, name, value) == 0 ? BAT_OK : string_fault(name);
}

static bat_status add_notes(const safetensors *content, json_t *header)
{
    json_t *notes = json_object();
    bat_status status = BAT_OK;
    for (size_t i = 0; i < content->note_count && status == BAT_OK; i++)
    {
        json_t *value = json_string(content->notes[i].value);
        status = value != NULL ? add_member(notes, content->notes[i].key, value) : string_fault(content->notes[i].value);
    }
    if (status == BAT_OK)
        return add_member(header, SAFETENSORS_NOTES, notes);
    json_decref(notes);
    return status;
}

/// Bytes of an array; false when its count or place is impossible.
static bool array_bytes(const safetensors_array *array, size_t *bytes)
{
    size_t count = 1;
    if (array->rank > SAFETENSORS_MAX_RANK)
        return false;
    for (size_t i = 0; i < array->rank; i++)
        if (size_multiply_overflows(count, array->shape[i], &count))
            return false;
    return count == array->count && !size_multiply_overflows(count, safetensors_element_size(array->type), bytes);
}

static json_t *array_object(const safetensors_array *array, size_t begin, size_t end)
{
    json_t *shape = json_array();
    for (size_t i = 0; i < array->rank; i++)
        if (json_array_append_new(shape, json_integer((json_int_t)array->shape[i])) != 0)
        {
            json_decref(shape);
            return NULL;
        }
    return json_pack("{s:s, s:o, s:[I, I]}", "dtype", safetensors_types[array->type].name, "shape", shape, "data_offsets",
                     (json_int_t)begin, (json_int_t)end);
}

static bat_status header_object(const safetensors *content, json_t *header, bat_error *error)
{
    bat_status status = content->note_count > 0 ? add_notes(content, header) : BAT_OK;
    if (status == BAT_INVALID_ARGUMENT)
        return error_set(error, status, BAT_NO_INDEX, 0, "a note is there twice or is not UTF-8");
    size_t end = 0;
    for (size_t i = 0; i < content->array_count && status == BAT_OK; i++)
    {
        const safetensors_array *array = &content->arrays[i];
        size_t begin = end, bytes;
        if (!array_bytes(array, &bytes) || bytes > SIZE_MAX - begin)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "array %zu has an impossible shape", i);
        end = begin + bytes;
        bool reserved = strcmp(array->name, SAFETENSORS_NOTES) == 0;
        status = reserved ? BAT_INVALID_ARGUMENT : add_member(header, array->name, array_object(array, begin, end));
        if (status == BAT_INVALID_ARGUMENT)
            return error_set(error, status, i, 0, "the name of array %zu is taken or is not UTF-8", i);
    }
    return status == BAT_OK ? BAT_OK : error_memory(error, content->array_count * sizeof *content->arrays);
}

static int append_piece(const char *piece, size_t size, void *text)
{
    text_append(text, piece, size);
    return ((text_buffer *)text)->failed ? -1 : 0;
}

bat_status safetensors_encode(const safetensors *content, text_buffer *bytes, bat_error *error)
{
    json_t *header = json_object();
    bat_status status = header_object(content, header, error);
    text_buffer text = {0};
    if (status == BAT_OK && json_dump_callback(header, append_piece, &text, JSON_COMPACT) != 0)
        status = error_memory(error, text.size);
    json_decref(header);
    if (status == BAT_OK)
    {
        size_t padding = (8 - text.size % 8) % 8;
        uint64_t stated = text.size + padding, stored;
        safetensors_copy(&stored, &stated, 1, sizeof stored);
        text_append(bytes, (const char *)&stored, sizeof stored);
        text_append(bytes, text.data, text.size);
        text_append(bytes, SPACES, padding);
        for (size_t i = 0; i < content->array_count; i++)
        {
            const safetensors_array *array = &content->arrays[i];
            size_t size = safetensors_element_size(array->type);
            char *place = text_reserve(bytes, array->count * size);
            if (place == NULL)
                break;
            safetensors_copy(place, array->values, array->count, size);
            text_advance(bytes, place + array->count * size);
        }
        if (bytes->failed)
            status = error_memory(error, bytes->size);
    }
    text_free(&text);
    return status;
}

bat_status safetensors_write(const char *path, const safetensors *content, bat_error *error)
{
    text_buffer bytes = {0};
    bat_status status = safetensors_encode(content, &bytes, error);
    if (status == BAT_OK)
        status = atomic_file_write(path, bytes.data, bytes.size, error);
    text_free(&bytes);
    return status;
}

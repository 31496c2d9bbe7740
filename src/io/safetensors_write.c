#include "base/error.h"
#include "base/memory.h"
#include "io/atomic_file.h"
#include "io/safetensors_type.h"

#include <errno.h>
#include <jansson.h>

static const char SPACES[] = "        ";

/// Put a new member into an object, which takes it. False when the name is there already or is not UTF-8, or out of memory.
static bool add_member(json_t *object, const char *name, json_t *value)
{
    if (json_object_get(object, name) != NULL)
    {
        json_decref(value);
        return false;
    }
    return json_object_set_new(object, name, value) == 0;
}

static json_t *notes_object(const safetensors *content)
{
    json_t *notes = json_object();
    for (size_t i = 0; i < content->note_count; i++)
        if (!add_member(notes, content->notes[i].key, json_string(content->notes[i].value)))
        {
            json_decref(notes);
            return NULL;
        }
    return notes;
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
        (void)json_array_append_new(shape, json_integer((json_int_t)array->shape[i]));
    return json_pack("{s:s, s:o, s:[I, I]}", "dtype", safetensors_types[array->type].name, "shape", shape, "data_offsets",
                     (json_int_t)begin, (json_int_t)end);
}

static bat_status header_object(const safetensors *content, json_t *header, bat_error *error)
{
    if (content->note_count > 0 && !add_member(header, SAFETENSORS_NOTES, notes_object(content)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a note is there twice or is not UTF-8");
    size_t end = 0;
    for (size_t i = 0; i < content->array_count; i++)
    {
        const safetensors_array *array = &content->arrays[i];
        size_t begin = end, bytes;
        if (!array_bytes(array, &bytes) || bytes > SIZE_MAX - begin)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "array %zu has an impossible shape", i);
        end = begin + bytes;
        bool reserved = strcmp(array->name, SAFETENSORS_NOTES) == 0;
        if (reserved || !add_member(header, array->name, array_object(array, begin, end)))
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "the name of array %zu is taken or is not UTF-8", i);
    }
    return BAT_OK;
}

static void append_header(const char *text, text_buffer *bytes)
{
    size_t length = strlen(text), padding = (8 - length % 8) % 8;
    uint64_t stated = length + padding, stored;
    safetensors_copy(&stored, &stated, 1, sizeof stored);
    text_append(bytes, (const char *)&stored, sizeof stored);
    text_append(bytes, text, length);
    text_append(bytes, SPACES, padding);
}

static void append_elements(const safetensors_array *array, text_buffer *bytes)
{
    size_t size = safetensors_element_size(array->type);
    char *place = text_reserve(bytes, array->count * size);
    if (place == NULL)
        return;
    safetensors_copy(place, array->values, array->count, size);
    text_advance(bytes, place + array->count * size);
}

bat_status safetensors_encode(const safetensors *content, text_buffer *bytes, bat_error *error)
{
    json_t *header = json_object();
    bat_status status = header_object(content, header, error);
    char *text = status == BAT_OK ? json_dumps(header, JSON_COMPACT) : NULL;
    json_decref(header);
    if (status != BAT_OK)
        return status;
    if (text != NULL)
        append_header(text, bytes);
    for (size_t i = 0; i < content->array_count && text != NULL; i++)
        append_elements(&content->arrays[i], bytes);
    bool failed = text == NULL || bytes->failed;
    free(text);
    return failed ? error_memory(error, bytes->size) : BAT_OK;
}

bat_status safetensors_write(const char *path, const safetensors *content, bat_error *error)
{
    text_buffer bytes = {0};
    atomic_file file;
    bat_status status = safetensors_encode(content, &bytes, error);
    if (status == BAT_OK)
        status = atomic_file_begin(path, &file, error);
    if (status == BAT_OK)
    {
        if (fwrite(bytes.data, 1, bytes.size, file.stream) != bytes.size)
            status = error_set(error, BAT_FILE_ACCESS, BAT_NO_INDEX, 0, "cannot write: %s", strerror(errno));
        status = atomic_file_end(&file, status, error);
    }
    text_free(&bytes);
    return status;
}

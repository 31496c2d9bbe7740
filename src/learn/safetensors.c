#include "learn/safetensors.h"

#include "base/error.h"
#include "batten/config.h"

size_t safetensors_element_size(safetensors_type type)
{
    return safetensors_types[type].size;
}

void safetensors_free(safetensors *content)
{
    free((void *)content->arrays);
    free((void *)content->notes);
    free(content->memory);
    *content = (safetensors){0};
}

const safetensors_array *safetensors_find(const safetensors *content, const char *name)
{
    for (size_t i = 0; i < content->array_count; i++)
        if (strcmp(content->arrays[i].name, name) == 0)
            return &content->arrays[i];
    return NULL;
}

const char *safetensors_find_note(const safetensors *content, const char *key)
{
    for (size_t i = 0; i < content->note_count; i++)
        if (strcmp(content->notes[i].key, key) == 0)
            return content->notes[i].value;
    return NULL;
}

static bool is_integer(safetensors_type type)
{
    return type != SAFETENSORS_F16 && type != SAFETENSORS_BF16 && type != SAFETENSORS_F32 && type != SAFETENSORS_F64 &&
           type != SAFETENSORS_U64;
}

static int64_t integer_at(const safetensors_array *array, size_t i)
{
    const void *values = array->values;
    switch (array->type)
    {
    case SAFETENSORS_I8:
        return ((const int8_t *)values)[i];
    case SAFETENSORS_U16:
        return ((const uint16_t *)values)[i];
    case SAFETENSORS_I16:
        return ((const int16_t *)values)[i];
    case SAFETENSORS_U32:
        return ((const uint32_t *)values)[i];
    case SAFETENSORS_I32:
        return ((const int32_t *)values)[i];
    case SAFETENSORS_I64:
        return ((const int64_t *)values)[i];
    default:
        return ((const uint8_t *)values)[i];
    }
}

/// Whether doubles hold every value of the type.
static bool fits_double(safetensors_type type)
{
    return type == SAFETENSORS_F32 || type == SAFETENSORS_F64 || (is_integer(type) && type != SAFETENSORS_I64);
}

static double double_at(const safetensors_array *array, size_t i)
{
    if (array->type == SAFETENSORS_F32)
        return (double)((const float *)array->values)[i];
    if (array->type == SAFETENSORS_F64)
        return ((const double *)array->values)[i];
    return (double)integer_at(array, i);
}

/// The array of a name, a count and a type that `fits`.
static bat_status find_fitting(const safetensors *content, const char *name, size_t count, bool (*fits)(safetensors_type),
                               const safetensors_array **array, bat_error *error)
{
    *array = safetensors_find(content, name);
    if (*array == NULL)
        return ERROR_FILE(error, 0, "there is no array '%s'", name);
    if ((*array)->count != count)
        return ERROR_FILE(error, 0, "array '%s' has %zu elements, not %zu", name, (*array)->count, count);
    if (!fits((*array)->type))
        return ERROR_FILE(error, 0, "array '%s' is of the wrong type %s", name, safetensors_types[(*array)->type].name);
    return BAT_OK;
}

bat_status safetensors_integers(const safetensors *content, const char *name, size_t count, int64_t *values,
                                bat_error *error)
{
    const safetensors_array *array;
    bat_status status = find_fitting(content, name, count, is_integer, &array, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        values[i] = integer_at(array, i);
    return status;
}

bat_status safetensors_doubles(const safetensors *content, const char *name, size_t count, double *values, bat_error *error)
{
    const safetensors_array *array;
    bat_status status = find_fitting(content, name, count, fits_double, &array, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        values[i] = double_at(array, i);
    return status;
}

#if !BAT_HAS_FILES
bat_status safetensors_read(const char *path BAT_UNUSED, safetensors *content BAT_UNUSED, bat_error *error)
{
    return ERROR_UNSUPPORTED(error, 0, "this build of the library reads no files");
}
#endif

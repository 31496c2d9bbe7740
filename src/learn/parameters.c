#include "learn/parameters.h"

#include "base/error.h"

#include <stdio.h>

size_t learn_parameters_add(learn_parameters *set, size_t rows, size_t columns, const char *name)
{
    size_t numbers, end = 0;
    bool countable = !size_multiply_overflows(rows > 0 ? rows : 1, columns, &numbers) &&
                     !__builtin_add_overflow(set->total, numbers, &end);
    if (set->status == BAT_OK && (!countable || strlen(name) >= LEARN_NAME_SIZE))
        set->status = BAT_TOO_LARGE;
    if (set->status == BAT_OK && !ARRAY_GROW(set->list, set->capacity, set->count + 1))
        set->status = BAT_NO_MEMORY;
    if (set->status != BAT_OK)
        return 0;
    learn_parameter *added = &set->list[set->count];
    *added =
        (learn_parameter){.rank = rows > 0 ? 2 : 1, .rows = rows > 0 ? rows : 1, .columns = columns, .offset = set->total};
    (void)snprintf(added->name, sizeof added->name, "%s", name);
    set->total = end;
    return set->count++;
}

bat_status learn_parameters_allocate(learn_parameters *set, bat_error *error)
{
    if (set->status == BAT_OK)
    {
        set->values = memory_array(set->total, sizeof *set->values);
        if (set->values == NULL)
            set->status = BAT_NO_MEMORY;
        else
            memset(set->values, 0, set->total * sizeof *set->values);
    }
    bat_status status = set->status;
    if (status == BAT_NO_MEMORY)
        (void)error_memory(error, set->total * sizeof *set->values);
    else if (status != BAT_OK)
        (void)error_set(error, status, BAT_NO_INDEX, 0, "the parameters are too many or a name is too long");
    if (status != BAT_OK)
        learn_parameters_free(set);
    return status;
}

void learn_parameters_free(learn_parameters *set)
{
    free(set->list);
    free(set->values);
    *set = (learn_parameters){0};
}

static bat_status extract_parameter(const learn_parameter *parameter, const safetensors_array *array, real *values,
                                    bat_error *error)
{
    bool matrix = parameter->rank == 2;
    bool fits = array->rank == parameter->rank && array->shape[0] == (matrix ? parameter->rows : parameter->columns) &&
                (!matrix || array->shape[1] == parameter->columns);
    if (!fits)
        return ERROR_FILE(error, 0, "array '%s' has the wrong shape", array->name);
    if (array->type == SAFETENSORS_F32)
        for (size_t k = 0; k < array->count; k++)
            values[k] = (real)((const float *)array->values)[k];
    else if (array->type == SAFETENSORS_F64)
        for (size_t k = 0; k < array->count; k++)
            values[k] = (real)((const double *)array->values)[k];
    else
        return ERROR_FILE(error, 0, "array '%s' is not of single or double precision", array->name);
    for (size_t k = 0; k < array->count; k++)
        if (!isfinite(values[k]))
            return error_set(error, BAT_BAD_FILE, k, 0, "array '%s' has no finite number at %zu", array->name, k);
    return BAT_OK;
}

bat_status learn_parameters_extract(const learn_parameters *set, const safetensors *content, const char *prefix, real *block,
                                    bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < set->count && status == BAT_OK; i++)
    {
        const learn_parameter *parameter = &set->list[i];
        char name[2 * LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "%s%s", prefix, parameter->name);
        const safetensors_array *array = safetensors_find(content, name);
        if (array == NULL)
            return ERROR_FILE(error, 0, "there is no array '%s'", name);
        status = extract_parameter(parameter, array, block + parameter->offset, error);
    }
    return status;
}

#include "research/learn/parameters.h"

#include "base/error.h"

#include <stdio.h>
#include <stdlib.h>

static size_t parameter_size(const learn_parameter *parameter)
{
    return parameter->rows * parameter->columns;
}

void learn_parameter_fill(learn_parameters *set, size_t index, real value)
{
    real *values = learn_parameter_values(set, index);
    for (size_t i = 0; i < parameter_size(&set->list[index]); i++)
        values[i] = value;
}

void learn_parameter_fill_normal(learn_parameters *set, size_t index, double deviation, bat_random *random)
{
    real *values = learn_parameter_values(set, index);
    for (size_t i = 0; i < parameter_size(&set->list[index]); i++)
        values[i] = (real)(deviation * bat_random_normal(random));
}

void learn_parameters_describe(const learn_parameters *set, const real *block, const char *prefix, safetensors_array *arrays,
                               char (*names)[2 * LEARN_NAME_SIZE])
{
    for (size_t i = 0; i < set->count; i++)
    {
        const learn_parameter *parameter = &set->list[i];
        (void)snprintf(names[i], sizeof names[i], "%s%s", prefix, parameter->name);
        bool matrix = parameter->rank == 2;
        arrays[i] = (safetensors_array){
            .name = names[i],
            .type = sizeof(real) == sizeof(float) ? SAFETENSORS_F32 : SAFETENSORS_F64,
            .rank = parameter->rank,
            .shape = {matrix ? parameter->rows : parameter->columns, matrix ? parameter->columns : 0},
            .count = parameter_size(parameter),
            .values = block + parameter->offset,
        };
    }
}

bat_status learn_parameters_write(const learn_parameters *set, const char *path, const safetensors_note *notes,
                                  size_t note_count, bat_error *error)
{
    safetensors_array *arrays = calloc(set->count, sizeof *arrays);
    char(*names)[2 * LEARN_NAME_SIZE] = calloc(set->count, sizeof *names);
    bat_status status;
    if (arrays == NULL || names == NULL)
        status = error_memory(error, set->count * (sizeof *arrays + sizeof *names));
    else
    {
        learn_parameters_describe(set, set->values, "", arrays, names);
        safetensors content = {.arrays = arrays, .array_count = set->count, .notes = notes, .note_count = note_count};
        status = safetensors_write(path, &content, error);
    }
    free(arrays);
    free(names);
    return status;
}

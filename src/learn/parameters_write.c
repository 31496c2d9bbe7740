#include "base/error.h"
#include "learn/parameters.h"

#include <stdlib.h>

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

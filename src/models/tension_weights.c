#include "models/tension_weights.h"

#include "models/tension_network.h"
#include "models/tension_sample.h"

#include <stdio.h>

/// The arrays' prefix in this file: a checkpoint has more than one set of weights.
static const char *find_prefix(const safetensors *content)
{
    static const char *const prefixes[] = {"", "best.", "weight."};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++)
    {
        char name[LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "%sinput_proj.0.weight", prefixes[i]);
        if (safetensors_find(content, name) != NULL)
            return prefixes[i];
    }
    return "";
}

/// Which of the networks of table 3 a file holds shows in its first layer.
static bat_tension_embedding find_embedding(const safetensors *content, const char *prefix)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%sinput_proj.0.weight", prefix);
    const safetensors_array *first = safetensors_find(content, name);
    size_t inputs = first != NULL && first->rank == 2 ? first->shape[1] : 0;
    return inputs == TENSION_FEATURES                    ? BAT_TENSION_EMBEDDING_NONE
           : inputs == TENSION_FEATURES + TENSION_SPACES ? BAT_TENSION_EMBEDDING_ONE_HOT
                                                         : BAT_TENSION_EMBEDDING_LEARNED;
}

bat_status tension_weights_read(const char *path, learn_parameters *parameters, bat_tension_embedding *embedding,
                                bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    const char *prefix = find_prefix(&content);
    *embedding = find_embedding(&content, prefix);
    *parameters = (learn_parameters){0};
    status = tension_predictor_make(*embedding, parameters, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(parameters, &content, prefix, parameters->values, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    safetensors_free(&content);
    return status;
}

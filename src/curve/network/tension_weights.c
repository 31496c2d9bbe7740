#include "curve/network/tension_weights.h"

#include "curve/network/tension_network.h"
#include "learn/weights.h"

#include <stdio.h>

bool tension_weights_prefix(const safetensors *content, const char *wanted, const char **prefix)
{
    static const char *const prefixes[] = {"", "best.", "weight."};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++)
    {
        char name[LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "%s%s", prefixes[i], wanted);
        *prefix = prefixes[i];
        if (safetensors_find(content, name) != NULL)
            return true;
    }
    *prefix = "";
    return false;
}

/// Which of the networks of table 3 a file holds shows in its first layer.
static tension_embedding find_embedding(const safetensors *content, const char *prefix)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%sinput_proj.0.weight", prefix);
    const safetensors_array *first = safetensors_find(content, name);
    size_t inputs = first != NULL && first->rank == 2 ? first->shape[1] : 0;
    return inputs == TENSION_FEATURES                    ? TENSION_NO_SPACE
           : inputs == TENSION_FEATURES + TENSION_SPACES ? TENSION_ONE_HOT
                                                         : TENSION_EMBEDDED;
}

bat_status tension_weights_take(const safetensors *content, learn_parameters *parameters, tension_embedding *embedding,
                                bat_error *error)
{
    const char *prefix;
    (void)tension_weights_prefix(content, "input_proj.0.weight", &prefix);
    *embedding = find_embedding(content, prefix);
    *parameters = (learn_parameters){0};
    bat_status status = tension_network_make_embedded(*embedding, parameters, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(parameters, content, prefix, parameters->values, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    return status;
}

bat_status tension_weights_read(const char *path, learn_parameters *parameters, tension_embedding *embedding,
                                bat_error *error)
{
    if (path == NULL)
        return tension_weights_take(&weights_published, parameters, embedding, error);
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    status = tension_weights_take(&content, parameters, embedding, error);
    safetensors_free(&content);
    return status;
}

#include "learn/model.h"

#include "base/error.h"

#include <stdio.h>

/// Whether a file holds an array, under any prefix.
static bool find_array(const char *array, learn_source *source)
{
    static const char *const prefixes[] = {"", "best.", "weight."};
    for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++)
    {
        char name[2 * LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "%s%s", prefixes[i], array);
        source->prefix = prefixes[i];
        if (safetensors_find(source->content, name) != NULL)
            return true;
    }
    source->prefix = "";
    return false;
}

static bool begins_with(const char *recipe, const char *words)
{
    size_t length = strlen(words);
    return recipe != NULL && strcspn(recipe, ",") == length && strncmp(recipe, words, length) == 0;
}

static const learn_network *find_network(const learn_networks *networks, learn_source *source, bat_error *error)
{
    const char *recipe = safetensors_find_note(source->content, "recipe");
    const learn_network *row = NULL;
    for (size_t i = 0; i < networks->count; i++)
    {
        row = networks->rows[i];
        bool found = find_array(row->array, source);
        if (row->recipe == NULL ? found : begins_with(recipe, row->recipe))
            return row;
    }
    if (row->recipe == NULL)
        return row;
    (void)ERROR_FILE(error, 0, "the file contains no such network; its recipe is '%.60s'", recipe != NULL ? recipe : "");
    return NULL;
}

static bat_status take_weights(const learn_networks *networks, const safetensors *content, learn_model *model,
                               bat_error *error)
{
    learn_source source = {.content = content};
    learn_parameters parameters = {0};
    model->kind = find_network(networks, &source, error);
    if (model->kind == NULL)
        return BAT_BAD_FILE;
    bat_status status = model->kind->make(&source, &parameters, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(&parameters, content, source.prefix, parameters.values, error);
    if (status == BAT_OK)
        status = model->kind->pack(&source, &parameters, &model->network, error);
    learn_parameters_free(&parameters);
    return status;
}

bat_status learn_model_read(const learn_networks *networks, const char *path, size_t size, learn_model **model,
                            bat_error *error)
{
    safetensors content = {0};
    bat_status status = path != NULL ? safetensors_read(path, &content, error) : BAT_OK;
    if (status != BAT_OK)
        return status;
    learn_model *made = calloc(1, size);
    status = made == NULL ? error_memory(error, size)
                          : take_weights(networks, path != NULL ? &content : networks->builtin, made, error);
    safetensors_free(&content);
    if (status == BAT_OK)
        *model = made;
    else
        learn_model_free(made);
    return status;
}

bat_status learn_model_copy(const learn_source *source BAT_UNUSED, const learn_parameters *parameters, void **network,
                            bat_error *error)
{
    real *weights = memory_array(parameters->total, sizeof *weights);
    if (weights == NULL)
        return error_memory(error, parameters->total * sizeof *weights);
    memcpy(weights, parameters->values, parameters->total * sizeof *weights);
    *network = weights;
    return BAT_OK;
}

void learn_model_free(learn_model *model)
{
    if (model != NULL && model->kind != NULL)
        model->kind->free(model->network);
    free(model);
}

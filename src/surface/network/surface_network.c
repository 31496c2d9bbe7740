#include "surface/network/surface_network.h"

#include "surface/network/surface_inference.h"

#include <assert.h>
#include <stdio.h>

// Parameters

static void add_layer(learn_parameters *parameters, size_t outputs, size_t inputs, const char *part, int place)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%d.weight", part, place);
    (void)learn_parameters_add(parameters, outputs, inputs, name);
    (void)snprintf(name, sizeof name, "%s.%d.bias", part, place);
    (void)learn_parameters_add(parameters, 0, outputs, name);
}

static void add_normalization(learn_parameters *parameters, size_t width, const char *part, int place)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%d.weight", part, place);
    (void)learn_parameters_add(parameters, 0, width, name);
    (void)snprintf(name, sizeof name, "%s.%d.bias", part, place);
    (void)learn_parameters_add(parameters, 0, width, name);
}

/// Places are those of PyTorch's Sequential: layer, normalization, ReLU, layer, …
static void add_message(learn_parameters *parameters, size_t inputs, const char *part)
{
    add_layer(parameters, SURFACE_WIDTH, inputs, part, 0);
    add_normalization(parameters, SURFACE_WIDTH, part, 1);
    add_layer(parameters, SURFACE_WIDTH, SURFACE_WIDTH, part, 3);
}

static bat_status make(bool informed, learn_parameters *parameters, bat_error *error)
{
    add_message(parameters, 6, "interior");
    if (informed)
        add_message(parameters, 8, "boundary");
    for (int layer = 0; layer < SURFACE_HIDDEN; layer++)
    {
        char part[16];
        (void)snprintf(part, sizeof part, "hidden.%d", layer);
        add_layer(parameters, SURFACE_WIDTH, (size_t)2 * SURFACE_WIDTH, part, 0);
    }
    add_layer(parameters, SURFACE_OUTPUT, SURFACE_JOINED, "output", 0);
    add_normalization(parameters, SURFACE_OUTPUT, "output", 1);
    add_layer(parameters, SURFACE_OUTPUT, SURFACE_OUTPUT, "output", 3);
    add_normalization(parameters, SURFACE_OUTPUT, "output", 4);
    add_layer(parameters, 2, SURFACE_OUTPUT, "output", 6);
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    assert(status != BAT_OK || !informed || parameters->total == SURFACE_WEIGHTS);
    return status;
}

static bat_status make_published(learn_parameters *parameters, bat_error *error)
{
    return make(true, parameters, error);
}

static bat_status make_uninformed(learn_parameters *parameters, bat_error *error)
{
    return make(false, parameters, error);
}

bool surface_network_count_is_informed(size_t parameter_count)
{
    return parameter_count == 2 * SURFACE_MESSAGE_ARRAYS + SURFACE_HIDDEN_ARRAYS + SURFACE_OUTPUT_ARRAYS;
}

size_t surface_network_part_begin(size_t parameter_count, surface_part part)
{
    const size_t begins[] = {0, SURFACE_MESSAGE_ARRAYS, parameter_count - SURFACE_OUTPUT_ARRAYS - SURFACE_HIDDEN_ARRAYS,
                             parameter_count - SURFACE_OUTPUT_ARRAYS};
    return begins[part];
}

size_t surface_network_part(const learn_parameters *parameters, surface_part part)
{
    return surface_network_part_begin(parameters->count, part);
}

bool surface_network_is_informed(const learn_parameters *parameters)
{
    return surface_network_count_is_informed(parameters->count);
}

const surface_network_kind surface_network_published = {
    .name = "published",
    .make = make_published,
    .make_network = surface_inference_make,
    .free_network = surface_inference_free,
    .infer = surface_inference_run,
};

const surface_network_kind surface_network_uninformed = {
    .name = "uninformed",
    .make = make_uninformed,
    .make_network = surface_inference_make,
    .free_network = surface_inference_free,
    .infer = surface_inference_run,
};

#include "curve/network/learned_network.h"

#include <assert.h>
#include <stdio.h>

static const char *const BLOCK_NAMES[KLEIN_COUNT] = {"kept", "second", "first", "both"};

static void add_layer(learn_parameters *parameters, size_t layer, klein_widths in)
{
    char name[LEARN_NAME_SIZE];
    for (size_t k = 0; k < KLEIN_COUNT; k++)
    {
        (void)snprintf(name, sizeof name, "layer.%zu.%s", layer, BLOCK_NAMES[k]);
        (void)learn_parameters_add(parameters, in.of[k], LEARNED_CHANNELS, name);
    }
    (void)snprintf(name, sizeof name, "layer.%zu.bias", layer);
    (void)learn_parameters_add(parameters, 0, LEARNED_CHANNELS, name);
}

bat_status learned_network_make(learn_parameters *parameters, bat_error *error)
{
    for (size_t layer = 0; layer < LEARNED_LAYERS; layer++)
        add_layer(parameters, layer, layer == 0 ? learned_widths() : klein_equal(LEARNED_CHANNELS));
    (void)learn_parameters_add(parameters, 1, LEARNED_CHANNELS, "output.first");
    (void)learn_parameters_add(parameters, 1, LEARNED_CHANNELS, "output.kept");
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    assert(status != BAT_OK || parameters->count == LEARNED_PARAMETERS);
    return status;
}

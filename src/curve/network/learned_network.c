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

void learned_network_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t i = 0; i < LEARNED_AT_OUTPUT; i++)
    {
        const learn_parameter *weight = &parameters->list[i];
        // A block's second layer begins small: the blocks change little at first.
        size_t layer = i / LEARNED_LAYER_SIZE;
        double gain = layer > 0 && layer % 2 == 0 ? 0.1 : 1;
        if (weight->rank == 2)
            learn_parameter_fill_normal(parameters, i, gain * sqrt(2.0 / (double)weight->rows), &random);
    }
}

static learn_array *linear_at(learn_tape *tape, learn_array *x, size_t layer)
{
    learn_array *weights[KLEIN_COUNT];
    size_t place = layer * LEARNED_LAYER_SIZE;
    for (size_t k = 0; k < KLEIN_COUNT; k++)
        weights[k] = learn_parameter_array(tape, place + k);
    return learn_klein_linear(tape, x, layer == 0 ? learned_widths() : klein_equal(LEARNED_CHANNELS),
                              klein_equal(LEARNED_CHANNELS), weights, learn_parameter_array(tape, place + KLEIN_COUNT));
}

learn_array *learned_network_apply(learn_tape *tape, learn_array *features)
{
    learn_array *x = learn_klein_gelu(tape, linear_at(tape, features, 0));
    for (size_t layer = 1; layer < LEARNED_LAYERS; layer += 2)
    {
        learn_array *inner = learn_klein_gelu(tape, linear_at(tape, x, layer));
        x = learn_add(tape, x, linear_at(tape, inner, layer + 1));
    }
    x = learn_klein_gelu(tape, x);
    static const klein_character BLOCKS[LEARNED_OUTPUTS] = {KLEIN_FIRST, KLEIN_KEPT};
    learn_array *outputs[LEARNED_OUTPUTS];
    for (size_t i = 0; i < LEARNED_OUTPUTS; i++)
        outputs[i] = learn_linear(tape, learn_slice_columns(tape, x, BLOCKS[i] * LEARNED_CHANNELS, LEARNED_CHANNELS),
                                  learn_parameter_array(tape, LEARNED_AT_OUTPUT + i), NULL);
    return learn_concatenate_columns(tape, outputs, LEARNED_OUTPUTS);
}

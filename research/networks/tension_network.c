#include "research/networks/tension_network.h"

#include "research/learn/parameters.h"

#include <assert.h>
#include <stdio.h>

/// Weight and bias; a norm when there are no inputs.
static void add_layer(learn_parameters *parameters, size_t inputs, size_t outputs, const char *prefix, int place)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%d.weight", prefix, place);
    (void)learn_parameters_add(parameters, inputs > 0 ? outputs : 0, inputs > 0 ? inputs : outputs, name);
    (void)snprintf(name, sizeof name, "%s.%d.bias", prefix, place);
    (void)learn_parameters_add(parameters, 0, outputs, name);
}

/// The layers behind the embedding; allocates what was added.
static bat_status add_trunk(learn_parameters *parameters, size_t inputs, bat_error *error)
{
    add_layer(parameters, inputs, TENSION_WIDTH, "input_proj", 0);
    add_layer(parameters, 0, TENSION_WIDTH, "input_proj", 1);
    for (int block = 0; block < TENSION_BLOCKS; block++)
    {
        char prefix[LEARN_NAME_SIZE / 2];
        (void)snprintf(prefix, sizeof prefix, "trunk.%d.net", block);
        add_layer(parameters, TENSION_WIDTH, TENSION_WIDTH, prefix, 0);
        add_layer(parameters, 0, TENSION_WIDTH, prefix, 1);
        add_layer(parameters, TENSION_WIDTH, TENSION_WIDTH, prefix, 4);
        add_layer(parameters, 0, TENSION_WIDTH, prefix, 5);
    }
    add_layer(parameters, TENSION_WIDTH, TENSION_HEAD, "head", 0);
    add_layer(parameters, TENSION_HEAD, 1, "head", 2);
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    return status;
}

bat_status tension_network_make(learn_parameters *parameters, bat_error *error)
{
    (void)learn_parameters_add(parameters, TENSION_SPACES, TENSION_EMBEDDING, "geom_embed.weight");
    bat_status status = add_trunk(parameters, TENSION_FEATURES + TENSION_EMBEDDING, error);
    assert(status != BAT_OK || (parameters->count == TENSION_PARAMETERS && parameters->total == TENSION_WEIGHTS));
    return status;
}

bat_status tension_network_make_plain(learn_parameters *parameters, size_t inputs, bat_error *error)
{
    return add_trunk(parameters, inputs, error);
}

bat_status tension_network_make_embedded(tension_embedding embedding, learn_parameters *parameters, bat_error *error)
{
    if (embedding == TENSION_EMBEDDED)
        return tension_network_make(parameters, error);
    size_t inputs = embedding == TENSION_ONE_HOT ? TENSION_FEATURES + TENSION_SPACES : TENSION_FEATURES;
    return tension_network_make_plain(parameters, inputs, error);
}

tension_embedding tension_network_embedding(const learn_parameters *parameters)
{
    if (parameters->count == TENSION_PARAMETERS)
        return TENSION_EMBEDDED;
    return parameters->list[0].columns == TENSION_FEATURES ? TENSION_NO_SPACE : TENSION_ONE_HOT;
}

void tension_network_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    size_t layers = parameters->count == TENSION_PARAMETERS ? TENSION_AT_INPUT_LINEAR : TENSION_AT_INPUT_LINEAR - 1;
    if (layers == TENSION_AT_INPUT_LINEAR)
        learn_parameter_fill_normal(parameters, TENSION_AT_EMBEDDING, 1, &random);
    for (size_t i = layers; i < parameters->count; i += 2)
    {
        const learn_parameter *weight = &parameters->list[i];
        if (weight->rank == 2)
            learn_parameter_fill_normal(parameters, i, sqrt(2.0 / (double)weight->columns), &random);
        else
            learn_parameter_fill(parameters, i, 1);
        learn_parameter_fill(parameters, i + 1, 0);
    }
}

static learn_array *linear_at(learn_tape *tape, learn_array *x, size_t place)
{
    return learn_linear(tape, x, learn_parameter_array(tape, place), learn_parameter_array(tape, place + 1));
}

static learn_array *norm_gelu_at(learn_tape *tape, learn_array *x, size_t place, learn_array *skip, double dropout)
{
    return learn_layer_norm_gelu(tape, x, learn_parameter_array(tape, place), learn_parameter_array(tape, place + 1), skip,
                                 dropout);
}

/// `x` with the embedding of each row's space beside it.
static learn_array *embed(learn_tape *tape, learn_array *x, const uint32_t *spaces)
{
    learn_array *embedded = learn_gather_rows(tape, learn_parameter_array(tape, TENSION_AT_EMBEDDING), spaces, x->rows);
    learn_array *both[2] = {x, embedded};
    return learn_concatenate_columns(tape, both, 2);
}

learn_array *tension_network_angles(learn_tape *tape, learn_array *features, const uint32_t *spaces)
{
    // Without an embedding all layers stand one place earlier.
    size_t shift = spaces == NULL ? 1 : 0;
    learn_array *x = spaces == NULL ? features : embed(tape, features, spaces);
    x = norm_gelu_at(tape, linear_at(tape, x, TENSION_AT_INPUT_LINEAR - shift), TENSION_AT_INPUT_NORM - shift, NULL, 0);
    for (size_t block = TENSION_AT_BLOCKS - shift; block < TENSION_AT_HEAD_LINEAR_1 - shift; block += TENSION_BLOCK_SIZE)
    {
        learn_array *inner = linear_at(tape, x, block + TENSION_AT_BLOCK_LINEAR_1);
        inner = norm_gelu_at(tape, inner, block + TENSION_AT_BLOCK_NORM_1, NULL, TENSION_DROPOUT);
        inner = linear_at(tape, inner, block + TENSION_AT_BLOCK_LINEAR_2);
        x = norm_gelu_at(tape, inner, block + TENSION_AT_BLOCK_NORM_2, x, 0);
    }
    x = learn_gelu(tape, linear_at(tape, x, TENSION_AT_HEAD_LINEAR_1 - shift));
    x = linear_at(tape, x, TENSION_AT_HEAD_LINEAR_2 - shift);
    return learn_interval(tape, x, (real)-TENSION_ANGLE_LIMIT, (real)TENSION_ANGLE_LIMIT);
}

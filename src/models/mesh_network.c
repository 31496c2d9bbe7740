#include "models/mesh_network.h"

#include <assert.h>
#include <stdio.h>

static void add_layer(learn_parameters *parameters, size_t inputs, const char *module, const char *layer)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%s.weight", module, layer);
    (void)learn_parameters_add(parameters, MESH_WIDTH, inputs, name);
    (void)snprintf(name, sizeof name, "%s.%s.bias", module, layer);
    (void)learn_parameters_add(parameters, 0, MESH_WIDTH, name);
}

bat_status mesh_network_make(mesh_network_form form, learn_parameters *parameters, bat_error *error)
{
    static const char *const modules[MESH_MODULE_COUNT] = {"net_init", "net_edge", "net_vertex"};
    for (int m = 0; m < MESH_MODULE_COUNT; m++)
    {
        size_t state = m != MESH_MODULE_INIT ? MESH_WIDTH : form.no_differences ? 3 : 6;
        add_layer(parameters, 4 * state - 3, modules[m], "layerIn");
        add_layer(parameters, MESH_WIDTH, modules[m], "hidden.0");
        add_layer(parameters, MESH_WIDTH, modules[m], "layerOut");
    }
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    assert(status != BAT_OK || parameters->count == MESH_PARAMETERS);
    assert(status != BAT_OK || form.no_differences || parameters->total == MESH_WEIGHTS);
    return status;
}

void mesh_network_start(learn_parameters *parameters, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    for (size_t p = 0; p < parameters->count; p++)
    {
        const learn_parameter *parameter = &parameters->list[p];
        // A bias follows its weight.
        size_t inputs = parameter->rank == 2 ? parameter->columns : parameters->list[p - 1].columns;
        double bound = 1 / sqrt((double)inputs);
        real *values = learn_parameter_values(parameters, p);
        for (size_t i = 0; i < parameter->rows * parameter->columns; i++)
            values[i] = (real)(bound * (2 * bat_random_uniform(&random) - 1));
    }
}

/// What a module says of all half-flaps.
static learn_array *ask(learn_tape *tape, mesh_module module, const tape_flap_sight *sight, learn_array *state)
{
    learn_array *parameters[MESH_MODULE_SIZE];
    for (size_t p = 0; p < MESH_MODULE_SIZE; p++)
        parameters[p] = learn_parameter_array(tape, (size_t)module * MESH_MODULE_SIZE + p);
    learn_array *x = tape_flap_layer(tape, sight, state, parameters[0], parameters[1]);
    x = learn_linear_relu(tape, x, parameters[2], parameters[3]);
    return learn_linear(tape, x, parameters[4], parameters[5]);
}

void mesh_network_refine(learn_tape *tape, mesh_network_form form, const mesh_levels *levels, learn_array *positions,
                         learn_array **states)
{
    flap_view view = {.fixed = form.fixed_frames, .relative = form.relative};
    learn_array *state = form.no_differences ? positions : tape_flap_differences(tape, &levels->level[0], positions);
    tape_flap_sight sight = tape_flap_see(tape, &levels->level[0], view, state, form.no_differences ? 0 : 1);
    state = tape_flap_move(tape, &sight, ask(tape, MESH_MODULE_INIT, &sight, state), state);
    states[0] = state;
    for (size_t level = 0; level < levels->count; level++)
    {
        const mesh_flaps *flaps = &levels->level[level];
        sight = tape_flap_see(tape, flaps, view, state, 0);
        state = tape_flap_move(tape, &sight, ask(tape, MESH_MODULE_VERTEX, &sight, state), state);
        sight = tape_flap_see(tape, flaps, view, state, 0);
        state = tape_flap_insert(tape, &sight, ask(tape, MESH_MODULE_EDGE, &sight, state), state);
        states[level + 1] = state;
    }
}

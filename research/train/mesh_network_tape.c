#include "research/train/mesh_network_tape.h"

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

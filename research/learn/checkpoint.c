#include "research/learn/checkpoint.h"

#include "base/error.h"
#include "base/memory.h"
#include "research/learn/parameters.h"

#include <stdlib.h>

// Single numbers of the state and their names in the file. Reading and writing share this list.

typedef struct state_number
{
    const char *name;
    uint64_t *whole; ///< one of the two is null
    double *number;
    bool must_agree; ///< with the training that reads it
} state_number;

enum
{
    STATE_NUMBERS = 12,
    FLAT_ARRAYS = 3
};

static void list_numbers(learn_state *state, uint64_t *has_best, state_number list[STATE_NUMBERS])
{
    learn_plateau *plateau = &state->plateau;
    const state_number numbers[STATE_NUMBERS] = {
        {"state.seed", &state->seed, NULL, true},
        {"state.pieces", &state->pieces, NULL, true},
        {"state.slots", &state->slots, NULL, true},
        {"state.epoch_steps", &state->epoch_steps, NULL, true},
        {"state.step", &state->step, NULL, false},
        {"state.has_best", has_best, NULL, false},
        {"state.best", NULL, &plateau->best, false},
        {"state.best_epoch", &plateau->best_epoch, NULL, false},
        {"state.reference", NULL, &plateau->reference, false},
        {"state.checks_since_gain", &plateau->checks_since_gain, NULL, false},
        {"state.checks_since_change", &plateau->checks_since_change, NULL, false},
        {"state.scale", NULL, &plateau->scale, false},
    };
    memcpy(list, numbers, sizeof numbers);
}

/// An array of numbers of type `real`.
static safetensors_array flat_array(const char *name, size_t count, const real *values)
{
    return (safetensors_array){.name = name,
                               .type = sizeof(real) == sizeof(float) ? SAFETENSORS_F32 : SAFETENSORS_F64,
                               .rank = 1,
                               .shape = {count},
                               .count = count,
                               .values = values};
}

/// Fill in the descriptions of all arrays; returns their number.
static size_t describe_state(const learn_parameters *parameters, const learn_state *state, const state_number *numbers,
                             safetensors_array *arrays, char (*names)[2 * LEARN_NAME_SIZE])
{
    size_t count = parameters->count;
    learn_parameters_describe(parameters, parameters->values, "weight.", arrays, names);
    if (state->has_best)
    {
        learn_parameters_describe(parameters, state->best, "best.", arrays + count, names + count);
        count *= 2;
    }
    arrays[count++] = flat_array("optimizer.mean", state->optimizer.count, state->optimizer.mean);
    if (state->optimizer.squares != NULL)
        arrays[count++] = flat_array("optimizer.squares", state->optimizer.count, state->optimizer.squares);
    arrays[count++] = (safetensors_array){.name = "sums",
                                          .type = SAFETENSORS_F64,
                                          .rank = 1,
                                          .shape = {state->sum_count},
                                          .count = state->sum_count,
                                          .values = state->sums};
    for (size_t i = 0; i < STATE_NUMBERS; i++)
    {
        bool whole = numbers[i].whole != NULL;
        arrays[count++] = (safetensors_array){.name = numbers[i].name,
                                              .type = whole ? SAFETENSORS_I64 : SAFETENSORS_F64,
                                              .count = 1,
                                              .values = whole ? (const void *)numbers[i].whole : numbers[i].number};
    }
    return count;
}

bat_status learn_checkpoint_write(const char *path, const char *recipe, const learn_parameters *parameters,
                                  const learn_state *state, bat_error *error)
{
    size_t max = 2 * parameters->count + FLAT_ARRAYS + STATE_NUMBERS;
    safetensors_array *arrays = calloc(max, sizeof *arrays);
    char(*names)[2 * LEARN_NAME_SIZE] = calloc(max, sizeof *names);
    bat_status status;
    if (arrays == NULL || names == NULL)
        status = error_memory(error, max * (sizeof *arrays + sizeof *names));
    else
    {
        learn_state copy = *state;
        uint64_t has_best = state->has_best;
        state_number numbers[STATE_NUMBERS];
        list_numbers(&copy, &has_best, numbers);
        safetensors_note note = {"recipe", recipe};
        safetensors content = {.arrays = arrays, .notes = &note, .note_count = 1};
        content.array_count = describe_state(parameters, state, numbers, arrays, names);
        status = safetensors_write(path, &content, error);
    }
    free(arrays);
    free(names);
    return error_prefix(error, status, "%s: ", path);
}

static bat_status read_numbers(const safetensors *content, learn_state *state, bat_error *error)
{
    learn_state found = {0};
    uint64_t has_best = 0;
    state_number numbers[STATE_NUMBERS], expected[STATE_NUMBERS];
    list_numbers(&found, &has_best, numbers);
    list_numbers(state, &has_best, expected);
    bat_status status = BAT_OK;
    for (size_t i = 0; i < STATE_NUMBERS && status == BAT_OK; i++)
    {
        int64_t whole = 0;
        if (numbers[i].whole == NULL)
        {
            status = safetensors_doubles(content, numbers[i].name, 1, numbers[i].number, error);
            continue;
        }
        status = safetensors_integers(content, numbers[i].name, 1, &whole, error);
        *numbers[i].whole = (uint64_t)whole;
        if (status == BAT_OK && numbers[i].must_agree && (uint64_t)whole != *expected[i].whole)
            status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                               "the checkpoint belongs to another training: %s is %lld, not %lld", numbers[i].name,
                               (long long)whole, (long long)*expected[i].whole);
    }
    if (status != BAT_OK)
        return status;
    state->step = found.step;
    state->plateau = found.plateau;
    state->has_best = has_best != 0;
    state->optimizer.steps = found.step;
    return BAT_OK;
}

static bat_status read_flat(const safetensors *content, const char *name, size_t count, real *values, bat_error *error)
{
    const safetensors_array *array = safetensors_find(content, name);
    safetensors_array expected = flat_array(name, count, values);
    if (array == NULL || array->type != expected.type || array->count != count)
        return error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0, "there is no array '%s' of %zu numbers of this precision",
                         name, count);
    memcpy(values, array->values, count * sizeof *values);
    return BAT_OK;
}

static bat_status read_state(const safetensors *content, const char *recipe, learn_parameters *parameters,
                             learn_state *state, bat_error *error)
{
    const char *found = safetensors_find_note(content, "recipe");
    if (found == NULL || strcmp(found, recipe) != 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "the checkpoint belongs to a training with other options, '%.80s'", found != NULL ? found : "");
    bat_status status = read_numbers(content, state, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(parameters, content, "weight.", parameters->values, error);
    if (status == BAT_OK && state->has_best)
        status = learn_parameters_extract(parameters, content, "best.", state->best, error);
    if (status == BAT_OK)
        status = read_flat(content, "optimizer.mean", state->optimizer.count, state->optimizer.mean, error);
    if (status == BAT_OK && state->optimizer.squares != NULL)
        status = read_flat(content, "optimizer.squares", state->optimizer.count, state->optimizer.squares, error);
    if (status == BAT_OK)
        status = safetensors_doubles(content, "sums", state->sum_count, state->sums, error);
    return status;
}

bat_status learn_checkpoint_read(const char *path, const char *recipe, learn_parameters *parameters, learn_state *state,
                                 bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status == BAT_OK)
    {
        status = read_state(&content, recipe, parameters, state, error);
        safetensors_free(&content);
    }
    return error_prefix(error, status, "%s: ", path);
}

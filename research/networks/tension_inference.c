#include "research/networks/tension_inference.h"

#include "base/error.h"
#include "base/memory.h"
#include "research/learn/packed_norm.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/// Where the next numbers go.
typedef struct packing
{
    const learn_parameters *parameters;
    size_t shift; ///< without an embedding all layers stand one place earlier
    real *free;
} packing;

static const learn_parameter *parameter_at(const packing *p, size_t place)
{
    return &p->parameters->list[place - p->shift];
}

static const real *values_at(const packing *p, size_t place)
{
    return learn_parameter_values(p->parameters, place - p->shift);
}

static learn_packed pack_layer(packing *p, size_t place)
{
    const learn_parameter *weight = parameter_at(p, place);
    learn_packed layer =
        learn_pack(weight->columns, weight->rows, values_at(p, place), weight->columns, values_at(p, place + 1), p->free);
    p->free += learn_packed_size(weight->columns, weight->rows);
    return layer;
}

static tension_norm pack_norm(packing *p, size_t place)
{
    const real *gain = p->free, *shift = p->free + TENSION_WIDTH;
    memcpy(p->free, values_at(p, place), TENSION_WIDTH * sizeof *p->free);
    memcpy(p->free + TENSION_WIDTH, values_at(p, place + 1), TENSION_WIDTH * sizeof *p->free);
    p->free += 2 * (size_t)TENSION_WIDTH;
    return (tension_norm){gain, shift};
}

/// What the columns behind the features add for one space: all edges of a curve lie in the same.
static double space_part(const packing *p, const real *row, size_t columns, size_t space)
{
    const real *embedding = learn_parameter_values(p->parameters, TENSION_AT_EMBEDDING) + space * TENSION_EMBEDDING;
    double sum = 0;
    if (columns == TENSION_FEATURES + TENSION_SPACES)
        return (double)row[TENSION_FEATURES + space];
    for (size_t k = TENSION_FEATURES; k < columns; k++)
        sum += (double)row[k] * (double)embedding[k - TENSION_FEATURES];
    return sum;
}

static learn_packed pack_input(packing *p, size_t space)
{
    const learn_parameter *weight = parameter_at(p, TENSION_AT_INPUT_LINEAR);
    const real *rows = values_at(p, TENSION_AT_INPUT_LINEAR);
    learn_packed layer = learn_pack(TENSION_FEATURES, weight->rows, rows, weight->columns,
                                    values_at(p, TENSION_AT_INPUT_LINEAR + 1), p->free);
    real *bias = p->free + layer.inputs * layer.columns;
    for (size_t o = 0; o < weight->rows; o++)
        bias[o] = (real)((double)bias[o] + space_part(p, rows + o * weight->columns, weight->columns, space));
    p->free += learn_packed_size(TENSION_FEATURES, weight->rows);
    return layer;
}

bat_status tension_inference_make(const learn_parameters *parameters, tension_inference *network, bat_error *error)
{
    const size_t norms = 1 + 2 * TENSION_BLOCKS;
    const size_t total = TENSION_SPACES * learn_packed_size(TENSION_FEATURES, TENSION_WIDTH) +
                         2 * TENSION_BLOCKS * learn_packed_size(TENSION_WIDTH, TENSION_WIDTH) +
                         learn_packed_size(TENSION_WIDTH, TENSION_HEAD) + learn_packed_size(TENSION_HEAD, 1) +
                         norms * 2 * TENSION_WIDTH;
    *network = (tension_inference){.memory = memory_array(total, sizeof *network->memory)};
    if (network->memory == NULL)
        return error_memory(error, total * sizeof *network->memory);
    packing p = {parameters, parameters->count == TENSION_PARAMETERS ? 0 : 1, network->memory};
    for (size_t space = 0; space < TENSION_SPACES; space++)
        network->input[space] = pack_input(&p, space);
    network->input_norm = pack_norm(&p, TENSION_AT_INPUT_NORM);
    for (size_t b = 0; b < TENSION_BLOCKS; b++)
    {
        size_t place = TENSION_AT_BLOCKS + b * TENSION_BLOCK_SIZE;
        network->blocks[b].linear_1 = pack_layer(&p, place + TENSION_AT_BLOCK_LINEAR_1);
        network->blocks[b].norm_1 = pack_norm(&p, place + TENSION_AT_BLOCK_NORM_1);
        network->blocks[b].linear_2 = pack_layer(&p, place + TENSION_AT_BLOCK_LINEAR_2);
        network->blocks[b].norm_2 = pack_norm(&p, place + TENSION_AT_BLOCK_NORM_2);
    }
    network->head_1 = pack_layer(&p, TENSION_AT_HEAD_LINEAR_1);
    network->head_2 = pack_layer(&p, TENSION_AT_HEAD_LINEAR_2);
    assert(p.free == network->memory + total);
    return BAT_OK;
}

void tension_inference_free(tension_inference *network)
{
    free(network->memory);
    *network = (tension_inference){0};
}

static void norm_gelu(tension_norm norm, size_t rows, const real *skip, real *y)
{
    learn_packed_norm_gelu(rows, TENSION_WIDTH, norm.gain, norm.shift, skip, y);
}

/// Whole tiles of rows, at most TENSION_INFERENCE_ROWS. Returns the last layer's results, LEARN_PANEL numbers apart.
static const real *forward(const tension_inference *network, size_t space, size_t rows, const real *features, real *scratch)
{
    const size_t size = (size_t)TENSION_INFERENCE_ROWS * TENSION_WIDTH;
    real *x = scratch, *inner = scratch + size, *next = scratch + 2 * size;
    learn_packed_linear(&network->input[space], rows, features, TENSION_FEATURES, x);
    norm_gelu(network->input_norm, rows, NULL, x);
    for (size_t b = 0; b < TENSION_BLOCKS; b++)
    {
        learn_packed_linear(&network->blocks[b].linear_1, rows, x, TENSION_WIDTH, inner);
        norm_gelu(network->blocks[b].norm_1, rows, NULL, inner);
        learn_packed_linear(&network->blocks[b].linear_2, rows, inner, TENSION_WIDTH, next);
        norm_gelu(network->blocks[b].norm_2, rows, x, next);
        real *done = x;
        x = next;
        next = done;
    }
    learn_packed_linear(&network->head_1, rows, x, TENSION_WIDTH, inner);
    learn_packed_gelu(rows * TENSION_HEAD, inner);
    learn_packed_linear(&network->head_2, rows, inner, TENSION_HEAD, next);
    return next;
}

void tension_inference_angles(const tension_inference *network, size_t space, size_t count, real *features, double *angles,
                              real *scratch)
{
    memset(features + count * TENSION_FEATURES, 0, (learn_whole_tiles(count) - count) * TENSION_FEATURES * sizeof *features);
    for (size_t done = 0; done < count; done += TENSION_INFERENCE_ROWS)
    {
        size_t rows = count - done < TENSION_INFERENCE_ROWS ? count - done : TENSION_INFERENCE_ROWS;
        const real *last = forward(network, space, learn_whole_tiles(rows), features + done * TENSION_FEATURES, scratch);
        for (size_t r = 0; r < rows; r++)
        {
            double angle = TENSION_ANGLE_LIMIT * tanh(0.5 * (double)last[r * LEARN_PANEL]);
            angles[done + r] = isnan(angle) ? 0 : angle;
        }
    }
}

#pragma once

#include "learn/real.h"

#include <stddef.h>

/// @file
/// Layers for inference alone, without a tape and without BLAS: weights are rearranged once, and the products of a run of
/// rows stay in the cache from layer to layer. A row's result depends on the row alone, and calls may come from several
/// threads.
///
/// Matrices have whole *panels* of columns and *tiles* of rows. The caller pads the input with zeros; padding is void.

enum
{
    LEARN_PANEL = 32, ///< columns
#if defined(__wasm__)
    LEARN_TILE = 4 ///< rows: browsers leave 15 registers of 128 bits
#else
    LEARN_TILE = 6 ///< rows
#endif
};

static inline size_t learn_whole_panels(size_t columns)
{
    return (columns + LEARN_PANEL - 1) / LEARN_PANEL * LEARN_PANEL;
}

static inline size_t learn_whole_tiles(size_t rows)
{
    return (rows + LEARN_TILE - 1) / LEARN_TILE * LEARN_TILE;
}

/// A linear layer: y = x W^T + b.
typedef struct learn_packed
{
    size_t inputs;
    size_t columns;      ///< outputs in whole panels
    size_t wanted;       ///< the first columns: others need not be computed. All, unless the caller sets it
    const real *weight;  ///< the transposed matrix, inputs x columns, in panels
    size_t input_stride; ///< from one input's numbers to the next one's within a panel
    size_t panel_stride; ///< from panel to panel
    const real *bias;    ///< columns
    bool adds;           ///< add to what y holds
} learn_packed;

/// A layer whose transposed matrix is stored plainly, inputs x columns, with whole panels of columns.
static inline learn_packed learn_packed_plain(size_t inputs, size_t columns, const real *weight, const real *bias)
{
    return (learn_packed){inputs, columns, columns, weight, columns, LEARN_PANEL, bias, false};
}

/// The numbers that a packed layer takes.
static inline size_t learn_packed_size(size_t inputs, size_t outputs)
{
    return (inputs + 1) * learn_whole_panels(outputs);
}

/// Pack a layer into `memory`, learn_packed_size() numbers aligned to 64 bytes.
/// @param weight outputs x `inputs`, rows `stride` numbers apart
/// @param bias   outputs
learn_packed learn_pack(size_t inputs, size_t outputs, const real *weight, size_t stride, const real *bias, real *memory);

/// @param rows whole tiles
/// @param x    rows `stride` numbers apart
/// @param y    rows x layer->columns
void learn_packed_linear(const learn_packed *layer, size_t rows, const real *x, size_t stride, real *y);

/// learn_klein_gelu() of numbers whose four blocks lie one behind the other, `count` numbers each.
void learn_packed_klein_gelu(size_t count, const real *restrict x, real *restrict y);

#ifndef RESEARCH_LEARN_OPERATIONS_H
#define RESEARCH_LEARN_OPERATIONS_H

#include "research/learn/tape.h"

/// @file
/// The operations of networks. Each takes arrays on a tape and gives a new one; R and C are the rows and columns of `x`.
/// Lists of indices are not copied: they must stay until the step has been differentiated. Every index must be in range.

// Layers (layers.c, normalization.c)

/// x W^T + b for the rows of x: R x O, with `weight` O x C and `bias` 1 x O or null.
learn_array *learn_linear(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias);
/// max(0, x W^T + b)
learn_array *learn_linear_relu(learn_tape *tape, learn_array *x, learn_array *weight, learn_array *bias);
/// Each row less its mean, over its deviation (1e-5 added to the variance), times `gain` plus `shift`, both 1 x C
/// (Ba, Kiros and Hinton 2016).
learn_array *learn_layer_norm(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift);
/// dropout(gelu(skip + layer_norm(x))) at once; `skip` is R x C, or null for 0.
learn_array *learn_layer_norm_gelu(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift,
                                   learn_array *skip, double dropout);
/// The same for each column, by the mean and variance of the current batch (Ioffe and Szegedy 2015).
learn_array *learn_batch_norm(learn_tape *tape, learn_array *x, learn_array *gain, learn_array *shift);

// Element by element (activation.c, arithmetic.c)

learn_array *learn_gelu(learn_tape *tape, learn_array *x);
learn_array *learn_relu(learn_tape *tape, learn_array *x);
learn_array *learn_sigmoid(learn_tape *tape, learn_array *x);
learn_array *learn_tanh(learn_tape *tape, learn_array *x);
/// low + (high - low) sigmoid(x)
learn_array *learn_interval(learn_tape *tape, learn_array *x, real low, real high);
/// Each number set to 0 with probability `rate`, else divided by 1 - rate; x itself unless learn_tape_drop() was called.
learn_array *learn_dropout(learn_tape *tape, learn_array *x, double rate);
learn_array *learn_add(learn_tape *tape, learn_array *x, learn_array *y);
learn_array *learn_subtract(learn_tape *tape, learn_array *x, learn_array *y);
learn_array *learn_multiply(learn_tape *tape, learn_array *x, learn_array *y);
learn_array *learn_scale(learn_tape *tape, learn_array *x, real factor);
/// x + number
learn_array *learn_add_number(learn_tape *tape, learn_array *x, real number);
/// Natural logarithms of positive numbers.
learn_array *learn_log(learn_tape *tape, learn_array *x);

// Sums: 1 x 1, except the norms of the rows: R x 1 (arithmetic.c)

learn_array *learn_sum(learn_tape *tape, learn_array *x);
learn_array *learn_sum_of_squares(learn_tape *tape, learn_array *x);
learn_array *learn_mean_of_squares(learn_tape *tape, learn_array *x);
/// The mean of the squares of x - y.
learn_array *learn_mean_squared_error(learn_tape *tape, learn_array *x, learn_array *y);
/// Euclidean norms; the derivative at a row of zeros is 0 by definition.
learn_array *learn_row_norms(learn_tape *tape, learn_array *x);

// Rows and columns (rows.c)

/// Row k is row indices[k] of x; with a parameter for x, an embedding. count x C.
learn_array *learn_gather_rows(learn_tape *tape, learn_array *x, const uint32_t *indices, size_t count);
/// Row s is the mean of the rows indices[k] of x (row k itself when `indices` is null) for offsets[s] <= k < offsets[s + 1],
/// and zero where there are none. count x C; `offsets` has count + 1 entries.
learn_array *learn_segment_mean(learn_tape *tape, learn_array *x, const uint32_t *offsets, const uint32_t *indices,
                                size_t count);
/// Row t is the mean of those rows k of x with targets[k] = t, and zero where there are none. count x C; R targets.
learn_array *learn_scatter_mean(learn_tape *tape, learn_array *x, const uint32_t *targets, size_t count);
learn_array *learn_slice_rows(learn_tape *tape, learn_array *x, size_t first, size_t count);
learn_array *learn_slice_columns(learn_tape *tape, learn_array *x, size_t first, size_t count);
/// Arrays with the same number of columns, one below the other.
learn_array *learn_concatenate_rows(learn_tape *tape, learn_array *const *arrays, size_t count);
/// Arrays with the same number of rows, side by side.
learn_array *learn_concatenate_columns(learn_tape *tape, learn_array *const *arrays, size_t count);

#endif

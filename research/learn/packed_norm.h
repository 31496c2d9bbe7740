#ifndef RESEARCH_LEARN_PACKED_NORM_H
#define RESEARCH_LEARN_PACKED_NORM_H

#include "learn/packed.h"

/// @file
/// Layers for inference that published networks have beside those of learn/packed.h.

/// y = gelu(skip + layer_norm(y)) in place, as learn_layer_norm_gelu().
/// @param skip rows x columns, or null for 0
void learn_packed_norm_gelu(size_t rows, size_t columns, const real *gain, const real *shift, const real *skip, real *y);

/// y = gelu(y) in place.
void learn_packed_gelu(size_t count, real *y);

#endif

#ifndef RESEARCH_LEARN_KLEIN_LAYERS_H
#define RESEARCH_LEARN_KLEIN_LAYERS_H

#include "learn/klein.h"
#include "research/learn/tape.h"

/// @file
/// The layers of learn/klein.h on a tape.

/// Block k of the result is x_k W_k, for the first block plus `bias`.
/// @param x       R x klein_total(in)
/// @param weights four, in.of[k] x out.of[k]
/// @param bias    1 x out.of[KLEIN_KEPT], or null
/// @return R x klein_total(out)
learn_array *learn_klein_linear(learn_tape *tape, learn_array *x, klein_widths in, klein_widths out,
                                learn_array *const weights[KLEIN_COUNT], learn_array *bias);

/// GELU in the regular representation. R x 4 width; every block has `width` columns.
learn_array *learn_klein_gelu(learn_tape *tape, learn_array *x);

#endif

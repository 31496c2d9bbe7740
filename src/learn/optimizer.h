#ifndef LEARN_OPTIMIZER_H
#define LEARN_OPTIMIZER_H

#include "batten/base.h"
#include "learn/real.h"

/// @file
/// Rules that move the numbers of a block against their gradient. The formulas are those of PyTorch, digit for digit where
/// it matters, so that published recipes carry over.

typedef enum learn_rule
{
    LEARN_SGD,  ///< with momentum; decay is added to the gradient
    LEARN_ADAM, ///< Kingma and Ba 2015; decay is added to the gradient
    LEARN_ADAMW ///< Loshchilov and Hutter 2019; decay shrinks the weights directly
} learn_rule;

typedef struct learn_optimizer_options
{
    learn_rule rule;
    double momentum; ///< SGD: the share kept of the last direction. Adam: of the mean of gradients (beta 1)
    double second;   ///< Adam: the share kept of the mean of squares (beta 2)
    double epsilon;  ///< Adam: added to the root of the mean of squares
    double decay;    ///< weight decay
} learn_optimizer_options;

/// Its memory.
typedef struct learn_optimizer
{
    learn_optimizer_options options;
    size_t count;
    real *mean;    ///< SGD's direction or Adam's mean of gradients
    real *squares; ///< Adam's mean of squares; null for SGD
    uint64_t steps;
} learn_optimizer;

/// @return BAT_OK, BAT_INVALID_ARGUMENT for a share outside [0, 1) or a negative epsilon or decay, or BAT_NO_MEMORY
bat_status learn_optimizer_make(const learn_optimizer_options *options, size_t count, learn_optimizer *optimizer,
                                bat_error *error);
void learn_optimizer_free(learn_optimizer *optimizer);
/// One step with the learning rate `rate`.
void learn_optimizer_step(learn_optimizer *optimizer, double rate, const real *gradient, real *values);

/// Scale a gradient down to the Euclidean norm `limit` if it is longer; returns its norm before. Infinity never scales. A
/// norm that is not finite leaves the gradient alone.
double learn_clip_norm(size_t count, real *gradient, double limit);

#endif

#ifndef RESEARCH_LEARN_OPTIMIZER_H
#define RESEARCH_LEARN_OPTIMIZER_H

#include "batten/base.h"
#include "learn/real.h"

/// @file
/// Optimizers and their learning rates. The formulas are those of PyTorch, so that published recipes carry over.

typedef enum learn_rule
{
    LEARN_SGD,  ///< with momentum; decay is added to the gradient
    LEARN_ADAM, ///< Kingma and Ba 2015; decay is added to the gradient
    LEARN_ADAMW ///< Loshchilov and Hutter 2019; decay shrinks the weights directly
} learn_rule;

typedef struct learn_optimizer_options
{
    learn_rule rule;
    double momentum; ///< SGD: momentum. Adam: decay of the mean of gradients (beta 1)
    double second;   ///< Adam: decay of the mean of squares (beta 2)
    double epsilon;  ///< Adam: added to the root of the mean of squares
    double decay;    ///< weight decay
} learn_optimizer_options;

/// The state of an optimizer.
typedef struct learn_optimizer
{
    learn_optimizer_options options;
    size_t count;
    real *mean;    ///< SGD's velocity or Adam's mean of gradients
    real *squares; ///< Adam's mean of squares; null for SGD
    uint64_t steps;
} learn_optimizer;

/// @return BAT_OK, BAT_INVALID_ARGUMENT for a momentum or second moment outside [0, 1) or a negative epsilon or decay, or
/// BAT_NO_MEMORY
bat_status learn_optimizer_make(const learn_optimizer_options *options, size_t count, learn_optimizer *optimizer,
                                bat_error *error);
void learn_optimizer_free(learn_optimizer *optimizer);
/// One step with the learning rate `rate`.
void learn_optimizer_step(learn_optimizer *optimizer, double rate, const real *gradient, real *values);

/// Scale a gradient down to the Euclidean norm `limit` if it is longer; returns its norm before. Infinity never scales. A
/// norm that is not finite leaves the gradient alone.
double learn_clip_norm(size_t count, real *gradient, double limit);

/// How the learning rate changes over the epochs.
typedef enum learn_schedule_kind
{
    LEARN_CONSTANT,
    LEARN_COSINE ///< cosine decay to 0 (Loshchilov and Hutter 2017)
} learn_schedule_kind;

/// Ugail and Howard (2026), eq. (23).
typedef struct learn_schedule
{
    learn_schedule_kind kind;
    double rate;     ///< the highest
    uint64_t warmup; ///< epochs of linear growth: epoch e has the rate (e + 1) / warmup of the highest
    uint64_t epochs; ///< of a cosine, warm-up included
} learn_schedule;

/// The learning rate of an epoch.
double learn_schedule_rate(const learn_schedule *schedule, uint64_t epoch);

/// The reaction to a validation metric that no longer decreases. All zero: none, but the best weights are still stored.
typedef struct learn_plateau_options
{
    double min_gain;          ///< a smaller decrease is no gain
    uint64_t reduce_patience; ///< validations without gain before the rate is reduced; 0: never
    double reduce_factor;     ///< by this factor
    double min_rate;          ///< but not below this
    uint64_t stop_patience;   ///< validations without gain before training stops; 0: never
} learn_plateau_options;

/// The validations so far.
typedef struct learn_plateau
{
    double best;                  ///< the lowest value; infinite before the first
    uint64_t best_epoch;          ///< its epoch
    double reference;             ///< the value at the last gain
    uint64_t checks_since_gain;   ///< validations, for stopping
    uint64_t checks_since_change; ///< validations since the last gain or reduction, for reducing
    double scale;                 ///< the product of the reductions
} learn_plateau;

learn_plateau learn_plateau_begin(void);
/// Record a value; true when it is the lowest so far. A value that is not finite is no gain.
bool learn_plateau_update(learn_plateau *plateau, const learn_plateau_options *options, uint64_t epoch, double value);
/// The scheduled rate after the reductions.
double learn_plateau_rate(const learn_plateau *plateau, const learn_plateau_options *options, double scheduled);
/// Whether training stops.
bool learn_plateau_stops(const learn_plateau *plateau, const learn_plateau_options *options);

#endif

#ifndef LEARN_SCHEDULE_H
#define LEARN_SCHEDULE_H

#include "batten/base.h"

/// @file
/// How the learning rate runs over the epochs, and what a figure that stops falling does to it.

typedef enum learn_schedule_kind
{
    LEARN_CONSTANT,
    LEARN_COSINE ///< falls to 0 along half a wave (Loshchilov and Hutter 2017)
} learn_schedule_kind;

/// Ugail and Howard (2026), eq. (23).
typedef struct learn_schedule
{
    learn_schedule_kind kind;
    double rate;     ///< the highest
    uint64_t warmup; ///< epochs in which it rises: epoch e has the share (e + 1) / warmup
    uint64_t epochs; ///< of a cosine, warm-up included
} learn_schedule;

/// The learning rate of an epoch.
double learn_schedule_rate(const learn_schedule *schedule, uint64_t epoch);

/// What to do when the figure that is watched does not fall. All zero: nothing, but the best one is still kept.
typedef struct learn_watch_options
{
    double least_gain;        ///< falling by less does not count
    uint64_t reduce_patience; ///< checks without gain before the rate is reduced; 0: never
    double reduce_factor;     ///< by this factor
    double least_rate;        ///< but not below this
    uint64_t stop_patience;   ///< checks without gain before training stops; 0: never
} learn_watch_options;

/// What has been seen so far.
typedef struct learn_watch
{
    double best;                  ///< the least figure; infinite before the first
    uint64_t best_epoch;          ///< where it was
    double reference;             ///< the figure of the last gain
    uint64_t checks_since_gain;   ///< for stopping
    uint64_t checks_since_change; ///< for reducing: since the last gain or reduction
    double scale;                 ///< the product of the reductions
} learn_watch;

learn_watch learn_watch_begin(void);
/// Take note of a figure; true when it is the best so far. One that is not finite is no gain.
bool learn_watch_see(learn_watch *watch, const learn_watch_options *options, uint64_t epoch, double figure);
/// The rate that remains of a schedule's.
double learn_watch_rate(const learn_watch *watch, const learn_watch_options *options, double scheduled);
/// Whether it is time to stop.
bool learn_watch_stops(const learn_watch *watch, const learn_watch_options *options);

#endif

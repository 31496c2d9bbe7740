#ifndef RESEARCH_TRAIN_LEARNED_TRAIN_H
#define RESEARCH_TRAIN_LEARNED_TRAIN_H

#include "batten/research/curve_train.h"

/// @file
/// Training of the shipped rule with a say in how much an epoch is.

/// What bat_learned_train() does between two looks at the weights.
typedef struct learned_epoch
{
    uint64_t steps; ///< of an epoch, 32 curves each
    size_t kept;    ///< curves a space that weights are checked on
} learned_epoch;

/// bat_learned_train() with epochs of another size.
bat_status learned_train_by(const bat_learned_train_options *options, learned_epoch epoch, bat_learned_train_report *report,
                            bat_error *error);

#endif

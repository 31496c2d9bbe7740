#ifndef MODELS_FAIRING_TRAIN_H
#define MODELS_FAIRING_TRAIN_H

#include "batten/fairing_train.h"

/// @file
/// Training of the shipped rule with a say in how much an epoch is.

/// What bat_fairing_train() does between two looks at the weights.
typedef struct fairing_epoch
{
    uint64_t steps; ///< of an epoch, 32 curves each
    size_t kept;    ///< curves a space that weights are checked on
} fairing_epoch;

/// bat_fairing_train() with epochs of another size.
bat_status fairing_train_by(const bat_fairing_train_options *options, fairing_epoch epoch, bat_fairing_train_report *report,
                            bat_error *error);

#endif

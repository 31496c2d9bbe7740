#ifndef BATTEN_FAIRING_TRAIN_H
#define BATTEN_FAIRING_TRAIN_H

#include "batten/tension_data.h"

BAT_C_BEGIN

/// @file
/// Training of the learned scheme that the library comes with (bat_scheme_learned(), docs/fairing.md).

/// How to train. Begin with bat_fairing_train_defaults(), which made the shipped weights.
typedef struct bat_fairing_train_options
{
    uint64_t seed;   ///< of the first weights and of all curves; default 1
    uint64_t epochs; ///< of 8,000 curves each, at least 1; the learning rate falls to 0 over as many; default 300
    /// Where the files go, made with those that it lies in where it is not there. While training runs: the log `log.csv`, its
    /// picture `log.png`, and every five epochs and at a stop `checkpoint.safetensors`. At the end: `model.safetensors`, the
    /// last weights. Null for no files; default null.
    const char *folder;
    /// Go on from the folder's checkpoint, if there is one, to the same bytes as without the stop; default false.
    bool resume;
    int threads;           ///< 0: as many as OpenMP gives, of which 8 help; the result does not depend on it; default 0
    bat_progress progress; ///< asked before every batch; when it says stop, the checkpoint is written first
} bat_fairing_train_options;

/// The options' default values.
BAT_API bat_fairing_train_options bat_fairing_train_defaults(void);

/// The fairnesses that training is checked at.
#define BAT_FAIRING_CHECKS 3

/// What weights do to curves kept aside, drawn from the trained families: means over the curves of a space, at 5 levels.
typedef struct bat_fairing_score
{
    double mean_nn, bending, g1;
} bat_fairing_score;

/// How a training went.
typedef struct bat_fairing_train_report
{
    uint64_t epochs; ///< done, earlier runs included
    double loss;     ///< mean over the last epoch of this run; NaN when there was none
    /// For the fairnesses 0, 1/2 and 1.
    bat_fairing_score scores[BAT_FAIRING_CHECKS][BAT_TENSION_SPACE_COUNT];
} bat_fairing_train_report;

/// Train the network on curves that are drawn anew for every step and never come again. While it runs, OpenBLAS works on one
/// thread in the whole process.
///
/// @param options null for the defaults, which keep nothing but the report
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (no epochs, a checkpoint of another training); BAT_NO_CONVERGENCE with
///         the step when a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_fairing_train(const bat_fairing_train_options *options, bat_fairing_train_report *report,
                                     bat_error *error);

BAT_C_END

#endif

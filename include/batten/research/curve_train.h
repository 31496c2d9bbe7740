#ifndef BATTEN_RESEARCH_CURVE_TRAIN_H
#define BATTEN_RESEARCH_CURVE_TRAIN_H

#include "batten/research/curve_data.h"

BAT_C_BEGIN

/// @file
/// Training of the learned tension of Ugail and Howard (2026): their network, data, loss and stopping rules (sections 5 and
/// 6). docs/tension.md says what the text leaves open and how it is read here.

/// How the network learns of the space that an edge lies in (table 3).
typedef enum bat_tension_embedding
{
    BAT_TENSION_EMBEDDING_LEARNED, ///< a table of 3 x 8 trained numbers: 140,505 weights
    BAT_TENSION_EMBEDDING_ONE_HOT, ///< three fixed numbers, one of which is 1: 139,841 weights
    BAT_TENSION_EMBEDDING_NONE     ///< not at all: 139,457 weights
} bat_tension_embedding;

/// How to train. Begin with bat_tension_train_defaults(), the published recipe.
typedef struct bat_tension_train_options
{
    uint64_t seed;                   ///< of the first weights, the order of the samples, dropout and isometries; default 1
    uint64_t epochs;                 ///< at most, at least 1; the learning rate falls to 0 over as many; default 300
    bat_tension_embedding embedding; ///< default learned
    double smoothness[BAT_TENSION_SPACE_COUNT]; ///< weight of eq. (20) in each space; default 0.05, on the sphere 0.15
    double bending;                             ///< weight of eq. (21); default 1e-4
    double consistency;                         ///< weight of eq. (22); default 0.1
    /// Where the files go, made with those that it lies in where it is not there. While training runs: the log `log.csv`,
    /// its picture `log.png`, and every five epochs and at a stop `checkpoint.safetensors`. At the end: `model.safetensors`,
    /// the best weights. Null for no files; default null.
    const char *folder;
    /// Go on from the folder's checkpoint, if there is one, to the same bytes as without the stop; default false.
    bool resume;
    int threads;           ///< 0: as many as OpenMP gives, of which 8 help; the result does not depend on it; default 0
    bat_progress progress; ///< asked before every batch; when it says stop, the checkpoint is written first
} bat_tension_train_options;

/// The options' default values.
BAT_API bat_tension_train_options bat_tension_train_defaults(void);

/// What the weights do to the validation curves of one space in BAT_TENSION_LEVELS learned levels: means over the curves.
typedef struct bat_tension_score
{
    double mean_nn, bending, g1;
} bat_tension_score;

/// How a training went.
typedef struct bat_tension_train_report
{
    uint64_t epochs;                                   ///< done, earlier runs included
    uint64_t best_epoch;                               ///< after which the weights were best, counted from 1
    bool stopped;                                      ///< before the last epoch, because the figure no longer fell
    double mean_nn;                                    ///< of the best weights: the mean of the three spaces'
    bat_tension_score scores[BAT_TENSION_SPACE_COUNT]; ///< of the best weights
} bat_tension_train_report;

/// Train the published network on the published curves (bat_tension_data_make()). While it runs, OpenBLAS works on one
/// thread in the whole process.
///
/// @param options null for the defaults, which keep nothing but the report
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (no epochs, weights that are negative or not finite, a checkpoint of
///         another training); BAT_NO_CONVERGENCE with the step when a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or
///         BAT_NO_MEMORY
BAT_API bat_status bat_tension_train(const bat_tension_train_options *options, bat_tension_train_report *report,
                                     bat_error *error);

// Training of the learned scheme that the library comes with (bat_curve_scheme_learned(), docs/fairing.md).

/// How to train. Begin with bat_learned_train_defaults(), which made the shipped weights.
typedef struct bat_learned_train_options
{
    uint64_t seed;   ///< of the first weights and of all curves; default 1
    uint64_t epochs; ///< of 8,000 curves each, at least 1; the learning rate falls to 0 over as many; default 300
    /// Where the files go, made with those that it lies in where it is not there. While training runs: the log `log.csv`,
    /// its picture `log.png`, and every five epochs and at a stop `checkpoint.safetensors`. At the end: `model.safetensors`,
    /// the last weights. Null for no files; default null.
    const char *folder;
    /// Go on from the folder's checkpoint, if there is one, to the same bytes as without the stop; default false.
    bool resume;
    int threads;           ///< 0: as many as OpenMP gives, of which 8 help; the result does not depend on it; default 0
    bat_progress progress; ///< asked before every batch; when it says stop, the checkpoint is written first
} bat_learned_train_options;

/// The options' default values.
BAT_API bat_learned_train_options bat_learned_train_defaults(void);

/// The fairnesses that training is checked at.
#define BAT_FAIRING_CHECKS 3

/// What weights do to curves kept aside, drawn from the trained families: means over the curves of a space, at 5 levels.
typedef struct bat_learned_score
{
    double mean_nn, bending, g1;
} bat_learned_score;

/// How a training went.
typedef struct bat_learned_train_report
{
    uint64_t epochs; ///< done, earlier runs included
    double loss;     ///< mean over the last epoch of this run; NaN when there was none
    /// For the fairnesses 0, 1/2 and 1.
    bat_learned_score scores[BAT_FAIRING_CHECKS][BAT_TENSION_SPACE_COUNT];
} bat_learned_train_report;

/// Train the network on curves that are drawn anew for every step and never come again. While it runs, OpenBLAS works on one
/// thread in the whole process.
///
/// @param options null for the defaults, which keep nothing but the report
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (no epochs, a checkpoint of another training); BAT_NO_CONVERGENCE
/// with
///         the step when a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_learned_train(const bat_learned_train_options *options, bat_learned_train_report *report,
                                     bat_error *error);

BAT_C_END

#endif

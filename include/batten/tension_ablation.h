#ifndef BATTEN_TENSION_ABLATION_H
#define BATTEN_TENSION_ABLATION_H

#include "batten/tension_train.h"

BAT_C_BEGIN

/// @file
/// Tables 3 and 4 of Ugail and Howard (2026), section 7.8: the published recipe trained anew with one thing changed.

/// What a training differs in from the published recipe.
typedef enum bat_tension_variant
{
    BAT_TENSION_FULL,           ///< nothing: "full"
    BAT_TENSION_ONE_HOT,        ///< BAT_TENSION_EMBEDDING_ONE_HOT: "one-hot"
    BAT_TENSION_NO_EMBEDDING,   ///< BAT_TENSION_EMBEDDING_NONE: "no-embedding"
    BAT_TENSION_NO_CONSISTENCY, ///< without eq. (22): "no-consistency"
    BAT_TENSION_NO_BENDING,     ///< without eq. (21): "no-bending"
    BAT_TENSION_NO_SMOOTHNESS,  ///< without eq. (20): "no-smoothness"
    BAT_TENSION_VARIANT_COUNT
} bat_tension_variant;

/// Rows of table 3: full, one-hot, no-embedding.
#define BAT_TENSION_TABLE3_ROWS 3
/// Rows of table 4: full, no-consistency, no-bending, no-smoothness.
#define BAT_TENSION_TABLE4_ROWS 4

/// How to train the variants. Begin with bat_tension_ablation_defaults().
typedef struct bat_tension_ablation_options
{
    uint64_t seed;   ///< of every training; default 1
    uint64_t epochs; ///< of every training, at least 1; the learning rate falls to 0 over as many; default 100, as published
    /// A training's files (bat_tension_train_options) go to the folder's subfolder seed-SEED/VARIANT, and what is there already
    /// is gone on with: a finished training is not repeated. Both tables may share a folder. Null for no files; default null.
    const char *folder;
    int threads;           ///< as in bat_tension_train_options; default 0
    bat_progress progress; ///< asked before every batch; when it says stop, the training's checkpoint is written first
} bat_tension_ablation_options;

/// The options' default values.
BAT_API bat_tension_ablation_options bat_tension_ablation_defaults(void);

/// What the best weights do to the validation curves of one space: means over the curves.
typedef struct bat_tension_ablation_score
{
    double mean_nn, g1;
    double bending; ///< over the mean bending of the four-point scheme as printed
} bat_tension_ablation_score;

typedef struct bat_tension_ablation_row
{
    const char *variant; ///< its name
    size_t weights;      ///< of the network
    bat_tension_train_report report;
    bat_tension_ablation_score scores[BAT_TENSION_SPACE_COUNT];
    bat_tension_ablation_score published[BAT_TENSION_SPACE_COUNT]; ///< the paper's; NaN where it has none
} bat_tension_ablation_row;

/// Train the networks of table 3. With the defaults a training takes minutes.
///
/// @param options null for the defaults
/// @param rows    receives BAT_TENSION_TABLE3_ROWS rows
/// @return as bat_tension_train(); BAT_INVALID_ARGUMENT also for a folder that holds trainings of another number of epochs
BAT_API bat_status bat_tension_table3(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

/// The same for table 4: BAT_TENSION_TABLE4_ROWS rows.
BAT_API bat_status bat_tension_table4(const bat_tension_ablation_options *options, bat_tension_ablation_row *rows,
                                      bat_error *error);

BAT_C_END

#endif

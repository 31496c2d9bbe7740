#ifndef BATTEN_RESEARCH_CURVE_TRAIN_H
#define BATTEN_RESEARCH_CURVE_TRAIN_H

#include "batten/research/curve_data.h"
#include "batten/research/train.h"

BAT_C_BEGIN

/// @file
/// Training of learned curve schemes. The published recipe is that of Ugail and Howard (2026), sections 5 and 6;
/// docs/algorithms/tension-network.md tells what the text leaves open and how it is read here. Batten's recipe makes the
/// weights of bat_curve_scheme_learned() (docs/algorithms/curve-network.md); its curves are drawn anew in every step.

/// How the published network encodes the space of an edge (table 3).
typedef enum bat_tension_embedding
{
    BAT_TENSION_EMBEDDING_LEARNED, ///< a table of 3 x 8 trained numbers: 140,505 weights
    BAT_TENSION_EMBEDDING_ONE_HOT, ///< three fixed numbers, one of which is 1: 139,841 weights
    BAT_TENSION_EMBEDDING_NONE     ///< not at all: 139,457 weights
} bat_tension_embedding;

/// How to train. Begin with bat_curve_train_defaults().
typedef struct bat_curve_train_options
{
    bat_train_options run; ///< default 300 epochs; batten's have 8,000 curves each
    bat_recipe recipe;
    /// Of batten's recipe: weights that training begins with, a file that a training wrote; null: random ones, the default
    const char *begin;
    // Of the published recipe alone; batten's has its defaults, which are 0.
    bat_tension_embedding embedding;            ///< default learned
    double smoothness[BAT_TENSION_SPACE_COUNT]; ///< weight of eq. (20) in each space, at least 0; default 0.05, sphere 0.15
    double bending;                             ///< weight of eq. (21), at least 0; default 1e-4
    double consistency;                         ///< weight of eq. (22), at least 0; default 0.1
} bat_curve_train_options;

/// The default options of a recipe.
BAT_API bat_curve_train_options bat_curve_train_defaults(bat_recipe recipe);

/// The fairnesses at which batten's recipe is validated: 0, 1/2 and 1.
#define BAT_CURVE_TRAIN_FAIRNESSES 3

/// Means over the validation curves of one space, refined by BAT_TENSION_LEVELS learned levels.
typedef struct bat_curve_train_score
{
    double mean_nn, bending, g1;
} bat_curve_train_score;

/// The outcome of a training.
typedef struct bat_curve_train_report
{
    bat_train_report run; ///< `best` is the mean of the three spaces' mean_nn, with batten's recipe at fairness 0
    size_t
        fairness_count; ///< rows of `scores`: BAT_CURVE_TRAIN_FAIRNESSES; 1 with the published recipe, which has no fairness
    bat_curve_train_score scores[BAT_CURVE_TRAIN_FAIRNESSES][BAT_TENSION_SPACE_COUNT]; ///< of the final weights
} bat_curve_train_report;

/// Train. The final weights are the best of the published recipe, and the last of batten's. While it runs, OpenBLAS works on
/// one thread in the whole process.
///
/// @param options null for the defaults of BAT_RECIPE_PUBLISHED
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (an option out of range, a checkpoint of another training);
///         BAT_NO_CONVERGENCE with the step when a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_curve_train(const bat_curve_train_options *options, bat_curve_train_report *report, bat_error *error);

BAT_C_END

#endif

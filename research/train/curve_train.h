#ifndef RESEARCH_TRAIN_CURVE_TRAIN_H
#define RESEARCH_TRAIN_CURVE_TRAIN_H

#include "batten/research/curve_train.h"
#include "research/train/run.h"

/// @file
/// The two recipes for curves, and trainings of other sizes than bat_curve_train() has.

/// Sizes of a training; zero and null for those of bat_curve_train().
typedef struct curve_train_size
{
    /// Published: the curves, at least one to train on and one to validate with; a space may have none.
    const bat_tension_data *data;
    uint64_t steps;           ///< batten: of an epoch, 32 curves each
    size_t validation_curves; ///< batten: of each space
} curve_train_size;

/// bat_curve_train() of another size.
bat_status curve_train_sized(const bat_curve_train_options *options, const curve_train_size *size,
                             bat_curve_train_report *report, bat_error *error);

/// What both recipes work on.
typedef struct curve_training
{
    train_context base;
    const bat_curve_train_options *options;
    curve_train_size size;
    bat_tension_data own_data;                           ///< published: where the caller gives none
    size_t sample_count;                                 ///< published
    size_t *order;                                       ///< published: of the samples in this epoch
    bat_tension_set validation[BAT_TENSION_SPACE_COUNT]; ///< batten
} curve_training;

/// NaN for none.
bat_curve_train_score curve_mean_score(const bat_curve_train_score *scores, size_t count);

extern const train_recipe curve_recipe_published, curve_recipe_batten;

/// Means over validation curves, for each space: refine the control polygons by BAT_TENSION_LEVELS levels of the published
/// network (Ugail and Howard 2026, section 7.1: all levels are learned, without the warm-up of training) and compare them
/// with their curves. A set without curves scores NaN. The processes of a group share the curves.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status curve_published_validate(const learn_parameters *parameters, bat_tension_embedding embedding,
                                    const bat_tension_set sets[BAT_TENSION_SPACE_COUNT], const bat_group *group, int threads,
                                    bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT], bat_error *error);
/// The validation metric (section 6.4): the mean over the spaces that have curves of their mean_nn.
double curve_published_metric(const bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT]);

/// The same for batten's network, at one fairness.
/// @return BAT_OK or what refinement returned
bat_status curve_batten_validate(const learn_parameters *parameters, const bat_tension_set sets[BAT_TENSION_SPACE_COUNT],
                                 double fairness, const bat_group *group, int threads,
                                 bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT], bat_error *error);
/// The scores at all fairnesses of bat_curve_train_report.
bat_status curve_batten_score(const curve_training *t,
                              bat_curve_train_score scores[BAT_CURVE_TRAIN_FAIRNESSES][BAT_TENSION_SPACE_COUNT],
                              bat_error *error);

#endif

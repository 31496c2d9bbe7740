#ifndef BATTEN_RESEARCH_SURFACE_TRAIN_H
#define BATTEN_RESEARCH_SURFACE_TRAIN_H

#include "batten/research/train.h"

BAT_C_BEGIN

/// @file
/// Training of learned parameters on random Bézier clouds. The published recipe is that of Giannelli et al., "BIDGCN"
/// (2023), section 4: a network of 192,130 weights. Batten's recipe has a network of its own
/// (docs/algorithms/surface-network.md).

/// The most steps of an epoch, clouds of a step and interior points of a cloud, and the highest bidegree.
#define BAT_SURFACE_TRAIN_MAX_STEPS 1000000000
#define BAT_SURFACE_TRAIN_MAX_BATCH 1000000
#define BAT_SURFACE_TRAIN_MAX_POINTS 100000
#define BAT_SURFACE_TRAIN_MAX_DEGREE 15

/// How to train. Begin with bat_surface_train_defaults().
typedef struct bat_surface_train_options
{
    bat_train_options run; ///< default 100 epochs; batten 60
    bat_recipe recipe;
    bool uninformed; ///< published alone: boundary points are treated as interior ones (section 6.1); default false
    size_t steps;    ///< per epoch, 1 to BAT_SURFACE_TRAIN_MAX_STEPS; default 1000; batten 500
    size_t batch;    ///< clouds per step, 1 to BAT_SURFACE_TRAIN_MAX_BATCH; default 1; batten 32
    /// Interior points of a cloud, drawn uniformly in the logarithm; 4 to BAT_SURFACE_TRAIN_MAX_POINTS; default 1000; batten
    /// 50 to 2000.
    size_t min_points, max_points;
    /// Bidegree of a cloud and of the fit in its loss, drawn uniformly; 1 to BAT_SURFACE_TRAIN_MAX_DEGREE; default 2; batten
    /// 2 to 5.
    int min_degree, max_degree;
    double noise; ///< the largest standard deviation of the noise, at least 0; drawn uniformly from 0 on; default 0; batten
                  ///< 0.05
    double clean; ///< the share of clouds without noise, at least 0 and below 1; default 0; batten 0.5
    double rate;  ///< the learning rate, above 0; default 0.1; batten 1e-3
    /// AdamW and cosine decay; false: gradient descent, the rate halved at plateaus; default false; batten true.
    bool adam;
} bat_surface_train_options;

/// The default options of a recipe.
BAT_API bat_surface_train_options bat_surface_train_defaults(bat_recipe recipe);

/// The outcome of a training.
typedef struct bat_surface_train_report
{
    bat_train_report
        run; ///< `best` is the mean square error of the fit over points and coordinates of the validation clouds
} bat_surface_train_report;

/// Train. Every cloud is new. The final weights are those of the lowest error on 100 validation clouds, after every epoch.
/// While it runs, OpenBLAS works on one thread in the whole process.
///
/// @param options null for the defaults of BAT_RECIPE_PUBLISHED
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (an option out of range, a checkpoint of another training);
///         BAT_NO_CONVERGENCE when a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_surface_train(const bat_surface_train_options *options, bat_surface_train_report *report,
                                     bat_error *error);

BAT_C_END

#endif

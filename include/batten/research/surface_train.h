#ifndef BATTEN_RESEARCH_SURFACE_TRAIN_H
#define BATTEN_RESEARCH_SURFACE_TRAIN_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Training of learned parameters on random Bézier clouds (Giannelli et al., "BIDGCN", 2023, section 4).

/// Which network and loss.
typedef enum bat_surface_network
{
    BAT_SURFACE_PUBLISHED, ///< BIDGCN: 192,130 weights
    BAT_SURFACE_BATTEN     ///< ours (docs/surface-network.md)
} bat_surface_network;

/// How to train. Begin with bat_surface_train_defaults(), the published recipe.
typedef struct bat_surface_train_options
{
    uint64_t seed;               ///< default 1
    bat_surface_network network; ///< default published
    bool uninformed; ///< the published network with boundary points as interior ones (section 6.1); default false
    uint64_t epochs; ///< at least 1; default 100
    size_t steps;    ///< of an epoch, at least 1; default 1000
    size_t batch;    ///< clouds of a step, at least 1; default 1
    size_t least_points, most_points; ///< interior points of a cloud, drawn evenly in the logarithm; default 1000
    int least_degree, most_degree;    ///< bidegree of a cloud, drawn evenly, and of the fit of its loss; default 2
    double noise;                     ///< the largest standard deviation of noise, drawn from 0 on; default 0
    double clean;                     ///< the share of clouds without noise, 0 to 1; default 0
    double rate;                      ///< default .1
    bool adam;          ///< AdamW and half a wave; false: plain gradient descent, the rate halved at plateaus; default false
    const char *folder; ///< as in bat_mesh_train_options
    bool resume;        ///< go on from the folder's checkpoint, if there is one, to the same bytes as without the stop
    int threads;        ///< 0: as many as OpenMP gives; the result does not depend on it
    bat_progress progress; ///< asked before every step; when it says stop, the checkpoint is written first
} bat_surface_train_options;

BAT_API bat_surface_train_options bat_surface_train_defaults(void);
/// The recipe of the weights that batten ships (weights/surface.md).
BAT_API bat_surface_train_options bat_surface_train_batten(void);

/// How a training went. Errors are mean squares over points and coordinates of the least-squares fit.
typedef struct bat_surface_train_report
{
    uint64_t epochs, best_epoch; ///< done, earlier runs included; the best, counted from 1
    double loss;                 ///< mean over the last epoch of this run; NaN when there was none
    double error;                ///< of the best weights, over clouds kept aside
} bat_surface_train_report;

/// Train. Clouds are made on the fly; none comes twice.
/// @param options null for the defaults
/// @param report  may be null
/// @return BAT_OK; BAT_CANCELLED; BAT_INVALID_ARGUMENT (numbers out of range, a checkpoint of another training);
/// BAT_NO_CONVERGENCE when
///         a loss is not finite; BAT_BAD_FILE, BAT_FILE_ACCESS or BAT_NO_MEMORY
BAT_API bat_status bat_surface_train(const bat_surface_train_options *options, bat_surface_train_report *report,
                                     bat_error *error);

BAT_C_END

#endif

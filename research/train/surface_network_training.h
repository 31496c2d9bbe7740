#ifndef RESEARCH_TRAIN_SURFACE_NETWORK_TRAINING_H
#define RESEARCH_TRAIN_SURFACE_NETWORK_TRAINING_H

#include "batten/research/surface_train.h"
#include "learn/operations.h"
#include "surface/network/model.h"

/// @file
/// What training needs of a network that parameterizes clouds, beside its kind.

/// A cloud to train on, or kept aside.
typedef struct surface_sample
{
    bat_cloud cloud;
    double *parameters; ///< cloud.count x 2: those that the points were sampled at. Networks are given the boundary's, which
                        ///< come first; only a loss may look at the others
    int degree; ///< of the surface that the cloud was sampled from, in both parameters
} surface_sample;

typedef struct surface_network_training
{
    const surface_network_kind *kind;

    /// Draw the weights that training begins with.
    void (*start)(learn_parameters *parameters, uint64_t seed);

    /// The network on a tape that began with its parameters. Cloud and boundary stay until the step has been differentiated;
    /// whatever else must stay is on the tape (learn_tape_memory()). Called from several threads at once, each with its own
    /// tape.
    /// @param boundary cloud->boundary_count x 2
    /// @return interior points x 2
    learn_array *(*predict)(learn_tape *tape, const bat_cloud *cloud, const double *boundary);
    /// The loss of one cloud, 1 x 1. Null: surface_sample_residual(), the mean square of the least-squares residual.
    /// @param interior what predict() said
    learn_array *(*loss)(learn_tape *tape, const surface_sample *sample, learn_array *interior);
} surface_network_training;

extern const surface_network_training surface_training_published, surface_training_uninformed, surface_training_batten;

/// The training that options ask for; null where there is none.
const surface_network_training *surface_network_training_of(bat_surface_network network, bool uninformed);

#endif

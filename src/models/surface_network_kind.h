#ifndef MODELS_SURFACE_NETWORK_KIND_H
#define MODELS_SURFACE_NETWORK_KIND_H

#include "batten/cloud.h"
#include "batten/surface_train.h"
#include "learn/operations.h"

/// @file
/// What training, model files and bat_surface_model_parameterize() need to know of a network that parameterizes clouds. A new network is
/// a surface_network_kind of its own, in its own files, and a line in the list of surface_network_kind.c: nothing else changes.
///
/// Everywhere here a cloud stands in the unit box (models/unit_box.h: one scale for all coordinates, boundary included), its boundary
/// points come first, and it passed bat_cloud_check(). *Interior* points are all others, in their order.

/// A cloud to train on, or kept aside.
typedef struct surface_sample
{
    bat_cloud cloud;
    double *
        parameters; ///< cloud.count x 2: those that the points were sampled at. Networks are given the boundary's, which come
                    ///< first; only a loss may look at the others
    int degree;     ///< of the surface that the cloud was sampled from, in both parameters
} surface_sample;

typedef struct surface_network_kind
{
    /// As the recipe's note in a file tells it: "surface NAME, …". No commas.
    const char *name;

    /// Add the weights' names and shapes to `parameters`, which is all zero before, and allocate it; all weights are zero then.
    /// @return BAT_OK or BAT_NO_MEMORY, with nothing to release on failure
    bat_status (*make)(learn_parameters *parameters, bat_error *error);
    /// Draw the weights that training begins with.
    void (*start)(learn_parameters *parameters, uint64_t seed);

    /// The network on a tape that began with its parameters. Cloud and boundary stay until the step has been differentiated; whatever
    /// else must stay is on the tape (learn_tape_memory()). Called from several threads at once, each with its own tape.
    /// @param boundary cloud->boundary_count x 2
    /// @return interior points x 2
    learn_array *(*predict)(learn_tape *tape, const bat_cloud *cloud, const double *boundary);
    /// The loss of one cloud, 1 x 1. Null: surface_sample_residual(), the mean square of the least-squares residual.
    /// @param interior what predict() said
    learn_array *(*loss)(learn_tape *tape, const surface_sample *sample, learn_array *interior);

    /// Lay the weights out for inference, without a tape.
    /// @param network receives what infer() is given; release it with free_network()
    /// @return BAT_OK or BAT_NO_MEMORY
    bat_status (*make_network)(const learn_parameters *parameters, void **network, bat_error *error);
    /// Does nothing to null.
    void (*free_network)(void *network);
    /// The same numbers as predict() to rounding, but for clouds that a kind knows to be beyond its network. Any number of calls may use a network at once; the result does not depend on
    /// `threads` (0: as many as OpenMP gives).
    /// @param interior receives interior points x 2, each in [0, 1]
    bat_status (*infer)(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error);
} surface_network_kind;

/// The kind that options ask for; null where there is none.
const surface_network_kind *surface_network_kind_of(bat_surface_network network, bool uninformed);
/// The kind that the recipe's note of a file names; null where there is none, or no note.
const surface_network_kind *surface_network_kind_named(const char *recipe);

#endif

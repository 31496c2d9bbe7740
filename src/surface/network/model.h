#ifndef SURFACE_NETWORK_MODEL_H
#define SURFACE_NETWORK_MODEL_H

#include "batten/cloud.h"
#include "learn/parameters.h"

/// @file
/// Interface between a network that parameterizes clouds and its users: training, model files and
/// bat_surface_model_parameterize(). A new network is one surface_network_kind, in a file of its own, and one entry of the
/// table in model.c.
///
/// Throughout, a cloud is scaled to the unit box (mesh/measure/unit_box.h), with one scale for all coordinates. Its boundary
/// points come first, and it has passed bat_cloud_check(). *Interior* points are all others, in order.

/// A kind of network.
typedef struct surface_network_kind
{
    /// Name in the recipe note of a file: "surface NAME, …". Contains no comma.
    const char *name;

    /// Add names and shapes of the weights to `parameters`, which is empty, and allocate it with zeros.
    /// @return BAT_OK or BAT_NO_MEMORY, with nothing to release on failure
    bat_status (*make)(learn_parameters *parameters, bat_error *error);
    /// Prepare the weights for inference without a tape.
    /// @param network receives the argument of infer(); release it with free_network()
    /// @return BAT_OK or BAT_NO_MEMORY
    bat_status (*make_network)(const learn_parameters *parameters, void **network, bat_error *error);
    /// Does nothing to null.
    void (*free_network)(void *network);
    /// Compute the interior parameters. The result agrees with that of the tape up to rounding, except for clouds on which
    /// the kind uses a classical method instead. Thread-safe; the result does not depend on `threads` (0: the default of
    /// OpenMP).
    /// @param interior receives interior points x 2, each in [0, 1]
    bat_status (*infer)(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error);
} surface_network_kind;

/// The kind named in the recipe note of a file; null if the note is missing or names none.
const surface_network_kind *surface_network_kind_by_name(const char *recipe);

#endif

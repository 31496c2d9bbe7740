#ifndef SURFACE_NETWORK_MODEL_H
#define SURFACE_NETWORK_MODEL_H

#include "batten/cloud.h"
#include "learn/parameters.h"

/// @file
/// What training, model files and bat_surface_model_parameterize() need to know of a network that parameterizes clouds. A
/// new network is a surface_network_kind of its own, in its own files, and a line in the list of surface_network_kind.c:
/// nothing else changes.
///
/// Everywhere here a cloud stands in the unit box (src/mesh/measure/unit_box.h: one scale for all coordinates, boundary
/// included), its boundary points come first, and it passed bat_cloud_check(). *Interior* points are all others, in their
/// order.

typedef struct surface_network_kind
{
    /// As the recipe's note in a file tells it: "surface NAME, …". No commas.
    const char *name;

    /// Add the weights' names and shapes to `parameters`, which is all zero before, and allocate it; all weights are zero
    /// then.
    /// @return BAT_OK or BAT_NO_MEMORY, with nothing to release on failure
    bat_status (*make)(learn_parameters *parameters, bat_error *error);
    /// Lay the weights out for inference, without a tape.
    /// @param network receives what infer() is given; release it with free_network()
    /// @return BAT_OK or BAT_NO_MEMORY
    bat_status (*make_network)(const learn_parameters *parameters, void **network, bat_error *error);
    /// Does nothing to null.
    void (*free_network)(void *network);
    /// The same numbers as on a tape to rounding, but for clouds that a kind knows to be beyond its network. Any number of
    /// calls may use a network at once; the result does not depend on `threads` (0: as many as OpenMP gives).
    /// @param interior receives interior points x 2, each in [0, 1]
    bat_status (*infer)(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error);
} surface_network_kind;

/// The kind that the recipe's note of a file names; null where there is none, or no note.
const surface_network_kind *surface_network_kind_by_name(const char *recipe);

#endif

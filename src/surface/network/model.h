#ifndef SURFACE_NETWORK_MODEL_H
#define SURFACE_NETWORK_MODEL_H

#include "batten/cloud_parameterize.h"
#include "learn/model.h"

/// @file
/// Networks that parameterize clouds, as rows of learn/model.h: training, files and bat_surface_model_parameterize() use
/// them. The recipe of a file tells its network.
///
/// Throughout, a cloud is scaled to the unit box (mesh/measure/unit_box.h), with one scale for all coordinates. Its boundary
/// points come first, and it has passed bat_cloud_check(). *Interior* points are all others, in order.

/// The rule of a network.
typedef struct surface_rule
{
    /// Compute the interior parameters. The result agrees with that of the tape up to rounding, except for clouds on which
    /// the network uses a classical method instead. Thread-safe; the result does not depend on `threads` (0: the default of
    /// OpenMP).
    /// @param interior receives interior points x 2, each in [0, 1]
    bat_status (*infer)(const void *network, const bat_cloud *cloud, const double *boundary, int threads, double *interior,
                        bat_error *error);
} surface_rule;
/// The table of networks.
extern const learn_networks surface_networks;

/// Read a model, a row's rule being a surface_rule.
bat_status surface_model_read(const learn_networks *networks, const char *path, bat_surface_model **model, bat_error *error);

#endif

#ifndef RESEARCH_SHAPES_CLOUD_SAMPLING_H
#define RESEARCH_SHAPES_CLOUD_SAMPLING_H

#include "batten/cloud.h"
#include "research/shapes/surface_shape.h"

/// @file
/// Clouds sampled from surfaces at known parameters: memory, evenly spread samples, and simulated scans.

/// A cloud under construction.
typedef struct sampled_cloud
{
    bat_cloud cloud;
    double *parameters; ///< count x 2
} sampled_cloud;

/// Allocate a cloud with `steps` edges (at least 1) on each side of the boundary, counter-clockwise from (0, 0), and
/// `interior` interior points. Sets the corners, not parameters and points.
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status sampled_cloud_make(const size_t steps[4], size_t interior, sampled_cloud *sampled, bat_error *error);
void sampled_cloud_free(sampled_cloud *sampled);
/// Move the cloud to the caller, and the parameters unless `parameters` is null.
void sampled_cloud_move(sampled_cloud *sampled, bat_cloud *cloud, double **parameters);

/// The parameter at a fraction of side 0 … 3 of the square, counter-clockwise from (0, 0).
static inline void square_side_at(int side, double share, double parameter[2])
{
    const double along[4][2] = {{share, 0}, {1, share}, {1 - share, 1}, {0, 1 - share}};
    parameter[0] = along[side][0];
    parameter[1] = along[side][1];
}

/// Add Gaussian noise to each coordinate of a cloud.
void cloud_add_noise(bat_cloud *cloud, double deviation, bat_random *random);

/// @param points of the whole cloud; the boundary has what suits the distance between neighbours, which is even along each
/// side
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_sample_evenly(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                               bat_error *error);

/// @param points about how many
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_sample_scan(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                             bat_error *error);

#endif

#ifndef RESEARCH_SHAPES_SURFACE_CLOUD_H
#define RESEARCH_SHAPES_SURFACE_CLOUD_H

#include "batten/cloud.h"

/// @file
/// What clouds sampled at known parameters begin with.

/// Points and parameters to be filled in.
typedef struct sampled_cloud
{
    bat_cloud cloud;
    double *parameters; ///< count x 2
} sampled_cloud;

/// Make room for a cloud with so many steps along each side of its boundary, at least 1, from (0, 0) counter-clockwise, and
/// so many points inside. Its corners are set, parameters and points are not.
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY
bat_status sampled_cloud_make(const size_t steps[4], size_t interior, sampled_cloud *sampled, bat_error *error);
void sampled_cloud_free(sampled_cloud *sampled);
/// Hand the cloud over, and the parameters unless nobody wants them.
void sampled_cloud_give(sampled_cloud *sampled, bat_cloud *cloud, double **parameters);

/// The parameter at a share of side 0 … 3 of the square: from (0, 0) counter-clockwise.
static inline void square_side_at(int side, double share, double parameter[2])
{
    const double along[4][2] = {{share, 0}, {1, share}, {1 - share, 1}, {0, 1 - share}};
    parameter[0] = along[side][0];
    parameter[1] = along[side][1];
}

/// Add Gaussian noise to each coordinate of a cloud.
void cloud_add_noise(bat_cloud *cloud, double deviation, bat_random *random);

#endif

#ifndef RESEARCH_SHAPES_CLOUD_SAMPLING_H
#define RESEARCH_SHAPES_CLOUD_SAMPLING_H

#include "batten/cloud.h"
#include "research/shapes/surface_shape.h"

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
void sampled_cloud_move(sampled_cloud *sampled, bat_cloud *cloud, double **parameters);

/// The parameter at a share of side 0 … 3 of the square: from (0, 0) counter-clockwise.
static inline void square_side_at(int side, double share, double parameter[2])
{
    const double along[4][2] = {{share, 0}, {1, share}, {1 - share, 1}, {0, 1 - share}};
    parameter[0] = along[side][0];
    parameter[1] = along[side][1];
}

/// Add Gaussian noise to each coordinate of a cloud.
void cloud_add_noise(bat_cloud *cloud, double deviation, bat_random *random);

/// @file
/// Points spread evenly over a surface, whatever its parameters: in strips of even width across its longer way, each with as
/// many points as its area asks for, a little out of line.

/// @param points of the whole cloud; the boundary has what suits the distance between neighbours, which is even along each
/// side
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_sample_evenly(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                               bat_error *error);

/// @file
/// What a scanner that looks along z makes of a surface: lines, denser along themselves than across, fewer points on steep
/// places, a second sweep over a part, a gap where nothing was seen, noise, no order.

/// @param points about how many
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_sample_scan(const surface_shape *shape, size_t points, bat_random *random, sampled_cloud *sampled,
                             bat_error *error);

#endif

#pragma once

#include "surface/cloud/local_plane.h"

/// @file
/// A part of a cloud that stands for all of it: a random sample of a large cloud, or an even sample of scan lines.

/// The part. All zero: none is needed. Release it with cloud_part_free().
typedef struct cloud_part
{
    bat_cloud cloud; ///< with its boundary loop and corners; `order` gives the indices in the input
    size_t *members; ///< cloud.count: index of each point in the given cloud
    bool is_even;    ///< it is an even sample of scan lines
} cloud_part;

/// Take a part of a cloud with known boundary and corners, which stay; the loop is thinned like the other points.
/// @param wanted number of points, about
/// @param part   stays empty for a cloud of no more points that is as dense in all directions
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_part_make(const bat_cloud *cloud, size_t wanted, cloud_part *part, bat_error *error);
void cloud_part_free(cloud_part *part);

/// Give each of some points the parameter of the nearest point of a part.
/// @param frame      in which distances are compared: that of the whole cloud
/// @param part       the points of the part
/// @param of_part    part->count x 2
/// @param points     count x 3
/// @param parameters receives count x 2
/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_part_spread(const unit_frame *frame, const bat_cloud *part, const double *of_part, const double *points,
                             size_t count, double *parameters, bat_error *error);

// Even samples of clouds that are much denser in one direction, such as scan lines, whose neighbourhoods are lines.

/// The least distance of points at which a cloud is as dense in all directions.
/// @param radius receives 0 for a cloud that already is, and infinity where none is found: the points lie along a curve
/// @return BAT_OK or BAT_NO_MEMORY
bat_status even_sample_radius(const double *points, const nearest_tree *tree, double *radius, bat_error *error);

/// Choose points that are at least `radius` apart (dart throwing): ends of lines first, then in ascending order.
/// @param chosen count; receives which points are chosen
/// @return BAT_OK or BAT_NO_MEMORY
bat_status even_sample_choose(const double *points, const nearest_tree *tree, double radius, bool *chosen, bat_error *error);

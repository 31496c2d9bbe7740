#ifndef SURFACE_CLOUD_LOCAL_PLANE_H
#define SURFACE_CLOUD_LOCAL_PLANE_H

#include "surface/cloud/neighbours.h"

/// @file
/// Planes fitted to neighbourhoods of points, by total least squares (principal component analysis), and the choice of
/// neighbourhoods.

/// A plane through the mean of some points, spanned by their two principal axes of largest variance.
typedef struct local_plane
{
    double centre[3];
    double axes[3][3];  ///< orthonormal and right-handed: the two axes in the plane, larger variance first, then the normal
    double variance[3]; ///< variances along the axes, descending
} local_plane;

/// Fit a plane to the listed points, at least one.
/// @param points coordinates, 3 for each point; squares of differences must not overflow
local_plane local_plane_fit(const double *points, const neighbour_list *list);

/// Coordinates of the projection of a point to the plane, relative to an origin.
void local_plane_project(const local_plane *plane, const double origin[3], const double point[3], double foot[2]);

/// A translation and a scale by a power of two: x -> ldexp(x / 2 - middle / 2, exponent).
typedef struct unit_frame
{
    double middle[3];
    int exponent;
} unit_frame;

/// The frame in which all coordinates of some points are in [-1, 1].
unit_frame unit_frame_of(const double *points, size_t count);

/// The place of a point in a frame.
void unit_frame_place(const unit_frame *frame, const double point[3], double place[3]);

/// A copy of points, translated and scaled by a power of two so that all coordinates are in [-1, 1]. All axes have the same
/// scale. Release it with free(); null when out of memory.
double *points_to_unit_size(const double *points, size_t count);

enum
{
    NEIGHBOURHOOD_MIN = 16, ///< minimum number of points of a neighbourhood, including its centre
    NEIGHBOURHOOD_MAX = 400 ///< number of points at which the neighbourhood stops growing
};

/// The smallest neighbourhood whose standard deviation across its plane is at most half of the smaller one along it. The
/// number of nearest points is doubled until this holds or NEIGHBOURHOOD_MAX is reached. On a noisy surface, the result is
/// about a disc of four standard deviations of the noise.
/// @param points the points of the tree
/// @param wanted initial number of points, at least NEIGHBOURHOOD_MIN
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbourhood_find(const neighbour_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error);

#endif

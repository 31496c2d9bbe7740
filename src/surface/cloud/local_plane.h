#ifndef SURFACE_CLOUD_LOCAL_PLANE_H
#define SURFACE_CLOUD_LOCAL_PLANE_H

#include "surface/cloud/neighbours.h"

/// The plane that some points lie near: through their mean, along the axes of their greatest scatter.
typedef struct local_plane
{
    double centre[3];
    double axes[3][3];  ///< unit vectors, orthogonal and right-handed: the plane's two, the more scattered first, then its
                        ///< normal
    double variance[3]; ///< mean squares along the axes, falling
} local_plane;

/// Fit a plane to listed points, at least one, in total least squares.
/// @param points rows of 3; squares of their differences must fit a double
local_plane local_plane_fit(const double *points, const neighbour_list *list);

/// Where a point's foot lies in the plane, from a given origin.
void local_plane_project(const local_plane *plane, const double origin[3], const double point[3], double foot[2]);

/// A copy of points, moved and scaled by a power of two so that all coordinates lie within -1 and 1 and squares are safe.
/// The scale is the same for all axes. Release it with free(); null when out of memory.
double *points_to_unit_size(const double *points, size_t count);

/// @file
/// Neighbourhoods that show which way a surface lies.

enum
{
    NEIGHBOURHOOD_MIN = 16, ///< points of a neighbourhood to begin with, its middle among them
    NEIGHBOURHOOD_MAX = 400 ///< points after which thickness is taken as it is
};

/// The nearest points of a place, as many as it takes until they spread twice as far along their plane as across it. In a
/// surface with noise that is a disc of four standard deviations.
/// @param points those of the tree
/// @param wanted the fewest points; NEIGHBOURHOOD_MIN or more where a smaller neighbourhood did not do
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbourhood_find(const neighbour_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error);

#endif

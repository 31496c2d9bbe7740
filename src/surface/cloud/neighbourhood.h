#ifndef SURFACE_CLOUD_NEIGHBOURHOOD_H
#define SURFACE_CLOUD_NEIGHBOURHOOD_H

#include "surface/cloud/local_plane.h"
#include "surface/cloud/neighbours.h"

/// @file
/// Neighbourhoods that show which way a surface lies.

enum
{
    NEIGHBOURHOOD_FEWEST = 16, ///< points of a neighbourhood to begin with, its middle among them
    NEIGHBOURHOOD_MOST = 400   ///< points after which thickness is taken as it is
};

/// The nearest points of a place, as many as it takes until they spread twice as far along their plane as across it. In a
/// surface with noise that is a disc of four standard deviations.
/// @param points those of the tree
/// @param wanted the fewest points; NEIGHBOURHOOD_FEWEST or more where a smaller neighbourhood did not do
/// @return BAT_OK or BAT_NO_MEMORY
bat_status neighbourhood_find(const neighbour_tree *tree, const double *points, const double place[3], size_t wanted,
                              neighbour_list *near, local_plane *plane, bat_error *error);

#endif

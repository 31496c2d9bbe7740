#ifndef SURFACE_CLOUD_TUBE_CUT_H
#define SURFACE_CLOUD_TUBE_CUT_H

#include "batten/base.h"

/// @file
/// Cut a tube into a disc.

/// Remove the shortest strip of triangles from one boundary loop to the other.
/// @param faces  *count x 3, consistently oriented; the others keep their order
/// @param points number of vertices
/// @return BAT_OK; BAT_NO_CONVERGENCE where there are not two loops, or a loop visits a point twice; BAT_NO_MEMORY
bat_status tube_cut(uint32_t *faces, size_t *count, size_t points, bat_error *error);

#endif

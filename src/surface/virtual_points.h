#ifndef SURFACE_VIRTUAL_POINTS_H
#define SURFACE_VIRTUAL_POINTS_H

#include "batten/cloud.h"

/// @file
/// Places on the triangles of a cloud, evenly in its parameters. They hold a surface where few points have much of the unit
/// square, as in parts that stand out of a deep shape.

/// Places of a grid of about as many nodes as points. Release it with virtual_points_free().
typedef struct virtual_points
{
    double *places;     ///< count x 3
    double *parameters; ///< count x 2
    size_t count;
} virtual_points;

/// Interpolate triangles linearly at the nodes of a grid. Where triangles overlap, the first one counts.
/// @param cloud      with triangles
/// @param parameters count x 2
/// @return BAT_OK or BAT_NO_MEMORY
bat_status virtual_points_make(const bat_cloud *cloud, const double *parameters, virtual_points *guides, bat_error *error);
void virtual_points_free(virtual_points *guides);

#endif

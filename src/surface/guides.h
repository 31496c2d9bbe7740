#ifndef SURFACE_GUIDES_H
#define SURFACE_GUIDES_H

#include "batten/cloud.h"

/// @file
/// Places on the triangles of a cloud, evenly in its parameters. They hold a surface where few points have much of the unit
/// square, as in parts that stand out of a deep shape.

/// Places of a grid of about as many nodes as points. Release it with surface_guides_free().
typedef struct surface_guides
{
    double *places;     ///< count x 3
    double *parameters; ///< count x 2
    size_t count;
} surface_guides;

/// Interpolate triangles linearly at the nodes of a grid. Where triangles overlap, the first one counts.
/// @param cloud      with triangles
/// @param parameters count x 2
/// @return BAT_OK or BAT_NO_MEMORY
bat_status surface_guides_make(const bat_cloud *cloud, const double *parameters, surface_guides *guides, bat_error *error);
void surface_guides_free(surface_guides *guides);

#endif

#ifndef DRAW_SURFACE_SURFACE_VIEW_H
#define DRAW_SURFACE_SURFACE_VIEW_H

#include "draw/mesh/mesh_view.h"

/// @file
/// From where patches of surface are seen.

/// Points of a patch.
typedef struct patch_points
{
    const double *points; ///< count x 3
    size_t count;
    size_t loop_count; ///< the first points, in order around the boundary; 0 when it is not known
} patch_points;

/// A view from a direction, with a direction upwards. Zeros leave it open: the eye is then a little above and beside the
/// mean normal, on the side to which the patch bulges out of its boundary; across the broad side of a patch that nearly
/// closes or whose boundary is not known; and on the side to which it leans where it is as deep as a head above its neck.
/// Upwards is z, or y where the patch faces z.
mesh_view surface_view_of(const patch_points *patch, const double direction[3], const double up[3]);

/// The smallest frame of what is seen of points.
mesh_frame surface_frame_of(const double *points, size_t count, const mesh_view *view);

#endif

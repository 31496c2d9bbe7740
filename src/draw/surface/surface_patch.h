#ifndef DRAW_SURFACE_SURFACE_PATCH_H
#define DRAW_SURFACE_SURFACE_PATCH_H

#include "batten/mesh.h"
#include "batten/spline_hierarchical.h"

/// @file
/// A spline surface as triangles to be shaded.

/// The vertices are an even grid of parameters, fine enough for the surface's finest cells but no finer than pictures show,
/// the boundary's first, counter-clockwise from (0, 0).
/// @param mesh       receives the triangles; release it with bat_mesh_free()
/// @param loop_count receives the number of vertices on the boundary
/// @return BAT_OK, what bat_spline_surface_evaluate() returns, or BAT_NO_MEMORY
bat_status surface_patch_make(const bat_spline_surface *surface, bat_mesh *mesh, size_t *loop_count, bat_error *error);

/// Leave out the triangles with a vertex outside of a box.
void surface_patch_cut(bat_mesh *mesh, const double low[3], const double high[3]);

/// Make the side that is seen from a direction the front of the triangles; of a patch that nearly closes the outer side.
void surface_patch_turn(bat_mesh *mesh, const double eye[3]);

#endif

#ifndef MESH_REFINE_LEAVE_OUT_H
#define MESH_REFINE_LEAVE_OUT_H

#include "mesh/refine/level.h"

/// @file
/// Faces at the boundary, where a scheme has no surface without rules for boundaries.

/// Leave out of a mesh, refined by one level or more, the faces that come from coarse faces with a vertex on a boundary that
/// is not sharp for ever, as OpenSubdiv does under VTX_BOUNDARY_NONE. Vertices and texture coordinates of no other face go,
/// too.
/// @param level   the coarse mesh's faces and links
/// @param sides   of the faces of `fine`, triangles or quads
/// @param normals of the vertices of `fine`, from which the same vertices go; null for none
/// @return BAT_OK; BAT_UNSUPPORTED where no face is left; BAT_NO_MEMORY; `fine` can be freed on failure
bat_status leave_out_boundary(const mesh_level *level, const bat_mesh *coarse, size_t levels, const mesh_sides *sides,
                              bat_mesh *fine, double *normals, bat_error *error);

#endif

#ifndef BATTEN_RESEARCH_MESH_SHAPES_H
#define BATTEN_RESEARCH_MESH_SHAPES_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Random meshes of any number: creatures, heads, machine parts, knots, reliefs, for training and for tests.
///
/// Most are solids bounded by implicit surfaces (blends of round cones and ellipsoids; machine parts of planes and
/// cylinders). Their boundaries are extracted on a tetrahedral lattice and remeshed isotropically, with edges along the
/// sharp edges of the solid. The others are triangulated grids.

/// A kind of shape.
typedef struct bat_mesh_shape_kind
{
    const char *name;    ///< "creature", "gear", …
    const char *summary; ///< short description
    bool closed;         ///< without a boundary
} bat_mesh_shape_kind;

/// The number of kinds.
BAT_API size_t bat_mesh_shape_count(void);
/// A kind, `index` from 0 on; null past the last. It has static storage duration.
BAT_API const bat_mesh_shape_kind *bat_mesh_shape_at(size_t index);

/// Make a shape.
///
/// @param name     of the kind
/// @param vertices number of vertices, met within a tenth; 200 to 1000000. Details need about 2000. The kind "cage" has a
///        fixed number.
/// @param seed     selects the proportions; the same three arguments give the same bytes
/// @param mesh     receives a connected manifold; the centre of its bounding box is the origin, the longest side is 1;
///        release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT for an unknown kind or a number out of range; BAT_TOO_LARGE; BAT_NO_MEMORY; `mesh`
/// is
///         untouched on failure
BAT_API bat_status bat_mesh_shape(const char *name, size_t vertices, uint64_t seed, bat_mesh *mesh, bat_error *error);

BAT_C_END

#endif

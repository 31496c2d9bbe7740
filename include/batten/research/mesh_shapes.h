#ifndef BATTEN_RESEARCH_MESH_SHAPES_H
#define BATTEN_RESEARCH_MESH_SHAPES_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Meshes of our own making, without end: creatures, heads, machine parts, knots, reliefs, to learn subdivision from and to
/// try things on.
///
/// Most are solids described by functions (bones and ellipsoids grown together, machine parts from planes and bars), cut out
/// of a lattice of tetrahedra and meshed anew with even triangles whose edges lie on the solid's edges; the others are woven
/// grids.

/// A kind of shape.
typedef struct bat_mesh_shape_kind
{
    const char *name;    ///< "creature", "gear", …
    const char *summary; ///< what it is, in a few words
    bool closed;         ///< without a boundary
} bat_mesh_shape_kind;

/// The number of kinds.
BAT_API size_t bat_mesh_shape_count(void);
/// A kind, `index` from 0 on; null past the last. It is there as long as the program.
BAT_API const bat_mesh_shape_kind *bat_mesh_shape_at(size_t index);

/// Make a shape.
///
/// @param name     of the kind
/// @param vertices about so many the mesh has, within a tenth; 200 to 1000000. From some 2000 on details come out. The kind
/// "cage" has its own number.
/// @param seed     chooses the proportions; the same three give the same bytes
/// @param mesh     receives one manifold piece, its box's middle at the origin and its box's longest side 1; release it with
/// bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT for an unknown kind or a number out of range; BAT_TOO_LARGE; BAT_NO_MEMORY; `mesh`
/// is
///         untouched on failure
BAT_API bat_status bat_mesh_shape(const char *name, size_t vertices, uint64_t seed, bat_mesh *mesh, bat_error *error);

BAT_C_END

#endif

#ifndef BATTEN_MESH_H
#define BATTEN_MESH_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Triangle meshes and who is whose neighbour in them.
///
/// Vertices, faces and half-edges are numbered from 0 by 32-bit indices. Half-edge 3 f + c runs along face f from its corner c
/// to its corner c + 1 (corner 0 after corner 2), so that faces[h] is where half-edge h begins. Seen from outside, corners go
/// around a face counter-clockwise.

/// Stands for a neighbour that does not exist.
#define BAT_MESH_NONE UINT32_MAX

/// The most faces a mesh may have: half-edges must have 32-bit indices.
#define BAT_MESH_MOST_FACES ((size_t)1431655764)

/// A sharpness that no refinement wears off (OpenSubdiv's value).
#define BAT_MESH_SHARP 10.0

/// An edge that refinement keeps sharp.
typedef struct bat_mesh_crease
{
    uint32_t a, b;    ///< the edge's two vertices, in either order
    double sharpness; ///< above 0: for how many levels; BAT_MESH_SHARP or above: for ever
} bat_mesh_crease;

/// A vertex that refinement keeps sharp.
typedef struct bat_mesh_corner
{
    uint32_t vertex;
    double sharpness; ///< as of a crease
} bat_mesh_corner;

/// A triangle mesh. All zero: empty. Everything in it is owned and comes from malloc(); release it with bat_mesh_free().
typedef struct bat_mesh
{
    double *positions; ///< vertex_count x 3
    uint32_t *faces;   ///< face_count x 3: the vertices at a face's corners
    size_t vertex_count;
    size_t face_count;

    double *texture;         ///< texture_count x 2 texture coordinates; null for none
    uint32_t *texture_faces; ///< face_count x 3: the texture coordinates at a face's corners; null for none
    size_t texture_count;

    double *channels;     ///< vertex_count x channel_count: further numbers at the vertices, such as colours; null for none
    char **channel_names; ///< channel_count texts
    size_t channel_count;

    bat_mesh_crease *creases; ///< in any order; null for none
    size_t crease_count;
    bat_mesh_corner *corners; ///< in any order; null for none
    size_t corner_count;
} bat_mesh;

/// Free what a mesh owns and make it empty. Does nothing to a mesh that is empty already.
BAT_API void bat_mesh_free(bat_mesh *mesh);

/// Copy a mesh with all it owns.
/// @return BAT_OK or BAT_NO_MEMORY; `copy` is untouched on failure
BAT_API bat_status bat_mesh_copy(const bat_mesh *mesh, bat_mesh *copy, bat_error *error);

/// A point on a mesh.
typedef struct bat_mesh_point
{
    uint32_t face;
    double barycentric[3]; ///< of the face's corners, 0 to 1, of sum 1
} bat_mesh_point;

/// Check what every call that takes a mesh relies on: at least one face, finite coordinates, faces of three different vertices
/// that exist, texture coordinates, creases and corners that name what exists.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no faces or a crease between vertices that are none; BAT_TOO_LARGE; BAT_INVALID_POINT
///         with the vertex or face at fault
BAT_API bat_status bat_mesh_check(const bat_mesh *mesh, bat_error *error);

/// Who is whose neighbour: half-edges in flat arrays, as Campagna, Kobbelt and Seidel, "Directed Edges" (1998). It describes
/// the faces that it was made from and does not follow their changes.
typedef struct bat_mesh_connectivity
{
    /// 3 x face_count: the half-edge along the same edge in the neighbouring face, in the other direction; BAT_MESH_NONE at a
    /// boundary.
    uint32_t *twin;
    /// vertex_count: a half-edge that begins at the vertex. At a boundary it is the one along the boundary, from which turning
    /// counter-clockwise (bat_mesh_next_around()) passes all others. BAT_MESH_NONE for a vertex without a face.
    uint32_t *first;
    /// 3 x face_count: the edge that a half-edge lies on. Edges are numbered by the lesser of their half-edges, in order.
    uint32_t *edge;
    size_t vertex_count, face_count;
    size_t edge_count;
    size_t boundary_edge_count;
} bat_mesh_connectivity;

/// Find the neighbours of all faces. Takes time in proportion to the mesh.
///
/// @param connectivity release it with bat_mesh_connectivity_free()
/// @return BAT_OK; BAT_TOO_LARGE (above BAT_MESH_MOST_FACES); BAT_INVALID_POINT with the face whose corner is not a vertex or
///         that has the same vertex twice; BAT_NOT_MANIFOLD with the face where an edge of more than two faces, an edge that two
///         faces run through in the same direction, or a vertex with several fans of faces shows first, the text naming the
///         vertices; BAT_NO_MEMORY. `connectivity` is untouched on failure
BAT_API bat_status bat_mesh_connect(const bat_mesh *mesh, bat_mesh_connectivity *connectivity, bat_error *error);

/// Free what it owns and make it empty.
BAT_API void bat_mesh_connectivity_free(bat_mesh_connectivity *connectivity);

/// The half-edge after another one in its face, counter-clockwise.
static inline uint32_t bat_mesh_next(uint32_t half_edge)
{
    return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}

/// The half-edge before another one in its face.
static inline uint32_t bat_mesh_previous(uint32_t half_edge)
{
    return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
}

/// The half-edge that begins at the same vertex and follows counter-clockwise; BAT_MESH_NONE at the end of a boundary vertex's
/// fan.
static inline uint32_t bat_mesh_next_around(const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    return connectivity->twin[bat_mesh_previous(half_edge)];
}

/// The half-edge that begins at the same vertex and precedes counter-clockwise; BAT_MESH_NONE at the begin of a boundary
/// vertex's fan.
static inline uint32_t bat_mesh_previous_around(const bat_mesh_connectivity *connectivity, uint32_t half_edge)
{
    uint32_t twin = connectivity->twin[half_edge];
    return twin == BAT_MESH_NONE ? BAT_MESH_NONE : bat_mesh_next(twin);
}

BAT_C_END

#endif

#ifndef BATTEN_MESH_H
#define BATTEN_MESH_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Triangle meshes and who is whose neighbour in them.
///
/// Vertices, faces and half-edges are numbered from 0 by 32-bit indices. Half-edge 3 f + c runs along face f from its corner
/// c to its corner c + 1 (corner 0 after corner 2), so that faces[h] is where half-edge h begins. Seen from outside, corners
/// go around a face counter-clockwise.

/// Stands for a neighbour that does not exist.
#define BAT_MESH_NONE UINT32_MAX

/// The most faces a mesh may have: half-edges must have 32-bit indices.
#define BAT_MESH_MAX_FACES ((size_t)1431655764)

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

/// Check what every call that takes a mesh relies on: at least one face, finite coordinates, faces of three different
/// vertices that exist, texture coordinates, creases and corners that name what exists.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no faces or a crease between vertices that are none; BAT_TOO_LARGE;
/// BAT_INVALID_POINT
///         with the vertex or face at fault
BAT_API bat_status bat_mesh_check(const bat_mesh *mesh, bat_error *error);

/// Who is whose neighbour: half-edges in flat arrays, as Campagna, Kobbelt and Seidel, "Directed Edges" (1998). It describes
/// the faces that it was made from and does not follow their changes.
typedef struct bat_mesh_connectivity
{
    /// 3 x face_count: the half-edge along the same edge in the neighbouring face, in the other direction; BAT_MESH_NONE at
    /// a boundary.
    uint32_t *twin;
    /// vertex_count: a half-edge that begins at the vertex. At a boundary it is the one along the boundary, from which
    /// turning counter-clockwise (bat_mesh_next_around()) passes all others. BAT_MESH_NONE for a vertex without a face.
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
/// @return BAT_OK; BAT_TOO_LARGE (above BAT_MESH_MAX_FACES); BAT_INVALID_POINT with the face whose corner is not a vertex
/// or
///         that has the same vertex twice; BAT_NOT_MANIFOLD with the face where an edge of more than two faces, an edge that
///         two faces run through in the same direction, or a vertex with several fans of faces shows first, the text naming
///         the vertices; BAT_NO_MEMORY. `connectivity` is untouched on failure
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

/// The half-edge that begins at the same vertex and follows counter-clockwise; BAT_MESH_NONE at the end of a boundary
/// vertex's fan.
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

// Meshes that bat_mesh_connect() accepts from meshes that it does not.

/// What a repair did.
typedef struct bat_mesh_repair_report
{
    size_t degenerate_faces; ///< dropped: they had the same vertex twice
    size_t duplicate_faces;  ///< dropped: an earlier face had the same vertices in the same cyclic order
    size_t flipped_faces;    ///< turned over, so that neighbours run the same way around
    size_t crowded_edges;    ///< cut: they had more than two faces
    size_t opposed_edges;    ///< cut: their two faces run against each other whatever is flipped, as on a Möbius strip
    size_t split_vertices;   ///< vertices of several fans, which became several vertices
    size_t added_vertices;   ///< by how many vertices those became more
    size_t unused_vertices;  ///< dropped: no face was left that has them
} bat_mesh_repair_report;

/// The number of places that were repaired: faces dropped or turned, edges cut and vertices split.
BAT_API size_t bat_mesh_repair_places(const bat_mesh_repair_report *report);

/// Make a mesh that bat_mesh_connect() accepts, changing no position: drop faces that have a vertex twice and repeated
/// faces, orient the faces of each piece alike (the way that flips the fewer of them), and cut the rest at edges of more
/// than two faces and where faces still run against each other. Cutting gives every fan of faces around a vertex a vertex of
/// its own, as Guéziec et al., "Cutting and Stitching" (2001); where the faces at such an edge belong to separate sheets,
/// each sheet stays whole.
///
/// The first fan keeps the vertex; the others follow after all vertices, in the order of their first faces. Vertices without
/// a face are dropped. Texture coordinates and channels stay with their corners and vertices; creases and corners follow to
/// every copy, and are dropped with edges and vertices that no face has.
///
/// @param broken   faces may be anything but must name vertices that exist
/// @param report   receives what was done; may be null
/// @param repaired receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT where no face is left; what bat_mesh_check() returns for anything but degenerate
/// faces;
///         BAT_TOO_LARGE; BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_repair(const bat_mesh *broken, bat_mesh_repair_report *report, bat_mesh *repaired,
                                   bat_error *error);

/// Make one vertex of vertices that coincide: each goes to the first vertex within the distance that stayed, which keeps its
/// position and channels. It joins what was cut apart, such as seams and the triangles of a soup, but leaves faces with the
/// same vertex twice where they were smaller than the distance, and joins what only touches: bat_mesh_repair() comes after
/// it. Vertices that no other one joins stay, whether a face has them or not.
///
/// @param distance 0 or above; 0: only vertices of equal coordinates
/// @param merged   receives the number of vertices that went to another; may be null
/// @param welded   receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT for the distance, what bat_mesh_check() returns for anything but degenerate faces,
/// or
///         BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_weld(const bat_mesh *mesh, double distance, size_t *merged, bat_mesh *welded, bat_error *error);

BAT_C_END

#endif

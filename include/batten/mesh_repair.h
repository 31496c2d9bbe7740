#ifndef BATTEN_MESH_REPAIR_H
#define BATTEN_MESH_REPAIR_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Meshes that bat_mesh_connect() accepts from meshes that it does not.

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

/// Make a mesh that bat_mesh_connect() accepts, changing no position: drop faces that have a vertex twice and repeated faces,
/// orient the faces of each piece alike (the way that flips the fewer of them), and cut the rest at edges of more than two faces
/// and where faces still run against each other. Cutting gives every fan of faces around a vertex a vertex of its own, as Guéziec
/// et al., "Cutting and Stitching" (2001); where the faces at such an edge belong to separate sheets, each sheet stays whole.
///
/// The first fan keeps the vertex; the others follow after all vertices, in the order of their first faces. Vertices without a
/// face are dropped. Texture coordinates and channels stay with their corners and vertices; creases and corners follow to every
/// copy, and are dropped with edges and vertices that no face has.
///
/// @param broken   faces may be anything but must name vertices that exist
/// @param report   receives what was done; may be null
/// @param repaired receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT where no face is left; what bat_mesh_check() returns for anything but degenerate faces;
///         BAT_TOO_LARGE; BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_repair(const bat_mesh *broken, bat_mesh_repair_report *report, bat_mesh *repaired,
                                   bat_error *error);

/// Make one vertex of vertices that coincide: each goes to the first vertex within the distance that stayed, which keeps its
/// position and channels. It joins what was cut apart, such as seams and the triangles of a soup, but leaves faces with the same
/// vertex twice where they were smaller than the distance, and joins what only touches: bat_mesh_repair() comes after it. Vertices
/// that no other one joins stay, whether a face has them or not.
///
/// @param distance 0 or above; 0: only vertices of equal coordinates
/// @param merged   receives the number of vertices that went to another; may be null
/// @param welded   receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT for the distance, what bat_mesh_check() returns for anything but degenerate faces, or
///         BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_weld(const bat_mesh *mesh, double distance, size_t *merged, bat_mesh *welded, bat_error *error);

BAT_C_END

#endif

#ifndef BATTEN_MESH_H
#define BATTEN_MESH_H

#include "batten/base.h"

BAT_C_BEGIN

/// @file
/// Meshes of triangles or of polygons, their connectivity, and their repair.
///
/// Vertices, faces and half-edges have 32-bit indices from 0. In a mesh of triangles, half-edge 3 f + c runs along face f
/// from corner c to the next corner, so that faces[h] is the vertex where half-edge h begins; in one of polygons it is
/// offsets[f] + c. Seen from outside, corners go around a face counter-clockwise.

/// The index of a neighbour that does not exist.
#define BAT_MESH_NONE UINT32_MAX

/// The most faces a mesh may have: half-edges must have 32-bit indices.
#define BAT_MESH_MAX_FACES ((size_t)1431655764)

/// The sharpness that lasts for all levels (OpenSubdiv's value).
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

/// Names that faces of a file share, in UTF-8. Null: the file gives no such name.
typedef struct bat_mesh_label
{
    char *object;    ///< `o` in OBJ, the node in glTF
    char *group;     ///< `g` in OBJ, the mesh in glTF
    char *material;  ///< `usemtl` in OBJ, the material's name in glTF
    char *smoothing; ///< the smoothing group: `s` in OBJ
} bat_mesh_label;

/// What refinement by Loop's or Catmull and Clark's scheme makes of a boundary; OpenSubdiv's names are in brackets.
typedef enum bat_mesh_boundary
{
    BAT_MESH_BOUNDARY_AUTO,    ///< as the mesh says, else BAT_MESH_BOUNDARY_EDGES
    BAT_MESH_BOUNDARY_EDGES,   ///< a cubic B-spline (VTX_BOUNDARY_EDGE_ONLY)
    BAT_MESH_BOUNDARY_CORNERS, ///< the same, with sharp corners at vertices of one face (VTX_BOUNDARY_EDGE_AND_CORNER)
    BAT_MESH_BOUNDARY_NONE     ///< the surface ends one face before: faces at the boundary are left out (VTX_BOUNDARY_NONE)
} bat_mesh_boundary;

/// How the sharpness of creases decreases.
typedef enum bat_mesh_creasing
{
    BAT_MESH_CREASING_AUTO,    ///< as the mesh says, else BAT_MESH_CREASING_UNIFORM
    BAT_MESH_CREASING_UNIFORM, ///< by 1 a level (CREASE_UNIFORM)
    BAT_MESH_CREASING_CHAIKIN  ///< towards that of the neighbours along the crease, then by 1 a level (CREASE_CHAIKIN)
} bat_mesh_creasing;

/// How Loop's and Catmull and Clark's schemes refine texture coordinates: what of them stays linear.
typedef enum bat_mesh_linear
{
    BAT_MESH_LINEAR_AUTO,          ///< as the mesh says, else BAT_MESH_LINEAR_ALL
    BAT_MESH_LINEAR_ALL,           ///< all: midpoints (FVAR_LINEAR_ALL)
    BAT_MESH_LINEAR_NONE,          ///< nothing: seams are smooth curves (FVAR_LINEAR_NONE)
    BAT_MESH_LINEAR_CORNERS,       ///< corners of one face (FVAR_LINEAR_CORNERS_ONLY)
    BAT_MESH_LINEAR_CORNERS_PLUS1, ///< and where more than two seams meet (FVAR_LINEAR_CORNERS_PLUS1)
    BAT_MESH_LINEAR_CORNERS_PLUS2, ///< and where seams end or one of two sides is a corner (FVAR_LINEAR_CORNERS_PLUS2)
    BAT_MESH_LINEAR_BOUNDARIES     ///< seams and boundaries (FVAR_LINEAR_BOUNDARIES)
} bat_mesh_linear;

/// What a mesh says about its refinement. All zero: nothing.
typedef struct bat_mesh_rules
{
    bat_mesh_boundary boundary;
    bat_mesh_creasing creasing;
    bat_mesh_linear linear;
} bat_mesh_rules;

/// Boundary rules, creasing rules and texture rules by name.
extern BAT_API const bat_family bat_mesh_boundary_family, bat_mesh_creasing_family, bat_mesh_linear_family;

/// A mesh of triangles or of polygons. All zero: empty. Everything in it is owned and comes from malloc(); release it with
/// bat_mesh_free(). Refinement, connectivity, files and pictures take polygons; all other calls take triangles alone and
/// refuse others with BAT_UNSUPPORTED: bat_mesh_triangulate() cuts them.
typedef struct bat_mesh
{
    double *positions; ///< vertex_count x 3
    uint32_t *faces;   ///< the vertices at the corners, face after face: face_count x 3 without `offsets`
    /// Of polygons: face f has the corners offsets[f], …, offsets[f + 1] - 1; face_count + 1 numbers. Null: triangles.
    uint32_t *offsets;
    size_t vertex_count;
    size_t face_count;

    double *texture;         ///< texture_count x 2 texture coordinates; null for none
    uint32_t *texture_faces; ///< the texture coordinates at the corners; null for none
    size_t texture_count;

    double *channels;     ///< vertex_count x channel_count: further numbers at the vertices, such as colours; null for none
    char **channel_names; ///< channel_count texts
    size_t channel_count;

    bat_mesh_crease *creases; ///< in any order; null for none
    size_t crease_count;
    bat_mesh_corner *corners; ///< in any order; null for none
    size_t corner_count;

    uint32_t *face_labels;  ///< face_count: the label of each face; null for none
    bat_mesh_label *labels; ///< label_count
    size_t label_count;
    char *material_files; ///< the files of the materials, as `mtllib` in OBJ names them; null for none
    /// The materials of glTF: a JSON object with its arrays materials, textures, images and samplers; null for none.
    char *material_json;

    bat_mesh_rules rules; ///< of refinement; all zero: none are given
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

/// Check the conditions of every call that takes a mesh: at least one face, finite coordinates, and faces of three or more
/// different existing vertices. Texture coordinates, labels, creases and corners must name what exists.
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no faces or a crease between vertices that do not exist; BAT_TOO_LARGE;
///         BAT_INVALID_POINT with the failing vertex or face
BAT_API bat_status bat_mesh_check(const bat_mesh *mesh, bat_error *error);

/// The neighbours of faces: half-edges in flat arrays, as Campagna, Kobbelt and Seidel, "Directed Edges" (1998). It
/// describes the faces that it was made from and does not follow their changes.
typedef struct bat_mesh_connectivity
{
    /// For each corner: the half-edge along the same edge in the neighbouring face, in the other direction; BAT_MESH_NONE at
    /// a boundary.
    uint32_t *twin;
    /// vertex_count: a half-edge that begins at the vertex. At a boundary it is the one along the boundary, from which
    /// turning counter-clockwise (bat_mesh_next_around()) passes all others. BAT_MESH_NONE for a vertex without a face.
    uint32_t *first;
    /// For each corner: the edge that a half-edge lies on. Edges are numbered by the lesser of their half-edges, in order.
    uint32_t *edge;
    size_t vertex_count, face_count;
    size_t edge_count;
    size_t boundary_edge_count;
} bat_mesh_connectivity;

/// Find the neighbours of all faces, in linear time.
///
/// @param connectivity release it with bat_mesh_connectivity_free()
/// @return BAT_OK; BAT_TOO_LARGE (above BAT_MESH_MAX_FACES); BAT_INVALID_POINT with a face whose corner is not a vertex or
///         that has the same vertex twice; the failures of bat_mesh_check() for polygons; BAT_NOT_MANIFOLD with the first
///         face at an edge of more than two faces, at an edge of two faces with the same direction, or at a vertex of
///         several fans, the text naming the vertices; BAT_NO_MEMORY. `connectivity` is untouched on failure
BAT_API bat_status bat_mesh_connect(const bat_mesh *mesh, bat_mesh_connectivity *connectivity, bat_error *error);

/// Free what it owns and make it empty.
BAT_API void bat_mesh_connectivity_free(bat_mesh_connectivity *connectivity);

/// The half-edge after another one in its triangle, counter-clockwise.
static inline uint32_t bat_mesh_next(uint32_t half_edge)
{
    return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}

/// The half-edge before another one in its triangle.
static inline uint32_t bat_mesh_previous(uint32_t half_edge)
{
    return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
}

/// The half-edge that begins at the same vertex and follows counter-clockwise; BAT_MESH_NONE at the end of a boundary
/// vertex's fan. In a mesh of triangles, as all of these.
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

// Normals.

/// Vertex normals: sums of the normals of the faces around, with weights.
typedef enum bat_mesh_normals
{
    BAT_MESH_NORMALS_NONE,
    BAT_MESH_NORMALS_ANGLE, ///< by the face's angle at the vertex (Thürmer and Wüthrich, 1998); independent of the triangles
    BAT_MESH_NORMALS_AREA   ///< by the face's area
} bat_mesh_normals;

/// The kinds of normals by name.
extern BAT_API const bat_family bat_mesh_normals_family;

/// The unit normals of the vertices; zero for a vertex without a face of positive area.
///
/// @param weights not BAT_MESH_NORMALS_NONE
/// @param normals receives vertex_count x 3 numbers
/// @return BAT_OK, BAT_INVALID_ARGUMENT for the weights, or the failures of bat_mesh_check(); `normals` is untouched on
///         failure
BAT_API bat_status bat_mesh_vertex_normals(const bat_mesh *mesh, bat_mesh_normals weights, double *normals,
                                           bat_error *error);

// Repair.

/// The changes of a repair.
typedef struct bat_mesh_repair_report
{
    size_t degenerate_faces;   ///< dropped: they had the same vertex twice
    size_t duplicate_faces;    ///< dropped: an earlier face had the same vertices in the same cyclic order
    size_t flipped_faces;      ///< turned over, so that neighbours run the same way around
    size_t nonmanifold_edges;  ///< cut: they had more than two faces
    size_t unorientable_edges; ///< cut: their two faces run against each other whatever is flipped, as on a Möbius strip
    size_t split_vertices;     ///< vertices of several fans, which became several vertices
    size_t added_vertices;     ///< by how many vertices those became more
    size_t unused_vertices;    ///< dropped: no face was left that has them
    size_t filled_holes;       ///< of bat_mesh_fill_holes(), where a reader calls it
} bat_mesh_repair_report;

/// The number of places that were repaired: faces dropped or turned, edges cut, vertices split and holes
/// filled.
BAT_API size_t bat_mesh_repair_places(const bat_mesh_repair_report *report);

/// Make a mesh that bat_mesh_connect() accepts, without changing a position. Faces with a repeated vertex and repeated faces
/// are dropped. The faces of each piece are oriented alike, the way that flips fewer of them. The mesh is cut at edges of
/// more than two faces, and where orientations still disagree. Cutting gives every fan of faces around a vertex its own
/// vertex, as Guéziec et al., "Cutting and Stitching" (2001). Separate sheets at such an edge stay whole.
///
/// The first fan keeps the vertex; the others follow after all vertices, in the order of their first faces. Vertices without
/// a face are dropped. Texture coordinates, labels and channels stay with their corners, faces and vertices. Creases and
/// corners are copied with their vertices, and dropped with edges and vertices that no face has.
///
/// @param broken   faces may be anything but must name vertices that exist
/// @param report   receives the changes; may be null
/// @param repaired receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT for no face left; the failures of bat_mesh_check() but for degenerate faces;
///         BAT_TOO_LARGE; BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_repair(const bat_mesh *broken, bat_mesh_repair_report *report, bat_mesh *repaired,
                                   bat_error *error);

/// Merge vertices that coincide: each goes to the first remaining vertex within the distance, which keeps its position and
/// channels. Welding joins cuts, such as seams and the triangles of a soup. It also joins what only touches, and leaves
/// faces with a repeated vertex where they are smaller than the distance: call bat_mesh_repair() after it. Vertices that are
/// not merged stay, with or without a face.
///
/// @param distance 0 or above; 0: only vertices of equal coordinates
/// @param merged   receives the number of merged vertices; may be null
/// @param welded   receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT for the distance; the failures of bat_mesh_check() but for degenerate faces;
///         BAT_NO_MEMORY; results are untouched on failure
BAT_API bat_status bat_mesh_weld(const bat_mesh *mesh, double distance, size_t *merged, bat_mesh *welded, bat_error *error);

/// The most edges of a hole that bat_mesh_fill_holes() fills.
#define BAT_MESH_MAX_HOLE 2000

/// Close boundary loops of at most `max_edges` edges by the triangles of least area between their vertices (Barequet and
/// Sharir, 1995). A loop all of whose triangulations need an edge that the mesh has elsewhere stays open. New faces follow
/// after all others; they have texture coordinates and a label of the faces beside the hole. A boundary that passes a point
/// twice, as where a repair split a vertex between two holes, is several loops; the vertices there become one again.
///
/// @param max_edges up to BAT_MESH_MAX_HOLE; time grows with its cube
/// @param filled    receives the number of filled holes; may be null
/// @param closed    receives the mesh; release it with bat_mesh_free()
/// @return BAT_OK; BAT_INVALID_ARGUMENT; the failures of bat_mesh_connect(); results are untouched on failure
BAT_API bat_status bat_mesh_fill_holes(const bat_mesh *mesh, size_t max_edges, size_t *filled, bat_mesh *closed,
                                       bat_error *error);

/// Cut the polygons of a mesh into triangles, as bat_mesh_read() does: quads along the better diagonal, convex polygons as a
/// fan, others by ear clipping. Triangles have the labels of their polygons. A mesh of triangles is copied.
/// @param triangles receives the mesh, with everything else of the other one; release it with bat_mesh_free()
/// @return BAT_OK; the failures of bat_mesh_check(); BAT_TOO_LARGE (too many faces, or a concave polygon of more than 10,000
///         corners); BAT_NO_MEMORY
BAT_API bat_status bat_mesh_triangulate(const bat_mesh *mesh, bat_mesh *triangles, bat_error *error);

BAT_C_END

#endif

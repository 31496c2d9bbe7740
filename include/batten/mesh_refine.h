#ifndef BATTEN_MESH_REFINE_H
#define BATTEN_MESH_REFINE_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Refinement of meshes by subdivision.
///
/// All schemes but square-root-three split every face in four. A level keeps the vertices, at the same indices, and appends
/// one new vertex for every edge, in the order of bat_mesh_connectivity::edge. Face f becomes the faces 4 f + c at its
/// corners c, each beginning with that corner, and the middle face 4 f + 3. Corner c of the middle face is the new vertex of
/// the edge from corner c.
///
/// A level of square-root-three keeps the vertices too, and appends one for every face, in the order of faces. Half-edge h
/// becomes the face h, which begins where h begins.
///
/// A level of Catmull and Clark's scheme keeps the vertices and appends one for every edge, then one for every face. Corner
/// h becomes the quad h, which begins with that corner. docs/algorithms/mesh-schemes.md has the rules.

/// The mesh schemes.
typedef enum bat_mesh_scheme
{
    BAT_MESH_SCHEME_AUTO,     ///< that of bat_mesh_scheme_for()
    BAT_MESH_SCHEME_MIDPOINT, ///< new vertices in the middle of edges; the same surface
    BAT_MESH_SCHEME_LOOP, ///< Loop (1987), with Hoppe's creases and corners (1994) and semi-sharp ones (DeRose et al., 1998)
    BAT_MESH_SCHEME_BUTTERFLY,    ///< modified butterfly (Zorin, Schröder and Sweldens, 1996), through all vertices
    BAT_MESH_SCHEME_SQRT3,        ///< Kobbelt (2000): a vertex in every face, edges turned; a level triples the faces
    BAT_MESH_SCHEME_LEARNED,      ///< by `rule`
    BAT_MESH_SCHEME_CATMULL_CLARK ///< Catmull and Clark (1978), with creases and corners as Loop's; for any polygons
} bat_mesh_scheme;

/// Faces below which a mesh is taken for a control cage: the learned scheme was trained on meshes of 200 faces and more.
#define BAT_MESH_CAGE_FACES 100

/// The scheme that BAT_MESH_SCHEME_AUTO stands for: Catmull and Clark's where more than half of the faces have four or more
/// corners, as quads that a modeller drew have; else Loop's for a mesh that has creases or corners with a sharpness above 0,
/// or fewer than BAT_MESH_CAGE_FACES faces and is no solid; else the learned one. docs/results/meshes.md tells why.
/// Cones, with a pole of eight faces or more and an eighth of all, count as solids. BAT_MESH_SCHEME_AUTO itself where memory
/// runs out.
BAT_API bat_mesh_scheme bat_mesh_scheme_for(const bat_mesh *mesh);

/// Find whether most of a mesh of triangles without creases and corners is a solid: connected pieces whose faces meet at
/// more than 30 degrees. Half of a piece's vertices or more are on flat faces, three at most, or its edges are either sharp
/// or smooth. A flat face is made of three or more coplanar triangles, or of two that are no facet of a smooth surface. The
/// learned scheme keeps the flat faces and sharp edges of solids, also beside other pieces. A mesh that is not manifold is
/// none. docs/algorithms/mesh-network.md has the rules.
/// @return BAT_OK or BAT_NO_MEMORY; `solid` is set in any case
BAT_API bat_status bat_mesh_is_solid(const bat_mesh *mesh, bool *solid, bat_error *error);

/// The schemes by name.
extern BAT_API const bat_family bat_mesh_scheme_family;

typedef struct bat_mesh_rule bat_mesh_rule;
typedef struct bat_mesh_refine_options bat_mesh_refine_options;

/// A rule of refinement beside the classical schemes, such as a network.
struct bat_mesh_rule
{
    size_t levels;       ///< levels that the rule makes, at least 1; a classical scheme makes further ones
    const void *context; ///< the rule's own
    bool bounded;        ///< bat_mesh_refine() bounds its moves, as those of the model that comes with the library
    /// Refine a checked mesh by `levels` levels, in the numbering above.
    /// @param fine     the refined mesh with its faces, and room for its positions, which the rule writes
    /// @param options  checked; a rule may use fairness, crease_angle and threads
    /// @param fallback receives the number of places where the rule had to fall back to a classical one
    /// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED
    bat_status (*refine)(const bat_mesh_rule *rule, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                         size_t levels, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                         bat_error *error);
};

/// Options of refinement. Begin with bat_mesh_refine_defaults().
struct bat_mesh_refine_options
{
    bat_mesh_scheme scheme;    ///< default BAT_MESH_SCHEME_AUTO; with a `rule` that means the learned one
    const bat_mesh_rule *rule; ///< of BAT_MESH_SCHEME_LEARNED; null: the model that comes with the library; default null
    /// Of the learned scheme, 0 to 1: 0 for the surface that is probably nearest to the original, 1 for the smoothest one
    /// that keeps the volume. Published networks ignore it. Default 0.25.
    double fairness;
    bat_mesh_scheme then; ///< the scheme of the levels beyond the rule's; default BAT_MESH_SCHEME_LOOP
    size_t levels;        ///< 0 to 32; default 2
    /// Move the vertices at the end to their limit under the scheme, or under `then` after a learned one. Semi-sharp
    /// features count as sharp for ever. Default false.
    bool limit;
    /// Radians, 0 to pi, for the learned scheme, Loop's and Catmull and Clark's: edges whose faces' normals differ by more
    /// are creases for ever. 0: none. Default 0.
    double crease_angle;
    /// With `limit` and Loop's or Catmull and Clark's scheme at the end: receives the normals of the limit surface at the
    /// fine vertices, as bat_mesh_limit_normals() gives them; release the array with free(). Null: none, the default.
    double **limit_normals;
    /// Bytes. A refinement that needs more is refused with BAT_TOO_LARGE before it begins. 0, the default: what the machine
    /// has available. Adaptive refinement compares before each level.
    size_t max_memory;
    bat_mesh_rules rules; ///< of Loop's and Catmull and Clark's schemes; they come before those of the mesh; default AUTO
    /// Loop's and Catmull and Clark's schemes, of which BAT_MESH_SCHEME_AUTO takes one: refine adaptively, as deep as is
    /// needed and whatever `levels` says, until no face is farther than this from the limit surface, by an estimate from
    /// second differences. 0: do not. Default 0.
    double tolerance;
    double max_edge; ///< the same, until no edge is longer; default 0
    int threads;     ///< 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;
};

/// The options' default values.
BAT_API bat_mesh_refine_options bat_mesh_refine_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_refine_fields;

/// Refine a mesh by subdivision.
///
/// Boundaries depend on their own vertices alone: cubic B-splines in Loop's and the square-root-three scheme, the four-point
/// rule in the butterfly and under the learned scheme. Vertices without a face stay. Channels use the scheme's weights, or
/// midpoints under a learned scheme, and are not moved to the limit; a channel of values from 0 to 1 keeps that range.
/// Texture coordinates are averaged along edges, on each side of a seam. Creases and corners act in Loop's and Catmull and
/// Clark's schemes and, by Loop's rules, in the learned one; all schemes pass them on, with their remaining sharpness.
/// Labels go from each face to the faces that it becomes. Adaptive refinement has all vertices on the limit surface and no
/// cracks: a triangle beside finer ones is cut to their vertices; a quad beside finer ones takes these in as corners, so
/// that it has five or more. The result has channels and labels, but no texture, creases or corners. Square-root-three flips
/// edges across seams and creases: its fine mesh has no texture, creases or corners. Catmull and Clark's scheme takes any
/// polygons and makes quads; the other schemes take and make triangles.
///
/// @param coarse   a mesh that bat_mesh_check() and bat_mesh_connect() accept
/// @param options  null for bat_mesh_refine_defaults(), which refine by the model that comes with the library
/// @param fine     receives the refined mesh; release it with bat_mesh_free()
/// @param fallback receives the number of places where a learned rule fell back to a classical one; may be null
/// @return BAT_OK; the failures of bat_mesh_check() and bat_mesh_connect(); BAT_INVALID_ARGUMENT for an option out of range
///         or a crease along no edge; BAT_INVALID_POINT for a coordinate beyond 1e290, as sums would overflow;
///         BAT_UNSUPPORTED for square-root-three with `limit`, for a crease angle or rules with a scheme that knows
///         neither, for a face of more than three corners with a scheme for triangles, and where BAT_MESH_BOUNDARY_NONE
///         leaves no face; BAT_TOO_LARGE for more faces than 32-bit indices can number, or more
///         memory than `max_memory`; BAT_NO_MEMORY; BAT_CANCELLED. Results are untouched on failure
BAT_API bat_status bat_mesh_refine(const bat_mesh *coarse, const bat_mesh_refine_options *options, bat_mesh *fine,
                                   size_t *fallback, bat_error *error);

/// The unit normals of the limit surface at the limits of the vertices: of Loop's scheme for triangles, of Catmull and
/// Clark's for quads. On a crease: the mean of both sides. At corners and ends of creases, which have no tangent plane in
/// general: the area-weighted mean of the faces around. At inner vertices of two quads: that of the two antisymmetric
/// tangents. Zero for a vertex without a face, and where the normal is not defined.
///
/// @param mesh    a mesh refined without `limit`; one of polygons must be refined at least once, or have quads alone
/// @param threads 0: as many as OpenMP gives; the result does not depend on it
/// @param normals receives vertex_count x 3 numbers
/// @return BAT_OK; the failures of bat_mesh_check() and bat_mesh_connect(); BAT_INVALID_ARGUMENT for a crease along no edge;
///         BAT_UNSUPPORTED with a polygon that is no quad; BAT_NO_MEMORY
BAT_API bat_status bat_mesh_limit_normals(const bat_mesh *mesh, int threads, double *normals, bat_error *error);

// Models of the learned scheme: the one that comes with the library, and others from files.

/// A trained network. It is constant, and any number of calls may use it at once.
typedef struct bat_mesh_model bat_mesh_model;

/// Read a model from a safetensors file of `batten train mesh --recipe batten`, in single or double precision. Of a
/// checkpoint, the last weights are taken. batten/research/networks.h reads the published network too.
///
/// @param path  null: the model that comes with the library (weights/mesh.md)
/// @param model receives the model; release it with bat_mesh_model_free()
/// @return BAT_OK; BAT_BAD_FILE (an array is missing, has another shape, or holds a number that is not finite);
///         BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_mesh_model_read(const char *path, bat_mesh_model **model, bat_error *error);
/// Does nothing to null.
BAT_API void bat_mesh_model_free(bat_mesh_model *model);

/// The rule of BAT_MESH_SCHEME_LEARNED with the weights of a model, which must outlive it.
///
/// Batten's network (docs/algorithms/mesh-network.md) combines classical rules. By construction, for any weights: rigid
/// motions, reflections, scaling, renumbering and turning all faces over change the result alike, up to roundings of single
/// precision; planes stay planes; boundaries depend on their own vertices alone; creases and corners follow Loop's rules. It
/// moves given vertices that are neither on a boundary nor sharp.
BAT_API const bat_mesh_rule *bat_mesh_model_rule(const bat_mesh_model *model);

BAT_C_END

#endif

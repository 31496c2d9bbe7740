#ifndef BATTEN_MESH_DECIMATE_H
#define BATTEN_MESH_DECIMATE_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Decimation of meshes by edge collapses, and the bijective map between both meshes. Sources: the quadric errors of Garland
/// and Heckbert (1997), with attributes as Hoppe (1999); memoryless simplification, Lindstrom and Turk (1998, 1999);
/// successive self-parameterization of Liu et al., "Neural Subdivision" (2020), section 4 and appendices B to E.
/// docs/algorithms/decimation.md describes the algorithm.

/// The error of a collapse.
typedef enum bat_mesh_decimate_method
{
    BAT_MESH_DECIMATE_METHOD_AUTO, ///< the default: BAT_MESH_DECIMATE_METHOD_BALANCED
    /// The squared distances from the planes of all given faces that became the new vertex, weighted by area (Garland and
    /// Heckbert, 1997).
    BAT_MESH_DECIMATE_METHOD_QUADRIC,
    /// The squared volumes between the new vertex and the present faces, at preserved volume (Lindstrom and Turk, 1998,
    /// 1999).
    BAT_MESH_DECIMATE_METHOD_MEMORYLESS,
    /// For large meshes: quadric errors without a strict order, in sweeps with rising thresholds, until three times the
    /// wanted vertices or faces are left; memoryless errors in order from there on. `candidates` act in the second part
    /// alone.
    BAT_MESH_DECIMATE_METHOD_FAST,
    /// Memoryless errors, twice. The second time no collapse may bring samples of the surfaces farther apart than three
    /// fifths of the greatest distance of the first result. Takes six times as long; as memoryless with `tolerance`.
    BAT_MESH_DECIMATE_METHOD_EVEN,
    /// As fast, with sweeps to eight times the target: as near as memoryless, and quicker the fewer faces are kept. Without
    /// a number of vertices or faces the same as memoryless.
    BAT_MESH_DECIMATE_METHOD_BALANCED
} bat_mesh_decimate_method;

/// The methods by name.
extern BAT_API const bat_family bat_mesh_decimate_method_family;

/// Options of decimation. Begin with bat_mesh_decimate_defaults().
typedef struct bat_mesh_decimate_options
{
    /// Stop at this number of vertices. At most one of `vertices`, `faces`, `ratio` and `tolerance` may be set; without any,
    /// edges collapse as long as possible. Default 0.
    size_t vertices;
    size_t faces; ///< stop at this number of faces, or one fewer; default 0
    double ratio; ///< stop at this share of the faces, above 0 to 1; default 0
    /// Collapse as long as no point of either surface is farther than this from the other. The result is measured by
    /// bat_mesh_compare(), and its proven bound does not exceed the given one. Default 0.
    double tolerance;
    double *distance;                ///< with `tolerance`: receives the proven bound of the result; may be null
    bool relative_tolerance;         ///< `tolerance` is a share of the diagonal of the mesh's box; default false
    bat_mesh_decimate_method method; ///< default BAT_MESH_DECIMATE_METHOD_BALANCED
    /// 0, and as many as there are edges: always collapse the edge of least error. Else that of least error among this
    /// number of random ones (appendix E: 100). Default 0.
    size_t candidates;
    /// The seed of the random choice; default 1.
    uint64_t seed;
    /// The least scalar product of a face's unit normals before and after a collapse, -1 to 1; default .2.
    double min_normal;
    /// The least triangle quality after a collapse, 0 to 1: 4 sqrt(3) times the area over the sum of the squared edges, in
    /// space and in the plane. Where a face around the edge is worse already, its quality is enough. Default .1.
    double min_quality;
    /// The weight of a boundary or crease edge, at least 0, relative to a face with the area of the square over the edge;
    /// default 1000.
    double boundary_weight;
    /// The weight of texture coordinates and channels in the error, at least 0. 1: a shift of the texture counts as a shift
    /// of the surface by the same length, and the whole range of a channel as a tenth of the box's diagonal. 0: they are
    /// ignored and dropped, and seams of the texture may vanish. Default 0.5.
    double attributes;
    int threads; ///< for the first errors and for measuring; 0: as many as OpenMP gives; the result does not depend on it
    bat_progress progress;
} bat_mesh_decimate_options;

/// The options' default values.
BAT_API bat_mesh_decimate_options bat_mesh_decimate_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_mesh_decimate_fields;

/// A bijective map between a mesh and its decimation. Opaque.
typedef struct bat_mesh_map bat_mesh_map;

/// Decimate a mesh. The numbers of pieces, handles and boundary loops stay; boundaries stay boundaries. Creases and corners
/// with a sharpness above 0 stay; vertices move along creases only.
///
/// The same mesh, options and seed give the same bytes. Calls may run side by side in several threads.
///
/// @param fine    one or more manifold pieces, with or without boundaries
/// @param options null for the defaults
/// @param coarse  receives the decimated mesh, with its creases and corners. Vertices without a face, texture and channels
///                are dropped; bat_mesh_map_transfer() brings the latter back
/// @param map     receives the map between the two; release it with bat_mesh_map_free(). Null: no map, which is faster and
///                skips the checks for the map
/// @return BAT_OK (also where no further collapse is possible); the failures of bat_mesh_check() and bat_mesh_connect();
///         BAT_INVALID_ARGUMENT (an option, a crease along no edge); BAT_TOO_LARGE; BAT_NO_MEMORY; BAT_CANCELLED; results
///         are untouched on failure
BAT_API bat_status bat_mesh_decimate(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                                     bat_mesh_map **map, bat_error *error);

/// Map points of the coarse mesh to the fine one, in place. Points of the boundary go to the boundary. The way there and
/// back has rounding errors alone, about 1e-15 of the face's size for well-shaped triangles.
/// @return BAT_OK, or BAT_INVALID_POINT with the index of a point that is not on the mesh; then all points are untouched
BAT_API bat_status bat_mesh_map_to_fine(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error);
/// Map points of the fine mesh to the coarse one, in place.
/// @return as bat_mesh_map_to_fine()
BAT_API bat_status bat_mesh_map_to_coarse(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error);

/// The vertices of a mesh subdivided `levels` times at the midpoints of its edges, as points of the mesh. Their numbering is
/// that of batten/mesh_refine.h.
///
/// @param points receives an array of `count` points; release it with free()
/// @return BAT_OK; the failures of bat_mesh_check() and bat_mesh_connect(); BAT_INVALID_POINT with a vertex that has no
///         face; BAT_TOO_LARGE
BAT_API bat_status bat_mesh_midpoints(const bat_mesh *coarse, size_t levels, bat_mesh_point **points, size_t *count,
                                      bat_error *error);

/// Transfer texture coordinates and channels of the fine mesh to a refinement of the coarse one, through the map.
///
/// A vertex on a seam of the texture gets several texture coordinates. A face across a seam takes the texture of the side
/// with most of its area, continued linearly.
///
/// @param refined the coarse mesh (levels = 0), or its refinement by a scheme that splits faces in four; its texture and
///                channels are replaced
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a map of other meshes, or for other numbers of vertices or faces in `refined`;
///         BAT_TOO_LARGE; BAT_NO_MEMORY. `refined` is untouched on failure
BAT_API bat_status bat_mesh_map_transfer(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse,
                                         size_t levels, bat_mesh *refined, bat_error *error);

/// Free a map. Does nothing to null.
BAT_API void bat_mesh_map_free(bat_mesh_map *map);

BAT_C_END

#endif

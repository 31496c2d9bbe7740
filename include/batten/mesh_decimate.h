#ifndef BATTEN_MESH_DECIMATE_H
#define BATTEN_MESH_DECIMATE_H

#include "batten/mesh.h"

BAT_C_BEGIN

/// @file
/// Coarse meshes from fine ones by edge collapses, and the bijective map between the two: quadric errors of Garland and
/// Heckbert (1997), successive self-parameterization of Liu et al., "Neural Subdivision" (2020), section 4 and appendices B
/// to E. docs/decimation.md says how.

/// How to decimate. Begin with bat_mesh_decimate_defaults().
typedef struct bat_mesh_decimate_options
{
    /// Stop at so many vertices; default 0, which goes on until nothing more can be collapsed.
    size_t vertices;
    /// 0: always collapse the edge of least error; else the one of least error among so many random ones (appendix E: 100).
    /// Default 0.
    size_t candidates;
    /// Of the random choice; default 1.
    uint64_t seed;
    /// The least scalar product of a face's unit normals before and after a collapse, -1 to 1; default .2.
    double least_normal;
    /// The least triangle quality after a collapse, 0 to 1: 4 sqrt(3) times the area over the sum of the squared edges, in
    /// space and in the plane; default .2. Where a face around the edge is worse already, to be as good as that one is
    /// enough.
    double least_quality;
    /// How much more the squared distance from a boundary or crease edge counts than that from a face as large as the square
    /// over the edge; default 1000.
    double boundary_weight;
    bat_progress progress;
} bat_mesh_decimate_options;

/// The options' default values.
BAT_API bat_mesh_decimate_options bat_mesh_decimate_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_mesh_decimate_options_check(const bat_mesh_decimate_options *options, bat_error *error);

/// A bijective map between a mesh and its decimation. Opaque.
typedef struct bat_mesh_map bat_mesh_map;

/// Decimate a mesh. Pieces, handles and boundary loops stay as many as they are; boundaries stay boundaries; creases and
/// corners (those of bat_mesh::creases and corners with a sharpness above 0) stay, vertices moving along creases only.
///
/// The same mesh, options and seed give the same bytes. Calls may run side by side in several threads.
///
/// @param fine   one or more manifold pieces, with or without boundaries
/// @param coarse receives the decimated mesh, with its creases and corners; vertices without a face are dropped, texture and
///               channels too (bat_mesh_map_transfer() brings them back)
/// @param map    receives the map between the two; release it with bat_mesh_map_free(). Null: none is made, which is faster,
///               and what only the map needs is not checked
/// @return BAT_OK (also when nothing more could be collapsed before the wanted number was reached); what bat_mesh_check()
///         and bat_mesh_connect() return; BAT_INVALID_ARGUMENT (an option, a crease that is no edge); BAT_TOO_LARGE;
///         BAT_NO_MEMORY; BAT_CANCELLED; results are untouched on failure
BAT_API bat_status bat_mesh_decimate(const bat_mesh *fine, const bat_mesh_decimate_options *options, bat_mesh *coarse,
                                     bat_mesh_map **map, bat_error *error);

/// Carry points of the coarse mesh to the fine one, in place. Points of the boundary go to the boundary. There and back
/// again leaves rounding errors alone, some 1e-15 of the face's size where triangles are well shaped.
/// @return BAT_OK, or BAT_INVALID_POINT with the index of a point that is not on the mesh; all stay as they are then
BAT_API bat_status bat_mesh_map_to_fine(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error);
/// Carry points of the fine mesh to the coarse one, in place.
/// @return as bat_mesh_map_to_fine()
BAT_API bat_status bat_mesh_map_to_coarse(const bat_mesh_map *map, bat_mesh_point *points, size_t count, bat_error *error);

/// The numbers of vertices and faces of the meshes of a map.
typedef struct bat_mesh_map_sizes
{
    size_t fine_vertices, fine_faces;
    size_t coarse_vertices, coarse_faces;
    size_t collapses;
} bat_mesh_map_sizes;

BAT_API bat_mesh_map_sizes bat_mesh_map_size(const bat_mesh_map *map);

/// Find the vertices of a mesh subdivided `levels` times, in the numbering of batten/mesh_refine.h, as points of the mesh,
/// its edges being halved at their midpoints.
///
/// @param points receives an array of `count` points; release it with free()
/// @return BAT_OK, what bat_mesh_check() and bat_mesh_connect() return, BAT_INVALID_POINT with a vertex that has no face,
///         BAT_TOO_LARGE
BAT_API bat_status bat_mesh_midpoints(const bat_mesh *coarse, size_t levels, bat_mesh_point **points, size_t *count,
                                      bat_error *error);

/// Find where the map takes the vertices of the coarse mesh subdivided `levels` times (bat_mesh_midpoints()): what a
/// subdivision rule that is learned should give (Liu et al. 2020, section 4).
///
/// @param fine, coarse the meshes of the map
/// @param positions    receives 3 numbers a vertex, on the fine mesh's faces
/// @param normals      receives unit normals of the fine mesh there, interpolated between the area-weighted ones of its
///                     vertices; zero where the face has no extent. May be null
/// @return BAT_OK, BAT_INVALID_ARGUMENT when the map belongs to other meshes, BAT_TOO_LARGE, BAT_NO_MEMORY
BAT_API bat_status bat_mesh_map_targets(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                                        double *positions, double *normals, bat_error *error);

/// Carry the texture coordinates and channels of the fine mesh to a refinement of the coarse one, by the map.
///
/// A vertex can have several texture coordinates afterwards, as where a seam of the texture passes. A face across a seam
/// takes the texture of the side that most of it lies on, continued linearly.
///
/// @param refined the coarse mesh (levels = 0), or what a scheme that splits faces in four makes of it; what texture and
///                channels it has are replaced
/// @return as bat_mesh_map_targets(); also BAT_INVALID_ARGUMENT when `refined` has other numbers of vertices or faces.
///         `refined` is untouched on failure
BAT_API bat_status bat_mesh_map_transfer(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse,
                                         size_t levels, bat_mesh *refined, bat_error *error);

/// Free a map. Does nothing to null.
BAT_API void bat_mesh_map_free(bat_mesh_map *map);

BAT_C_END

#endif

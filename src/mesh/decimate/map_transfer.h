#ifndef MESH_DECIMATE_MAP_TRANSFER_H
#define MESH_DECIMATE_MAP_TRANSFER_H

#include "batten/mesh_decimate.h"
#include "mesh/decimate/map.h"

/// @file
/// Subdivisions of a coarse mesh whose vertices a decimation map carries to the fine mesh.

/// The midpoint subdivision of a mesh, as points of that mesh, in the numbering of batten/mesh_refine.h.
typedef struct midpoint_mesh
{
    uint32_t *faces;
    double (*corners)[3][3]; ///< for each face: the barycentric coordinates of its corners in face f >> 2 level
    bat_mesh_point *points;  ///< for each vertex
    size_t face_count, vertex_count;
} midpoint_mesh;

/// Set the texture coordinates of `refined`, which has none, from the fine mesh. `split` is the coarse mesh subdivided
/// `levels` times, and `images` are its vertices on the fine mesh.
///
/// A corner gets the texture coordinate at its image; at a seam, the one on its face's side. A face across a seam belongs to
/// the side with most of its samples. Its corners on the other side get the values of an affine map fitted to these samples.
/// @return BAT_OK, BAT_NO_MEMORY, or a failure of bat_mesh_connect()
bat_status map_texture_transfer(const bat_mesh_map *map, const bat_mesh *fine, const midpoint_mesh *split,
                                const bat_mesh_point *images, size_t levels, bat_mesh *refined, bat_error *error);

#endif

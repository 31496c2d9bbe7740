#ifndef MESH_DECIMATE_MAP_TRANSFER_H
#define MESH_DECIMATE_MAP_TRANSFER_H

#include "batten/mesh_decimate.h"
#include "mesh/decimate/map.h"

/// A mesh split at its edges' midpoints, as points of the mesh it was made from. Numbered as batten/mesh_refine.h says.
typedef struct midpoint_mesh
{
    uint32_t *faces;
    double (*corners)[3][3]; ///< of every face: its corners' barycentric coordinates in face f >> 2 level
    bat_mesh_point *points;  ///< of every vertex
    size_t face_count, vertex_count;
} midpoint_mesh;

/// Split a mesh so often.
/// @return as bat_mesh_midpoints()
bat_status midpoint_mesh_make(const bat_mesh *coarse, size_t levels, midpoint_mesh *made, bat_error *error);
void midpoint_mesh_free(midpoint_mesh *mesh);

/// Give `refined` (which has none) the texture coordinates of the fine mesh. `split` is the coarse mesh subdivided `levels`
/// times, `images` says where its vertices lie on the fine mesh.
///
/// A face takes the texture coordinates at its corners, at a seam those of its side. Where the texture jumps within a face,
/// the face goes to the side that most of it lies on, and corners on the other one take what the affine map gives that fits
/// the face's points on its side best.
/// @return BAT_OK, BAT_NO_MEMORY, and what bat_mesh_connect() returns
bat_status map_texture_transfer(const bat_mesh_map *map, const bat_mesh *fine, const midpoint_mesh *split,
                                const bat_mesh_point *images, size_t levels, bat_mesh *refined, bat_error *error);

#endif

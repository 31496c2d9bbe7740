#ifndef MESH_DECIMATE_MAP_TEXTURE_H
#define MESH_DECIMATE_MAP_TEXTURE_H

#include "mesh/decimate/map.h"
#include "mesh/decimate/midpoints.h"

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

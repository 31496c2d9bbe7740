#ifndef RESEARCH_TRAIN_MESH_TARGETS_H
#define RESEARCH_TRAIN_MESH_TARGETS_H

#include "batten/mesh_decimate.h"

/// The images on the fine mesh of the vertices of bat_mesh_midpoints(): the training targets of a learned scheme (Liu et al.
/// 2020, section 4).
///
/// @param fine, coarse the meshes of the map
/// @param positions    receives 3 numbers a vertex, on the fine mesh's faces
/// @param normals      receives unit normals of the fine mesh there, interpolated between the area-weighted normals of its
///                     vertices; zero on a face without area. May be null
/// @return BAT_OK, BAT_INVALID_ARGUMENT for a map of other meshes, BAT_TOO_LARGE, BAT_NO_MEMORY
bat_status mesh_map_targets(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                            double *positions, double *normals, bat_error *error);

#endif

#pragma once

#include "batten/batten.h"

/// @file
/// The base colours of materials, for baking: those of glTF, and of the MTL file of OBJ.

/// The colours of a mesh. All zero: none.
typedef struct mesh_paints mesh_paints;

/// Read the colours of the materials that faces have. In glTF they are the image, times the factor, times the vertices'
/// colours; in OBJ the image, else the vertices' colours, else Kd.
/// @param path the file of the mesh
/// @param size the texels along a side of what is baked; images of more detail are made smaller
/// @param made receives null where there are no more than the vertices' colours; release it with mesh_paints_free()
bat_status mesh_paints_read(const bat_mesh *mesh, const char *path, size_t size, mesh_paints **made, bat_error *error);
void mesh_paints_free(mesh_paints *paints);

/// bat_mesh_painter::paint of paints.
void mesh_paints_at(const void *paints, const bat_mesh_point *point, unsigned char colour[3]);

/// Set the base colour factors of a mesh to 1 and leave out the images, because they are baked. False when out of memory.
bool mesh_paints_reset(bat_mesh *mesh);

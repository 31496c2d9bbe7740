#ifndef MESH_REFINE_SEAMS_H
#define MESH_REFINE_SEAMS_H

#include "batten/mesh.h"

/// Find who is whose neighbour in a mesh's texture: faces are, where they share an edge of the mesh and both of its texture
/// coordinates. What parts faces in the texture alone is a seam, a boundary of the texture's. `first` is left null.
/// @return BAT_OK or BAT_NO_MEMORY; `seams` is untouched on failure
bat_status seams_connect(const bat_mesh *mesh, const bat_mesh_connectivity *links, bat_mesh_connectivity *seams,
                         bat_error *error);

#endif

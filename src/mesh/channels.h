#ifndef MESH_CHANNELS_H
#define MESH_CHANNELS_H

#include "batten/mesh.h"

/// Give a mesh the names of another one's channels, and room for their values at `vertices` vertices.
/// @param to receives channels, channel_names and channel_count, which it must not have yet; bat_mesh_free() releases what
///           was made, also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status channels_make(const bat_mesh *from, size_t vertices, bat_mesh *to, bat_error *error);

#endif

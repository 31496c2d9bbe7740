#ifndef DRAW_CURVE_MAP_NETWORK_H
#define DRAW_CURVE_MAP_NETWORK_H

#include "batten/curve_picture.h"

/// @file
/// Which edges of a map are drawn, and the colours of its features.

/// All zero for a panel without polygons.
typedef struct map_network
{
    size_t *starts;       ///< layer_count + 1: the number of a layer's first edge, counted over the panel
    unsigned char *drawn; ///< for each edge: 1 unless an earlier layer of the same role and kind has the same edge
    int *colours;         ///< for each layer: the fill, 0 to MAP_COLOURS - 1
} map_network;

/// The number of fills.
#define MAP_COLOURS 6

/// Find equal edges of the layers and colour the features: neighbours, which share an edge, differ while there are colours.
/// Release the network with map_network_free().
/// @return BAT_OK or BAT_NO_MEMORY; without polygons `network` is all zero
bat_status map_network_make(const bat_curve_picture_panel *panel, map_network *network, bat_error *error);
void map_network_free(map_network *network);

#endif

#ifndef CURVE_MAP_MET_EDGES_H
#define CURVE_MAP_MET_EDGES_H

#include "curve/map/arc_refine.h"

/// @file
/// Edges of arcs that meet in the given map, and may meet in what is made of it.

/// Two edges of arcs that meet.
typedef struct met_pair
{
    edge_place places[2]; ///< each pair occurs in both orders
} met_pair;

/// All zero: none.
typedef struct met_edges
{
    met_pair *pairs; ///< in order
    size_t count, capacity;
} met_edges;

/// Find the edges of arcs that meet, other than at ends that two arcs share.
/// @param charts of the arcs
/// @param met    release it with met_edges_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status met_edges_find(const chart_curves *charts, const map_chart *chart, int threads, met_edges *met, bat_error *error);
void met_edges_free(met_edges *met);

/// Whether two edges meet, or neighbours of them.
bool met_edges_near(const met_edges *met, const bat_curve *arcs, edge_place first, edge_place second);

#endif

#ifndef MESH_MEASURE_EDGE_GROUPS_H
#define MESH_MEASURE_EDGE_GROUPS_H

#include "batten/mesh.h"

/// @file
/// The edges of any mesh, manifold or not, and what hangs together through them.

/// Half-edges sorted by their edges: those of edge e are order[begin[e]] … order[begin[e + 1] - 1], lesser numbers first.
typedef struct edge_groups
{
    uint32_t *order; ///< 3 x face_count half-edges
    uint32_t *begin; ///< count + 1
    size_t count;
} edge_groups;

/// @param mesh checked
/// @return BAT_OK or BAT_NO_MEMORY; `groups` is untouched on failure
bat_status edge_groups_make(const bat_mesh *mesh, edge_groups *groups, bat_error *error);
void edge_groups_free(edge_groups *groups);

/// Sets of numbers that are joined step by step (union-find with path halving). At first each number is alone.
void sets_begin(uint32_t *parent, size_t count);
uint32_t sets_find(uint32_t *parent, uint32_t item);
void sets_join(uint32_t *parent, uint32_t a, uint32_t b);

#endif

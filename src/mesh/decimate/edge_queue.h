#ifndef MESH_DECIMATE_EDGE_QUEUE_H
#define MESH_DECIMATE_EDGE_QUEUE_H

#include "batten/base.h"

/// @file
/// The edges that wait to be collapsed, with their errors. Taken in order of their errors (a heap of four children a
/// node), or each time the least of a few random ones (Liu et al. 2020, appendix E).

typedef struct edge_queue_item
{
    double error;
    uint32_t edge;
} edge_queue_item;

typedef struct edge_queue
{
    edge_queue_item *items; ///< `count` of them; a heap where `candidates` is 0
    uint32_t *place;        ///< of every edge: its item, or EDGE_QUEUE_ABSENT
    size_t count;
    size_t candidates; ///< of each random choice; 0: always the least of all
    bat_random random;
} edge_queue;

#define EDGE_QUEUE_ABSENT UINT32_MAX

/// An empty queue with room for `edges` edges.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status edge_queue_make(size_t edges, size_t candidates, uint64_t seed, edge_queue *queue, bat_error *error);
void edge_queue_free(edge_queue *queue);

/// Let an edge wait with this error, whether it did before or not. Ties go to the lesser index.
void edge_queue_put(edge_queue *queue, uint32_t edge, double error);
/// Take an edge out, if it is there.
void edge_queue_remove(edge_queue *queue, uint32_t edge);
/// Take the next edge out; EDGE_QUEUE_ABSENT when none waits.
uint32_t edge_queue_take(edge_queue *queue);

static inline bool edge_queue_has(const edge_queue *queue, uint32_t edge)
{
    return queue->place[edge] != EDGE_QUEUE_ABSENT;
}

#endif

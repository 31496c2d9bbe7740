#ifndef MESH_DECIMATE_EDGE_QUEUE_H
#define MESH_DECIMATE_EDGE_QUEUE_H

#include "batten/base.h"

/// @file
/// A priority queue of edges by error. The next edge is the one with the smallest error, or with the smallest error of a few
/// random edges (Liu et al., 2020, appendix E).

typedef struct edge_queue_item
{
    double error;
    uint32_t edge;
} edge_queue_item;

typedef struct edge_queue
{
    edge_queue_item *items; ///< `count` items; a heap when `candidates` is 0
    uint32_t *place;        ///< for each edge: its item, or EDGE_QUEUE_ABSENT
    size_t count;
    size_t candidates; ///< the number of random edges to choose from; 0: the minimum of all
    bat_random random;
} edge_queue;

#define EDGE_QUEUE_ABSENT UINT32_MAX

/// Make an empty queue for `edges` edges.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status edge_queue_make(size_t edges, size_t candidates, uint64_t seed, edge_queue *queue, bat_error *error);
void edge_queue_free(edge_queue *queue);

/// Fill an empty queue with the edges of finite error, in linear time. `errors` has one for each edge.
void edge_queue_fill(edge_queue *queue, const double *errors, size_t edges);
/// Insert an edge or change its error. Of equal errors the smaller index comes first.
void edge_queue_put(edge_queue *queue, uint32_t edge, double error);
/// Remove an edge, if it is in the queue.
void edge_queue_remove(edge_queue *queue, uint32_t edge);
/// Remove and return the next edge; EDGE_QUEUE_ABSENT when the queue is empty.
uint32_t edge_queue_take(edge_queue *queue);

static inline bool edge_queue_has(const edge_queue *queue, uint32_t edge)
{
    return queue->place[edge] != EDGE_QUEUE_ABSENT;
}

#endif

#ifndef RESEARCH_TRAIN_TAPE_GRAPH_H
#define RESEARCH_TRAIN_TAPE_GRAPH_H

#include "learn/operations.h"
#include "surface/network/radius_graph.h"

/// @file
/// What networks do along the edges of radius graphs, on a tape: nothing is kept for an edge but its bit.

/// Which sources are near which targets.
typedef struct tape_graph
{
    size_t targets, sources, edges;
    size_t words;      ///< of a target
    uint64_t *bits;    ///< targets x words
    uint32_t *degrees; ///< of the targets
} tape_graph;

/// A graph that lives as long as the step. It has no derivative.
/// @param targets count x width
/// @param sources count x width, with width at most SURFACE_WIDTH
tape_graph tape_graph_make(learn_tape *tape, const learn_array *targets, const learn_array *sources, double radius);

/// Row i is the mean of the rows of x that are near row i.
/// @param x     R x SURFACE_WIDTH
/// @param graph of R targets and as many sources, symmetric, each its own neighbour
learn_array *tape_graph_mean(learn_tape *tape, learn_array *x, const tape_graph *graph);

/// What a linear layer, batch normalization over all edges and ReLU say of edges, in the mean: row i is the mean over the
/// neighbours j of max(0, normalized(x_i + y_j)), 0 where there are none.
/// @param x          targets x SURFACE_WIDTH
/// @param y          sources x SURFACE_WIDTH
/// @param gain,shift 1 x SURFACE_WIDTH
learn_array *tape_graph_messages(learn_tape *tape, learn_array *x, learn_array *y, learn_array *gain, learn_array *shift,
                                 const tape_graph *graph);

#endif

#ifndef RESEARCH_TRAIN_SURFACE_NETWORK_TAPE_H
#define RESEARCH_TRAIN_SURFACE_NETWORK_TAPE_H

#include "research/train/surface_network_training.h"
#include "surface/network/bidgcn.h"

/// @file
/// The published network of surface/network/surface_network.h on a tape, for training.

/// How many neighbours the graphs have in all: interior, boundary, then the hidden layers'.
typedef struct surface_edges
{
    size_t count[2 + SURFACE_HIDDEN];
} surface_edges;

/// The published network as in surface_network_training. The tape's parameters tell which form it has.
/// @param edges may be null
learn_array *surface_network_predict(learn_tape *tape, const bat_cloud *cloud, const double *boundary, surface_edges *edges);

#endif

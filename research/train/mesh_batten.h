#ifndef RESEARCH_TRAIN_MESH_BATTEN_H
#define RESEARCH_TRAIN_MESH_BATTEN_H

#include "batten/research/mesh_train.h"

/// @file
/// The recipe of the shipped mesh scheme: network, data and loss of docs/algorithms/mesh-network.md.

/// bat_mesh_train() with BAT_RECIPE_BATTEN.
bat_status mesh_batten_train(const bat_mesh *shapes, size_t shape_count, const bat_mesh_train_options *options,
                             bat_mesh_train_report *report, bat_error *error);

#endif

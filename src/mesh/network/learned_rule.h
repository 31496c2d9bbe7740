#ifndef MESH_NETWORK_LEARNED_RULE_H
#define MESH_NETWORK_LEARNED_RULE_H

#include "batten/mesh_refine.h"
#include "learn/model.h"

/// @file
/// The learned scheme as a bat_mesh_rule: levels by the network, boundaries by the four-point rule, creases and corners by
/// Loop's rules.

/// The network as a row of learn/model.h, and its table.
extern const learn_network mesh_network_learned;
extern const learn_networks mesh_networks;

/// Read a model, a row's rule being a bat_mesh_rule whose context is the network.
bat_status mesh_model_read(const learn_networks *networks, const char *path, bat_mesh_model **model, bat_error *error);

#endif

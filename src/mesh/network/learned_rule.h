#ifndef MESH_NETWORK_LEARNED_RULE_H
#define MESH_NETWORK_LEARNED_RULE_H

#include "batten/mesh_refine.h"
#include "mesh/network/learned_inference.h"

/// @file
/// The learned scheme as a bat_mesh_rule: levels by the network, boundaries by the four-point rule, creases and corners by
/// Loop's rules.

/// bat_mesh_rule::refine with a network.
bat_status mesh_learned_rule(const mesh_learned *network, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                             size_t levels, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                             bat_error *error);

#endif

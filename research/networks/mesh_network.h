#ifndef RESEARCH_NETWORKS_MESH_NETWORK_H
#define RESEARCH_NETWORKS_MESH_NETWORK_H

#include "learn/parameters.h"

/// @file
/// The network of Liu et al., "Neural Subdivision" (2020), section 5 and appendix F: three modules on half-flaps, shared by
/// all levels, 15,104 weights with the names of the published program.
///
///     module: Linear-ReLU-Linear-ReLU-Linear, all layers 32 wide
///     state = mean over half-flaps of init(positions, differential coordinates)
///     at each level: state = mean of vertex(state), then the new vertices' = mean of edge(state)
///
/// The first three of a module's outputs displace a vertex; the other 29 are its features.

/// The modules, in the order of their weights.
typedef enum mesh_module
{
    MESH_MODULE_INIT,
    MESH_MODULE_EDGE,
    MESH_MODULE_VERTEX,
    MESH_MODULE_COUNT
} mesh_module;

enum
{
    MESH_WIDTH = 32,      ///< the width of states and layers
    MESH_MODULE_SIZE = 6, ///< parameters of a module: weight and bias of three layers
    MESH_PARAMETERS = MESH_MODULE_COUNT * MESH_MODULE_SIZE,
    MESH_WEIGHTS = 15104
};

/// Variants of the network: the published ablations (section 6, appendix H) and one with relative lengths.
typedef struct mesh_network_form
{
    bool fixed_frames;   ///< the axes of space replace local frames
    bool no_differences; ///< without differential coordinates
    bool relative;       ///< lengths are relative to each half-flap, so the result does not depend on scale
} mesh_network_form;

/// Marks in the note "recipe" of a weights file. Missing differential coordinates follow from the shapes of the arrays.
#define MESH_NETWORK_FIXED ", fixed frames"
#define MESH_NETWORK_RELATIVE ", relative lengths"

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_network_make(mesh_network_form form, learn_parameters *parameters, bat_error *error);

#endif

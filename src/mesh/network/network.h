#ifndef MESH_NETWORK_NETWORK_H
#define MESH_NETWORK_NETWORK_H

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

/// The modules in the order of their weights.
typedef enum mesh_module
{
    MESH_MODULE_INIT,
    MESH_MODULE_EDGE,
    MESH_MODULE_VERTEX,
    MESH_MODULE_COUNT
} mesh_module;

enum
{
    MESH_WIDTH = 32,      ///< of a state and of all layers
    MESH_MODULE_SIZE = 6, ///< parameters of a module: three times weight and bias
    MESH_PARAMETERS = MESH_MODULE_COUNT * MESH_MODULE_SIZE,
    MESH_WEIGHTS = 15104
};

/// What the published ablations leave out (section 6, appendix H), and what scale needs.
typedef struct mesh_network_form
{
    bool fixed_frames;   ///< half-flaps are seen through the axes of space
    bool no_differences; ///< without differential coordinates
    bool relative;       ///< lengths are in units of each half-flap's own, so that scale does not matter
} mesh_network_form;

/// What the note "recipe" of a file with weights says of their form; what is left out shows in the arrays' shapes.
#define MESH_NETWORK_FIXED ", fixed frames"
#define MESH_NETWORK_RELATIVE ", relative lengths"

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_network_make(mesh_network_form form, learn_parameters *parameters, bat_error *error);

#endif

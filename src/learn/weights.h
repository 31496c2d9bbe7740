#pragma once

#include "learn/safetensors.h"

/// @file
/// The weights in weights/ as constants of the library, written by cmake/weights.cmake. The data of each file are one block
/// of floats that is aligned to 64 bytes; the arrays lie in it one after the other.

extern const safetensors weights_learned; ///< weights/batten.safetensors, in the order of learned_network_make()
extern const safetensors weights_mesh;    ///< weights/mesh.safetensors
extern const safetensors weights_surface; ///< weights/surface.safetensors

#ifndef LEARN_WEIGHTS_H
#define LEARN_WEIGHTS_H

#include "curve/network/learned_network.h"

/// @file
/// The weights in models/ as data of the library; cmake/weights.cmake writes them when it is built.

enum
{
    /// Of learned_network_make(): one number a feature or channel and channel for the weights, one a channel for the bias.
    WEIGHTS_LEARNED = (LEARNED_FEATURES + 1 + (LEARNED_LAYERS - 1) * (LEARNED_WIDTH + 1) + 1) * LEARNED_CHANNELS
};

/// The file's words as they are, and the numbers that they mean.
typedef union weights_learned_words
{
    uint32_t words[WEIGHTS_LEARNED];
    float values[WEIGHTS_LEARNED];
} weights_learned_words;

/// weights/batten.safetensors without its header.
extern const weights_learned_words weights_learned;

/// weights/tension-published.safetensors.
extern const unsigned char weights_published[];
extern const size_t weights_published_size;

/// weights/mesh.safetensors.
extern const unsigned char weights_mesh[];
extern const size_t weights_mesh_size;

/// weights/surface.safetensors.
extern const unsigned char weights_surface[];
extern const size_t weights_surface_size;

#endif

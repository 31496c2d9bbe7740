#ifndef MODELS_WEIGHTS_H
#define MODELS_WEIGHTS_H

#include "models/fairing_network.h"

/// @file
/// The weights in models/ as data of the library; cmake/weights.cmake writes them when it is built.

enum
{
    /// Of fairing_network_make(): one number a feature or channel and channel for the weights, one a channel for the bias.
    WEIGHTS_FAIRING = (FAIRING_SEEN + 1 + (FAIRING_LAYERS - 1) * (FAIRING_WIDTH + 1) + 1) * FAIRING_CHANNELS
};

/// The file's words as they are, and the numbers that they mean.
typedef union weights_fairing_words
{
    uint32_t words[WEIGHTS_FAIRING];
    float values[WEIGHTS_FAIRING];
} weights_fairing_words;

/// models/batten.safetensors without its header.
extern const weights_fairing_words weights_fairing;

/// models/tension-published.safetensors.
extern const unsigned char weights_published[];
extern const size_t weights_published_size;

/// models/mesh.safetensors.
extern const unsigned char weights_mesh[];
extern const size_t weights_mesh_size;

/// models/surface.safetensors.
extern const unsigned char weights_surface[];
extern const size_t weights_surface_size;

#endif

#ifndef RESEARCH_NETWORKS_WEIGHTS_H
#define RESEARCH_NETWORKS_WEIGHTS_H

#include "learn/safetensors.h"

/// @file
/// The weights of published networks in weights/ as constants, as in learn/weights.h.

extern const safetensors weights_published; ///< weights/tension-published.safetensors

#endif

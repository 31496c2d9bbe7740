#ifndef SURFACE_NETWORK_SURFACE_INFERENCE_H
#define SURFACE_NETWORK_SURFACE_INFERENCE_H

#include "surface/network/surface_network.h"

/// @file
/// The published network of src/surface/network/surface_network.h for inference alone: no tape, graphs that are not kept,
/// and products whose weights lie as they are read. On any number of threads to the same bytes.

/// As in surface_network_kind.
bat_status surface_inference_make(const learn_parameters *parameters, void **network, bat_error *error);
void surface_inference_free(void *network);
bat_status surface_inference_run(const void *network, const bat_cloud *cloud, const double *boundary, int threads,
                                 double *interior, bat_error *error);

#endif

#ifndef SURFACE_NETWORK_BIDGCN_H
#define SURFACE_NETWORK_BIDGCN_H

#include "surface/network/model.h"
#include "surface/network/radius_graph.h"

/// @file
/// The network of Giannelli et al., "BIDGCN" (2023), sections 2 and 4.1: parameters of the interior points of a cloud.
///
///     input:   x'_i = the mean over interior points j near i of h(x_i, x_j - x_i)
///                   + the mean over boundary points k near i of g(x_i, x_k - x_i, u_k), then ReLU
///     hidden:  four times the mean over rows j near row i of W (x_i, x_j - x_i) + b, then ReLU but for the last
///     output:  a network of three layers on the input's and all hidden layers' features, then the sigmoid
///
/// Near is within the radius, in space at first and then among the features. h, g and the output network have a batch
/// normalization, by the cloud's own mean and variance, and a ReLU behind each layer but the last.
///
/// A linear layer commutes with the mean. So a hidden layer is one product for each point, W (x_i, mean_j x_j - x_i) + b;
/// the second layers of h and g are products of means; and their first layers are (W_a - W_b) x_i + W_b x_j + W_u u_j,
/// products for each point that edges only add up.

/// Of the graphs, in the unit box and among the features.
static const double SURFACE_RADIUS = 0.1;

enum
{
    SURFACE_HIDDEN = 4,   ///< layers
    SURFACE_OUTPUT = 256, ///< width of the output network
    SURFACE_JOINED = (SURFACE_HIDDEN + 1) * SURFACE_WIDTH,
    SURFACE_MESSAGE_ARRAYS = 6,                 ///< of h or g
    SURFACE_HIDDEN_ARRAYS = 2 * SURFACE_HIDDEN, ///< of the hidden layers
    SURFACE_OUTPUT_ARRAYS = 10,                 ///< of the output network
    SURFACE_WEIGHTS = 192130
};

/// Where a part's arrays begin among the parameters: weight before bias, gain before shift.
typedef enum surface_part
{
    SURFACE_PART_INTERIOR, ///< layer, normalization, layer
    SURFACE_PART_BOUNDARY, ///< the same; without the informed layer there is none
    SURFACE_PART_HIDDEN,   ///< four layers
    SURFACE_PART_OUTPUT    ///< twice layer and normalization, then a layer
} surface_part;

/// The index of a part's first array in a network with this number of arrays.
size_t surface_network_part_begin(size_t parameter_count, surface_part part);
size_t surface_network_part(const learn_parameters *parameters, surface_part part);
/// Whether the network has the informed input layer. Without, it takes boundary points for interior ones, and knows nothing
/// of their parameters (section 6.1).
bool surface_network_is_informed(const learn_parameters *parameters);
bool surface_network_count_is_informed(size_t parameter_count);

extern const surface_network_kind surface_network_published, surface_network_uninformed;

/// @file
/// The published network of src/surface/network/surface_network.h for inference alone: no tape, graphs that are not kept,
/// and products whose weights lie as they are read. On any number of threads to the same bytes.

/// As in surface_network_kind.
bat_status surface_inference_make(const learn_parameters *parameters, void **network, bat_error *error);
void surface_inference_free(void *network);
bat_status surface_inference_run(const void *network, const bat_cloud *cloud, const double *boundary, int threads,
                                 double *interior, bat_error *error);

#endif

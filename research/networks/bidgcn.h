#ifndef RESEARCH_NETWORKS_BIDGCN_H
#define RESEARCH_NETWORKS_BIDGCN_H

#include "research/networks/radius_graph.h"
#include "surface/network/chart_network.h"

/// @file
/// The network of Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), sections 2 and 4.1, which maps a cloud
/// with boundary parameters u_k to the parameters of its interior points x_i:
///     input:   f_0 = ReLU(mean over interior points j near i of h(x_i, x_j - x_i)
///                         + mean over boundary points k near i of g(x_i, x_k - x_i, u_k))
///     hidden:  f_l+1 = ReLU(mean over rows j near row i of W_l (f_i, f_j - f_i) + b_l), l = 0 … 3, the last without ReLU
///     output:  sigmoid(three layers applied to (f_0, …, f_4))
/// Near means within SURFACE_RADIUS: in space for the input layer, among the features f_l for the hidden layers. In h, g and
/// the output network, a batch normalization and a ReLU follow every layer but the last. The normalization uses the mean and
/// variance of the cloud itself.
///
/// A linear layer commutes with the mean. Hence a hidden layer is one product for each point, W (f_i, mean_j f_j - f_i) + b.
/// The second layers of h and g apply to means. Their first layers are (W_a - W_b) x_i + W_b x_j + W_u u_j, which are
/// products for each point, summed along edges.

/// Radius of the graphs, in the unit box and among the features.
static const double SURFACE_RADIUS = 0.1;

enum
{
    SURFACE_HIDDEN = 4,   ///< number of hidden layers
    SURFACE_OUTPUT = 256, ///< width of the output network
    SURFACE_JOINED = (SURFACE_HIDDEN + 1) * SURFACE_WIDTH,
    SURFACE_MESSAGE_ARRAYS = 6,                 ///< parameter arrays of h, and of g
    SURFACE_HIDDEN_ARRAYS = 2 * SURFACE_HIDDEN, ///< parameter arrays of the hidden layers
    SURFACE_OUTPUT_ARRAYS = 10,                 ///< parameter arrays of the output network
    SURFACE_WEIGHTS = 192130
};

/// Parts of the network. Arrays are stored with weight before bias, and gain before shift.
typedef enum surface_part
{
    SURFACE_PART_INTERIOR, ///< layer, normalization, layer
    SURFACE_PART_BOUNDARY, ///< the same; absent without the informed input layer
    SURFACE_PART_HIDDEN,   ///< four layers
    SURFACE_PART_OUTPUT    ///< twice layer and normalization, then a layer
} surface_part;

/// The index of a part's first array in a network with this number of arrays.
size_t surface_network_part_begin(size_t parameter_count, surface_part part);
size_t surface_network_part(const learn_parameters *parameters, surface_part part);
/// Whether the network has the boundary-informed input layer. Without it, boundary points are treated as interior ones, and
/// their parameters are not used (section 6.1).
bool surface_network_is_informed(const learn_parameters *parameters);
bool surface_network_count_is_informed(size_t parameter_count);

extern const learn_network surface_network_published, surface_network_uninformed;

/// Inference: the functions of these. The result does not depend on the number of threads.
bat_status surface_inference_make(const learn_source *source, const learn_parameters *parameters, void **network,
                                  bat_error *error);
void surface_inference_free(void *network);
bat_status surface_inference_run(const void *network, const bat_cloud *cloud, const double *boundary, int threads,
                                 double *interior, bat_error *error);

#endif

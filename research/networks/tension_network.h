#ifndef RESEARCH_NETWORKS_TENSION_NETWORK_H
#define RESEARCH_NETWORKS_TENSION_NETWORK_H

#include "research/learn/operations.h"

/// @file
/// The network of Ugail and Howard, *A Neural Tension Operator…* (2026), section 5.3: from what an edge sees to the angle at
/// which the new vertex is inserted. 140,505 weights, named as PyTorch names them in the published program.
///
///     embedding 3 x 8;  Linear 14-128, LayerNorm, GELU;
///     four times GELU(x + [Linear, LayerNorm, GELU, Dropout .05, Linear, LayerNorm](x));
///     Linear 128-32, GELU, Linear 32-1, sigmoid onto (-pi/4 + .02, pi/4 - .02)

enum
{
    TENSION_FEATURES =
        6,              ///< numbers of an edge beside its space: four exterior angles over pi, two relative lengths (eq. 17)
    TENSION_SPACES = 3, ///< rows of the embedding: curvature -1, 0, 1
    TENSION_EMBEDDING = 8,
    TENSION_WIDTH = 128,
    TENSION_BLOCKS = 4,
    TENSION_HEAD = 32,
    TENSION_WEIGHTS = 140505
};

/// The places of the weights in the list, those of a block counted from its first. A linear layer has a weight and a bias, a
/// layer norm a gain and a shift.
enum
{
    TENSION_AT_EMBEDDING,
    TENSION_AT_INPUT_LINEAR,
    TENSION_AT_INPUT_NORM = TENSION_AT_INPUT_LINEAR + 2,
    TENSION_AT_BLOCKS = TENSION_AT_INPUT_NORM + 2,
    TENSION_AT_BLOCK_LINEAR_1 = 0,
    TENSION_AT_BLOCK_NORM_1 = 2,
    TENSION_AT_BLOCK_LINEAR_2 = 4,
    TENSION_AT_BLOCK_NORM_2 = 6,
    TENSION_BLOCK_SIZE = 8,
    TENSION_AT_HEAD_LINEAR_1 = TENSION_AT_BLOCKS + TENSION_BLOCKS * TENSION_BLOCK_SIZE,
    TENSION_AT_HEAD_LINEAR_2 = TENSION_AT_HEAD_LINEAR_1 + 2,
    TENSION_PARAMETERS = TENSION_AT_HEAD_LINEAR_2 + 2
};

#define TENSION_DROPOUT 0.05
#define TENSION_ANGLE_LIMIT (0.78539816339744830962 - 0.02)

/// How the network learns of the space, in the order of bat_tension_embedding.
typedef enum tension_embedding
{
    TENSION_EMBEDDED, ///< by a table of trained numbers
    TENSION_ONE_HOT,  ///< by three fixed numbers, one of which is 1
    TENSION_NO_SPACE  ///< not at all
} tension_embedding;

/// The weights' names and shapes, all zero.
/// @param parameters all zero before the call; release it with learn_parameters_free()
/// @return BAT_OK or BAT_NO_MEMORY
bat_status tension_network_make(learn_parameters *parameters, bat_error *error);
/// The same without the embedding, for edges that are described by `inputs` numbers alone.
bat_status tension_network_make_plain(learn_parameters *parameters, size_t inputs, bat_error *error);

/// The network with a kind of embedding.
bat_status tension_network_make_embedded(tension_embedding embedding, learn_parameters *parameters, bat_error *error);
/// The kind of embedding that weights are for.
tension_embedding tension_network_embedding(const learn_parameters *parameters);

/// The weights of a network in a file as bat_curve_model_read_published() reads them.
/// @param path       null: those that the library holds
/// @param parameters receives the weights; release it with learn_parameters_free()
bat_status tension_network_read(const char *path, learn_parameters *parameters, bat_error *error);

/// Draw weights: normal with variance 2 / inputs (He et al. 2015), zero biases, norms that change nothing, a standard normal
/// embedding.
void tension_network_start(learn_parameters *parameters, uint64_t seed);

/// The angles of a batch of edges, rows x 1. The tape must have begun with the network's parameters. Dropout drops if the
/// tape says so.
/// @param features rows x TENSION_FEATURES, or as many columns as a network without embedding has inputs
/// @param spaces for each row curvature + 1; must stay until the step was differentiated; null for a network without
/// embedding
learn_array *tension_network_angles(learn_tape *tape, learn_array *features, const uint32_t *spaces);

#endif

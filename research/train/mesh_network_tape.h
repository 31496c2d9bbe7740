#ifndef RESEARCH_TRAIN_MESH_NETWORK_TAPE_H
#define RESEARCH_TRAIN_MESH_NETWORK_TAPE_H

#include "mesh/network/flap.h"
#include "research/learn/operations.h"
#include "research/networks/mesh_frame.h"
#include "research/networks/mesh_network.h"

/// @file
/// The mesh network of research/networks/mesh_network.h on a tape, for training, and its operations on half-flaps. A *state*
/// has a row per vertex: the position, then any number of vectors that rotate with the mesh, then features that do not. All
/// derivatives are complete, those through edges and frames too. Half-flaps are not copied and must stay until the step has
/// been differentiated.

/// Draw weights and biases uniformly between plus and minus 1 / sqrt(inputs), as PyTorch does.
void mesh_network_start(learn_parameters *parameters, uint64_t seed);

/// Refine a mesh. The tape must have begun with the network's parameters.
/// @param positions vertices x 3
/// @param states    receives the state at each level, levels->count + 1 arrays, of which the first three columns are the
///                  positions
void mesh_network_refine(learn_tape *tape, mesh_network_form form, const mesh_levels *levels, learn_array *positions,
                         learn_array **states);

// Operations

/// Positions (V x 3), each followed by its vertex's differential coordinates, v - mean of the neighbours: V x 6.
learn_array *tape_flap_differences(learn_tape *tape, const mesh_flaps *flaps, learn_array *positions);

/// The vectors of all half-flaps in the coordinates of their frames.
typedef struct tape_flap_local
{
    const mesh_flaps *flaps;
    flap_frame_options view;
    size_t vectors;           ///< of a state's row, beside the position
    learn_array *frame;       ///< FLAP_FRAME x count, as flap_frames() gives it
    learn_array *coordinates; ///< numbers x count: three edges, then the vectors of corner i, those of j, of k, of l
} tape_flap_local;

/// Compute the local coordinates of a state of which the first 3 + 3 `vectors` columns are vectors.
tape_flap_local tape_flap_localize(learn_tape *tape, const mesh_flaps *flaps, flap_frame_options view, learn_array *state,
                                   size_t vectors);

/// The first layer of a network on half-flaps: max(0, W x + b), where row f of x has, for each corner of half-flap f, the
/// corner's local position (not for i, whose is 0), its local vectors, its features. Products with features are computed
/// once per vertex. count x outputs.
/// @param state  V x C
/// @param weight outputs x (4 C - 3)
/// @param bias   1 x outputs
learn_array *tape_flap_layer(learn_tape *tape, const tape_flap_local *local, learn_array *state, learn_array *weight,
                             learn_array *bias);

/// The mean of the outputs of those half-flaps that begin at a vertex: the first three numbers, rotated out of the frame,
/// displace the vertex; the others are its features. Gives the next state, V x O.
/// @param output count x O
/// @param state  the positions are its first 3 columns
learn_array *tape_flap_move(learn_tape *tape, const tape_flap_local *local, learn_array *output, learn_array *state);

/// The same over the two half-flaps of every edge: the new vertex is displaced from the edge's midpoint. Gives the state of
/// the refined mesh, (V + E) x C, whose first V rows are those of `state`.
/// @param output count x C
/// @param state  V x C
learn_array *tape_flap_insert(learn_tape *tape, const tape_flap_local *local, learn_array *output, learn_array *state);

#endif

#ifndef RESEARCH_TRAIN_TAPE_FLAP_H
#define RESEARCH_TRAIN_TAPE_FLAP_H

#include "learn/operations.h"
#include "mesh/network/flap_frame.h"
#include "mesh/network/mesh_flap.h"

/// @file
/// What networks for meshes do with half-flaps, on a tape. A *state* has a row for every vertex: the position, then any
/// number of vectors that turn with the mesh, then features that do not. All derivatives are there, those through edges and
/// frames too. Half-flaps are not copied and must stay until the step has been differentiated.

/// Positions (V x 3), each with its vertex's differential coordinates beside it, v - mean of the neighbours: V x 6.
learn_array *tape_flap_differences(learn_tape *tape, const mesh_flaps *flaps, learn_array *positions);

/// What a network sees of all half-flaps through their frames.
typedef struct tape_flap_sight
{
    const mesh_flaps *flaps;
    flap_view view;
    size_t vectors;     ///< of a state's row, beside the position
    learn_array *frame; ///< FLAP_FRAME x count, as flap_frames() gives it
    learn_array *seen;  ///< numbers x count: three edges, then the vectors of corner i, those of j, of k, of l
} tape_flap_sight;

/// Look at a state of which the first 3 + 3 `vectors` columns are vectors.
tape_flap_sight tape_flap_see(learn_tape *tape, const mesh_flaps *flaps, flap_view view, learn_array *state, size_t vectors);

/// The first layer of a network on half-flaps: max(0, W x + b), where row f of x is what half-flap f sees, corner after
/// corner: the corner's position (left out for i, whose is 0), its vectors, its features. Products with features are made
/// once for each vertex. count x outputs.
/// @param state  V x C
/// @param weight outputs x (4 C - 3)
/// @param bias   1 x outputs
learn_array *tape_flap_layer(learn_tape *tape, const tape_flap_sight *sight, learn_array *state, learn_array *weight,
                             learn_array *bias);

/// The mean of what half-flaps say, over those that begin at a vertex: the first three numbers move the vertex, after they
/// were turned out of the frame; the others are its features. Gives the next state, V x O.
/// @param said count x O
/// @param state the positions are its first 3 columns
learn_array *tape_flap_move(learn_tape *tape, const tape_flap_sight *sight, learn_array *said, learn_array *state);

/// The same over the two half-flaps of every edge: the new vertex is moved from the edge's middle. Gives the state of the
/// refined mesh, (V + E) x C, whose first V rows are those of `state`.
/// @param said  count x C
/// @param state V x C
learn_array *tape_flap_insert(learn_tape *tape, const tape_flap_sight *sight, learn_array *said, learn_array *state);

#endif

#ifndef RESEARCH_TRAIN_MESH_LEARNED_TAPE_H
#define RESEARCH_TRAIN_MESH_LEARNED_TAPE_H

#include "mesh/network/learned_network.h"
#include "research/learn/operations.h"

/// @file
/// The mesh network of src/mesh/network/learned_network.h on a tape, for training.
///
/// The gradient passes through the candidates, which are linear in the positions, and through the states. Normals and
/// features count as constants: at the second level their dependence on the first is left out.

/// Draw the weights: normal numbers of variance 2 / inputs; the last layers begin small, biases at 0.
void mesh_learned_start(learn_parameters *parameters, uint64_t seed);

/// The row indices of a level's half-flaps and edges.
typedef struct mesh_learned_rows
{
    uint32_t *flap[3]; ///< of each half-flap: first vertex, second vertex, edge
    uint32_t *edge[4]; ///< of each edge: its four corners
    uint32_t *memory;
} mesh_learned_rows;

/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_learned_rows_make(const mesh_flaps *flaps, mesh_learned_rows *rows, bat_error *error);
void mesh_learned_rows_free(mesh_learned_rows *rows);

/// Compute the geometry of a level in memory of its own, to be released with learned_geometry_free().
/// @return BAT_OK or BAT_NO_MEMORY; `geometry` is untouched on failure
bat_status learned_geometry_make(const mesh_flaps *flaps, const double *positions, learned_geometry *geometry,
                                 bat_error *error);
void learned_geometry_free(learned_geometry *geometry);

/// A coarse mesh as the network gets it.
typedef struct mesh_learned_input
{
    const mesh_levels *levels;        ///< two
    const mesh_learned_rows *rows;    ///< of each level
    const double *positions;          ///< of the coarse mesh
    const learned_geometry *geometry; ///< of the coarse mesh
} mesh_learned_input;

/// Refine a mesh by two levels. The tape must have begun with the network's parameters.
/// @param fairness 0 to 1
/// @return the positions after two levels, vertices x 3
learn_array *mesh_learned_refine(learn_tape *tape, const mesh_learned_input *input, double fairness);

/// One level from given positions, for tests of the derivatives.
/// @param old     the number of vertices of the level before
/// @param state   of the level before; null at level 0
/// @param context receives the mesh-wide numbers at level 0; read at level 1
learn_array *mesh_learned_level(learn_tape *tape, size_t level, const mesh_flaps *flaps, const mesh_learned_rows *rows,
                                const learned_geometry *geometry, size_t old, learn_array *positions, double fairness,
                                learn_array **state, learn_array **context);

#endif

#ifndef RESEARCH_TRAIN_MESH_TASK_H
#define RESEARCH_TRAIN_MESH_TASK_H

#include "mesh/measure/closest.h"
#include "research/data/coarse_mesh.h"
#include "research/train/mesh_learned_tape.h"

/// @file
/// The training data of batten's mesh recipe: a coarse mesh of a shape, and what classical schemes make of it. And the loss:
/// distances between surfaces, roughness and volume, relative to the classical schemes.

/// A shape with what distances to it need. Release it with mesh_target_free().
typedef struct mesh_target
{
    bat_mesh shape;
    closest_tree tree;
    double (*samples)[3]; ///< MESH_TARGET_SAMPLES points of the surface, of equal areas, in random order
    bool closed;
    double volume; ///< of a closed shape
} mesh_target;

enum
{
    MESH_TARGET_SAMPLES = 20000
};

/// @param shape is moved into the target
/// @return BAT_OK or BAT_NO_MEMORY
bat_status mesh_target_make(bat_mesh *shape, uint64_t seed, mesh_target *target, bat_error *error);
void mesh_target_free(mesh_target *target);

/// Distances of a refined mesh from the shape.
typedef struct mesh_fit
{
    double mean, rms; ///< both ways, half the sum
    double peak;      ///< power mean of the distances both ways, which follows the largest ones
    double roughness; ///< power mean of the normals' differences along edges
    double volume;    ///< relative error; 0 for an open mesh
} mesh_fit;

/// A coarse mesh, all that the network and the loss need. Release it with mesh_task_free().
typedef struct mesh_task
{
    const mesh_target *target;
    bat_mesh coarse;
    mesh_levels levels;
    mesh_learned_rows rows[LEARNED_LEVELS_OF_MESH];
    learned_geometry geometry;
    bat_mesh_connectivity fine_links; ///< of the refined mesh
    bat_mesh fine;                    ///< the coarse mesh refined by midpoints
    double edge;                      ///< mean edge of the coarse mesh
    mesh_fit best;                    ///< of butterfly, Loop and midpoint, each number the least; roughness that of Loop
} mesh_task;

bat_status mesh_task_make(const mesh_target *target, coarse_kind kind, size_t vertices, bat_random *random, mesh_task *task,
                          bat_error *error);
void mesh_task_free(mesh_task *task);

/// The mean distance over the best classical one; 1e-4 of the mean coarse edge is added to both.
double mesh_task_ratio(const mesh_task *task, const mesh_fit *fit);

/// How much the terms of the loss count.
typedef struct mesh_task_weights
{
    double hinge;     ///< of the logarithm of the distance over the best classical one, where it is above -margin
    double margin;    ///< of the hinge
    double rms;       ///< of the root mean square of distances
    double peak;      ///< of the power mean of distances
    double rough[2];  ///< of the roughness over Loop's, at fairness 0 and 1
    double volume[2]; ///< of the relative error of the volume, at fairness 0 and 1
} mesh_task_weights;

/// Refine the coarse mesh and compute the loss.
/// @param samples of each surface
/// @param fit     receives the measures
/// @return 1 x 1
learn_array *mesh_task_loss(learn_tape *tape, const mesh_task *task, double fairness, const mesh_task_weights *weights,
                            size_t samples, bat_random *random, mesh_fit *fit);

#endif

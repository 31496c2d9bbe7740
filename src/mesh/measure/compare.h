#ifndef MESH_MEASURE_COMPARE_H
#define MESH_MEASURE_COMPARE_H

#include "base/shared_work.h"
#include "batten/mesh_measure.h"
#include "mesh/measure/closest.h"

/// @file
/// The parts of bat_mesh_compare(). All lengths here are multiplied by one power of two that brings the coordinates of both
/// meshes to -1 … 1.

enum
{
    /// Distances that a thread takes at a time.
    COMPARE_BLOCK = 1024
};

/// One of the two meshes. Faces come in the order of its own tree, so that neighbours follow each other.
typedef struct compare_side
{
    bat_mesh mesh; ///< its faces are borrowed, its positions its own
    closest_tree tree;
    uint32_t *vertices; ///< those that have a face, in the order in which faces name them
    size_t vertex_count;
    double *distances; ///< of every vertex (that has a face) from the other side
    uint32_t *places;  ///< where in the other side's tree that distance was found
    size_t *samples;   ///< the first sample of each face, in the order of the tree, and at the end their number; or null
    double area;       ///< of all faces, when samples are planned
    double wanted;     ///< samples
} compare_side;

/// What is known of the distances of one side from the other.
typedef struct compare_way
{
    const compare_side *from, *onto;
    double mean, mean_square;
    double greatest;    ///< found
    double farthest[3]; ///< where
    double most;        ///< proven
} compare_way;

/// What some distances amount to.
typedef struct compare_tally
{
    double weight, sum, squares;
    double greatest;
    double farthest[3];
} compare_tally;

static inline void compare_count(compare_tally *tally, double distance, double weight, const double point[3])
{
    tally->weight += weight;
    tally->sum += weight * distance;
    tally->squares += weight * (distance * distance);
    if (distance <= tally->greatest)
        return;
    tally->greatest = distance;
    for (int k = 0; k < 3; k++)
        tally->farthest[k] = point[k];
}

static inline const double *compare_corner(const compare_side *side, uint32_t face, int corner)
{
    return side->mesh.positions + 3 * (size_t)side->mesh.faces[3 * (size_t)face + (size_t)corner];
}

/// Make the greatest distance as exact as the options ask, and find out what it cannot exceed.
/// @param diagonal of the bounding box
bat_status compare_refine(compare_way *way, double diagonal, const bat_mesh_compare_options *options, shared_work *work,
                          bat_error *error);

#endif

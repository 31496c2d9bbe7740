#ifndef MESH_MEASURE_COMPARE_H
#define MESH_MEASURE_COMPARE_H

#include "base/shared_work.h"
#include "batten/mesh_measure.h"
#include "mesh/measure/closest.h"

/// @file
/// Types of bat_mesh_compare(). All lengths are scaled by a power of two that brings the coordinates of both meshes to -1
/// … 1.

enum
{
    /// Distances of a block.
    COMPARE_BLOCK = 1024
};

/// One of the two meshes. Its faces are processed in the order of its tree, where neighbours are close.
typedef struct compare_side
{
    bat_mesh mesh; ///< with borrowed faces and its own positions
    closest_tree tree;
    uint32_t *vertices; ///< the vertices that have a face, in the order of the tree's faces
    size_t vertex_count;
    double *distances; ///< for each such vertex: its distance from the other mesh
    uint32_t *places;  ///< for each such vertex: the place of the closest triangle in the other tree
    size_t *samples;   ///< the first sample of each face, in the order of the tree, then their number; or null
    double area;       ///< the area of all faces; set with the samples
    double wanted;     ///< the requested number of samples
} compare_side;

/// The distances of one mesh from the other, in one direction.
typedef struct compare_way
{
    const compare_side *from, *onto;
    double mean, mean_square;
    double greatest;    ///< the largest distance found
    double farthest[3]; ///< the point of the largest distance
    double most;        ///< an upper bound of the one-sided Hausdorff distance
} compare_way;

/// Sums and maximum of some distances.
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

/// Enclose the one-sided Hausdorff distance to the options' tolerance: increase way->greatest and set way->most.
/// @param diagonal of the bounding box
bat_status compare_refine(compare_way *way, double diagonal, const bat_mesh_compare_options *options, shared_work *work,
                          bat_error *error);

#endif

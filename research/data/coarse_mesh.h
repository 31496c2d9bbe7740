#ifndef RESEARCH_DATA_COARSE_MESH_H
#define RESEARCH_DATA_COARSE_MESH_H

#include "batten/mesh.h"
#include "mesh/measure/closest.h"

/// @file
/// Coarse meshes of a fine one, made in the ways of different programs.

typedef enum coarse_kind
{
    COARSE_QUADRIC,    ///< bat_mesh_decimate(), with random bounds and, for some, random candidates
    COARSE_KEPT,       ///< quadric errors, but vertices are vertices of the fine mesh (Kobbelt et al., 1998)
    COARSE_MEMORYLESS, ///< volume kept and optimized, without memory (Lindstrom and Turk, 1998)
    COARSE_MIDDLE,     ///< the shortest edge first, into its middle
    COARSE_REMESHED,   ///< isotropic (Botsch and Kobbelt, 2004), vertices projected to the surface
    COARSE_KINDS
} coarse_kind;

/// Make a coarse mesh.
/// @param shape a manifold; with a boundary only COARSE_QUADRIC
/// @param tree  of the shape
/// @return BAT_OK, BAT_UNSUPPORTED for a boundary, the failures of bat_mesh_decimate()
bat_status coarse_mesh_make(const bat_mesh *shape, const closest_tree *tree, coarse_kind kind, size_t vertices,
                            bat_random *random, bat_mesh *coarse, bat_error *error);

#endif

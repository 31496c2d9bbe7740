#pragma once

#include "base/memory.h"
#include "batten/mesh.h"

/// @file
/// Half-flaps: directed edges with their two faces, the input of the networks for meshes (Liu et al., "Neural Subdivision",
/// 2020, section 5.2). This file has their connectivity; frame.h has their geometry.

/// Which of the two faces is missing.
typedef enum mesh_flap_side
{
    MESH_FLAP_WHOLE,
    MESH_FLAP_NO_LEFT, ///< corner[2] repeats corner[3]
    MESH_FLAP_NO_RIGHT ///< corner[3] repeats corner[2]
} mesh_flap_side;

/// The half-flap of the directed edge from i to j. At a boundary a missing opposite vertex is replaced by i + j - k. The
/// flap is then flat, and a regular mesh continues regularly. The features of the missing vertex are those of the other
/// opposite vertex.
typedef struct mesh_flap
{
    uint32_t corner[4]; ///< i, j, k opposite in the left face, l opposite in the right face
    uint32_t edge;
    mesh_flap_side missing;
} mesh_flap;

/// All half-flaps of a mesh, two for each edge. They are sorted by first vertex and, around it, counter-clockwise.
typedef struct mesh_flaps
{
    size_t vertex_count, edge_count;
    size_t count;           ///< 2 x edge_count
    mesh_flap *flap;        ///< count
    uint32_t *first;        ///< vertex_count + 1: vertex v has first[v] … first[v + 1] - 1
    uint32_t (*of_edge)[2]; ///< edge_count: the two half-flaps of an edge
} mesh_flaps;

/// The half-flaps of a mesh and of its refinements, whose faces are split in four as in batten/mesh_refine.h.
typedef struct mesh_levels
{
    size_t count;        ///< the number of refinement levels
    mesh_flaps *level;   ///< count: the half-flaps of the mesh that each level refines
    size_t vertex_count; ///< the number of vertices after the last level
    memory_pool pool;    ///< of all arrays
} mesh_levels;

/// Find the half-flaps of all levels.
/// @param count at least 1
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY; `levels` is untouched on failure
bat_status mesh_levels_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, size_t count, int threads,
                            mesh_levels *levels, bat_error *error);
void mesh_levels_free(mesh_levels *levels);

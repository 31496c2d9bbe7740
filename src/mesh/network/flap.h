#ifndef MESH_NETWORK_FLAP_H
#define MESH_NETWORK_FLAP_H

#include "batten/mesh.h"

/// @file
/// Half-flaps: a directed edge with the two faces beside it, which is what the networks for meshes look at (Liu et al.,
/// "Neural Subdivision" (2020), section 5.2). Connectivity alone; the geometry is in src/mesh/network/frame.h.

/// Which of the two faces is not there.
typedef enum mesh_flap_side
{
    MESH_FLAP_WHOLE,
    MESH_FLAP_NO_LEFT, ///< corner[2] repeats corner[3]
    MESH_FLAP_NO_RIGHT ///< corner[3] repeats corner[2]
} mesh_flap_side;

/// The half-flap of the directed edge i to j. At a boundary the missing corner is thought where the other one goes by point
/// reflection in the edge's middle, i + j - k, so that the flap is flat and a regular mesh continues as it is; what its
/// vertex carries is that of the other corner.
typedef struct mesh_flap
{
    uint32_t corner[4]; ///< i, j, k opposite in the face to the left, l opposite in the face to the right
    uint32_t edge;
    mesh_flap_side missing;
} mesh_flap;

/// All half-flaps of a mesh: two for every edge, also at boundaries. They are sorted by their first vertex, around which
/// they run counter-clockwise.
typedef struct mesh_flaps
{
    size_t vertex_count, edge_count;
    size_t count;           ///< 2 x edge_count
    mesh_flap *flap;        ///< count
    uint32_t *first;        ///< vertex_count + 1: those of vertex v are first[v] … first[v + 1] - 1
    uint32_t (*of_edge)[2]; ///< edge_count: an edge's two
} mesh_flaps;

/// @param connectivity of the faces
/// @param flaps        release it with mesh_flaps_free()
/// @return BAT_OK or BAT_NO_MEMORY; `flaps` is untouched on failure
bat_status mesh_flaps_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, mesh_flaps *flaps,
                           bat_error *error);
void mesh_flaps_free(mesh_flaps *flaps);

/// The half-flaps of a mesh and of what it becomes when faces are split in four, in the numbering of batten/mesh_refine.h.
typedef struct mesh_levels
{
    size_t count;        ///< levels of refinement
    mesh_flaps *level;   ///< count: those that a level begins with
    size_t vertex_count; ///< after the last level
} mesh_levels;

/// @param count at least 1
/// @return BAT_OK, BAT_TOO_LARGE or BAT_NO_MEMORY; `levels` is untouched on failure
bat_status mesh_levels_make(const uint32_t *faces, const bat_mesh_connectivity *connectivity, size_t count, int threads,
                            mesh_levels *levels, bat_error *error);
void mesh_levels_free(mesh_levels *levels);

#endif

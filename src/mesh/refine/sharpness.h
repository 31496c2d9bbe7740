#ifndef MESH_REFINE_SHARPNESS_H
#define MESH_REFINE_SHARPNESS_H

#include "mesh/refine/level.h"

/// @file
/// Sharpness of creases and corners through the levels: DeRose, Kass and Truong, "Subdivision surfaces in character
/// animation" (1998). Each level subtracts 1 from a sharpness below BAT_MESH_SHARP.

/// The sharpness that remains after one level.
static inline double sharpness_after_level(double sharpness)
{
    if (sharpness >= BAT_MESH_SHARP)
        return sharpness;
    return sharpness > 1 ? sharpness - 1 : 0;
}

/// Compute the sharpness of edges from a mesh's creases and, with `crease_angle` above 0, from the angles between its faces.
/// @param sharpness receives one number for each edge, or null when no edge is sharp
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a crease that is not an edge; BAT_NO_MEMORY
bat_status sharpness_of_edges(const bat_mesh *mesh, const bat_mesh_connectivity *links, double crease_angle,
                              double **sharpness, bat_error *error);

/// Compute the sharpness of vertices from a mesh's corners: one number for each vertex, or null without corners.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_of_vertices(const bat_mesh *mesh, double **sharpness, bat_error *error);

/// Compute the sharpness of the edges of the split mesh `fine` from that of the edges of `links`.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_split(const double *sharpness, const bat_mesh_connectivity *links, const bat_mesh_connectivity *fine,
                           double **result, bat_error *error);

/// Write the creases and corners of the mesh `fine` that `level` is split into.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` may hold a part of both on failure
bat_status sharpness_write(const mesh_level *level, bat_mesh *fine, bat_error *error);

/// The type of a vertex, which selects its rule.
typedef enum sharp_kind
{
    SHARP_SMOOTH, ///< no sharp edge
    SHARP_DART,   ///< one sharp edge, which ends here
    SHARP_CREASE, ///< two sharp edges
    SHARP_CORNER  ///< three or more sharp edges, or a sharp vertex
} sharp_kind;

/// A vertex and its sharp edges. Boundary edges are always sharp.
typedef struct sharp_vertex
{
    sharp_kind kind;
    uint32_t ends[2]; ///< crease: its neighbours along the crease; dart: the neighbour along the sharp edge
} sharp_vertex;

/// Classify a vertex that has a face, on this level and after one more level.
/// @param after  receives the type after the level; may be null
/// @param fading receives the weight of the rule for `now`, against the rule for `after`; null when `after` is
void sharpness_around(const mesh_level *level, uint32_t vertex, sharp_vertex *now, sharp_vertex *after, double *fading);

#endif

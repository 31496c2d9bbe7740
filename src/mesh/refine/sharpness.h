#ifndef MESH_REFINE_SHARPNESS_H
#define MESH_REFINE_SHARPNESS_H

#include "mesh/refine/level.h"

/// @file
/// Creases and corners on their way through the levels: DeRose, Kass and Truong, "Subdivision surfaces in character
/// animation" (1998). A level takes 1 from a sharpness, except from BAT_MESH_SHARP and more.

/// What is left of a sharpness after a level.
static inline double sharpness_after_level(double sharpness)
{
    if (sharpness >= BAT_MESH_SHARP)
        return sharpness;
    return sharpness > 1 ? sharpness - 1 : 0;
}

/// Make the sharpness of edges from a mesh's creases, and where `crease_angle` is above 0 from the angles between its faces.
/// @param sharpness receives an array of one number an edge, or null when no edge is sharp
/// @return BAT_OK; BAT_INVALID_ARGUMENT for a crease along no edge; BAT_NO_MEMORY
bat_status sharpness_of_edges(const bat_mesh *mesh, const bat_mesh_connectivity *links, double crease_angle,
                              double **sharpness, bat_error *error);

/// Make the sharpness of vertices from a mesh's corners, an array of one number a vertex, or null when there are none.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_of_vertices(const bat_mesh *mesh, double **sharpness, bat_error *error);

/// What is left of the sharpness of `links`' edges on the edges of the split mesh `fine`.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status sharpness_split(const double *sharpness, const bat_mesh_connectivity *links, const bat_mesh_connectivity *fine,
                           double **result, bat_error *error);

/// Make the creases and corners of the mesh that `level` is split into, into `fine`.
/// @return BAT_OK or BAT_NO_MEMORY; `fine` may hold some of both on failure
bat_status sharpness_write(const mesh_level *level, bat_mesh *fine, bat_error *error);

/// How a vertex is treated.
typedef enum sharp_kind
{
    SHARP_SMOOTH, ///< no sharp edge
    SHARP_DART,   ///< one, which ends here
    SHARP_CREASE, ///< two, which pass through
    SHARP_CORNER  ///< more, or a corner
} sharp_kind;

/// What is sharp around a vertex. Boundary edges are sharp for ever.
typedef struct sharp_vertex
{
    sharp_kind kind;
    uint32_t ends[2]; ///< of a crease: its neighbours along it; of a dart: the one
} sharp_vertex;

/// What is sharp around a vertex that has a face, on this level and, with no edge split, on the next.
/// @param after  receives what is sharp then; may be null
/// @param fading receives the weight of the rule for `now`, against that for `after`; may be null together with it
void sharpness_around(const mesh_level *level, uint32_t vertex, sharp_vertex *now, sharp_vertex *after, double *fading);

#endif

#pragma once

#include "mesh/refine/level.h"

/// @file
/// Bounds of a learned rule. The rule's surface is compared with the midpoint scheme's, which is the coarse mesh itself.
///
/// Each coarse vertex, edge and face has a reach: the longest move of the fine vertices on it. It is at most the height of
/// the triangles beside it, times a function of the greatest angle at which these meet their neighbours: some times
/// the sagitta of an arc through them. The reach of flat faces and, on a solid, of sharp edges is 0.
///
/// A flat face is a set of three or more coplanar triangles. Two coplanar triangles are a flat face too, unless they are one
/// of many facets of a smooth surface, beside neighbours of comparable height. A solid is a connected piece with sharp
/// edges. Half of its vertices or more are on flat faces, or hardly an edge has an angle between sharp and smooth.

/// Radians: an edge of a solid is sharp where faces meet at a greater angle. Prisms of up to eleven sides are not round.
#define BRAKE_SHARP 0.5235987755982988

typedef struct mesh_brake
{
    const bat_mesh *coarse; ///< null: nothing is bounded
    const bat_mesh_connectivity *links;
    double *reach;        ///< of the coarse vertices, then edges, then faces; 0: stay; infinite: free
    bool marched, shared; ///< made by marching cubes: faces may turn over; the butterfly scheme has a share in the result
    // Of the current level:
    size_t level, count; ///< the number of levels made, and of vertices
    double *plain;       ///< count x 4: positions by the midpoint scheme, and the share of the butterfly
    uint32_t *owner;     ///< count: the coarse vertex, edge or face that a vertex is on, an index into `reach`
} mesh_brake;

/// Measure a coarse mesh of triangles. Release the result with brake_free().
/// @param level the coarse mesh's, with sharpness: sharp edges and vertices are free
/// @param found solids are found, because no sharp edges are named
/// @return BAT_OK or BAT_NO_MEMORY
bat_status brake_make(const bat_mesh *coarse, const mesh_level *level, bool found, mesh_brake *brake, bat_error *error);
void brake_free(mesh_brake *brake);

/// Go to the next level, whose faces are split in four.
/// @param level the level before
/// @return BAT_OK or BAT_NO_MEMORY
bat_status brake_advance(mesh_brake *brake, const mesh_level *level, int threads, bat_error *error);

/// Bound the positions of the current level. Where a fine face is turned over against its coarse face, this and its
/// vertices stay, with all edges and faces between vertices that stay.
/// @param faces the current level's
/// @return the number of coarse faces that stay for that reason
size_t brake_judge(mesh_brake *brake, const uint32_t *faces, double *positions);

/// Find whether a mesh of triangles is one of marching cubes: its vertices are on the edges of a lattice along the axes, and
/// each face is in a cell. Coordinates within `equal` are equal.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status lattice_find(const bat_mesh *mesh, double equal, bool *found, bat_error *error);

/// The bytes of a brake for each vertex of a level and of the next, with those of the butterfly scheme.
#define BRAKE_VERTEX_BYTES (7 * sizeof(double) + sizeof(uint32_t))

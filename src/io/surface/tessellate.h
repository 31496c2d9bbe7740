#ifndef IO_SURFACE_TESSELLATE_H
#define IO_SURFACE_TESSELLATE_H

#include "base/memory_pool.h"
#include "batten/spline.h"

/// @file
/// Tessellation of spline surfaces into grids of quads and into triangles without cracks.

/// A surface sampled on a grid in each cell. Cells share the points of their borders. Release it with tessellation_free().
typedef struct surface_tessellation
{
    memory_pool pool;
    size_t vertex_count;
    size_t grid_count;  ///< the number of vertices of quads, which come first
    double *parameters; ///< vertex_count x 2
    double *positions;  ///< vertex_count x 3
    double *normals; ///< vertex_count x 3: unit vectors along S_u x S_v; where that is zero, the normal at a nearby interior
                     ///< point

    size_t quad_count;
    /// quad_count x 4, counter-clockwise from the lower left; finer neighbours are ignored
    uint32_t *quads;
    /// quad_count: the level of its cell. A trimmed surface has no quads, and triangle_count levels
    uint32_t *levels;

    size_t triangle_count;
    uint32_t *triangles; ///< triangle_count x 3, counter-clockwise: a manifold with all border points
} surface_tessellation;

/// Tessellate a surface.
/// @param surface of dimension 3
/// @param samples of each cell and direction; 0: the degree plus 1
/// @return BAT_OK; BAT_TOO_LARGE beyond 2^32 - 1 vertices or lattice points along a side; BAT_NO_MEMORY
bat_status surface_tessellate(const bat_spline_surface *surface, size_t samples, surface_tessellation *tessellation,
                              bat_error *error);
void tessellation_free(surface_tessellation *tessellation);

#endif

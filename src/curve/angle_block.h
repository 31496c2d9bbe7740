#pragma once

#include "batten/curve.h"

#include "base/lanes.h"

/// @file
/// Vector code of the angle-based schemes on the oriented surfaces that the library made: a short run of vertices, measured
/// and refined in arrays that stay in the first-level cache.

enum
{
    /// Edges refined at a time.
    ANGLE_BLOCK_EDGES = 128,
    /// Exterior angles that the stencil of eq. (9) reaches beyond the block's own vertices: one before, two behind.
    ANGLE_BLOCK_ANGLES = ANGLE_BLOCK_EDGES + 3,
    /// Vertices those angles are made of.
    ANGLE_BLOCK_VERTICES = ANGLE_BLOCK_ANGLES + 2,
};

/// One block. What measures it goes by the entries: angle i lies at vertex i + 1, edge i begins at vertex i. What inserts
/// takes vertex i + 2 for the beginning of edge i, so that the vertices before it are there for its angles.
typedef struct angle_block
{
    double x[ANGLE_BLOCK_VERTICES], y[ANGLE_BLOCK_VERTICES], z[ANGLE_BLOCK_VERTICES];
    double angle[ANGLE_BLOCK_ANGLES];
    double length[ANGLE_BLOCK_VERTICES - 1];
    double slope[ANGLE_BLOCK_EDGES];  ///< tangent of the insertion angle, positive to the left of the edge
    double margin[ANGLE_BLOCK_EDGES]; ///< positive where the new vertex exists
    double new_x[ANGLE_BLOCK_EDGES], new_y[ANGLE_BLOCK_EDGES], new_z[ANGLE_BLOCK_EDGES];
} angle_block;

/// The tangent of an insertion angle, limited to the admissible interval (Ugail and Howard 2026, Theorem 1).
static inline double angle_slope(double insertion)
{
    insertion = insertion > BAT_CURVE_ANGLE_LIMIT ? BAT_CURVE_ANGLE_LIMIT : insertion;
    insertion = insertion < -BAT_CURVE_ANGLE_LIMIT ? -BAT_CURVE_ANGLE_LIMIT : insertion;
    return lane_tan(insertion);
}

/// What differs between the surfaces. `scale` is the kernel's, see there.
typedef struct angle_surface
{
    void (*angles)(angle_block *block, size_t count, double scale);
    void (*lengths)(angle_block *block, size_t count, double scale);
    void (*insert)(angle_block *block, size_t edges);
    bat_status missing; ///< what it means that a new vertex does not exist
} angle_surface;

/// Null for a surface that a user made.
const angle_surface *angle_surface_of(const bat_space *space);

/// Load vertices into the entries from `entry` on.
void angle_block_load(angle_block *block, size_t entry, const double *points, size_t dim, size_t vertices);
/// Write the old vertices in `points` and the new ones in turn.
void angle_block_store(const angle_block *block, const double *points, size_t dim, size_t edges, double *restrict fine);

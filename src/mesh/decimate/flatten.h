#ifndef MESH_DECIMATE_FLATTEN_H
#define MESH_DECIMATE_FLATTEN_H

#include "mesh/decimate/collapse.h"

/// @file
/// Flattening of a ring before and after its collapse onto the same polygon (Liu et al., 2020, section 4.1).
///
/// The points are in the order i, j, the new vertex, vertex[0], vertex[1], ….

enum
{
    FLAT_I,
    FLAT_J,
    FLAT_NEW,
    FLAT_RING,
    FLAT_POINTS = FLAT_RING + COLLAPSE_MAX_FACES + 1,
    /// The unknowns of a flattening: all points except the new vertex.
    FLAT_UNKNOWNS = FLAT_POINTS - 1
};

/// Workspace of one flattening.
typedef struct flat_workspace
{
    /// The lower triangle of the Hermitian matrix of the conformal energy, then of its factor: real and imaginary parts.
    double real[FLAT_UNKNOWNS][FLAT_UNKNOWNS], imaginary[FLAT_UNKNOWNS][FLAT_UNKNOWNS];
    double inverse_pivot[FLAT_UNKNOWNS];
    double right[FLAT_UNKNOWNS][2];
    uint32_t unknown[FLAT_UNKNOWNS]; ///< for each row: its point
} flat_workspace;

/// The points of face k of a ring, before or after the collapse. Vanishing faces come last.
static inline void flat_corners(const collapse_ring *ring, uint32_t face, bool after, uint32_t *corners)
{
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t local = collapse_ring_corner(ring, face, c);
        corners[c] = local < 2 ? (after ? (uint32_t)FLAT_NEW : local) : local + 1;
    }
}

/// Flatten a ring with minimal conformal energy.
///
/// Closed rings, and rings with one end on the boundary, use spectral conformal parameterization (Mullen, Tong, Alliez and
/// Desbrun, 2008). The new vertex then follows by least squares with fixed outer vertices, or lies at a boundary vertex i.
/// Rings of a boundary edge use a least-squares conformal map. Their boundary, from the last vertex through i and j to the
/// first, lies on a line with its lengths; the new vertex lies on that line.
///
/// @param points positions in space
/// @param flat   receives positions in the plane
/// @return false when the equations have no solution
bool flatten_ring(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace, double (*flat)[2]);

/// Whether the flattened ring is a bijection before and after the collapse. All faces must have positive areas, and the
/// angles around the new vertex must add up to a full turn or, on the boundary, to less. The outer polygon is then simple
/// and covered once. After the collapse every face must have the quality `min_quality`, or that of the worst face before.
bool flat_is_valid(const collapse_ring *ring, const double (*flat)[2], double min_quality);

#endif

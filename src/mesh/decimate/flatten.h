#ifndef MESH_DECIMATE_FLATTEN_H
#define MESH_DECIMATE_FLATTEN_H

#include "mesh/decimate/collapse.h"

/// @file
/// A ring in the plane, before and after its edge is collapsed, both covering the same polygon (Liu et al. 2020,
/// section 4.1).
///
/// Points of a ring stand in the order i, j, the vertex that replaces them, vertex[0], vertex[1], ….

enum
{
    FLAT_I,
    FLAT_J,
    FLAT_NEW,
    FLAT_RING,
    FLAT_POINTS = FLAT_RING + COLLAPSE_MAX_FACES + 1,
    /// Unknowns of a flattening: all but the new vertex.
    FLAT_UNKNOWNS = FLAT_POINTS - 1
};

/// Room to work in.
typedef struct flat_workspace
{
    /// The Hermitian matrix of the conformal energy, then its factor; the lower triangle. Real and imaginary parts.
    double real[FLAT_UNKNOWNS][FLAT_UNKNOWNS], imaginary[FLAT_UNKNOWNS][FLAT_UNKNOWNS];
    double inverse_pivot[FLAT_UNKNOWNS];
    double right[FLAT_UNKNOWNS][2];
    uint32_t unknown[FLAT_UNKNOWNS]; ///< the point of a row
} flat_workspace;

/// The points of face k of a ring (in the ring's order, those that vanish last), before the collapse or after it.
static inline void flat_corners(const collapse_ring *ring, uint32_t face, bool after, uint32_t *corners)
{
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t local = collapse_ring_corner(ring, face, c);
        corners[c] = local < 2 ? (after ? (uint32_t)FLAT_NEW : local) : local + 1;
    }
}

/// Flatten a ring with the least conformal energy that a map of fixed size can have. Closed rings, and those of an edge with
/// one end on the boundary: spectral conformal parameterization (Mullen, Tong, Alliez and Desbrun 2008); then the new vertex
/// by least squares with the outside held in place, or where i is, on the boundary. Rings of a boundary edge: least-squares
/// conformal map that lays the boundary from the last vertex over i and j to the first one on a line by its lengths, so that
/// the new vertex can be anywhere between; it is placed by least squares along the line.
///
/// @param points the ring's points in space
/// @param flat   receives its points in the plane
/// @return false where the equations have no solution
bool flatten_ring(const collapse_ring *ring, const double (*points)[3], flat_workspace *workspace, double (*flat)[2]);

/// Whether the flat ring is a bijection before and after the collapse: all faces have a positive area, and around the new
/// vertex angles add up to a full turn or, on the boundary, less. Then the outside is a simple polygon, which faces of
/// positive area can cover only once. And whether every face's quality after the collapse is at least `min_quality` or
/// that of the worst face before.
bool flat_is_valid(const collapse_ring *ring, const double (*flat)[2], double min_quality);

#endif

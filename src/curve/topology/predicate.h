#ifndef CURVE_TOPOLOGY_PREDICATE_H
#define CURVE_TOPOLOGY_PREDICATE_H

#include <stdbool.h>

/// @file
/// Exact predicates of points and geodesic edges. Every answer is that of exact arithmetic on the coordinates as they are
/// stored. A floating-point value with a proven error bound decides most cases; where it cannot, the determinant is summed
/// without rounding, as an expansion (Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
/// Predicates, 1997).
///
/// All three surfaces are one case of the same geometry. A point stands for a vector: (x, y, 1) in the plane, (x, y, z) on
/// the sphere, and (x, y, (1 + x^2 + y^2) / 2) in the disk, which is Klein's model in homogeneous coordinates. A geodesic is
/// the intersection with a plane through the origin, and the orientation of a, b, c is the sign of det[a, b, c].

/// The surfaces that have predicates.
typedef enum surface_kind
{
    SURFACE_PLANE,
    SURFACE_SPHERE, ///< points of the unit sphere in R^3, taken as directions: their lengths do not matter
    SURFACE_DISK    ///< Poincaré's disk
} surface_kind;

/// No product of coordinates may underflow or overflow: a coordinate that is not 0 must lie between 2^-PREDICATE_RANGE of
/// its surface and, in the plane, 2^PREDICATE_RANGE.
#define PREDICATE_RANGE_PLANE 480
#define PREDICATE_RANGE_SPHERE 300
#define PREDICATE_RANGE_DISK 200

/// 1 when a, b, c turn left, -1 when they turn right, 0 when one geodesic contains them. On the sphere left is seen from
/// outside.
int predicate_orientation(surface_kind kind, const double *a, const double *b, const double *c);

/// Whether the edges ab and cd have a point in common, ends included. Both edges have a length.
bool predicate_edges_meet(surface_kind kind, const double *a, const double *b, const double *c, const double *d);

/// Whether the edges ab and bc have more in common than b: they lie on one geodesic and fold back.
bool predicate_folds_back(surface_kind kind, const double *a, const double *b, const double *c);

#endif

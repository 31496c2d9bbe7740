#ifndef CURVE_MAP_SNAP_H
#define CURVE_MAP_SNAP_H

#include "curve/map/chart.h"

/// @file
/// Points of a set of curves that lie nearer to each other than a tolerance, made one.

/// Copies of curves whose points were joined. All zero: empty.
typedef struct snapped_curves
{
    bat_curve *curves; ///< `count`; null when no point had to move, and the given curves serve
    size_t count;
    size_t **origins; ///< of each curve, the given point that each point comes from; of an added one, that before it
    size_t moved;     ///< points that were moved
    size_t added;     ///< vertices that were added to edges
    double largest;   ///< the longest way of a point
} snapped_curves;

/// Points that are nearer than this are the same point in other digits, on the sphere in radians: 1e-10 degrees.
#define SNAP_ROUNDING_SPHERE 1.75e-12
/// The same in the plane and the disk, relative to the largest coordinate.
#define SNAP_ROUNDING_FLAT 4e-15

/// Join points, then points with edges. In the order of the curves each point moves to the nearest of the points before it
/// that is within the tolerance and has not moved itself. Then a point within the tolerance of an edge, which is straight in
/// the chart, becomes a vertex of the edge. This gives two features the same border where one has a vertex and the other has
/// none. Points that follow each other and have become equal are dropped. Curves that would have fewer points than a curve
/// needs stay as they are.
///
/// @param curves    checked curves on the sphere, in the plane or in the disk
/// @param chart     of their space
/// @param tolerance in the unit of the space's distance; 0: only what rounding tells apart is joined
/// @param snapped   release it with snapped_curves_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status snapped_curves_make(const bat_curve *curves, size_t count, const map_chart *chart, double tolerance, int threads,
                               snapped_curves *snapped, bat_error *error);

void snapped_curves_free(snapped_curves *snapped);

#endif

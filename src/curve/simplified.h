#pragma once

#include "batten/curve.h"

/// @file
/// What a simplified line tells of the curve between its points.
///
/// The simplification of Douglas and Peucker leaves out what is nearer to an edge than a tolerance. So the curve stays that
/// near to every edge, however long, and hardly a vertex is nearer to the line between its neighbours. The deviations
///
///     h_i = e_(i-1) e_i / (e_(i-1) + e_i) 2 sin(|d_i| / 2)
///
/// of n vertices with exterior angles d_i begin near the tolerance. Those of other samples of curves begin near 0. With q
/// the deviation that one of 32 is below, and m their median, a line counts as simplified where
///
///     q >= 0.33 m    and    (1 - q / m)^(n / 2) <= 0.02,
///
/// the last being the chance that n / 2 deviations between 0 and m are all above q. Then no edge of more than 1.25 median
/// lengths bends by more than 1.5 q: it is straight. The numbers were chosen with the curves of `reproduce real-curves` and
/// random lines in view.

/// The edges that stay straight.
typedef struct simplified_bound
{
    double length;   ///< they are longer,
    double distance; ///< and would leave their geodesic farther; 0: no edge stays straight
} simplified_bound;

/// Find the bound of a curve in an oriented surface, or that there is none.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status simplified_bound_find(const bat_curve *curve, simplified_bound *bound, bat_error *error);

/// Make edges straight by a bound.
/// @param rows   the curve, or a piece of it: `count` points
/// @param levels of the refinement
/// @param fine   the refined points; those of an edge begin at a multiple of 2^levels rows
/// @return BAT_OK, or what polygon_edge_point() returns, with the edge's index
bat_status simplified_straighten(const simplified_bound *bound, const bat_space *space, const double *rows, size_t count,
                                 bool closed, size_t levels, double *fine, bat_error *error);

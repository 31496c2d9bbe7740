#ifndef CURVE_POLYGON_H
#define CURVE_POLYGON_H

#include "batten/curve.h"

/// How an open polygon goes on beyond its ends; what bat_curve_end_rule and the scheme come down to.
typedef enum polygon_end
{
    POLYGON_END_REFLECT, ///< point reflection in the end point
    POLYGON_END_LINE,    ///< the geodesic through the last two points, evenly spaced
    POLYGON_END_CUBIC,   ///< the cubic through the last four points, in the tangent space of the end point
    POLYGON_END_MIRROR   ///< reflection in the perpendicular bisector of the end edge, which continues circles
} polygon_end;

/// Fill rows -before … -1 and count … count + after - 1 around a polygon of `count` rows of space->point_dim numbers: the
/// points of a closed polygon again, or those that the end rule makes.
/// @return BAT_OK, or the status of the space's function that failed, with the index of the end point
bat_status polygon_extend(const bat_space *space, double *points, size_t count, bool closed, polygon_end end, size_t before,
                          size_t after, bat_error *error);

#endif

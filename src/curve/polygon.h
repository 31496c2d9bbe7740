#pragma once

#include "batten/curve.h"

/// How an open polygon goes on beyond its ends; what bat_curve_end_rule and the scheme come down to.
typedef enum polygon_end
{
    POLYGON_END_REFLECT, ///< point reflection in the end point
    POLYGON_END_LINE,    ///< the geodesic through the last two points, evenly spaced
    POLYGON_END_CUBIC,   ///< the cubic through the last four points, in the tangent space of the end point
    POLYGON_END_MIRROR   ///< reflection in the perpendicular bisector of the end edge, which continues circles
} polygon_end;

/// A curve like another with room for `count` rows, and for flags of corners, none set.
/// @param made release it with bat_curve_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status curve_room(const bat_curve *like, size_t count, bool corners, bat_curve *made, bat_error *error);
/// Release an array of curves, which may be null.
void curves_free(bat_curve *curves, size_t count);
/// Copy a row of a curve, also within a curve. The flag of a corner goes along where there is room for it.
void curve_copy_row(const bat_curve *from, size_t i, bat_curve *to, size_t row);

/// A point of a curve.
static inline const double *curve_point(const bat_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

/// The edges of a polygon of `count` points, at least one.
static inline size_t polygon_edges(size_t count, bool closed)
{
    return closed ? count : count - 1;
}

/// The point at share k / parts of the edge from p to q, from the nearer end, so that reversal changes nothing.
/// @return BAT_OK, or what bat_space_geodesic() returns
bat_status polygon_edge_point(const bat_space *space, const double *p, const double *q, size_t k, size_t parts,
                              double *point);

/// The unsigned exterior angle at `p` in any space, in [0, pi]: between -log(before) and log(after), of any lengths.
/// @return BAT_OK, or what the logarithms return
bat_status polygon_exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                  double *angle);

/// The value at `-at` of the polynomial through rows at parameters, in the tangent space of the first.
/// @param end    the first row; the others lie at multiples of `step` numbers from it
/// @param knots  degree + 1 parameters; the first is 0
/// @param row    receives the value
/// @return BAT_OK, or what the space's functions return
bat_status polygon_value_beyond(const bat_space *space, const double *end, ptrdiff_t step, const double *knots,
                                size_t degree, double at, double *row);

/// Fill rows -before … -1 and count … count + after - 1 around a polygon of `count` rows of space->point_dim numbers: the
/// points of a closed polygon again, or those that the end rule makes.
/// @return BAT_OK, or the status of the space's function that failed, with the index of the end point
bat_status polygon_extend(const bat_space *space, double *points, size_t count, bool closed, polygon_end end, size_t before,
                          size_t after, bat_error *error);

/// How the distance of a point from an edge is computed.
typedef enum edge_geometry
{
    GEOMETRY_ANY,
    GEOMETRY_FLAT,
    GEOMETRY_SPHERE ///< the sphere in R^3
} edge_geometry;

edge_geometry polygon_geometry_of(const bat_space *space);

/// The distance of a point from the geodesic from p to q; in other spaces than R^n and S^2 from its foot in the tangent
/// space at p, which is never nearer.
double polygon_edge_distance(const bat_space *space, edge_geometry geometry, const double *p, const double *q,
                             const double *point);

/// Check that the differences of a curve's coordinates can be taken: none is beyond DBL_MAX / 2, infinite or NaN.
/// @param which "first", "second", …, for the message
/// @return BAT_OK or BAT_INVALID_POINT with the point's index
bat_status coordinates_check(const bat_curve *curve, const char *which, bat_error *error);

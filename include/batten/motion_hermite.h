#ifndef BATTEN_MOTION_HERMITE_H
#define BATTEN_MOTION_HERMITE_H

#include "batten/curve.h"
#include "batten/space.h"

BAT_C_BEGIN

/// @file
/// Curves through points with tangents, in any space: averages, refinement, sampling at times, estimated tangents.
/// `docs/algorithms/hermite-schemes.md` explains the mathematics and which of the schemes to use when.
///
/// Conventions are those of the space: quaternions are (w, x, y, z); tangents of bat_rotation() are rotation vectors in the
/// body's frame, as velocities in radians a unit of time; those of bat_rigid() are the velocity in the fixed frame and then
/// the angular velocity in the body's. Rigid motions are the product of R^3 and rotations, not screw motions.
///
/// A space of a user needs all functions that are not optional: bat_space_check() and the calls here name the first that is
/// missing.

/// The largest sum of the two angles between an edge and the tangents at its ends: the bound of condition (3.4) of Ben-Zion
/// Vardi, Dyn and Sharon, 0.1 below 2 pi.
#define BAT_HERMITE_ANGLE_LIMIT 6.18318530717958647693
/// The largest deviation of a direction's length from 1, and of a tangent from its tangent space, relative to its length.
#define BAT_HERMITE_TANGENT_TOLERANCE 1e-9

/// What the tangents of a curve are. Calls that make tangents state it; calls that need velocities refuse directions.
typedef enum bat_hermite_tangents
{
    BAT_HERMITE_TANGENTS_AUTO,             ///< not stated: taken for what a call needs
    BAT_HERMITE_TANGENTS_DIRECTIONS,       ///< unit vectors, without a speed
    BAT_HERMITE_TANGENTS_VELOCITIES,       ///< derivatives by time; without times, points are at 0, 1, 2, …
    BAT_HERMITE_TANGENTS_INDEX_DERIVATIVES ///< derivatives by the index of the points, also where there are times
} bat_hermite_tangents;

/// Points with tangents, and optionally times. Tangents are *directions* of unit length where only the shape matters, else
/// *derivatives* of any length: velocities where there are times, else derivatives by the index.
typedef struct bat_hermite_curve
{
    const bat_space *space; ///< where the points live; never null; must outlive the curve
    double *points;         ///< count x point_dim, row-major
    double *tangents;       ///< count x tangent_dim, row-major
    double *times;          ///< count increasing numbers; may be null
    size_t count;
    bool closed;               ///< the last point joins the first
    double closing_time;       ///< closed curves with times: how long it takes from the last point to the first
    bat_hermite_tangents kind; ///< what `tangents` are; 0 is BAT_HERMITE_TANGENTS_AUTO
} bat_hermite_curve;

/// Free what the library allocated for a curve and make it empty. Does nothing to a curve that is empty already.
BAT_API void bat_hermite_free(bat_hermite_curve *curve);

/// Check a curve: a space with all functions, at least 2 points (3 when closed), each in its space, with one shortest
/// geodesic to the next. Tangents are finite and in the tangent space, times finite and increasing. Neighbours may be equal,
/// as where a motion rests.
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT or BAT_CUT_LOCUS, with the index of the first failing point
BAT_API bat_status bat_hermite_check(const bat_hermite_curve *curve, bat_error *error);

/// Bring all tangents to unit length; they are BAT_HERMITE_TANGENTS_DIRECTIONS then.
/// @return BAT_OK, BAT_INVALID_ARGUMENT (the space lacks a function), or BAT_INVALID_POINT with the first tangent that is
/// zero or not finite; those before it are done
BAT_API bat_status bat_hermite_normalize(bat_hermite_curve *curve, bat_error *error);

/// The highest order of the Lane-Riesenfeld schemes: the highest that is published. Each order averages once more, over
/// points ever farther away.
#define BAT_HERMITE_MAX_ORDER 10

/// Options of refinement. Begin with bat_hermite_refine_defaults().
typedef struct bat_hermite_refine_options
{
    size_t order;          ///< 1 … BAT_HERMITE_MAX_ORDER; 1 keeps the given points and tangents; default 1
    size_t levels;         ///< 0 to 60; each doubles the number of edges; default 5
    size_t max_points;     ///< refuse larger results with BAT_TOO_LARGE; default BAT_MAX_POINTS
    int threads;           ///< 0 to 1024; 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress; ///< default: none
} bat_hermite_refine_options;

/// The options' default values.
BAT_API bat_hermite_refine_options bat_hermite_refine_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_hermite_refine_fields;

/// Refine Hermite data by repeated subdivision.
///
/// Algorithm 4 of Ben-Zion Vardi, Dyn and Sharon, with the averages of their algorithm 3 at 1/2. Order 1 interpolates with
/// fourth-order accuracy.
///
/// Old point i becomes new point i 2^levels where the order is odd. A closed curve gets count 2^levels points, an open one
/// (count - 1) 2^levels + 1. Even orders give two new points on every edge instead; an open curve then gets its ends back,
/// (count - 1) 2^levels + 2 points in all. Open curves are continued by geodesic point reflection, with transported
/// tangents. Times are averaged as the points of a linear scheme are. For a curve through given points at given times, use
/// bat_motion_spline_make().
///
///
/// @param options null for the defaults
/// @param fine    receives the refined curve; release it with bat_hermite_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS, BAT_TOO_LARGE, BAT_NO_MEMORY or BAT_CANCELLED;
///         `fine` is untouched on failure
BAT_API bat_status bat_hermite_refine(const bat_hermite_curve *coarse, const bat_hermite_refine_options *options,
                                      bat_hermite_curve *fine, bat_error *error);

/// Estimate tangents from the points: the derivative at each point of the polynomial through its neighbours' logarithms
/// there. It uses `order` + 1 points, fewer on shorter curves, as evenly to both sides as possible. With times: velocities,
/// with an error of the `order`th power of the spacing, however uneven. Without times: directions of the same accuracy.
/// Their parameter is geodesic distance along the polygon, for order 4 corrected by the ratio of arc and chord.
///
/// Order 2 is Bessel's parabola, for data with noise or corners. Order 4 has the accuracy of the fourth-order schemes.
///
/// @param curve its tangents are overwritten; the array must exist
/// @param order 2 or 4
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with a point that repeats its neighbour or where a curve without
///         times turns back on itself; BAT_CUT_LOCUS with a point whose neighbours have no unique logarithm; BAT_NO_MEMORY;
///         the tangents are undefined on failure
BAT_API bat_status bat_hermite_estimate_tangents(bat_hermite_curve *curve, size_t order, bat_error *error);

BAT_C_END

#endif

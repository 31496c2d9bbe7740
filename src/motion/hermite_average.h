#pragma once

#include "batten/motion_hermite.h"
#include "curve/kernel.h"

/// The checks beyond those of single points, tangents and times.
typedef struct hermite_check_parts
{
    bool unit;  ///< tangents are of unit length
    bool edges; ///< neighbours are within reach of each other
    /// and distinct, and their pairs admissible (definition 3.2 of Ben-Zion Vardi, Dyn and Sharon): the angles of an edge
    /// with its tangents sum to at most BAT_HERMITE_ANGLE_LIMIT
    bool admissible;
} hermite_check_parts;

static inline const double *hermite_point(const bat_hermite_curve *curve, size_t index)
{
    return curve->points + index * curve->space->point_dim;
}

static inline double *hermite_tangent(const bat_hermite_curve *curve, size_t index)
{
    return curve->tangents + index * curve->space->tangent_dim;
}

/// Arrays of a curve's count; release them with bat_hermite_free(), also after a failure.
bat_status hermite_allocate(bat_hermite_curve *curve, bool timed, bat_error *error);
/// Whether there are points enough, and tangents.
bat_status hermite_check_counts(const bat_hermite_curve *curve, bat_error *error);

/// bat_hermite_check() of parts. The fault found is the first, whatever the number of threads.
bat_status hermite_check(const bat_hermite_curve *curve, hermite_check_parts parts, int threads, bat_error *error);

/// Whether the tangents of a curve may be velocities: they are not stated to be directions.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status hermite_check_velocities(const bat_hermite_curve *curve, bat_error *error);

/// The edge of a pair of Hermite data as the average sees it.
typedef struct hermite_edge
{
    double length;           ///< geodesic distance
    double half_turn_cosine; ///< cos((theta_0 + theta_1) / 2) with the angles of eq. (3.7)
    double reach;            ///< alpha of eq. (3.6): how far along the tangents the inner control points lie
} hermite_edge;

/// Measure an edge between distinct points.
/// @return BAT_OK, BAT_CUT_LOCUS (nothing is measured), or BAT_INVALID_POINT when the points coincide (then the length is 0)
/// or
///         the pair is not admissible (then all is measured)
bat_status hermite_edge_measure(const bat_space *space, const double *p0, const double *v0, const double *p1,
                                const double *v1, hermite_edge *edge);

/// Algorithm 3, the manifold-Hermite De Casteljau average, of unit directions at points that differ: a point and a direction
/// at share `weight` of the cubic.
/// @return BAT_OK, BAT_CUT_LOCUS or BAT_INVALID_POINT
bat_status hermite_average(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                           double weight, double *point, double *direction);

/// Rows of a point, a direction and, where the kernel is timed, a time: averages at 1/2.
row_average hermite_row_average;

/// bat_hermite_refine() by another step: a linear one of derivatives by the index, on rows of a point, a derivative and,
/// where there are times, a time. Null: averages of directions.
bat_status hermite_refine_by(const bat_hermite_curve *coarse, const bat_hermite_refine_options *options,
                             const refine_kernel *linear, bat_hermite_curve *fine, bat_error *error);

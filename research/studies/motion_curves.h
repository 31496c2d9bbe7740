#ifndef RESEARCH_STUDIES_MOTION_CURVES_H
#define RESEARCH_STUDIES_MOTION_CURVES_H

#include "batten/research/motion_study.h"

/// @file
/// Tools to measure the claims about Hermite schemes on manifolds: smooth test curves, samples of them, distances of refined
/// curves, and the comparison of geodesic and Bezier averages.

typedef struct study_curve study_curve;

/// A smooth curve; closed ones have period 2 pi. Without `form`, the curve is t -> exp_c(r (cos t a_0 + 0.8 sin t a_1 + 0.3
/// sin 2t a_2)), with orthonormal a_0, a_1 and, if the dimension allows, a_2 (else a_0).
struct study_curve
{
    const bat_space *space;
    bat_status (*form)(const study_curve *curve, double t, double *point); ///< the point at t, or null
    const double *data;                                                    ///< argument of `form`
    double radius;
    double *centre;  ///< point_dim numbers
    double *axes[3]; ///< tangent_dim numbers each
};

/// A curve about a random centre along random axes. Release it with study_curve_free().
/// @return BAT_OK, BAT_UNSUPPORTED for a space of dimension 1, BAT_NO_MEMORY, or what the space's functions return
bat_status study_curve_make(const bat_space *space, double radius, uint64_t seed, study_curve *curve, bat_error *error);
void study_curve_free(study_curve *curve);

bat_status study_curve_point(const study_curve *curve, double t, double *point);
/// The derivative with respect to t by finite differences, accurate to about 1e-12.
bat_status study_curve_velocity(const study_curve *curve, double t, const double *point, double *velocity);

/// Sample the curve at `count` parameters, with velocities; the parameters are the times. The closing time completes a
/// period. Release the result with bat_hermite_free().
bat_status study_curve_sample(const study_curve *curve, const double *parameters, size_t count, bool closed,
                              bat_hermite_curve *samples, bat_error *error);

/// The distance of a point from the curve, by Newton's method from the parameter `start`: the minimum over the iterates.
bat_status study_curve_distance(const study_curve *curve, const double *point, double start, double *distance);

/// The largest distance of the points of a refined curve from the curve, with the points' times as start parameters.
bat_status study_curve_error(const study_curve *curve, const bat_hermite_curve *fine, double *largest);

/// The setting of a measurement.
typedef struct study_setup
{
    size_t count;
    bool closed;       ///< samples over the whole period, else over half of it
    double unevenness; ///< delay of every second sample, as a fraction of the mean spacing: 0 … 0.9
    bool estimated;    ///< directions estimated from the points (order 4) instead of the exact ones
    const bat_hermite_refine_options *options;
    const bat_hermite_linear *linear; ///< receives derivatives by the index; null: averages
} study_setup;

/// The largest distance of the refined curve from the smooth curve of its samples.
bat_status study_refinement_error(const study_curve *curve, const study_setup *setup, double *largest, bat_error *error);

/// Delta of eq. (4.1): the longest edge.
double study_longest_edge(const bat_hermite_curve *curve);

/// The displacement of eq. (4.3): the largest distance between new point 2 i and old point i after one level.
double study_displacement(const bat_hermite_curve *coarse, const bat_hermite_curve *fine);

/// Differences between the average in an isometrically embedded space and the Bezier average of the same data in the ambient
/// space.
typedef struct study_proximity
{
    double length; ///< d, the geodesic distance of the pair
    double point;  ///< |q - b| of Lemma 3.7 and eq. (4.7)
    double angle;  ///< the largest of the four differences of angles of eq. (4.8)
} study_proximity;

/// Compare both averages of a pair at weight 1/2.
/// @return BAT_OK, BAT_UNSUPPORTED where tangent vectors are not stored in the coordinates of points, or what
///         bat_hermite_average() returns
bat_status study_proximity_of(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                              study_proximity *proximity);

#endif

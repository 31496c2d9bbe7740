#ifndef RESEARCH_STUDIES_MOTION_CURVES_H
#define RESEARCH_STUDIES_MOTION_CURVES_H

#include "batten/motion_hermite.h"

/// @file
/// What the claims about Hermite schemes are measured with: a smooth curve in any space, samples of it, and how far a
/// refined curve lies from it.

typedef struct study_curve study_curve;

/// A smooth curve; closed ones have period 2 pi. With `form` null t -> exp_c(r (cos t a_0 + 0.8 sin t a_1 + 0.3 sin 2t
/// a_2)), with orthonormal a_0, a_1 and, where the dimension allows, a_2 (else a_0).
struct study_curve
{
    const bat_space *space;
    bat_status (*form)(const study_curve *curve, double t, double *point); ///< the point at t, or null
    const double *data;                                                    ///< whatever `form` needs
    double radius;
    double *centre;  ///< point_dim numbers
    double *axes[3]; ///< tangent_dim numbers each
};

/// A curve about a random centre along random axes. Release it with study_curve_free().
/// @return BAT_OK, BAT_UNSUPPORTED for a space of dimension 1, BAT_NO_MEMORY, or what the space's functions return
bat_status study_curve_make(const bat_space *space, double radius, uint64_t seed, study_curve *curve, bat_error *error);
void study_curve_free(study_curve *curve);

bat_status study_curve_point(const study_curve *curve, double t, double *point);
/// The derivative by t at a point, from differences: accurate to about 1e-12.
bat_status study_curve_velocity(const study_curve *curve, double t, const double *point, double *velocity);

/// Points of the curve at `count` parameters, with velocities and the parameters as times. The closing time makes a period
/// whole. Release it with bat_hermite_free().
bat_status study_curve_sample(const study_curve *curve, const double *parameters, size_t count, bool closed,
                              bat_hermite_curve *samples, bat_error *error);

/// The distance of a point from the curve, sought from the parameter `start` on by Newton's steps: the least seen.
bat_status study_curve_distance(const study_curve *curve, const double *point, double start, double *distance);

/// The largest distance of a refined curve's points from the curve, sought from the points' times on.
bat_status study_curve_error(const study_curve *curve, const bat_hermite_curve *fine, double *largest);

/// What a refinement is measured on.
typedef struct study_setup
{
    size_t count;
    bool closed;                        ///< all around the curve, else along half of it
    double unevenness;                  ///< every second sample comes this share of the mean spacing late: 0 … 0.9
    bool estimated;                     ///< directions from the points alone (order 4), not the curve's own
    const bat_hermite_options *options; ///< linear Hermite schemes are given derivatives by the index
} study_setup;

/// The largest distance of a refined curve from the smooth one that its data are sampled from.
bat_status study_refinement_error(const study_curve *curve, const study_setup *setup, double *largest, bat_error *error);

/// Delta of eq. (4.1): the longest edge.
double study_longest_edge(const bat_hermite_curve *curve);

/// The largest distance of new point 2 i from old point i, eq. (4.3), after one level.
double study_displacement(const bat_hermite_curve *coarse, const bat_hermite_curve *fine);

/// How far the average in a space that its coordinates embed isometrically is from the Bezier average of the same arrays in
/// the space around it.
typedef struct study_proximity
{
    double length; ///< d, the geodesic distance of the pair
    double point;  ///< |q - b| of Lemma 3.7 and eq. (4.7)
    double angle;  ///< the largest of the four differences of angles of eq. (4.8)
} study_proximity;

/// Both averages at 1/2 of a pair, compared.
/// @return BAT_OK, BAT_UNSUPPORTED where tangent vectors are not stored in the coordinates of points, or what
///         bat_hermite_average() returns
bat_status study_proximity_of(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                              study_proximity *proximity);

#endif

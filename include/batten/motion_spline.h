#ifndef BATTEN_MOTION_SPLINE_H
#define BATTEN_MOTION_SPLINE_H

#include "batten/motion_hermite.h"

BAT_C_BEGIN

/// @file
/// Splines in time on manifolds: the motion through keys at their times, with continuous velocity and acceleration, and its
/// point, velocity and acceleration at any time. `docs/algorithms/motion-splines.md` derives the method.
///
/// Conventions are those of the space: quaternions are (w, x, y, z); velocities of bat_rotation() are angular velocities in
/// the body's frame, in radians a unit of time; those of bat_rigid() are the velocity in the fixed frame and then the
/// angular velocity in the body's. Rigid motions are the product of R^3 and rotations, not screw motions.

/// What holds at the two ends of an open motion.
typedef enum bat_motion_ends
{
    BAT_MOTION_ENDS_AUTO,       ///< by how the acceleration changes from key to key, as measured best: not-a-knot where
                                ///< slowly, natural where faster (in R^n not-a-knot), else the mean velocity of the
                                ///< interval
    BAT_MOTION_ENDS_NOT_A_KNOT, ///< the first two intervals share one cubic, and so do the last two
    BAT_MOTION_ENDS_NATURAL,    ///< the acceleration is 0
    BAT_MOTION_ENDS_CLAMPED     ///< the velocity is given, or 0
} bat_motion_ends;

/// How velocities at the keys are chosen where none are given.
typedef enum bat_motion_shape
{
    BAT_MOTION_SHAPE_AUTO,    ///< the default: BAT_MOTION_SHAPE_RESTING
    BAT_MOTION_SHAPE_RESTING, ///< equal neighbouring keys make a constant motion, and velocities next to it are limited;
                              ///< else twice continuously differentiable
    BAT_MOTION_SHAPE_SMOOTH,  ///< twice continuously differentiable everywhere; overshoots where keys rest
    BAT_MOTION_SHAPE_LIMITED  ///< velocities limited as Fritsch and Carlson (1980) do: monotone along every geodesic between
                              ///< neighbours; once continuously differentiable
} bat_motion_shape;

/// The ends and the shapes by name.
extern BAT_API const bat_family bat_motion_ends_family, bat_motion_shape_family;

/// The constants of Huber's and of Tukey's rule, in units of sigma: 95 per cent of the efficiency of least squares for
/// normal noise (Holland and Welsch, Robust regression using iteratively reweighted least-squares, 1977).
#define BAT_MOTION_HUBER 1.345
#define BAT_MOTION_TUKEY 4.685

/// For `sigma`: the noise is estimated, by generalized cross-validation.
#define BAT_MOTION_SIGMA_AUTO (-1.0)

/// What noisy keys far from a smoothed motion count.
typedef enum bat_motion_outliers
{
    BAT_MOTION_OUTLIERS_NONE,  ///< no rule: as much as all others
    BAT_MOTION_OUTLIERS_HUBER, ///< their residuals count by the distance, not by its square (Huber 1964), from 1.345 sigma
                               ///< on
    BAT_MOTION_OUTLIERS_TUKEY  ///< nothing from 4.685 sigma on (Tukey's biweight), beginning with Huber's solution
} bat_motion_outliers;

/// The rules for outliers by name.
extern BAT_API const bat_family bat_motion_outliers_family;

/// Angular rates of a gyroscope that turns with the body, in its frame, in radians a unit of time.
typedef struct bat_motion_gyro
{
    const double *times; ///< count, increasing, over the time of the keys
    const double *rates; ///< count x 3
    size_t count;
    const double *forces; ///< count x 3: of an accelerometer beside it, in the same frame, in units of length a squared unit
                          ///< of time; for rigid motions, whose origin it is at; null: none
} bat_motion_gyro;

/// What keys and a gyroscope tell of each other.
typedef struct bat_motion_gyro_report
{
    double bias[3];       ///< what the rates are too great by, all the time
    double bias_sigma[3]; ///< its standard deviations
    double walk;          ///< the noise of the integrated rates about an axis, in radians a root of time
    double sigma;         ///< the noise of the keys' rotations, given or estimated
} bat_motion_gyro_report;

/// What keys and an accelerometer tell of each other. It measures R^T (acceleration - gravity) + bias, R being the rotation.
typedef struct bat_motion_force_report
{
    double bias[3], bias_sigma[3]; ///< all the time the same, with its standard deviations, as if rotations were exact
    double gravity[3];             ///< in the fixed frame
    double noise;                  ///< of the acceleration, in its unit and a root of time
    double explained;              ///< the share of the energy of the keys' accelerations that the forces tell
    bool used;                     ///< by the motion: at least half of it
} bat_motion_force_report;

/// Options of splines. Begin with bat_motion_spline_defaults().
typedef struct bat_motion_spline_options
{
    bat_motion_ends ends;         ///< of open motions; default BAT_MOTION_ENDS_AUTO. Closed motions are periodic
    bat_motion_shape shape;       ///< default BAT_MOTION_SHAPE_RESTING
    const double *begin_velocity; ///< clamped: the velocity at the first key; null: 0; default null
    const double *end_velocity;   ///< clamped: the velocity at the last key; null: 0; default null
    /// The noise of keys, the root mean square of their distances from the truth. The spline passes near the keys, with the
    /// penalty on the squared acceleration that has the least expected error. In R^n, and of
    /// translations of rigid motions, in units of length; of rotations, in radians. BAT_MOTION_SIGMA_AUTO: what the keys
    /// tell, which is none for fewer than 12. 0: through the keys; default 0. Not for closed motions and for given
    /// velocities; ends are natural where they are automatic.
    double sigma;
    double angle_sigma; ///< of the rotations of rigid motions, in radians; default 0
    /// Rotations and rigid motions: count - 1 rows, of closed motions count, of 3 numbers: about how the body turns from
    /// each key to the next, as a rotation vector in its frame. The motion takes the nearest of all ways there, so that half
    /// a turn and more are known. NaN: by velocities where both keys have them, else the shortest way. Null: NaN; default
    /// null
    const double *turns;
    /// Open motions of rotations or rigid motions, 6 keys at least: the rates between the keys, which have noise and an
    /// unknown constant bias, fused with the keys' rotations, whose noise is `angle_sigma`, or `sigma` for rotations alone;
    /// 0 or automatic: what both tell. The spline has keys at the times of the rates, too. Translations follow an
    /// accelerometer between the keys: what is left is a spline with `sigma`. Null: none; default null
    const bat_motion_gyro *gyro;
    bat_motion_outliers outliers; ///< with sigma, of translations with a gyroscope; default BAT_MOTION_OUTLIERS_NONE
    /// Limits of the length of velocities and accelerations; 0: none. The motion gets new times then: the fastest ones along
    /// its path within the limits (time-optimal path parameterization: Pham and Pham 2018). Open motions begin and end at
    /// rest where accelerations are limited. What rests, or moves without a limit, keeps its duration at least. Of rigid
    /// motions `max_speed` and `max_acceleration` are of the translation; default 0
    double max_speed, max_acceleration;
    double max_angular_speed, max_angular_acceleration; ///< of the rotations of rigid motions, in radians; default 0
    bool extrapolate; ///< go on outside of the keys' times along the geodesic, with constant velocity; default false
    int threads; ///< of bat_motion_spline_sample(), 0 to 1024; 0: as many as are worth it; no effect on results; default 0
} bat_motion_spline_options;

/// The options' default values.
BAT_API bat_motion_spline_options bat_motion_spline_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_motion_spline_fields;

/// A spline prepared for evaluation. It never changes, so that threads may share it.
typedef struct bat_motion_spline bat_motion_spline;

/// Make the spline through keys at their times. On the interval between two keys it is the exponential, at the middle of
/// their shortest geodesic, of a cubic polynomial. Without given velocities those at the keys solve a system that makes
/// (covariant) accelerations continuous; the error against a smooth motion is O(h^4). With given velocities the spline takes
/// them, and accelerations jump; less so in R^n, where the polynomial then has degree 5. Reversing time reverses the motion.
/// Factors of a product have splines of their own, so do translations and rotations of bat_rigid(). Tensors have the cubic
/// spline of their logarithms, which exists for all keys.
///
/// For rotations this is the construction of Kang and Park (Cubic spline algorithms for orientation interpolation, 1999) and
/// of scipy's RotationSpline, moved from the beginning of the interval to its middle. In R^n it is the cubic spline.
///
/// With `sigma` the motion passes near the keys instead: in R^n it is Reinsch's smoothing spline (1967). Each coordinate has
/// a penalty of its own, which is lower where the motion accelerates more.
///
/// With limits of speed or acceleration all times of the spline are new ones, from the first key's time on.
///
/// @param keys    at least 2 points (3 when closed); `tangents` are velocities, or null for none. Those of a factor are
///                unknown at a key where all of their numbers are NaN. Without times the keys are at 0, 1, 2, .... The space
///                must outlive the spline, the arrays need not
/// @param options null for the defaults
/// @param spline  receives the spline; release it with bat_motion_spline_free()
/// @return BAT_OK; the failures of bat_hermite_check(); BAT_INVALID_POINT with the key near which the space has no
///         exponential; BAT_NO_CONVERGENCE where keys are too far apart for continuous accelerations; BAT_NO_MEMORY;
///         BAT_UNSUPPORTED for `sigma` in other spaces than R^n, rotations and rigid motions; `spline` is untouched on
///         failure
BAT_API bat_status bat_motion_spline_make(const bat_hermite_curve *keys, const bat_motion_spline_options *options,
                                          bat_motion_spline **spline, bat_error *error);
/// Does nothing for null.
BAT_API void bat_motion_spline_free(bat_motion_spline *spline);

/// The keys of a spline. The arrays belong to it.
typedef struct bat_motion_keys
{
    const bat_space *space;
    size_t count;
    double begin, end;        ///< the time of the first key, and of the last; of a closed motion the end of its first period
    const double *times;      ///< count; the new ones where there are limits
    const double *points;     ///< count x point_dim: the keys themselves, but for smoothing and the signs of quaternions
    const double *velocities; ///< count x tangent_dim
    /// The distances of the given keys from a smoothed motion in units of sigma; of rigid motions the larger of the
    /// distances of translations and of rotations. Zeros where nothing was smoothed.
    const double *deviations;
    /// count x tangent_dim: the standard deviations of the smoothed keys, by the noise and the penalty as a prior (Wahba
    /// 1983); of rotations in radians about the axes. Zeros where nothing was smoothed.
    const double *uncertainties;
    double sigma, angle_sigma; ///< the noise that was given or estimated
    /// Intervals far shorter than those beside them, with a far greater or smaller speed, whose keys have the velocity of
    /// the motion around both; acceleration jumps there. Counted for each factor. 0 for BAT_MOTION_SHAPE_SMOOTH.
    size_t held;
    bat_motion_gyro_report gyro;   ///< zeros without a gyroscope
    size_t turned;                 ///< intervals whose rotations go another way than the shortest
    bat_motion_force_report force; ///< zeros without an accelerometer
} bat_motion_keys;

/// What a spline holds, valid until bat_motion_spline_free().
BAT_API bat_motion_keys bat_motion_spline_keys(const bat_motion_spline *spline);

/// The motion at a time, in O(log keys) at most. At the time of a key, the key, bit for bit but for the sign of quaternions,
/// which do not jump along the motion.
///
/// @param time         within the times of bat_motion_spline_keys(), unless the motion is closed or extrapolates
/// @param point        receives point_dim numbers
/// @param velocity     receives tangent_dim numbers; may be null
/// @param acceleration receives tangent_dim numbers, the covariant derivative of the velocity: for rotations the derivative
///                     of the angular velocity in the body's frame; may be null. At a key that of the interval after it.
///                     For spaces of a user, derivatives are differences, accurate to about 1e-9 of the largest
/// @return BAT_OK; BAT_INVALID_ARGUMENT with a text that tells the time and the range; BAT_CUT_LOCUS or BAT_INVALID_POINT
///         where the motion leaves the space
BAT_API bat_status bat_motion_spline_at(const bat_motion_spline *spline, double time, double *point, double *velocity,
                                        double *acceleration, bat_error *error);

/// The motion at many times: bat_motion_spline_at() of each, faster, and fastest for increasing times.
///
/// @param times         in any order
/// @param points        receives count x point_dim numbers; velocities and accelerations, count x tangent_dim, may be null
/// @return as bat_motion_spline_at(), with the index of the first failing time; the results are undefined then
BAT_API bat_status bat_motion_spline_sample(const bat_motion_spline *spline, const double *times, size_t count,
                                            double *points, double *velocities, double *accelerations, bat_error *error);

/// The standard deviations of a smoothed motion: between keys those of the keys, and what the penalty as a prior lets the
/// motion wander. Covariances beside them are 0.
///
/// @param times      within the times of bat_motion_spline_keys()
/// @param deviations receives count x tangent_dim numbers; zeros where nothing was smoothed
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with the index of the first failing time
BAT_API bat_status bat_motion_spline_uncertainty(const bat_motion_spline *spline, const double *times, size_t count,
                                                 double *deviations, bat_error *error);

BAT_C_END

#endif

#pragma once

#include "base/memory.h"
#include "batten/motion_spline.h"
#include "batten/space.h"

/// @file
/// One interval of a spline in one factor of a space: exp_m(c(s)), with a cubic c in the tangent space at m, the middle of
/// the shortest geodesic between two keys. Needs the differential of exp_m, its inverse, and the covariant acceleration.

/// How derivatives are computed.
typedef enum factor_kind
{
    FACTOR_FLAT,     ///< R^n: m is the first key, and exp the sum
    FACTOR_ROTATION, ///< by the right Jacobian of SO(3)
    FACTOR_CURVED,   ///< constant curvature: by Jacobi fields in closed form
    FACTOR_TENSOR,   ///< positive definite matrices: m is the identity; by the derivative of the matrix exponential
    FACTOR_ANY       ///< by differences
} factor_kind;

/// A factor of a space, and where its numbers are.
typedef struct spline_factor
{
    factor_kind kind;
    bat_space space;
    double curvature;  ///< FACTOR_CURVED: 1 or -1
    size_t point_at;   ///< place in a point of the whole space
    size_t tangent_at; ///< place in a tangent vector of the whole space
    size_t record_at;  ///< place in an interval's record
    bool quintic;      ///< FACTOR_FLAT, with all velocities given: c has degree 5
} spline_factor;

/// A curve in a tangent space at one parameter: its value and its first three derivatives.
typedef struct tangent_jet
{
    const double *value, *first, *second, *third;
} tangent_jet;

/// The functions of x = |c|^2 in the right Jacobian of SO(3), I - a [c] + b [c]^2.
typedef struct spline_turning
{
    double a, b;             ///< (1 - cos r) / r^2, (r - sin r) / r^3
    double a_slope, b_slope; ///< their derivatives by x, times 2
    double inverse;          ///< the inverse is I + [c] / 2 + inverse [c]^2
} spline_turning;

/// For FACTOR_ROTATION.
spline_turning spline_turning_of(double x);

/// Divide a space into factors, at most `limit`. Products and rigid motions are divided, others are one factor.
/// @return the number of factors; 0 when there are more
size_t spline_factors(const bat_space *space, spline_factor *factors, size_t limit);

/// The numbers of an interval: m, and the coefficients of the powers of s in c. FACTOR_FLAT has no m, but a constant.
size_t spline_factor_record_size(const spline_factor *f);

/// The middle m of two keys, or of the way from p to q that is not the shortest, and their logarithms there.
///
/// @param way of rotations: the rotation vector of the way; NaN, or null: the shortest
bat_status spline_middle(const spline_factor *f, const double *p, const double *q, const double *way, double *middle,
                         double *log_p, double *log_q);

/// Rotate v by the rotation vector e.
void spline_rotate(const double *e, const double *v, double *rotated);

/// The inverse of the differential of exp_m at c, of a vector; `q` is exp_m(c). `turning` is that of c, for FACTOR_ROTATION.
/// `pulled` is an approximation first, where derivatives are differences: each call improves it.
bat_status spline_pull(const spline_factor *f, const double *middle, const double *c, const double *q, const double *vector,
                       const spline_turning *turning, double *pulled);
/// The covariant acceleration of exp_m(c(s)) at q = exp_m(c); `turning` as before.
bat_status spline_acceleration(const spline_factor *f, const double *middle, const tangent_jet *c, const double *q,
                               const spline_turning *turning, double *acceleration);

/// Point, velocity and acceleration (null where not wanted) of an interval at `share`, with derivatives by the share.
bat_status spline_factor_at(const spline_factor *f, const double *record, double share, double *point, double *velocity,
                            double *acceleration);

/// The most shares of spline_factor_run().
#define SPLINE_RUN 64

/// Points of one interval at `count` shares, `stride` numbers apart.
bat_status spline_factor_run(const spline_factor *f, const double *record, const double *shares, size_t count,
                             double *points, size_t stride);
/// The same for places in several intervals, whose records are `size` numbers each.
bat_status spline_factor_mixed(const spline_factor *f, const double *records, size_t size, const uint32_t *intervals,
                               const double *shares, size_t count, double *points, size_t stride);

/// Differences: the places on a line, in units of its parameter, and the derivatives of a function that is 0 at 0.
#define SPLINE_PLACES 6
double spline_place_of(size_t place);
/// @param rows SPLINE_PLACES x n values
void spline_differences(size_t n, const double *rows, double *first, double *second);

/// Spaces of a user up to this dimension have charts.
#define CHART_DIM 6

/// What fixes the velocity at a key.
typedef enum key_state
{
    KEY_FREE,
    KEY_GIVEN, ///< the user, or a limit
    KEY_RESTS  ///< a neighbour that is the same point
} key_state;

/// The keys of one factor, and the intervals between them.
typedef struct spline_system
{
    const spline_factor *factor;
    memory_pool pool;      ///< holds the arrays
    size_t count;          ///< of keys
    size_t intervals;      ///< count when closed, else count - 1
    const double *points;  ///< count x point_dim
    const double *lengths; ///< of the intervals in time
    const double *ways;    ///< of intervals, FACTOR_ROTATION: see spline_middle(); null where all are the shortest
    double *velocities;    ///< count x tangent_dim: those of KEY_GIVEN, and zeros, which the system solves
    // Work space, by interval; pairs are of its beginning and its end.
    double *middles;          ///< point_dim
    double *logs;             ///< 2 x tangent_dim: the keys, seen from the middle
    double *slopes;           ///< 2 x tangent_dim: derivatives of the cubic by its share
    double *accelerations;    ///< 2 x tangent_dim, at the keys
    spline_turning *turnings; ///< 2, FACTOR_ROTATION, else null
    double *charts;           ///< FACTOR_ANY of few dimensions, else null: see spline_chart()
    // By key.
    double *residuals; ///< tangent_dim
    double *rows;      ///< 3: lower, diagonal, upper
    bool smoothed;     ///< the keys are, by a natural spline
    double roughness;  ///< of accelerations, where the ends go by it; else 0
    // By interval.
    double *weights;      ///< of accelerations: below 1 where they are far above those around
    double *calm;         ///< shares by which the velocities at the ends of gaps go over to the mean one; below 0: not even
                          ///< limited
    unsigned char *fixed; ///< of keys, a key_state: 0 while the velocity is unknown
    size_t held;          ///< intervals that spline_system_hold() found, or of little weight
} spline_system;

/// Allocate the arrays but for points and lengths; release the pool in any case.
bat_status spline_system_allocate(spline_system *system, bat_error *error);

/// Find middles, logarithms, velocities and slopes. Velocities that are not all given: continuous accelerations, conditions
/// at the ends, rests and limits, as the options say. `begin_velocity` and `end_velocity` are of this factor.
/// @return BAT_OK, BAT_INVALID_POINT, BAT_CUT_LOCUS or BAT_NO_CONVERGENCE with a key
bat_status spline_system_solve(spline_system *system, bat_motion_ends ends, bat_motion_shape shape,
                               const double *begin_velocity, const double *end_velocity, bat_error *error);

/// The places of an interval that have tangent vectors.
typedef enum spline_place
{
    AT_BEGIN,
    AT_END,
    AT_MIDDLE
} spline_place;

/// The numbers of an interval's matrices.
static inline size_t spline_chart_size(size_t n)
{
    return (n + 7) * n * n;
}

/// Matrices of an interval: of an end, 0 or 1, the differential of exp_m, its inverse, and vectors of pairs (k, l), k <= l:
/// the covariant acceleration is their sum, times velocities k and l; of `end` 2, parallel transport there and back.
static inline double *spline_chart(const spline_system *system, size_t interval, size_t end)
{
    size_t n = system->factor->space.tangent_dim;
    return system->charts + interval * spline_chart_size(n) + end * (n + 5) * n * n / 2;
}

/// The covariant acceleration of a velocity `first` and its derivative `second`, at the end whose matrices these are.
static inline void spline_chart_bend(size_t n, const double *push, const double *first, const double *second,
                                     double *acceleration)
{
    for (size_t c = 0; c < n; c++)
    {
        const double *pair = push + 2 * n * n + c;
        acceleration[c] = 0;
        for (size_t k = 0; k < n; k++)
            for (size_t l = k; l < n; l++, pair += n)
                acceleration[c] += *pair * (first[k] * first[l]);
        for (size_t k = 0; k < n; k++)
            acceleration[c] += push[c * n + k] * second[k];
    }
}

/// Find the charts, after middles and logarithms.
bat_status spline_charts_make(spline_system *system, bat_error *error);
/// spline_transport() by a chart. False without one.
bool spline_chart_transport(const spline_system *system, size_t interval, spline_place from, spline_place to,
                            const double *vector, double *transported);

/// Transport a vector along the geodesic of an interval.
bat_status spline_transport(const spline_system *system, size_t interval, spline_place from, spline_place to,
                            const double *vector, double *transported);

/// The whole way of an interval at one of its ends, as the velocity of its geodesic that takes a unit of time.
bat_status spline_chord(const spline_system *system, size_t interval, spline_place end, double *chord);

/// The interval before (side -1) or after (side 1) an interval, round the end of a motion; before a key, that of its index.
static inline size_t spline_interval_beside(const spline_system *system, size_t interval, int side)
{
    size_t n = system->intervals;
    return side < 0 ? (interval > 0 ? interval - 1 : n - 1) : (interval + 1 < n ? interval + 1 : 0);
}

/// The mean speed of an interval.
double spline_speed(const spline_system *system, size_t interval);

/// Fix the velocities of keys that are far nearer in time than their neighbours are, where their step is far faster or
/// slower than those around it: they are those of the motion around both.
/// @param held receives the number of such intervals
/// @return BAT_OK, or the failure of a logarithm or transport
bat_status spline_system_hold(spline_system *system, size_t *held);

/// The record of an interval; see spline_factor_record_size().
void spline_system_record(const spline_system *system, size_t interval, double *record);

/// Prepare a factor of tensors by the spline of their logarithms in R^n, which exists for all keys, however far apart
/// (Arsigny et al., Log-Euclidean metrics for fast and simple calculus on diffusion tensors, 2006).
///
/// @param system points, lengths, and velocities where `fixed` gives them; receives those of all keys
/// @param records receives the record of interval i at i * record_size
/// @return as spline_system_solve()
bat_status spline_tensor_prepare(spline_system *system, bat_motion_ends ends, bat_motion_shape shape,
                                 const double *begin_velocity, const double *end_velocity, double *records,
                                 size_t record_size, bat_error *error);

/// Move noisy keys of one factor, FACTOR_FLAT or FACTOR_ROTATION, onto the spline of least expected error, natural at ends.
///
/// @param lengths of the count - 1 intervals in time
/// @param points  count x point_dim; replaced
/// @param sigma   the noise; BAT_MOTION_SIGMA_AUTO is replaced by what the keys tell
/// @param deviations receives, for each key, the larger of what it has and the distance of the given key in units of sigma
/// @param uncertainties receives count x tangent_dim standard deviations of the keys that are made
/// @param wander  receives count x tangent_dim, of the intervals: the variance in their middle where both ends were certain
/// @return BAT_OK; BAT_CUT_LOCUS with the key whose measurement is half a turn from the motion; BAT_NO_MEMORY
bat_status spline_smooth(const spline_factor *f, size_t count, const double *lengths, bat_motion_outliers outliers,
                         double *points, double *sigma, double *deviations, double *uncertainties, double *wander,
                         bat_error *error);

/// The time at a share of an interval of a spline.
double spline_time_at(const bat_motion_spline *spline, size_t interval, double share);

/// The distance from the motion, in units of sigma, from which a rule lets keys count less; 0 for BAT_MOTION_OUTLIERS_NONE.
double motion_outliers_threshold(bat_motion_outliers outliers);

// Gyroscopes

/// What a gyroscope and noisy rotations tell together.
typedef struct gyro_fusion
{
    memory_pool pool;          ///< holds the arrays; release it in any case
    double *times, *rotations; ///< count, and count x 4: at the keys and at the rates between them
    double *deviations;        ///< count: of the rotations about any axis, in radians
    size_t count;
    bat_motion_gyro_report report;
} gyro_fusion;

/// Fuse rotations at their times with the rates of a gyroscope.
///
/// @param keys      count x 4, the quaternions of a motion, at increasing times
/// @param sigma     the noise of the keys, in radians; at most 0: it is estimated
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_UNSUPPORTED or BAT_NO_MEMORY
bat_status gyro_fuse(const double *times, const double *keys, size_t count, const bat_motion_gyro *gyro, double sigma,
                     gyro_fusion *fusion, bat_error *error);

/// The random walk that the noise of rows of 3 measurements integrates to, in a second. `sorted` has gyro->count numbers.
double gyro_walk_of(const bat_motion_gyro *gyro, const double *rows, double *sorted);

/// A row of 3 measurements at a time, linear between. `*near` is one before it, and goes up.
void gyro_row_at(const bat_motion_gyro *gyro, const double *rows, double time, size_t *near, double *row);

/// What is left of keys beside a path, smoothed; the caller's arrays of count x 3.
typedef struct force_rest
{
    double *keys, *deviations; ///< and their standard deviations
    double *wander;            ///< that of spline_smooth()
    double sigma;              ///< the noise of the keys
} force_rest;

/// The path that specific forces tell, but for a start and a velocity.
///
/// @param keys  count x 3, translations at `times`, which the fusion has, too
/// @param sigma the noise of the keys; 0: none; below 0: it is estimated
/// @param path  receives a place and a velocity for each rotation of the fusion; zeros where keys contradict the forces
/// @param rest  is filled where forces are used
bat_status force_path(const gyro_fusion *fused, const bat_motion_gyro *gyro, const double *times, const double *keys,
                      size_t count, double sigma, double *path, force_rest *rest, bat_motion_force_report *report,
                      bat_error *error);

// New times along a path: the fastest ones within limits of speed and acceleration

/// The parts of a motion with limits of their own: all of it, or translations and rotations of rigid motions.
#define TIMING_PARTS 2

/// Limits, of each part; 0 for none.
typedef struct timing_limits
{
    double speed[TIMING_PARTS], acceleration[TIMING_PARTS];
} timing_limits;

/// Scalar products of the velocity v and the acceleration a of a part of the path, as functions of its old time.
typedef struct timing_rates
{
    double vv, va, aa;
} timing_rates;

/// The path whose times are sought.
typedef struct timing_path
{
    size_t intervals;
    bool closed;
    const double *times; ///< intervals + 1: the old ones
    /// The rates of each part at a share of an interval.
    bat_status (*rates)(const void *context, size_t interval, double share, timing_rates rates[TIMING_PARTS]);
    const void *context;
} timing_path;

/// New times: the share of each interval is a parabola in time on each of its equal cells.
typedef struct spline_timing
{
    size_t cells;  ///< of each interval
    double *times; ///< intervals * cells + 1, from the first old time on
    double *rates; ///< 2 a cell: the derivative of the share by time at its beginning, and the second derivative
} spline_timing;

/// Find the times. Open motions begin and end at rest where accelerations are limited. Where nothing moves that has a limit,
/// the old duration stays.
///
/// By the reachability passes of Pham and Pham (A new approach to time-optimal path parameterization based on reachability
/// analysis, IEEE Transactions on Robotics 34, 2018), with the lengths of accelerations as cones, which hold within cells.
///
/// @param pool of the arrays of `timing`
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of `rates`
bat_status spline_timing_make(const timing_path *path, const timing_limits *limits, memory_pool *pool, spline_timing *timing,
                              bat_error *error);

/// The share of an interval at a new time within it, and its two derivatives.
double spline_timing_share(const spline_timing *timing, size_t interval, double time, double *rate, double *slope);

/// The new time at a share of an interval.
double spline_timing_time(const spline_timing *timing, size_t interval, double share);

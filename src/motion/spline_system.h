#ifndef MOTION_SPLINE_SYSTEM_H
#define MOTION_SPLINE_SYSTEM_H

#include "batten/motion_spline.h"
#include "motion/spline_factor.h"

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
    size_t count;          ///< of keys
    size_t intervals;      ///< count when closed, else count - 1
    const double *points;  ///< count x point_dim
    const double *lengths; ///< of the intervals in time
    double *velocities;    ///< count x tangent_dim; given, or what the system solves
    // Work space, by interval; pairs are of its beginning and its end.
    double *middles;          ///< point_dim
    double *logs;             ///< 2 x tangent_dim: the keys, seen from the middle
    double *slopes;           ///< 2 x tangent_dim: derivatives of the cubic by its share
    double *accelerations;    ///< 2 x tangent_dim, at the keys
    spline_turning *turnings; ///< FACTOR_ROTATION; of either end, else null
    // By key.
    double *residuals;    ///< tangent_dim
    double *rows;         ///< 3: lower, diagonal, upper
    double roughness;     ///< of accelerations, where the ends go by it; else 0
    unsigned char *fixed; ///< a key_state: 0 while the velocity is unknown
} spline_system;

/// Allocate the arrays but for points, lengths and velocities.
/// @return false when out of memory; release in any case
bool spline_system_allocate(spline_system *system);
void spline_system_free(spline_system *system);

/// Find the middles and the logarithms of all intervals.
/// @return BAT_OK, or BAT_CUT_LOCUS or BAT_INVALID_POINT with the key that begins the failing interval
bat_status spline_system_measure(spline_system *system, bat_error *error);

/// Compute velocities: continuous accelerations, conditions at the ends, rests and limits, as the options say.
/// `begin_velocity` and `end_velocity` are of this factor.
/// @return BAT_OK, BAT_INVALID_POINT, BAT_CUT_LOCUS or BAT_NO_CONVERGENCE with a key
bat_status spline_system_solve(spline_system *system, bat_motion_ends ends, bat_motion_shape shape,
                               const double *begin_velocity, const double *end_velocity, bat_error *error);

/// Compute slopes from velocities, to the last digit.
bat_status spline_system_finish(spline_system *system, bat_error *error);

/// The record of an interval; see spline_factor_record_size().
void spline_system_record(const spline_system *system, size_t interval, double *record);

#endif

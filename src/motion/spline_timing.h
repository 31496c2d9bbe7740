#pragma once

#include "batten/base.h"

#include <stdbool.h>
#include <stddef.h>

/// @file
/// New times along the path of a spline: the fastest ones within limits of speed and acceleration.

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
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of `rates`
bat_status spline_timing_make(const timing_path *path, const timing_limits *limits, spline_timing *timing, bat_error *error);
void spline_timing_free(spline_timing *timing);

/// The share of an interval at a new time within it, and its two derivatives.
double spline_timing_share(const spline_timing *timing, size_t interval, double time, double *rate, double *slope);

/// The new time at a share of an interval.
double spline_timing_time(const spline_timing *timing, size_t interval, double share);

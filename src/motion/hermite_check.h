#ifndef MOTION_HERMITE_CHECK_H
#define MOTION_HERMITE_CHECK_H

#include "batten/motion_hermite.h"

/// The checks beyond those of single points, tangents and times.
typedef struct hermite_check_parts
{
    bool unit;  ///< tangents are of unit length
    bool edges; ///< neighbours are within reach of each other
    /// and distinct, and their pairs admissible (definition 3.2 of Ben-Zion Vardi, Dyn and Sharon): the angles of an edge
    /// with its tangents sum to at most BAT_HERMITE_ANGLE_LIMIT
    bool admissible;
} hermite_check_parts;

/// bat_hermite_check() of parts. The fault found is the first, whatever the number of threads.
bat_status hermite_check(const bat_hermite_curve *curve, hermite_check_parts parts, int threads, bat_error *error);

/// Whether the tangents of a curve may be velocities: they are not stated to be directions.
/// @return BAT_OK or BAT_INVALID_ARGUMENT
bat_status hermite_check_velocities(const bat_hermite_curve *curve, bat_error *error);

#endif

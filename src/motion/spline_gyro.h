#pragma once

#include "batten/motion_spline.h"

/// What a gyroscope and noisy rotations tell together.
typedef struct gyro_fusion
{
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
void gyro_fusion_free(gyro_fusion *fusion);

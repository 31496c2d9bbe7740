#ifndef BATTEN_MOTION_PICTURE_H
#define BATTEN_MOTION_PICTURE_H

#include "batten/motion.h"

BAT_C_BEGIN

/// @file
/// Pictures of motions in time: the path with frames of the body or a strip of poses, and below it the speeds over time.

/// Options of pictures. Begin with bat_motion_picture_defaults().
typedef struct bat_motion_picture_options
{
    double width;            ///< in points, 100 to 10000; 0: 520; default 0
    double height;           ///< in points, up to 10000; 0: from the content; default 0
    double pixels_per_point; ///< PNG only, 0.1 to 20; default 2
    size_t poses;            ///< frames along a path, poses of a strip, up to 1000; 0: by the motion; default 0
    const char *length_unit; ///< UTF-8; null: m for TUM, EuRoC and KITTI files, else none; default null
    const char *time_unit;   ///< the same; null: s for TUM and EuRoC files, and dates, else none; default null
    bool legend;             ///< explain lines and marks; default true
    const char *title;       ///< UTF-8, above the picture; null or "" for none; default null
} bat_motion_picture_options;

/// The largest number of motions in a picture.
#define BAT_MOTION_PICTURE_MOTIONS 7

/// The options' default values.
BAT_API bat_motion_picture_options bat_motion_picture_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_motion_picture_options_check(const bat_motion_picture_options *options, bat_error *error);

/// Draw the splines of the keyframes in a set over their whole duration into a file, whose ending chooses the format: .svg,
/// .png or .pdf.
///
/// R^2, R^3 and rigid motions are a path with axes at true aspect. R^3 is seen from above at 28 degrees of elevation, or 55
/// for a level path, turned so that the path is broad; z is upwards, or the axis across which the path is flat (minus y for
/// y, as cameras have it). Rigid motions have frames at equal times, fewer where they would cover each other: the body's
/// axes x, y and z in red, green and blue. Rotations are a strip of poses at equal times: a block that is long in the body's
/// x, broad in y and thin in z. Curves on the sphere S^2, in the hyperbolic plane and of 2 x 2 and 3 x 3 tensors are drawn
/// as in bat_curve_picture_write(). Of other spaces the coordinates are drawn over time, at most seven.
///
/// Below are the speed, that is the length of the velocity, and of rigid motions and rotations the angular speed in degrees.
/// Keyframes are circles, those that a rule for outliers lets count less are marked (beyond 3 sigma for Huber's).
///
/// @param keyframes 1 to BAT_MOTION_PICTURE_MOTIONS curves, which bat_motion_method_for() gives BAT_MOTION_SPLINE
/// @param motion    as for bat_motion_curves(); null for the defaults
/// @param options   null for the defaults
/// @return as bat_motion_curve_spline(); BAT_INVALID_ARGUMENT; BAT_UNSUPPORTED for too many curves; BAT_INVALID_POINT for
///         coordinates or speeds beyond 1e150; BAT_TOO_LARGE; BAT_NO_MEMORY; BAT_FILE_ACCESS
BAT_API bat_status bat_motion_picture_write(const char *path, const bat_curve_set *keyframes,
                                            const bat_motion_options *motion, const bat_motion_picture_options *options,
                                            bat_error *error);

BAT_C_END

#endif

#ifndef BATTEN_MOTION_H
#define BATTEN_MOTION_H

#include "batten/curve_set.h"
#include "batten/motion_hermite.h"
#include "batten/motion_spline.h"

BAT_C_BEGIN

/// @file
/// Smooth motions from keyframes in a set of curves: points, with times and velocities where columns of the file have them.
/// docs/formats.md has the names of the columns; docs/algorithms/motion-splines.md and hermite-schemes.md explain the
/// methods.
///
/// Conventions: quaternions are (w, x, y, z); angular velocities are in the body's frame, in radians a unit of time; rigid
/// motions are the product of translations and rotations, and their velocities those in the fixed frame, then the angular
/// ones.

/// How a motion is made.
typedef enum bat_motion_method
{
    BAT_MOTION_METHOD_AUTO,   ///< BAT_MOTION_METHOD_SPLINE where there are times, or a rate; BAT_MOTION_METHOD_HERMITE where
                              ///< there are none, or for another Hermite scheme than the default one
    BAT_MOTION_METHOD_SPLINE, ///< bat_motion_spline_make(): keyframes are samples in time
    BAT_MOTION_METHOD_HERMITE ///< Hermite schemes: bat_hermite_refine() by levels, for shapes; times do not steer it. At a
                              ///< rate it is a spline with estimated velocities
} bat_motion_method;

/// The methods by name.
extern BAT_API const bat_family bat_motion_method_family;

/// What bat_motion_curves() did, over all curves.
typedef struct bat_motion_report
{
    size_t keys;               ///< of all motions in time
    double sigma, angle_sigma; ///< the greatest noise of a curve's keys, given or estimated; 0 for none
    double threshold; ///< keys farther from a smoothed motion, in units of sigma, are outliers; 0 without a rule for them
    size_t outliers;  ///< keys that count less (huber) or not at all (tukey)
    size_t outlier;   ///< the first of them, and its curve; BAT_NO_INDEX for none
    size_t outlier_curve;
    double outlier_time; ///< its time
    size_t held, turned; ///< see bat_motion_keys
    /// How far given velocities are from the mean ones between keys, over all curves: root mean squares, relative to those
    /// of the latter. Near 1 or above, they have other units or another frame; 0 without given velocities.
    double conflict;
    /// The greatest lengths of velocities, accelerations, and changes of the acceleration in the time between samples
    /// (jerk), at the samples that are written; of rigid motions those of translations, then those of rotations.
    bat_motion_gyro_report gyro; ///< of the last curve
    double peaks[2][3];
    double duration, given_duration; ///< of the longest motion; they differ where there are limits
    bat_motion_force_report force;   ///< of the last curve
} bat_motion_report;

/// Options of motions. Begin with bat_motion_curves_defaults().
typedef struct bat_motion_curves_options
{
    bat_motion_method method;         ///< default BAT_MOTION_METHOD_AUTO
    bat_motion_spline_options spline; ///< of BAT_MOTION_METHOD_SPLINE; default bat_motion_spline_defaults()
    bat_hermite_refine_options
        scheme;           ///< kind, order, levels and so on, where `rate` is 0; default bat_hermite_refine_defaults().
                          ///< Splines take `levels`, 2^levels parts of each interval, and `max_points`
    double rate;          ///< samples a unit of time, at least 0; 0: by levels instead; default 0
    double period;        ///< of closed motions; 0: the time until a last key that repeats the first, or else one mean step
                          ///< beyond the last key; default 0
    double wrap;          ///< R^n: coordinates are angles with this full turn, which go the shorter way. Results begin at 0,
                          ///< or lie around 0 where a key is negative. 0: they are numbers; default 0
    const double *times;  ///< BAT_MOTION_METHOD_SPLINE: `time_count` increasing times to sample at; null: none; default null
    size_t time_count;    ///< default 0
    size_t tangent_order; ///< 2 or 4: the order of tangents that are estimated where the file has none. 0: splines solve for
                          ///< continuous accelerations, Hermite schemes take 2; default 0
    bool uncertainty;     ///< write velocities and the standard deviations of a smoothed motion, "sd_x", ..., of rotations
                          ///< "sd_wx", ... in radians; default false
    bool velocities;      ///< write velocities also where the keyframes have none; default false
    bat_motion_report *report; ///< receives what bat_motion_curves() did; null for none; default null
} bat_motion_curves_options;

/// The method that a set of keyframes gets: that of the options, or what BAT_MOTION_METHOD_AUTO chooses. Null options are
/// defaults.
BAT_API bat_motion_method bat_motion_method_for(const bat_curve_set *set, const bat_motion_curves_options *options);
/// Options by a scheme's name with settings, as the program's `--scheme` takes it:
///
///     spline              (BAT_MOTION_METHOD_SPLINE)
///     hermite             hermite:order=3
///
/// @param options other fields than the method and the scheme are untouched
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the part at fault
BAT_API bat_status bat_motion_scheme_by_name(const char *name, bat_motion_curves_options *options, bat_error *error);
/// The schemes of motions by name, with their settings.
extern BAT_API const bat_family bat_motion_scheme_family;

/// The options' default values.
BAT_API bat_motion_curves_options bat_motion_curves_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_motion_curves_fields;

/// Whether the curves of a set have times: a channel from a column of that name.
BAT_API bool bat_motion_has_times(const bat_curve_set *set);
/// Whether the curves of a set have velocities: channels from columns of these names.
BAT_API bool bat_motion_has_velocities(const bat_curve_set *set);

/// Whether a set is a motion, for which bat_motion_curves() is the default: rotations, poses or tensors with times or
/// velocities.
BAT_API bool bat_motion_suits(const bat_curve_set *set);

/// The Hermite data of one curve of a set: its points, its times, and its velocities. Splines compute missing velocities;
/// for Hermite schemes they are estimated as tangents of the order in the options.
///
/// What the tangents are depends on the method (bat_motion_method_for()). BAT_MOTION_METHOD_SPLINE, and a rate: velocities.
/// BAT_MOTION_METHOD_HERMITE without a rate: unit vectors, which `keys->kind` states; splines refuse these.
///
/// @param options null for the defaults
/// @param keys    receives the data; release it with bat_hermite_free()
/// @param error   `index` is the failing point and `line` its line in the file
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS, BAT_UNSUPPORTED (other channels than times and
///         velocities, uneven times for a scheme of even ones) or BAT_NO_MEMORY; `keys` is untouched on failure
BAT_API bat_status bat_motion_data(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                                   bat_hermite_curve *keys, bat_error *error);

/// Prepare the spline through the keyframes of one curve of a set, with the options of BAT_MOTION_METHOD_SPLINE.
///
/// @param options null for the defaults; `rate`, `times` and levels do not matter
/// @param spline  receives the spline; release it with bat_motion_spline_free()
/// @param error   as of bat_motion_data()
/// @return as bat_motion_data() and bat_motion_spline_make(); BAT_UNSUPPORTED where the set gets BAT_MOTION_METHOD_HERMITE
BAT_API bat_status bat_motion_curve_spline(const bat_curve_set *set, size_t curve, const bat_motion_curves_options *options,
                                           bat_motion_spline **spline, bat_error *error);

/// Make smooth curves of the keyframes in a set, with the same kind of columns, by bat_motion_method_for(): a spline sampled
/// at given times, at a rate, or at 2^levels parts of each interval; or a refined Hermite curve. Sampled curves always have
/// times; without times in the set, keyframe i is at time i.
///
/// Velocities are written where the set has them or the options demand them. Splines give those of the motion, Hermite
/// schemes their direction times the speed between neighbours; without times, the unit direction. The signs of quaternions
/// do not jump.
///
/// @param options null for the defaults
/// @param fine    receives a curve for each one of `keyframes`; release it with bat_curve_set_free()
/// @param error   its `curve` is the failing one
/// @return as bat_motion_data(), bat_motion_spline_make(), bat_motion_spline_sample(), and bat_hermite_refine(); `fine` is
/// untouched on failure
BAT_API bat_status bat_motion_curves(const bat_curve_set *keyframes, const bat_motion_curves_options *options,
                                     bat_curve_set *fine, bat_error *error);

/// Read increasing times: a number a line in the unit of a set's times, or a date with a time of day (ISO 8601). Where the
/// set's times are seconds, the size of a number tells its unit; see bat_time_unit. Blank lines, lines that begin with # and
/// a first line of "time" are skipped.
///
/// @param path   "-" is standard input
/// @param set    its bat_curve_set_time_origin() is that of the result, too; null: times count from 0
/// @param times  receives `count` numbers, at least one; release them with free()
/// @param error  its `line` is that of the failure
/// @return BAT_OK, BAT_BAD_FILE (no number, more than one in a line, a time that does not come after the one before),
///         BAT_FILE_ACCESS or BAT_NO_MEMORY; `times` is untouched on failure
BAT_API bat_status bat_motion_times_read(const char *path, const bat_curve_set *set, double **times, size_t *count,
                                         bat_error *error);

/// Read the rates of a gyroscope for bat_motion_gyro. A header tells which columns are a time, as above, and angular rates
/// about x, y and z in the body's frame, in rad/s or deg/s; without one these are the first columns, in rad/s. Other columns
/// do not matter. A row with the time of the row before is left out, and the set gets a note of that.
///
/// @param rates receives `count` x 3 numbers; release them with free(), too. Null: a line has a time alone
/// @return as bat_motion_times_read()
BAT_API bat_status bat_motion_rates_read(const char *path, const bat_curve_set *set, double **times, double **rates,
                                         size_t *count, bat_error *error);

/// The same with the specific forces of an accelerometer, in m/s^2 or g, or in the next three columns, in m/s^2.
///
/// @param gyro receives the arrays; release them with bat_motion_gyro_free()
/// @return as bat_motion_times_read()
BAT_API bat_status bat_motion_gyro_read(const char *path, const bat_curve_set *set, bat_motion_gyro *gyro, bat_error *error);
BAT_API void bat_motion_gyro_free(bat_motion_gyro *gyro);

BAT_C_END

#endif

#ifndef BATTEN_MOTION_H
#define BATTEN_MOTION_H

#include "batten/curve_set.h"
#include "batten/motion_hermite.h"

BAT_C_BEGIN

/// @file
/// From keyframes to a smooth curve: points, and times and velocities where the columns of the keyframes' file have them.
/// docs/formats.md says what the columns are called; docs/hermite.md explains the schemes.

/// How to make the curve. Begin with bat_motion_defaults().
typedef struct bat_motion_options
{
    bat_hermite_options scheme; ///< kind, order, levels and so on, where `rate` is 0; default bat_hermite_defaults()
    double rate;                ///< points for a unit of time; default 0: refine by levels instead
    size_t tangent_order;       ///< 2 or 4: of the tangents that are estimated where the file has none; default 2
    bool velocities;            ///< put velocities into the result even if there were none before; default false
} bat_motion_options;

/// The options' default values.
BAT_API bat_motion_options bat_motion_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_motion_options_check(const bat_motion_options *options, bat_error *error);

/// Whether the curves of a set have times, or velocities: channels that came from columns of these names.
BAT_API bool bat_motion_has_times(const bat_curve_set *set);
BAT_API bool bat_motion_has_velocities(const bat_curve_set *set);

/// Whether a set is a motion, for which a Hermite scheme is the default: rotations, poses or tensors with times or
/// velocities.
BAT_API bool bat_motion_suits(const bat_curve_set *set);

/// The Hermite data of one curve of a set: its points, its times if there are any, and its velocities; where it has none,
/// tangents estimated with the order that the options say. Without a rate and for BAT_HERMITE_LANE_RIESENFELD the tangents
/// are of unit length; for BAT_HERMITE_TRANSPORT they are derivatives by the index, for which times must be evenly spaced.
///
/// @param options null for the defaults
/// @param keys    receives the data; release it with bat_hermite_free()
/// @param error   `index` is the point at fault and `line` its line in the file
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS, BAT_UNSUPPORTED (channels that are neither times
/// nor
///         velocities, uneven times where the scheme needs even ones) or BAT_NO_MEMORY; `keys` is untouched on failure
BAT_API bat_status bat_motion_data(const bat_curve_set *set, size_t curve, const bat_motion_options *options,
                                   bat_hermite_curve *keys, bat_error *error);

/// Make smooth curves of the keyframes in a set, with the same kind of columns: bat_hermite_sample_rate() at a rate, else
/// bat_hermite_refine(). Sampled curves have times in any case: without times in the set, keyframe i is at time i.
/// Velocities are there where the set has them or the options ask for them: those of the motion where it is sampled and from
/// BAT_HERMITE_TRANSPORT; from BAT_HERMITE_LANE_RIESENFELD the scheme's direction times the speed from neighbour to
/// neighbour, and without times the direction, of unit length. The signs of quaternions do not jump.
///
/// @param options null for the defaults
/// @param fine    receives a curve for each one of `keyframes`; release it with bat_curve_set_free()
/// @param failed  receives the curve at fault; may be null
/// @return as bat_motion_data(), bat_hermite_refine() and bat_hermite_sample_rate(); `fine` is untouched on failure
BAT_API bat_status bat_motion_curves(const bat_curve_set *keyframes, const bat_motion_options *options, bat_curve_set *fine,
                                     size_t *failed, bat_error *error);

BAT_C_END

#endif

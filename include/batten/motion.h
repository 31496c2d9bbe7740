#ifndef BATTEN_MOTION_H
#define BATTEN_MOTION_H

#include "batten/curve_set.h"
#include "batten/motion_hermite.h"

BAT_C_BEGIN

/// @file
/// Smooth motions from keyframes in a set of curves: points, with times and velocities where columns of the file have them.
/// docs/formats.md has the names of the columns; docs/algorithms/hermite-schemes.md explains the schemes.

/// Options of motions. Begin with bat_motion_defaults().
typedef struct bat_motion_options
{
    bat_hermite_options scheme; ///< kind, order, levels and so on, where `rate` is 0; default bat_hermite_defaults()
    double rate;                ///< samples a unit of time, at least 0; 0: refine by levels instead; default 0
    size_t tangent_order;       ///< 2 or 4: the order of tangents that are estimated where the file has none; default 2
    bool velocities;            ///< write velocities also where the keyframes have none; default false
} bat_motion_options;

/// The options' default values.
BAT_API bat_motion_options bat_motion_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_motion_options_check(const bat_motion_options *options, bat_error *error);

/// Whether the curves of a set have times: a channel from a column of that name.
BAT_API bool bat_motion_has_times(const bat_curve_set *set);
/// Whether the curves of a set have velocities: channels from columns of these names.
BAT_API bool bat_motion_has_velocities(const bat_curve_set *set);

/// Whether a set is a motion, for which a Hermite scheme is the default: rotations, poses or tensors with times or
/// velocities.
BAT_API bool bat_motion_suits(const bat_curve_set *set);

/// The Hermite data of one curve of a set: its points, its times, and its velocities. Missing velocities are estimated as
/// tangents of the order in the options. Without a rate, BAT_HERMITE_LANE_RIESENFELD gets unit tangents.
/// BAT_HERMITE_TRANSPORT gets derivatives by the index, for which times must be evenly spaced.
///
/// @param options null for the defaults
/// @param keys    receives the data; release it with bat_hermite_free()
/// @param error   `index` is the failing point and `line` its line in the file
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_CUT_LOCUS, BAT_UNSUPPORTED (other channels than times and
///         velocities, uneven times for a scheme of even ones) or BAT_NO_MEMORY; `keys` is untouched on failure
BAT_API bat_status bat_motion_data(const bat_curve_set *set, size_t curve, const bat_motion_options *options,
                                   bat_hermite_curve *keys, bat_error *error);

/// Make smooth curves of the keyframes in a set, with the same kind of columns: bat_hermite_sample_rate() at a rate, else
/// bat_hermite_refine(). Sampled curves always have times; without times in the set, keyframe i is at time i.
///
/// Velocities are written where the set has them or the options demand them. Sampling and BAT_HERMITE_TRANSPORT give those
/// of the motion. BAT_HERMITE_LANE_RIESENFELD gives the scheme's direction times the speed between neighbours; without
/// times, the unit direction. The signs of quaternions do not jump.
///
/// @param options null for the defaults
/// @param fine    receives a curve for each one of `keyframes`; release it with bat_curve_set_free()
/// @param failed  receives the index of the failing curve; may be null
/// @return as bat_motion_data(), bat_hermite_refine() and bat_hermite_sample_rate(); `fine` is untouched on failure
BAT_API bat_status bat_motion_curves(const bat_curve_set *keyframes, const bat_motion_options *options, bat_curve_set *fine,
                                     size_t *failed, bat_error *error);

BAT_C_END

#endif

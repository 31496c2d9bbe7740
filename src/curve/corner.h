#pragma once

#include "batten/curve.h"
#include "linalg/vector.h"

/// @file
/// Corners: the vertices at which a curve is cut for refinement.

/// The largest corner angle, pi: no vertex turns by more.
#define CORNER_ANGLE_LIMIT ANGLE_PI

/// Whether the scheme and the rule of the ends keep corners where they are.
bool corners_stay(const bat_curve_refine_options *options);
/// Whether a curve can have corners: it has flags, or the options ask for corners.
bool corners_wanted(const bat_curve *curve, const bat_curve_refine_options *options);

/// Find the corners of a checked curve: those of its flags, of options->corner_angle and of options->find_corners. The
/// exterior angle is that of -log(before) and log(after). The ends of an open curve are corners only by their flags.
///
/// @param flags receives curve->count flags, 1 at corners
/// @param count receives their number
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_CUT_LOCUS with the index of the vertex
bat_status corners_find(const bat_curve *curve, const bat_curve_refine_options *options, unsigned char *flags, size_t *count,
                        bat_error *error);

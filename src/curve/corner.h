#ifndef CURVE_CORNER_H
#define CURVE_CORNER_H

#include "batten/curve.h"

/// @file
/// Corners: the vertices at which a curve is cut for refinement.

/// The largest corner angle, pi: no vertex turns by more.
#define CORNER_ANGLE_LIMIT 3.14159265358979323846

/// Find the corners of a checked curve. A vertex is one where it has a flag in curve->corners, or where `angle` is above 0
/// and the exterior angle is greater: the angle between -log(before) and log(after) at the vertex. The ends of an open curve
/// are corners only by their flags.
///
/// @param angle radians
/// @param flags receives curve->count flags, 1 at corners
/// @param count receives their number
/// @return BAT_OK or BAT_CUT_LOCUS with the index of the vertex
bat_status corners_find(const bat_curve *curve, double angle, unsigned char *flags, size_t *count, bat_error *error);

#endif

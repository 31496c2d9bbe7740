#ifndef CURVE_PIECES_H
#define CURVE_PIECES_H

#include "batten/curve.h"

/// @file
/// Refinement of curves that are cut at corners, or whose edges have levels of their own.

/// Whether a curve has flags of corners, or the options (null for the defaults) a corner angle or a stop.
bool pieces_wanted(const bat_curve *coarse, const bat_curve_refine_options *options);

/// bat_curve_refined_count() of such a curve, or of any other.
bat_status pieces_count(const bat_curve *coarse, const bat_curve_refine_options *options, size_t *count, bat_error *error);

/// bat_curve_refine_into() of such a curve, or of any other.
bat_status pieces_refine_into(const bat_curve *coarse, const bat_curve_refine_options *options, double *points,
                              double *channels, size_t capacity, bat_error *error);

/// bat_curve_refine() of such a curve, or of any other.
///
/// @param starts receives the row of `fine` at which each coarse edge begins, and as the last number fine->count for a
/// closed
///               curve and fine->count - 1 for an open one: as many numbers as there are edges, and one; release it with
///               free(). Schemes that move points have the point there that belongs to the vertex, or the first one after
///               it. May be null
bat_status pieces_refine(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine, size_t **starts,
                         bat_error *error);

#endif

#ifndef CURVE_PLAN_H
#define CURVE_PLAN_H

#include "curve/cascade.h"

/// What refining a curve comes down to, known before anything is computed.
typedef struct refine_plan
{
    bat_curve_refine_options options;
    bat_mask_stencil snap; ///< count 0 when points stay where they are
    index_range points;    ///< the indices of the last level that make the refined curve
    bool ends_added;       ///< the coarse end points are put around them
    size_t count;          ///< rows of the refined curve
} refine_plan;

/// Check a curve and the options (null for the defaults), choose the scheme where they leave it open, lay out the result.
/// @return as bat_curve_refined_count()
bat_status refine_plan_make(const bat_curve *coarse, const bat_curve_refine_options *options, refine_plan *plan,
                            bat_error *error);

/// Whether indices, bytes and the caller's limit leave room for `count` rows refined `levels` times.
bool plan_has_room(const refine_kernel *kernel, size_t count, size_t levels, size_t limit);
/// The rows of the last level at parameters from 0 to count - 1, those of an open curve.
index_range plan_between_ends(const refine_kernel *kernel, size_t levels, size_t count);

#endif

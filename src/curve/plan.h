#pragma once

#include "curve/kernel.h"

/// @file
/// Several levels of one kernel at once. Any run of points of the last level depends on a short run of each level before,
/// so the result is made in chunks that never leave the cache: levels in between are nowhere stored, a chunk is written
/// once, and chunks are independent of each other (and of the number of threads).

/// More levels than this overflow size_t from any number of points.
#define CASCADE_MOST_LEVELS 60

/// Indices begin … end - 1 of the points of one level. They may be negative.
typedef struct index_range
{
    ptrdiff_t begin, end;
} index_range;

/// What to compute.
typedef struct cascade
{
    refine_kernel kernel;
    size_t levels;
    size_t count; ///< points of level 0, to name the one at fault
    size_t base;  ///< levels before level 0, likewise
    bool closed;
    index_range result;    ///< indices wanted of the last level
    bat_mask_stencil snap; ///< moves the points of the last level onto the limit curve; count 0: not at all
    int threads;           ///< 0: as many as OpenMP gives
    bat_progress progress;
} cascade;

/// The range of level 0 that the result depends on.
index_range cascade_support(const cascade *task);

/// Compute task->result into `fine`.
///
/// @param root  row 0 is point 0 of level 0; the rows of cascade_support() are there
/// @param fine  result.end - result.begin rows
/// @return BAT_OK, BAT_NO_MEMORY, BAT_CANCELLED or what the kernel returned, with the index of the edge of level 0 at fault
bat_status cascade_run(const cascade *task, const double *root, double *fine, bat_error *error);

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

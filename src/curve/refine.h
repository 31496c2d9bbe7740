#pragma once

#include "curve/scheme_kind.h"

/// @file
/// Refinement of one piece: a closed curve, or an open one without corners.

/// Refine a curve by its plan, all levels everywhere: points, then channels. Nothing keeps the result simple.
/// @param points   room for plan->count rows
/// @param channels the same; null: they are not computed
bat_status refine_carry_out(const bat_curve *coarse, const refine_plan *plan, bat_progress progress, double *points,
                            double *channels, bat_error *error);

/// Add the report of a curve to that of all, whose min_levels begins with SIZE_MAX. The result does not depend on the order.
void refine_report_add(bat_curve_refine_report *sum, const bat_curve_refine_report *one);

/// A polygon with the points that its end rule adds, from which any run of points of any level is computed.
typedef struct refine_source
{
    const bat_space *space;
    double *buffer;
    const double *rows;      ///< within `buffer`: row 0 is point 0 of level `base`
    size_t base;             ///< levels that a rule has decided
    bat_curve_scheme scheme; ///< of the levels after these; the task refers to it, so the source must not be moved
    cascade task;            ///< but for levels, result and threads
    ptrdiff_t shift;         ///< see refine_source_index()
} refine_source;

/// Prepare up to `levels` levels of a polygon of as many rows as `coarse` has points, such as its points or its channels.
/// @param rows   coarse->count rows of space->point_dim numbers
/// @param kernel the scheme's, for rows of the space
/// @return BAT_OK, BAT_NO_MEMORY, or the failure of the end rule; `source` is to be freed on success
bat_status refine_source_make(const bat_space *space, const double *rows, const bat_curve *coarse,
                              const bat_curve_scheme *scheme, const refine_kernel *kernel, const refine_plan *plan,
                              size_t levels, refine_source *source, bat_error *error);
void refine_source_free(refine_source *source);

/// The index of the point that begins a coarse edge at a level: of a mask with centre c, point i is at (i + c) / 2^k - c.
static inline ptrdiff_t refine_source_index(const refine_source *source, size_t levels, size_t edge)
{
    return source->shift * (((ptrdiff_t)1 << levels) - 1) + (ptrdiff_t)(edge << levels);
}

/// A vertex of the given polygon, also the one after the last edge.
static inline const double *refine_source_vertex(const refine_source *source, size_t vertex)
{
    return source->rows + (vertex << source->base) * source->space->point_dim;
}

/// Compute `count` points after `levels` levels, from point `begin` of a coarse edge on.
/// @return as cascade_run()
bat_status refine_source_run(const refine_source *source, size_t levels, size_t edge, size_t begin, size_t count,
                             int threads, double *fine, bat_error *error);

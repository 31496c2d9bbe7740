#pragma once

#include "curve/refine.h"

/// @file
/// Stops: how many levels each coarse edge needs until its pieces are short enough, or near enough to the limit curve. The
/// levels of an edge depend on the points of that edge alone.

enum
{
    STOP_DEFAULT_LEVELS = 20,
    STOP_MOST_LEVELS = 40,
    /// Levels beyond the one under test that the estimate of the distance to the limit uses.
    STOP_LOOKAHEAD = 2
};

/// Whether options have a stop, if the scheme can be stopped.
static inline bool stop_wanted(const bat_curve_refine_options *options)
{
    return options->max_edge > 0 || options->tolerance > 0 || options->relative_tolerance > 0;
}

/// Whether a checked scheme can be stopped: an edge's points are among those of the next level and on the limit curve.
/// @return BAT_OK, or BAT_UNSUPPORTED with the way out
bat_status stop_check(const bat_curve_refine_options *options, bat_error *error);

/// The median length of the edges of curves; 0 without edges.
bat_status curves_median_edge(const bat_curve *curves, size_t count, double *median, bat_error *error);

/// Set the tolerance that relative_tolerance means for these curves, unless there is one, and on the sphere the longest
/// piece; without a scheme that can be stopped, relative_tolerance becomes 0.
/// @return BAT_OK or BAT_NO_MEMORY
bat_status stop_resolve(const bat_curve *curves, size_t count, bat_curve_refine_options *options, bat_error *error);
/// The failure of an edge that needs more levels than are allowed.
/// @return BAT_TOO_LARGE
bat_status stop_needs_more(size_t edge, size_t most, bat_error *error);

/// The deepest level that `edges` edges may want: options->max_levels and the lookahead, less where indices overflow.
size_t stop_deepest(const bat_curve_refine_options *options, size_t edges);

/// The levels of a geodesic: the smallest k for which 2^k even pieces are short enough. SIZE_MAX where there is none.
size_t stop_levels_of_geodesic(const bat_curve_refine_options *options, double length);

/// Find the levels of each edge of a polygon.
///
/// The distance of the limit curve from the pieces of level k is estimated from the two levels after it. Let a be the
/// largest distance of the new points of level k + 1 from the pieces of level k, b that of level k + 2 from the pieces of
/// level k + 1, and d that of both from the pieces of level k. Deviations of later levels are taken as a geometric series of
/// ratio r = b / a, not below 1/4 (smooth limits) nor above 3/4: the estimate is d + b r / (1 - r). It is a bound where
/// later levels decay at least as fast as measured; of a scheme whose limits are not C1 it may be too small.
///
/// @param edges   of the polygon
/// @param deepest of stop_deepest(), as prepared in `source`
/// @param levels  receives a number for each edge
/// @return BAT_OK, BAT_TOO_LARGE with the edge, BAT_INVALID_POINT, BAT_CANCELLED, BAT_NO_MEMORY or the kernel's failures
bat_status stop_levels(const refine_source *source, const bat_curve_refine_options *options, bool keeps_points, size_t edges,
                       size_t deepest, int threads, bat_progress progress, unsigned char *levels, bat_error *error);

/// Compute the points of edges with levels of their own: 2^levels[e] of edge e, one after the other.
/// @param with_end compute the point after the last edge, too
bat_status stop_run(const refine_source *source, const unsigned char *levels, size_t edges, bool with_end, int threads,
                    bat_progress progress, double *fine, bat_error *error);

// Refinement of curves, in pieces where they are cut at corners, without smoothing.

/// bat_curve_refined_count()
bat_status pieces_count(const bat_curve *coarse, const bat_curve_refine_options *options, size_t *count, bat_error *error);

/// The caller's arrays for a refined curve, with room for `capacity` rows. Without `channels` these are not computed.
typedef struct refine_room
{
    double *points, *channels;
    size_t capacity;
} refine_room;

/// bat_curve_refine()
///
/// @param joints flags of points where lines meet end to end: stops see to it that the curve hardly turns there. May be null
/// @param room   where the rows go, without flags of corners; null: to new memory
/// @param starts receives the row of `fine` at which each coarse edge begins, and as the last number fine->count for a
///               closed curve and fine->count - 1 for an open one: as many numbers as there are edges, and one; release it
///               with free(). Schemes that move points have the point there that belongs to the vertex, or the first one
///               after it. May be null
bat_status pieces_refine(const bat_curve *coarse, const bat_curve_refine_options *options, const unsigned char *joints,
                         const refine_room *room, bat_curve *fine, size_t **starts, bat_error *error);

#include "curve/pieces.h"
#include "curve/smooth.h"

/// @file
/// Refinement of a curve, which is smoothed before if that is wanted.

/// A curve that was smoothed, how to refine it, and what smoothing did.
typedef struct smoothed_curve
{
    bat_curve curve;
    bat_curve_refine_options how;
    bat_curve_refine_report moved;
} smoothed_curve;

static bat_status smoothed_make(const bat_curve *coarse, const bat_curve_refine_options *options, smoothed_curve *smooth,
                                bat_error *error)
{
    smooth->how = *options;
    smooth->how.smooth = 0;
    smooth->how.corner_angle = 0; // corners have flags now
    smooth->how.find_corners = false;
    return smooth_curve(coarse, options, &smooth->curve, &smooth->moved, error);
}

/// Release a smoothed curve and complete the report of its refinement, which ended with `status`.
static bat_status smoothed_end(smoothed_curve *smooth, bat_status status)
{
    bat_curve_free(&smooth->curve);
    if (status == BAT_OK && smooth->how.report != NULL)
        smooth_report_add(smooth->how.report, &smooth->moved);
    return status;
}

bat_status bat_curve_refined_count(const bat_curve *coarse, const bat_curve_refine_options *options, size_t *count,
                                   bat_error *error)
{
    if (smooth_wanted(options))
    {
        smoothed_curve smooth;
        bat_status done = smoothed_make(coarse, options, &smooth, error);
        smooth.how.report = NULL;
        return smoothed_end(&smooth,
                            done == BAT_OK ? bat_curve_refined_count(&smooth.curve, &smooth.how, count, error) : done);
    }
    return pieces_count(coarse, options, count, error);
}

/// Refine into new memory, or into `room` unless it is null.
static bat_status refine_curve(const bat_curve *coarse, const bat_curve_refine_options *options, const refine_room *room,
                               bat_curve *fine, bat_error *error)
{
    if (smooth_wanted(options))
    {
        smoothed_curve smooth;
        bat_status done = smoothed_make(coarse, options, &smooth, error);
        return smoothed_end(&smooth, done == BAT_OK ? refine_curve(&smooth.curve, &smooth.how, room, fine, error) : done);
    }
    return pieces_refine(coarse, options, NULL, room, fine, NULL, error);
}

bat_status bat_curve_refine_into(const bat_curve *coarse, const bat_curve_refine_options *options, double *points,
                                 double *channels, size_t capacity, bat_error *error)
{
    const refine_room room = {points, channels, capacity};
    bat_curve fine;
    return refine_curve(coarse, options, &room, &fine, error);
}

bat_status bat_curve_refine(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                            bat_error *error)
{
    return refine_curve(coarse, options, NULL, fine, error);
}

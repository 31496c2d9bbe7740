#include "base/error.h"
#include "base/memory.h"
#include "base/progress.h"
#include "curve/pieces.h"
#include "curve/refine.h"
#include "curve/smooth.h"
#include "curve/topology/draw_back.h"

/// @file
/// Refinement of a curve: of one piece, or of its pieces between corners.

/// The share of the work that is refinement, where the result is tested for crossings.
#define REFINED_SHARE 0.8

/// Everything: rows, and what keeps the curve simple.
static bat_status carry_out(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels,
                            bat_error *error)
{
    double share = wants_simple(coarse, &plan->options) ? REFINED_SHARE : 1;
    progress_part parts[2] = {{plan->options.progress, 0, share}, {plan->options.progress, share, 1 - share}};
    bat_status status = refine_carry_out(coarse, plan, progress_of_part(&parts[0]), points, channels, error);
    if (status != BAT_OK)
        return status;
    bat_curve fine = {.space = coarse->space, .points = points, .count = plan->count, .closed = coarse->closed};
    bat_curve_refine_report report;
    status = keep_simple(coarse, &plan->options, &fine, NULL, progress_of_part(&parts[1]), &report, error);
    if (status != BAT_OK)
        return status;
    if (share < 1 && plan->options.progress.report != NULL)
        (void)plan->options.progress.report(plan->options.progress.context, 1); // a wish to stop comes too late
    report.min_levels = report.max_levels = plan->options.levels;
    if (plan->options.report != NULL)
        *plan->options.report = report;
    return BAT_OK;
}

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
    if (pieces_wanted(coarse, options))
        return pieces_count(coarse, options, count, error);
    refine_plan plan;
    bat_status status = refine_plan_make(coarse, options, &plan, error);
    if (status == BAT_OK)
        *count = plan.count;
    return status;
}

bat_status bat_curve_refine_into(const bat_curve *coarse, const bat_curve_refine_options *options, double *points,
                                 double *channels, size_t capacity, bat_error *error)
{
    if (smooth_wanted(options))
    {
        smoothed_curve smooth;
        bat_status done = smoothed_make(coarse, options, &smooth, error);
        return smoothed_end(
            &smooth,
            done == BAT_OK ? bat_curve_refine_into(&smooth.curve, &smooth.how, points, channels, capacity, error) : done);
    }
    if (pieces_wanted(coarse, options))
        return pieces_refine_into(coarse, options, points, channels, capacity, error);
    refine_plan plan;
    bat_status status = refine_plan_make(coarse, options, &plan, error);
    if (status != BAT_OK)
        return status;
    if (capacity < plan.count)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the refined curve has %zu points, there is room for %zu",
                         plan.count, capacity);
    return carry_out(coarse, &plan, points, channels, error);
}

bat_status bat_curve_refine(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                            bat_error *error)
{
    if (smooth_wanted(options))
    {
        smoothed_curve smooth;
        bat_status done = smoothed_make(coarse, options, &smooth, error);
        return smoothed_end(&smooth, done == BAT_OK ? bat_curve_refine(&smooth.curve, &smooth.how, fine, error) : done);
    }
    if (pieces_wanted(coarse, options))
        return pieces_refine(coarse, options, fine, NULL, error);
    refine_plan plan;
    bat_status status = refine_plan_make(coarse, options, &plan, error);
    if (status != BAT_OK)
        return status;
    size_t channel_count = coarse->channel_count, row = coarse->space->point_dim * sizeof(double);
    bat_curve result = {
        .space = coarse->space, .count = plan.count, .closed = coarse->closed, .channel_count = channel_count};
    result.points = memory_array(plan.count, row);
    if (channel_count > 0)
        result.channels = memory_array(plan.count, channel_count * sizeof *result.channels);
    if (result.points == NULL || (channel_count > 0 && result.channels == NULL))
        status = error_memory(error, plan.count * row);
    else
        status = carry_out(coarse, &plan, result.points, result.channels, error);
    if (status != BAT_OK)
    {
        bat_curve_free(&result);
        return status;
    }
    *fine = result;
    return BAT_OK;
}

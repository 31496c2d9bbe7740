#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/pieces.h"
#include "curve/smooth.h"

/// @file
/// Refinement of curves, which are smoothed before if that is wanted.

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

// Many curves

/// From this many curves a thread on, each thread refines whole curves; of fewer, the threads share each one's points.
static const size_t MANY = 4;

void refine_report_add(bat_curve_refine_report *sum, const bat_curve_refine_report *one)
{
#pragma omp critical(refine_report)
    {
        sum->checked += one->checked;
        sum->given_crossing += one->given_crossing;
        sum->crossing += one->crossing;
        sum->crossings += one->crossings;
        sum->drawn_back += one->drawn_back;
        sum->straight += one->straight;
        sum->left_crossing += one->left_crossing;
        sum->stopped += one->stopped;
        sum->corners += one->corners;
        smooth_report_add(sum, one);
        sum->min_levels = one->min_levels < sum->min_levels ? one->min_levels : sum->min_levels;
        sum->max_levels = one->max_levels > sum->max_levels ? one->max_levels : sum->max_levels;
    }
}

static void refine_many(const bat_curve *coarse, const bat_curve_refine_options *options, int threads, bat_curve *fine,
                        bat_curve_refine_report *report, shared_work *work)
{
    (void)threads; // without OpenMP
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < work->total; i++)
    {
        if (!shared_work_wants(work, i))
            continue;
        bat_error error;
        bat_curve_refine_options how = *options;
        bat_curve_refine_report one = {0};
        how.threads = 1;
        how.progress = (bat_progress){0};
        how.report = &one;
        bat_status status = error_curve(&error, bat_curve_refine(&coarse[i], &how, &fine[i], &error), i);
        refine_report_add(report, &one);
        shared_work_finish(work, i, status, &error);
    }
}

/// One after the other, each reporting its part of the whole.
static bat_status refine_few(const bat_curve *coarse, size_t count, const bat_curve_refine_options *options, bat_curve *fine,
                             bat_curve_refine_report *report, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        bat_curve_refine_options how = *options;
        progress_part part = {how.progress, (double)i / (double)count, 1 / (double)count};
        bat_curve_refine_report one = {0};
        how.progress = progress_of_part(&part);
        how.report = &one;
        status = error_curve(error, bat_curve_refine(&coarse[i], &how, &fine[i], error), i);
        refine_report_add(report, &one);
    }
    return status;
}

bat_status bat_curves_refine(const bat_curve *coarse, size_t count, const bat_curve_refine_options *options, bat_curve *fine,
                             bat_error *error)
{
    const bat_curve_refine_options defaults = bat_curve_refine_defaults();
    options = options != NULL ? options : &defaults;
    bat_curve_refine_report report = {.min_levels = count > 0 ? SIZE_MAX : 0};
    for (size_t i = 0; i < count; i++)
        fine[i] = (bat_curve){.space = coarse[i].space};
    bat_status status = bat_options_check(&bat_curve_refine_fields, options, error);
    if (status != BAT_OK)
        return status;
    int threads = threads_for(options->threads, SIZE_MAX);
    if (count < MANY * (size_t)threads)
        status = refine_few(coarse, count, options, fine, &report, error);
    else
    {
        shared_work work = shared_work_make(count, options->progress);
        refine_many(coarse, options, threads, fine, &report, &work);
        status = shared_work_end(&work, error);
    }
    if (status == BAT_OK && options->report != NULL)
        *options->report = report;
    if (status == BAT_OK)
        return BAT_OK;
    for (size_t i = 0; i < count; i++)
        bat_curve_free(&fine[i]);
    return status;
}

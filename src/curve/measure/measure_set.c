#include "batten/curve_measure.h"

#include "base/progress.h"
#include "base/shared_work.h"
#include "base/threads.h"

enum
{
    /// From this many curves for each thread on, threads share curves and not the points of each.
    CURVES_PER_THREAD = 4
};

/// What is to be measured of every curve of a set.
typedef struct set_task
{
    const bat_curve *first, *second;
    bat_curve_measure_options options;
    bat_curve_distance *distances; ///< null to measure fairness
    bat_curve_fairness_values *fairness;
} set_task;

static bat_status measure_curve(const set_task *task, size_t i, const bat_curve_measure_options *options, bat_error *error)
{
    return task->distances != NULL
               ? bat_curve_compare(&task->first[i], &task->second[i], options, &task->distances[i], error)
               : bat_curve_fairness(&task->first[i], options, &task->fairness[i], error);
}

/// One curve after the other, each with all threads.
static bat_status measure_in_turn(const set_task *task, size_t count, size_t *failed_curve, bat_error *error)
{
    double share = count > 0 ? 1 / (double)count : 1;
    for (size_t i = 0; i < count; i++)
    {
        progress_part part = {task->options.progress, (double)i * share, share};
        bat_curve_measure_options own = task->options;
        own.progress = progress_of_part(&part);
        bat_status status = measure_curve(task, i, &own, error);
        if (status != BAT_OK && status != BAT_CANCELLED && failed_curve != NULL)
            *failed_curve = i;
        if (status != BAT_OK)
            return status;
    }
    return BAT_OK;
}

/// Threads share the curves.
static bat_status measure_together(const set_task *task, size_t count, size_t *failed_curve, bat_error *error)
{
    shared_work work = shared_work_make(count, task->options.progress);
    bat_curve_measure_options own = task->options;
    own.threads = 1;
    own.progress = (bat_progress){0};
    int threads = threads_for(task->options.threads, count);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error fault;
        bat_status status = measure_curve(task, i, &own, &fault);
        shared_work_finish(&work, i, status, &fault);
    }
    if (failed_curve != NULL && work.failed < count)
        *failed_curve = work.failed;
    return shared_work_end(&work, error);
}

bat_status bat_curves_compare(const bat_curve *first, const bat_curve *second, size_t count,
                              const bat_curve_measure_options *options, bat_curve_distance *distances, size_t *failed_curve,
                              bat_error *error)
{
    set_task task = {.first = first, .second = second, .distances = distances};
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    task.options = options != NULL ? *options : bat_curve_measure_defaults();
    size_t threads = (size_t)threads_for(task.options.threads, SIZE_MAX);
    return count / CURVES_PER_THREAD < threads ? measure_in_turn(&task, count, failed_curve, error)
                                               : measure_together(&task, count, failed_curve, error);
}

bat_status bat_curves_fairness(const bat_curve *curves, size_t count, const bat_curve_measure_options *options,
                               bat_curve_fairness_values *fairness, size_t *failed_curve, bat_error *error)
{
    set_task task = {.first = curves, .fairness = fairness};
    bat_status status = bat_options_check(&bat_curve_measure_fields, options, error);
    if (status != BAT_OK)
        return status;
    task.options = options != NULL ? *options : bat_curve_measure_defaults();
    return measure_together(&task, count, failed_curve, error);
}

#include "batten/curve.h"

#include "base/error.h"
#include "base/threads.h"

/// Where a set of curves stands that several threads work on.
typedef struct set_state
{
    bat_status status;
    bat_error error;
    size_t failed; ///< the first curve that failed; none beyond it is begun
    size_t done;
    bool cancelled;
} set_state;

static void refine_one_of(const bat_curve *coarse, size_t index, size_t count, const bat_refine_options *options,
                          const bat_progress *progress, bat_curve *fine, set_state *state)
{
    size_t failed, done;
    bool cancelled;
#pragma omp atomic read
    failed = state->failed;
#pragma omp atomic read
    cancelled = state->cancelled;
    if (cancelled || index > failed)
        return;
    bat_error error;
    bat_status status = bat_curve_refine(coarse + index, options, fine + index, &error);
    if (status != BAT_OK)
    {
#pragma omp critical(curves_failure)
        if (index < state->failed)
        {
            state->status = status;
            state->error = error;
#pragma omp atomic write
            state->failed = index;
        }
    }
#pragma omp atomic capture
    done = ++state->done;
    if (progress->report != NULL && threads_is_calling() &&
        !progress->report(progress->context, (double)done / (double)count))
    {
#pragma omp atomic write
        state->cancelled = true;
    }
}

bat_status bat_curves_refine(const bat_curve *coarse, size_t count, const bat_refine_options *options, bat_curve *fine,
                             size_t *failed_curve, bat_error *error)
{
    bat_refine_options how = options != NULL ? *options : bat_refine_defaults();
    bat_progress progress = how.progress;
    int threads = threads_for(how.threads, count);
    if (count > 1)
    {
        how.progress = (bat_progress){0};
        how.threads = 1;
    }
    for (size_t i = 0; i < count; i++)
        fine[i] = (bat_curve){.space = coarse[i].space};
    set_state state = {.status = BAT_OK, .failed = SIZE_MAX};
    if (count == 1)
        progress = (bat_progress){0};
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
        refine_one_of(coarse, i, count, &how, &progress, fine, &state);
    if (state.status == BAT_OK && !state.cancelled)
        return BAT_OK;
    for (size_t i = 0; i < count; i++)
        bat_curve_free(fine + i);
    if (state.status == BAT_OK)
        return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    if (error != NULL)
        *error = state.error;
    if (failed_curve != NULL)
        *failed_curve = state.failed;
    return state.status;
}

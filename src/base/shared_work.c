#include "base/shared_work.h"

#include "base/error.h"
#include "base/threads.h"

shared_work shared_work_make(size_t total, bat_progress progress)
{
    return (shared_work){.progress = progress, .total = total, .failed = SIZE_MAX, .status = BAT_OK};
}

bool shared_work_wants(const shared_work *work, size_t piece)
{
    size_t failed;
    bool cancelled;
#pragma omp atomic read
    failed = work->failed;
#pragma omp atomic read
    cancelled = work->cancelled;
    return !cancelled && piece <= failed;
}

static void record_failure(shared_work *work, size_t piece, bat_status status, const bat_error *error)
{
#pragma omp critical(shared_work_failure)
    if (work->status == BAT_OK || piece < work->failed)
    {
        work->status = status;
        work->error = *error;
#pragma omp atomic write
        work->failed = piece;
    }
}

/// Report progress when this is the calling thread.
static void report(shared_work *work, size_t done)
{
    if (work->progress.report == NULL || !threads_is_calling())
        return;
    if (!work->progress.report(work->progress.context, (double)done / (double)work->total))
    {
#pragma omp atomic write
        work->cancelled = true;
    }
}

void shared_work_finish(shared_work *work, size_t piece, bat_status status, const bat_error *error)
{
    if (status != BAT_OK)
        record_failure(work, piece, status, error);
    size_t done;
#pragma omp atomic capture
    done = ++work->done;
    report(work, done);
}

void shared_work_poll(shared_work *work)
{
    size_t done;
#pragma omp atomic read
    done = work->done;
    report(work, done);
}

bat_status shared_work_end(const shared_work *work, bat_error *error)
{
    if (work->status != BAT_OK)
    {
        if (error != NULL)
            *error = work->error;
        return work->status;
    }
    if (work->cancelled)
        return error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped");
    // Another thread may have done the last piece; a wish to stop comes too late.
    if (work->progress.report != NULL)
        (void)work->progress.report(work->progress.context, 1);
    return BAT_OK;
}

#include "batten/curve.h"

#include "base/shared_work.h"
#include "base/threads.h"

bat_status bat_curves_refine(const bat_curve *coarse, size_t count, const bat_refine_options *options, bat_curve *fine,
                             size_t *failed_curve, bat_error *error)
{
    bat_refine_options how = options != NULL ? *options : bat_refine_defaults();
    // Of one curve the points are shared by threads, of several the curves.
    bool alone = count == 1;
    shared_work work = shared_work_make(count, alone ? (bat_progress){0} : how.progress);
    int threads = threads_for(how.threads, count);
    if (!alone)
    {
        how.progress = (bat_progress){0};
        how.threads = 1;
    }
    for (size_t i = 0; i < count; i++)
        fine[i] = (bat_curve){.space = coarse[i].space};
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < count; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        bat_status status = bat_curve_refine(coarse + i, &how, fine + i, &own);
        shared_work_finish(&work, i, status, &own);
    }
    bat_status status = shared_work_end(&work, error);
    if (status == BAT_OK)
        return BAT_OK;
    for (size_t i = 0; i < count; i++)
        bat_curve_free(fine + i);
    if (failed_curve != NULL && work.failed < count)
        *failed_curve = work.failed;
    return status;
}

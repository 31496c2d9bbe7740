#pragma once

#include "base/error.h"

#include <time.h>

/// Seconds since some moment in the past: for differences.
static inline double clock_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// One part of a longer piece of work: what it reports from 0 to 1 becomes begin to begin + length of the whole.
typedef struct progress_part
{
    bat_progress whole;
    double begin, length;
} progress_part;

static inline bool progress_part_report(void *context, double fraction)
{
    const progress_part *part = context;
    return part->whole.report(part->whole.context, part->begin + part->length * fraction);
}

/// The progress to hand to the part, which must outlive it. Silent when the whole is.
static inline bat_progress progress_of_part(progress_part *part)
{
    return part->whole.report == NULL ? (bat_progress){0} : (bat_progress){progress_part_report, part};
}

/// Report a share; whether the work goes on.
static inline bool progress_goes_on(bat_progress progress, double fraction)
{
    return progress.report == NULL || progress.report(progress.context, fraction);
}

/// The same; BAT_OK or BAT_CANCELLED.
static inline bat_status progress_check(bat_progress progress, double fraction, bat_error *error)
{
    bool stops = !progress_goes_on(progress, fraction);
    return stops ? error_set(error, BAT_CANCELLED, BAT_NO_INDEX, 0, "stopped") : BAT_OK;
}

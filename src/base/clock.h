#ifndef BASE_CLOCK_H
#define BASE_CLOCK_H

#include <time.h>

/// Seconds since some moment in the past: for differences.
static inline double clock_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

#endif

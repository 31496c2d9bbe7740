#ifndef SURFACE_CLOUD_LOOP_H
#define SURFACE_CLOUD_LOOP_H

#include "batten/cloud.h"

/// A closed line through points, by arc length.
typedef struct cloud_loop
{
    const double *points; ///< count x 3, the caller's; squares of their differences must fit a double
    size_t count;
    double *arc; ///< count + 1: the length from point 0 to each point, and the whole length
} cloud_loop;

/// @return BAT_OK or BAT_NO_MEMORY
bat_status cloud_loop_make(const double *points, size_t count, cloud_loop *loop, bat_error *error);
void cloud_loop_free(cloud_loop *loop);

static inline double cloud_loop_length(const cloud_loop *loop)
{
    return loop->arc[loop->count];
}

/// The place on the loop at a length from point 0, which may be any.
void cloud_loop_at(const cloud_loop *loop, double length, double place[3]);

/// Find four corners of a cloud's boundary, which must be known: see bat_cloud_find_corners().
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY
bat_status cloud_loop_corners(const bat_cloud *cloud, size_t corners[4], bat_error *error);

#endif

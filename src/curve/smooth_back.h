#ifndef CURVE_SMOOTH_BACK_H
#define CURVE_SMOOTH_BACK_H

#include "base/memory.h"
#include "batten/curve.h"

/// @file
/// Smoothed points drawn back to the given ones, near edges that meet.

/// The points of a smoothed curve, and the shares of their ways that they have come.
typedef struct smooth_back
{
    bat_curve given;  ///< its points are in `pool`
    double *smoothed; ///< the points at share 1
    double *shares, *factors;
    bool marked;      ///< an edge since the last smooth_back_move()
    memory_pool pool; ///< of all arrays
} smooth_back;

/// Copy a given curve.
/// @param back release it with smooth_back_free(), also on failure
/// @return BAT_OK or BAT_NO_MEMORY
bat_status smooth_back_make(const bat_curve *given, smooth_back *back, bat_error *error);
void smooth_back_free(smooth_back *back);

/// Take these points as those at share 1.
void smooth_back_begin(smooth_back *back, const double *points);
/// Let the points beside an edge come half as far, and points farther along the curve less and less of it.
void smooth_back_mark(smooth_back *back, size_t edge);
/// Move the points of marked edges along geodesics. `*moved` becomes true where one moved.
/// @return BAT_OK, or what bat_space_geodesic() returns
bat_status smooth_back_move(smooth_back *back, double *points, bool *moved);

#endif

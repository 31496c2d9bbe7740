#ifndef MOTION_SMOOTHER_H
#define MOTION_SMOOTHER_H

#include "base/memory.h"
#include "motion/spline_system.h"

/// @file
/// Penalized splines of noisy keys for one weight of the penalty: its system, its solution, and the influence of each key.

/// Noisy keys of one factor. Vectors are in a frame that is parallel along the keys. Of R^n one component is fitted at a
/// time, of rotations all together.
typedef struct smoother
{
    memory_pool pool; ///< holds the arrays
    const spline_factor *f;
    size_t count, dim, n; ///< keys; numbers of a point and of a tangent vector
    size_t first, last;   ///< the components that are fitted
    double scale;         ///< a hundredth of the mean distance of neighbours, to tell when steps are small
    const double *given;  ///< the measurements
    double *points;       ///< the motion
    double *lengths;      ///< count - 1, with mean 1
    double *activity;     ///< count - 1: how much the velocity changes, relative to the mean of 1
    double *frames;       ///< count x n x n: vectors of the frame; null for FACTOR_FLAT
    double *residuals;    ///< count x n: logarithms of the measurements, in the frame
    double *chords;       ///< count - 1 x n: mean velocities
    double *weights;      ///< count
    double *bends;        ///< count x n: right-hand sides, then the accelerations; rows 0 and count - 1 are 0
    double *bands;        ///< count x 3: the factors L and D of the system
    double *inverse;      ///< count x 3: the diagonal of its inverse, and the two beside it
    double *influence;    ///< count: of each measurement on its own key
} smoother;

/// Allocate the arrays, and begin with the measurements, which stay the caller's.
bat_status smoother_begin(smoother *s, const spline_factor *f, size_t count, const double *lengths, const double *given,
                          bat_error *error);

/// Move the points to the penalized spline, by Gauss-Newton steps from where they are.
/// @param accuracy of the steps, relative to the scale
/// @return BAT_OK; BAT_CUT_LOCUS where the motion leaves a measurement by half a turn
bat_status smoother_fit(smoother *s, double weight, double accuracy, bat_error *error);

/// Fill `influence` after a fit. Returns the sum, the degrees of freedom of a component.
double smoother_influence(smoother *s, double weight);

/// The sum of the weighted squares of the residuals of the components that are fitted, of which none counts more than `cut`.
double smoother_squares(const smoother *s, double cut);

#endif

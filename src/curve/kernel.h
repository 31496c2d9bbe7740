#ifndef CURVE_KERNEL_H
#define CURVE_KERNEL_H

#include "batten/curve.h"
#include "curve/mask.h"

/// A subdivision step as the drivers see it: which old points a new one depends on, and the function that makes new points.
///
/// New point i depends on the old points from ceil((i - last) / 2) to floor((i - first) / 2), as if it had a mask on the
/// indices first … last.
typedef struct refine_kernel refine_kernel;

/// Averages of neighbours: row i of the result, `stride` numbers after the one before, is made of the rows i and i + 1 of
/// `rows`, for i < count. The result may be `rows` itself. On failure *fault is the row at fault.
typedef bat_status row_average(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                               size_t stride, size_t *fault);

struct refine_kernel
{
    const bat_space *space;
    const bat_curve_scheme *scheme;
    const struct angle_surface *surface; ///< angle-based and rules: the vector code of the space; null for a user's space
    size_t dim;                          ///< numbers a point is stored in
    int first, last;                     ///< support of the step, see above
    mask_taps even, odd;                 ///< of a linear scheme; of a log-exp scheme only the odd ones
    double scale; ///< angle-based: a power of two that brings coordinates near 1, so that no product of chords overflows
    double mean_angle;    ///< what the adaptive scheme needs to know of the whole polygon: its mean absolute exterior angle
    double mean_length;   ///< what an angle rule may want to know of it: its mean edge length
    row_average *average; ///< Lane-Riesenfeld: what takes the place of the arithmetic mean
    size_t order;         ///< Lane-Riesenfeld: rounds of averaging
    const struct bat_hermite_mask *hermite_mask; ///< linear Hermite schemes
    bat_curve_base hermite_base;                 ///< likewise
    size_t scratch_size;                         ///< bytes that one call of run() needs
    size_t chunk;                                ///< points worth a thread's while; 0 where they cost next to nothing

    /// Make the new points 2 j and 2 j + 1 for j = 0 … pairs - 1; row 0 of `points` is old point 0, and rows before and
    /// behind it are there as the support asks. `scratch` is aligned to 64 bytes. On failure *fault is the pair at fault.
    bat_status (*run)(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, void *scratch,
                      size_t *fault);
};

/// A mask on rows of `dim` numbers.
refine_kernel kernel_linear(const bat_curve_scheme *scheme, size_t dim);
/// An angle-based step; the space must be oriented.
refine_kernel kernel_angle(const bat_space *space, const bat_curve_scheme *scheme);
/// The mean absolute exterior angle at the points first … end - 1, 0 when there are none; the rows before and behind are
/// there. The kernel knows its scale.
double kernel_angle_mean(const refine_kernel *kernel, const double *points, size_t first, size_t end);
/// An angle-based step whose angles come from scheme->rule; the space must be oriented.
refine_kernel kernel_rule(const bat_space *space, const bat_curve_scheme *scheme);
/// The mean length of the edges first … end - 1, 0 when there are none. The kernel knows its scale.
double kernel_rule_mean_length(const refine_kernel *kernel, const double *points, size_t first, size_t end);
/// A log-exp step.
refine_kernel kernel_log_exp(const bat_space *space, const bat_curve_scheme *scheme);
/// Doubling followed by `order` rounds of averaging rows of `dim` numbers (Lane and Riesenfeld 1980), centred as
/// bat_mask_lane_riesenfeld() is.
refine_kernel kernel_lane_riesenfeld(const bat_space *space, size_t dim, size_t order, row_average *average);
/// kernel_lane_riesenfeld() of points by midpoints of geodesics.
refine_kernel kernel_geodesic(const bat_space *space, const bat_curve_scheme *scheme);

#endif

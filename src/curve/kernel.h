#pragma once

#include "batten/curve.h"
#include "curve/mask.h"

#include <stddef.h>

/// A subdivision step as the drivers see it: which old points a new one depends on, and the function that makes new points.
///
/// New point i depends on the old points from ceil((i - last) / 2) to floor((i - first) / 2), as by a mask first … last.
typedef struct refine_kernel refine_kernel;

/// Averages of neighbours: row i of the result, `stride` numbers after the one before, is made of the rows i and i + 1 of
/// `rows`, for i < count. The result may be `rows` itself. On failure *fault is the failing row.
typedef bat_status row_average(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                               size_t stride, size_t *fault);

/// Bytes for the private data of a kind of scheme; the largest is a pair of mask_taps.
#define KERNEL_DATA (2 * sizeof(mask_taps) + 64)

struct refine_kernel
{
    const bat_space *space;
    size_t dim;          ///< numbers a point is stored in
    int first, last;     ///< support of the step, see above
    size_t scratch_size; ///< bytes that one call of run() needs
    size_t level;        ///< levels before this one, where each level has a kernel of its own; else 0
    size_t chunk;        ///< points that are worth a thread; 0 where they cost next to nothing

    /// Make the new points 2 j and 2 j + 1 for j = 0 … pairs - 1; row 0 of `points` is old point 0, and rows before and
    /// behind it are there as the support asks. `scratch` is aligned to 64 bytes. On failure *fault is the failing pair.
    bat_status (*run)(const refine_kernel *kernel, const double *points, size_t pairs, double *fine, void *scratch,
                      size_t *fault);
    /// Optional: measure the whole polygon of a level before run(), `count` points with the rows around them.
    void (*measure)(refine_kernel *kernel, const double *points, size_t count, bool closed);

    _Alignas(max_align_t) unsigned char data[KERNEL_DATA]; ///< the kind's own, see kernel_data()
};

/// floor(i / 2) for negative numbers, too.
static inline ptrdiff_t floor_half(ptrdiff_t i)
{
    return (i - (i & 1)) / 2;
}

/// The private data of a kernel, a struct of its kind. The struct fits KERNEL_DATA and holds no pointer to itself.
static inline void *kernel_data(refine_kernel *kernel)
{
    return kernel->data;
}

/// The same to read.
static inline const void *kernel_data_of(const refine_kernel *kernel)
{
    return kernel->data;
}

/// A mask on rows of `dim` numbers.
refine_kernel kernel_linear(const bat_curve_scheme *scheme, size_t dim);
/// An angle-based step; the space must be oriented.
refine_kernel kernel_angle(const bat_space *space, const bat_curve_scheme *scheme);
/// An angle-based step whose angles come from scheme->rule; the space must be oriented.
refine_kernel kernel_rule(const bat_space *space, const bat_curve_scheme *scheme);
/// A log-exp step.
refine_kernel kernel_log_exp(const bat_space *space, const bat_curve_scheme *scheme);
/// The four-point step at parameters of the points (BAT_CURVE_SCHEME_KIND_FOUR_POINT). A row is a point of the space and
/// `channel_count` numbers, which the step interpolates at the parameters of the points.
refine_kernel kernel_four_point(const bat_space *space, size_t channel_count, const bat_curve_scheme *scheme);
/// Doubling, then `order` rounds of averaging rows of `dim` numbers, centred as bat_mask_lane_riesenfeld() is.
refine_kernel kernel_lane_riesenfeld(const bat_space *space, size_t dim, size_t order, row_average *average);
/// A power of two that brings `count` x dimension coordinates near 1, so that no product of chords overflows.
double kernel_scale(const double *points, size_t count, size_t dim);
/// Whether a mask has a meaning on geodesics: one of Lane and Riesenfeld, or corner cutting (means of two neighbours).
bool kernel_has_geodesic(const bat_mask *mask);
/// kernel_lane_riesenfeld() of points by midpoints of geodesics, or corner cutting; the mask has kernel_has_geodesic().
refine_kernel kernel_geodesic(const bat_space *space, const bat_curve_scheme *scheme);

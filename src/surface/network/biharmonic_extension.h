#ifndef SURFACE_NETWORK_BIHARMONIC_EXTENSION_H
#define SURFACE_NETWORK_BIHARMONIC_EXTENSION_H

#include "batten/cloud.h"

/// @file
/// Extension of the parameters on the boundary loop to space by a biharmonic smoothing spline,
///     f(x) = a + B x - sum_k w_k |x - x_k|,   f(x_i) + lambda w_i = u_i,   sum_k w_k = 0,   sum_k w_k x_k = 0.
/// The kernel |x| is that of the biharmonic spline in space (Duchon 1977; Wahba 1990, section 2.4). lambda grows with the
/// noise of the loop, so that f smooths noisy loops instead of interpolating them.

/// The spline f.
typedef struct biharmonic_extension
{
    double *centres; ///< count x 3: the x_k, relative to `middle`
    double *weights; ///< (count + 4) x 2: w, a, B
    size_t count;
    double middle[3]; ///< mean of the loop
    double
        noise; ///< estimated standard deviation of a coordinate of the loop's points; about three quarters of the true one
} biharmonic_extension;

/// Compute the spline.
/// @param cloud    in the unit box
/// @param boundary cloud->boundary_count x 2
/// @return BAT_OK, BAT_NO_MEMORY, or BAT_NO_CONVERGENCE when the system is singular
bat_status biharmonic_extension_make(const bat_cloud *cloud, const double *boundary, biharmonic_extension *extension,
                                     bat_error *error);
void biharmonic_extension_free(biharmonic_extension *extension);
/// Evaluate the spline, clamped to the unit square.
/// @param points     count x 3
/// @param parameters receives count x 2, in [0, 1]
void biharmonic_extension_evaluate(const biharmonic_extension *extension, const double *points, size_t count,
                                   double *parameters);

#endif

#ifndef SURFACE_TRIM_TRIMMING_H
#define SURFACE_TRIM_TRIMMING_H

#include "surface/trim/outline.h"

/// @file
/// Trimmed surfaces: the chart of a cloud, its outline and holes, and the trimming curves of a fit over the chart's
/// rectangle.

/// What is known of a trimmed surface before the fit.
typedef struct surface_trimming
{
    planar_chart chart;
    outline_loops loops;
} surface_trimming;

/// Make the chart and find the loops.
/// @param fill holes of at most this diameter are to be closed, in units of the cloud
/// @return BAT_OK; see planar_chart_make() and outline_find(); release `trimming` in both cases
bat_status trimming_make(const cloud_geometry *geometry, double fill, surface_trimming *trimming, bat_error *error);
void trimming_free(surface_trimming *trimming);

/// The parameters of the points in the chart's rectangle.
/// @param parameters receives count x 2, in the cloud's order
void trimming_parameters(const cloud_geometry *geometry, const surface_trimming *trimming, double *parameters);

/// The curves of all loops, the filled ones included.
/// @param parameters of the points after the fit, count x 2, in the cloud's order
/// @return BAT_OK or BAT_NO_MEMORY; `trim` is empty on failure
bat_status trimming_curves(const cloud_geometry *geometry, const surface_trimming *trimming, const double *parameters,
                           bat_spline_trim *trim, bat_error *error);
/// Remove the curves of the filled loops. Returns their number.
size_t trimming_drop_filled(const surface_trimming *trimming, bat_spline_trim *trim);

#endif

#ifndef MODELS_SURFACE_CANDIDATE_H
#define MODELS_SURFACE_CANDIDATE_H

#include "batten/surface.h"

/// @file
/// One way to find a cloud's parameters, and a fit on trial.

/// All zero: none. Release it with surface_candidate_free().
typedef struct surface_candidate
{
    bat_surface_candidate report;
    double *parameters; ///< count x 2, unfolded, as fits begin with them
    double *corrected;  ///< count x 2, as the fit left them; null where that went through a part of the points
    bat_spline_surface surface;
    bat_surface_fit_report fit;
} surface_candidate;

void surface_candidate_free(surface_candidate *candidate);

/// Parameterize and unfold.
/// @param boundary cloud->boundary_count x 2; null for given parameters
/// @return BAT_OK, also where the candidate is out, as its report's failure says; BAT_NO_MEMORY
bat_status surface_candidate_make(const bat_cloud *cloud, const double *boundary, const bat_surface_options *options,
                                  bat_surface_parameters kind, surface_candidate *candidate, bat_error *error);

/// Fit all points, and keep the surface.
/// @param slides as in bat_fit_data
/// @return as surface_candidate_make(), or BAT_CANCELLED
bat_status surface_candidate_fit(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides,
                                 surface_candidate *candidate, bat_error *error);
/// Fit about `points` of them, and keep the figures alone.
bat_status surface_candidate_try(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides, size_t points,
                                 surface_candidate *candidate, bat_error *error);

/// Whether a candidate is better than another, by its fit. One that failed never is.
bool surface_candidate_is_better(const surface_candidate *candidate, const surface_candidate *than,
                                 const bat_surface_fit_options *options);

#endif

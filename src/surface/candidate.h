#ifndef SURFACE_CANDIDATE_H
#define SURFACE_CANDIDATE_H

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
/// @param slides as in bat_surface_fit_data
/// @return as surface_candidate_make(), or BAT_CANCELLED
bat_status surface_candidate_fit(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides,
                                 surface_candidate *candidate, bat_error *error);
/// Fit about `points` of them, and keep the figures alone.
bat_status surface_candidate_fit_sample(const bat_cloud *cloud, const bat_surface_fit_options *options, bool slides,
                                        size_t points, surface_candidate *candidate, bat_error *error);

/// The best of candidates by their fits: of those that stray less than twice as far as another, the one with fewer functions
/// where both reach the tolerance, else the one with the smaller distances. The first where all have failed. Notes which
/// stray.
size_t surface_candidate_best(surface_candidate *candidates, size_t count, const bat_surface_fit_options *options);

#endif

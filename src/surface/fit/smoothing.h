#ifndef SURFACE_FIT_SMOOTHING_H
#define SURFACE_FIT_SMOOTHING_H

#include "surface/fit/fit_solve.h"
#include "surface/fit/system.h"

/// @file
/// The weight of smoothing: solutions of the normal equations for a given one, and the search for a good one.

/// What to look for and from where.
typedef struct fit_weight_search
{
    bat_surface_smoothing smoothing;
    double noise;  ///< of a coordinate, for BAT_SURFACE_SMOOTHING_DISCREPANCY
    double lambda; ///< the given one, or where the search begins; 0: nowhere in particular
    int trials;    ///< the most weights tried, at least 1
    bat_progress progress;
} fit_weight_search;

/// Solve (G + 2 lambda M) c = b. Where that is singular in double precision, lambda is raised until it is not.
/// @param lambda  receives what was used
/// @param control functions x dimension
bat_status fit_weight_solve(const fit_system *system, fit_solver *solver, double *lambda, double *control, bat_error *error);

/// Solve with the best weight that the search finds.
/// @param lambda receives it
bat_status fit_weight_find(const fit_system *system, fit_solver *solver, const fit_weight_search *search, double *lambda,
                           double *control, bat_error *error);

#endif

#ifndef SURFACE_FIT_SMOOTHING_H
#define SURFACE_FIT_SMOOTHING_H

#include "surface/fit/fit_solve.h"
#include "surface/fit/system.h"

/// @file
/// Solution of the normal equations for a smoothing weight lambda, and the choice of lambda by restricted maximum
/// likelihood, generalized cross-validation with unknown or given noise.

/// The criterion and the start of a search for lambda.
typedef struct fit_weight_search
{
    bat_surface_smoothing smoothing;
    double noise;  ///< root of the variance to assume, for BAT_SURFACE_SMOOTHING_NOISE
    double spread; ///< ratio of the variance to assume to that of residuals: above 1 after parameter correction
    double lambda; ///< the given weight, or the start of the search; 0: no estimate is known
    int trials;    ///< maximum number of weights to evaluate, at least 1
    bat_progress progress;
} fit_weight_search;

/// Solve (G + 2 lambda M) c = b. If the matrix is singular in double precision, lambda is increased until it is not.
/// @param lambda  receives the weight used
/// @param control functions x dimension
bat_status fit_weight_solve(const fit_system *system, fit_solver *solver, double *lambda, double *control, bat_error *error);

/// Search for the best weight and solve with it.
/// @param lambda receives the weight
/// @param trace  receives the estimated trace of the influence matrix; NaN for a given weight
bat_status fit_weight_find(const fit_system *system, fit_solver *solver, const fit_weight_search *search, double *lambda,
                           double *trace, double *control, bat_error *error);

#endif

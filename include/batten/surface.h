#ifndef BATTEN_SURFACE_H
#define BATTEN_SURFACE_H

#include "batten/parameterize.h"
#include "batten/surface_fit.h"
#include "batten/surface_model.h"

BAT_C_BEGIN

/// @file
/// From a cloud to a surface in one call.

/// Where parameters come from.
typedef enum bat_surface_parameters
{
    BAT_SURFACE_AUTO,    ///< tries learned and classical ones and takes those that fit best by measure (default)
    BAT_SURFACE_LEARNED, ///< the network
    BAT_SURFACE_UNIFORM,
    BAT_SURFACE_INVERSE_DISTANCE,
    BAT_SURFACE_SHAPE_PRESERVING,
    BAT_SURFACE_MEAN_VALUE,
    BAT_SURFACE_GIVEN ///< brought by the caller
} bat_surface_parameters;

BAT_API const char *bat_surface_parameters_name(bat_surface_parameters parameters);

/// How. Begin with bat_surface_defaults().
typedef struct bat_surface_options
{
    bat_surface_fit_options fit;
    bat_surface_parameters parameters;
    bat_side_parameters sides;
    bool published;                 ///< classical neighbourhoods as published
    const bat_surface_model *model; ///< null: the built-in one
    const double *given;            ///< count x 2 for BAT_SURFACE_GIVEN
    bool no_repair;                 ///< leave folds, only report them
} bat_surface_options;

BAT_API bat_surface_options bat_surface_defaults(void);

/// One candidate of BAT_SURFACE_AUTO, or the one that was asked for.
typedef struct bat_surface_candidate
{
    bat_surface_parameters parameters;
    bat_status status;           ///< of its parameterization
    double mean_squared;         ///< of the trial fit; NaN when it failed
    double seconds;              ///< of its parameterization
    bat_parameters_report folds; ///< before repair
} bat_surface_candidate;

#define BAT_SURFACE_MOST_CANDIDATES 6

/// What came of it. Release it with bat_surface_result_free().
typedef struct bat_surface_result
{
    bat_spline_surface surface;
    bat_surface_fit_report report;
    double *parameters; ///< count x 2, after correction
    bat_surface_parameters chosen;
    bat_surface_candidate candidates[BAT_SURFACE_MOST_CANDIDATES];
    size_t candidate_count;
    bat_parameters_report folds; ///< of the final parameters
} bat_surface_result;

BAT_API void bat_surface_result_free(bat_surface_result *result);

/// Fit a surface to a cloud: find the boundary and corners if they are not known, parameterize, unfold, fit adaptively.
/// @param cloud boundary points are brought to the front where they have to be found
BAT_API bat_status bat_surface_reconstruct(bat_cloud *cloud, const bat_surface_options *options, bat_surface_result *result,
                                           bat_error *error);

BAT_C_END

#endif

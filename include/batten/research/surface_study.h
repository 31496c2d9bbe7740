#ifndef BATTEN_RESEARCH_SURFACE_STUDY_H
#define BATTEN_RESEARCH_SURFACE_STUDY_H

#include "batten/research/surface_shapes.h"
#include "batten/surface.h"

BAT_C_BEGIN

/// @file
/// The experiments of Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 6, with our clouds or any
/// scans. docs/surface-figures.md has results.

/// A way to find parameters.
typedef struct bat_surface_method
{
    const char *name; ///< stays the caller's
    bat_surface_parameters parameters;
    bool published;                 ///< classical neighbourhoods as published
    const bat_surface_model *model; ///< of learned ones; null: the built-in one
    bool unfolded;                  ///< in adaptive fits: folds are repaired first, which the paper does not do
} bat_surface_method;

/// How to study. Begin with bat_surface_study_defaults().
typedef struct bat_surface_study_options
{
    size_t clouds; ///< of each case, at least 1; default 100
    uint64_t seed; ///< of the clouds; default 1
    int threads;   ///< 0: as many as OpenMP gives; only times depend on it
    bat_progress progress;
} bat_surface_study_options;

BAT_API bat_surface_study_options bat_surface_study_defaults(void);

/// What random clouds to study.
typedef struct bat_surface_case
{
    size_t points; ///< inside of a cloud; the boundary is as dense
    double noise;  ///< standard deviation of each coordinate
    int degree;    ///< of surface and fit, in both parameters
} bat_surface_case;

/// How a method did. Errors are mean squares over points and coordinates of what the best Bézier patch with its parameters
/// leaves, in the unit box of the cloud: coordinates over its longest side.
typedef struct bat_surface_score
{
    size_t succeeded; ///< clouds that it could parameterize; the means are over these
    double mse;
    double excess;  ///< mse less that with the parameters that the points were sampled at; NaN for scans
    double seconds; ///< of one thread, for the parameters and the patch of one cloud
} bat_surface_score;

/// Try methods on random Bézier clouds, whose boundaries have their true parameters (figures 4 to 9). Cases of one degree
/// and number of points differ in noise alone.
/// @param scores receives `count` scores
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_CANCELLED; what bat_cloud_bezier() and bat_surface_model_builtin() return
BAT_API bat_status bat_surface_study_clouds(const bat_surface_case *what, const bat_surface_method *methods, size_t count,
                                            const bat_surface_study_options *options, bat_surface_score *scores,
                                            bat_error *error);

/// Try methods on a scan by one Bézier patch, with chord-length parameters on the boundary (figure 12). `succeeded` is 0
/// or 1.
/// @param cloud with a boundary; corners are found where it has none
BAT_API bat_status bat_surface_study_scan(const bat_cloud *cloud, int degree, const bat_surface_method *methods,
                                          size_t count, bat_surface_score *scores, bat_error *error);

/// An adaptive fit of a study.
typedef struct bat_surface_trial
{
    bool own; ///< the published neighbourhoods failed, and ours took their place
    bat_surface_result result;
} bat_surface_trial;

BAT_API void bat_surface_trial_free(bat_surface_trial *trial);

/// Fit a scan adaptively with the parameters of a method (figures 14 to 16).
/// @param fit   the degrees, and how many functions
/// @param trial release it with bat_surface_trial_free()
/// @return as bat_surface_reconstruct()
BAT_API bat_status bat_surface_study_fit(const bat_cloud *cloud, const bat_surface_method *method,
                                         const bat_surface_fit_options *fit, bat_surface_trial *trial, bat_error *error);

/// Draw adaptive fits of a cloud below each other, with one scale of colours.
/// @param path .png, .svg or .pdf
BAT_API bat_status bat_surface_study_draw(const char *path, const bat_cloud *cloud, const bat_surface_method *methods,
                                          const bat_surface_trial *trials, size_t count, bat_error *error);

BAT_C_END

#endif

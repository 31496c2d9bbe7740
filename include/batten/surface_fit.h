#ifndef BATTEN_SURFACE_FIT_H
#define BATTEN_SURFACE_FIT_H

#include "batten/spline_hierarchical.h"

BAT_C_BEGIN

/// @file
/// Spline surfaces through scattered points with parameters: penalized least squares and the adaptive loop of Giannelli,
/// Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 5, after Kiss et al. (2014).

/// Points and their parameters.
typedef struct bat_surface_fit_data
{
    const double *points;  ///< count x dimension
    double *parameters;    ///< count x 2 in [0, 1]^2; parameter correction moves them
    size_t count;          ///< at least 1
    size_t dimension;      ///< at least 1
    size_t boundary_count; ///< the first points whose parameters lie on the boundary, which correction never takes them off
    /// Whether correction moves boundary parameters along their sides. Where the boundary has few points against the
    /// functions they crowd, and the surface runs wild between. False: they stay; those at the square's corners always do.
    bool slides;
} bat_surface_fit_data;

/// The most rings of cells that are refined around a marked one.
#define BAT_SURFACE_FIT_MAX_NEIGHBOURS 64

/// How the smoothing weight is found.
typedef enum bat_surface_smoothing
{
    BAT_SURFACE_SMOOTHING_LIKELIHOOD,       ///< restricted maximum likelihood: Wahba (1985)
    BAT_SURFACE_SMOOTHING_CROSS_VALIDATION, ///< generalized cross-validation: Craven and Wahba (1979)
    BAT_SURFACE_SMOOTHING_DISCREPANCY,      ///< the residual matches the noise that is given: Morozov (1966)
    BAT_SURFACE_SMOOTHING_GIVEN             ///< the number in the options
} bat_surface_smoothing;

/// When the adaptive loop stops and what it does. Begin with bat_surface_fit_defaults().
typedef struct bat_surface_fit_options
{
    bat_hierarchical_options space; ///< to begin with: default bidegree (2, 2), one cell, truncated, of no class
    double
        tolerance; ///< points farther than this from S(u) mark their cells; at least 0; 0: found from the budget; default 0
    double share;  ///< stop when this share of points lies within the tolerance, above 0 to 1; default 1
    size_t functions; ///< the most functions: the loop stops before more, and fills the budget with the worst cells; 0: none
                      ///< set; default 0. Without a tolerance and a budget the loop stops at a quarter of the points
    int iterations;   ///< the most refinements, 0 or more; default 30
    int neighbours; ///< rings of cells of its level refined around a marked one; to BAT_SURFACE_FIT_MAX_NEIGHBOURS; default
                    ///< 1
    bat_surface_smoothing smoothing; ///< default likelihood, which corrected parameters do not mislead
    double weight; ///< lambda of eq. (5) for BAT_SURFACE_SMOOTHING_GIVEN, at least 0; it does not depend on the points' unit
    double
        noise; ///< standard deviation of a coordinate for BAT_SURFACE_SMOOTHING_DISCREPANCY, in units of the points; above 0
    int corrections;       ///< parameter corrections after each fit, 0 or more; default 1
    int final_corrections; ///< rounds of correction and fit after the last refinement, 0 or more; default 0
    bool robust; ///< re-weight: points far off count less (Tukey's biweight on the residuals' scale); default false
    int threads; ///< 0: as many as OpenMP gives; the result does not depend on it
    bat_progress progress;
} bat_surface_fit_options;

BAT_API bat_surface_fit_options bat_surface_fit_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_surface_fit_options_check(const bat_surface_fit_options *options, bat_error *error);

/// One round of the loop. Distances are |S(u_i) - x_i|.
typedef struct bat_surface_fit_round
{
    size_t functions;
    size_t levels;
    double mean_squared; ///< mean over points of squared distance
    double rms;          ///< its root
    double largest;
    size_t worst;   ///< the point of the largest
    double within;  ///< share of points within the tolerance; without one, of those that are met exactly
    double weight;  ///< of smoothing, lambda of eq. (5)
    double seconds; ///< since the beginning
} bat_surface_fit_round;

/// A report. Release it with bat_surface_fit_report_free().
typedef struct bat_surface_fit_report
{
    bat_surface_fit_round *rounds; ///< the last is that of the result
    size_t count;
    double *distances; ///< of every point, signed by nothing; data count
    size_t moved;      ///< parameters that correction has moved
    size_t outliers;   ///< points that robust weights have switched off
    bool reached;      ///< the tolerance (share) or the budget that was asked for has been met
} bat_surface_fit_report;

BAT_API void bat_surface_fit_report_free(bat_surface_fit_report *report);

/// Fit control points over a space by penalized least squares, eq. (5) of the paper:
///     min  1/2 sum_i w_i |S(u_i) - x_i|^2  +  lambda  integral |S_uu|^2 + |S_uv|^2 + |S_vv|^2
/// The matrix of the thin plate is exact (Gauss' rule on every cell). Where points say nothing and lambda is 0, the least
/// bit of smoothing that makes the system regular in double precision is added; `*lambda` then says so.
/// @param weights count, at least 0; null: ones
/// @param lambda  the weight of smoothing, at least 0; receives what was used
/// @param control receives functions x dimension
/// @return BAT_OK; BAT_INVALID_ARGUMENT; BAT_INVALID_POINT with the first point that is not finite or parameter not in the
/// square;
///         BAT_NO_CONVERGENCE when the system is singular beyond repair; BAT_TOO_LARGE; BAT_NO_MEMORY
BAT_API bat_status bat_spline_fit(const bat_hierarchical_space *space, const bat_surface_fit_data *data,
                                  const double *weights, double *lambda, double *control, bat_error *error);

/// Find parameters of feet: for each point the parameter near its own where S comes nearest, eq. (6), by a safeguarded
/// Newton method that never makes a distance larger. Boundary parameters stay on their side and go at most half way to its
/// corners.
/// @param moved receives how many changed; may be null
BAT_API bat_status bat_spline_correct(const bat_spline_surface *surface, bat_surface_fit_data *data, size_t *moved,
                                      bat_error *error);

/// The adaptive loop: fit, measure, mark, refine, correct.
/// @param surface receives the surface; release it with bat_spline_surface_free()
/// @param report  may be null; else release it with bat_surface_fit_report_free()
/// @return as bat_spline_fit(), or BAT_CANCELLED
BAT_API bat_status bat_surface_fit(bat_surface_fit_data *data, const bat_surface_fit_options *options,
                                   bat_spline_surface *surface, bat_surface_fit_report *report, bat_error *error);

BAT_C_END

#endif

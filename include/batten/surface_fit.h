#ifndef BATTEN_SURFACE_FIT_H
#define BATTEN_SURFACE_FIT_H

#include "batten/spline.h"

BAT_C_BEGIN

/// @file
/// Spline surfaces through scattered points with parameters: penalized least squares, and adaptive refinement. Source:
/// Giannelli, Imperatore, Mantzaflaris and Scholz, "BIDGCN" (2023), section 5, after Kiss et al. (2014).

/// Border curves of a fit by several processes; see batten/research/distributed.h.
typedef struct bat_surface_border bat_surface_border;

/// Points and their parameters.
typedef struct bat_surface_fit_data
{
    const double *points;  ///< count x dimension
    double *parameters;    ///< count x 2 in [0, 1]^2; changed by parameter correction
    size_t count;          ///< at least 1
    size_t dimension;      ///< at least 1
    size_t boundary_count; ///< number of leading points with parameters on the boundary, where correction keeps them
    /// Whether correction moves boundary parameters along their sides; those at the square's corners always stay. With few
    /// boundary points for the number of functions, they cluster, and the surface oscillates between them.
    bool slides;
    /// Whether each side gets a border curve with a smoothing weight of its own. The curves hold the border of the surface,
    /// and boundary points are then as free as others. It takes six boundary points on each side, else this has no effect.
    bool border;
    /// The border curves of bat_surface_fit_together(), which takes them; null: none.
    bat_surface_border *curves;
    /// Places near the surface that hold it where there are few points: each counts a tenth of a point. For
    /// bat_surface_fit().
    const double *guides;           ///< guide_count x dimension; null: none
    const double *guide_parameters; ///< guide_count x 2 in [0, 1]^2
    size_t guide_count;
} bat_surface_fit_data;

/// The largest number of rings of cells that are refined around a marked one.
#define BAT_SURFACE_FIT_MAX_NEIGHBOURS 64

/// The choice of the smoothing weight.
typedef enum bat_surface_smoothing
{
    BAT_SURFACE_SMOOTHING_AUTO,             ///< the default: BAT_SURFACE_SMOOTHING_LIKELIHOOD
    BAT_SURFACE_SMOOTHING_LIKELIHOOD,       ///< restricted maximum likelihood: Wahba (1985)
    BAT_SURFACE_SMOOTHING_CROSS_VALIDATION, ///< generalized cross-validation: Craven and Wahba (1979)
    BAT_SURFACE_SMOOTHING_NOISE,            ///< restricted maximum likelihood, with the noise that is given
    BAT_SURFACE_SMOOTHING_GIVEN             ///< the number in the options
} bat_surface_smoothing;

/// The choices of the weight by name.
extern BAT_API const bat_family bat_surface_smoothing_family;

/// Options of the adaptive fit. Begin with bat_surface_fit_defaults().
typedef struct bat_surface_fit_options
{
    bat_hierarchical_options space; ///< the first space; default bidegree (3, 3), one cell, truncated, of no class
    double tolerance;               ///< farther points mark their cells; at least 0; 0: set by the budget; default 0
    double share;                   ///< stop when this share of points is within the tolerance; above 0, to 1; default 1
    size_t functions;               ///< the budget of functions; 0: as many as reduce the distances of held-out points, at
                                    ///< most a quarter of the points, beside a tolerance half of them
    int hold_out; ///< one in this many points along a space-filling curve is held out of the fits while the space is
                  ///< refined, 2 to 1000; 0: none, and `functions` 0 is the limit above; default 10. Fewer than 200 points:
                  ///< none
    int iterations;                  ///< the most refinements, 0 to 1000; default 30
    int neighbours;                  ///< rings of cells refined around a marked one, 0 to 64; default 1
    bat_surface_smoothing smoothing; ///< default likelihood, which is robust against parameter correction
    double weight;                   ///< of smoothing GIVEN: lambda of eq. (5), at least 0; independent of the points' unit
    double noise;                    ///< of smoothing NOISE: standard deviation of a coordinate, above 0
    int corrections;                 ///< parameter corrections after each fit, 0 to 1000; default 1
    int final_corrections;           ///< rounds of correction and fit after the last refinement, 0 to 1000; default 0
    bool restarts; ///< project points anew whose projection converged to a wrong foot; published loops do not; default true
    /// Refine all cells at once and keep the parameters: a tensor-product surface. Distances are those of feet all the same.
    /// Default false
    bool tensor;
    bool robust;           ///< robust weights: Tukey's biweight on the scale of the residuals; default false
    int threads;           ///< 0 to 1024; 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress; ///< default: none
} bat_surface_fit_options;

/// The default options.
BAT_API bat_surface_fit_options bat_surface_fit_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_surface_fit_fields;

/// One round of the loop. Distances are |S(u_i) - x_i|.
typedef struct bat_surface_fit_round
{
    size_t functions;
    size_t levels;
    double mean_squared; ///< mean over points of squared distance
    double rms;          ///< its root
    double largest;
    size_t worst;    ///< the point of the largest
    double within;   ///< share of points within the tolerance; without one, of those that are met exactly
    double held_out; ///< root mean square distance of the points that this round's fit held out; NaN without
    double weight;   ///< of smoothing, lambda of eq. (5)
    double seconds;  ///< since the beginning
} bat_surface_fit_round;

/// A report. Release it with bat_surface_fit_report_free().
typedef struct bat_surface_fit_report
{
    bat_surface_fit_round *rounds; ///< the last is that of the result
    size_t count;
    double *distances;       ///< unsigned distance of each point, [count]
    size_t moved;            ///< parameters changed by correction
    size_t outliers;         ///< points of robust weight 0
    bool reached;            ///< the tolerance (for the share) or the budget of functions is met, or the size was found
    bool stalled;            ///< refinement ended because the distances of held-out points no longer fell
    size_t held_out_count;   ///< points that were held out; 0: none, and the next two are NaN
    double held_out_rms;     ///< of a fit in the final space to the other points; with robust weights, of inliers
    double held_out_largest; ///< the largest of these distances
    /// Expected root mean square distance of a new point: of the held-out ones (a third, in logarithms) and by generalized
    /// cross-validation of the others. It chooses the size, and among candidates. NaN without held-out points
    double expected_rms;
} bat_surface_fit_report;

/// Free what a report owns and make it empty.
BAT_API void bat_surface_fit_report_free(bat_surface_fit_report *report);

/// Fit a surface adaptively: fit, measure, mark, refine, correct. Some points are held out. Refinement ends when their
/// distances no longer fall, unless a number of functions is given. The last fit is to all points in the best space.
/// @param options null for the defaults
/// @param surface receives the surface; release it with bat_spline_surface_free()
/// @param report  may be null; else release it with bat_surface_fit_report_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT, BAT_NO_CONVERGENCE, BAT_NO_MEMORY or BAT_CANCELLED; results are
///         untouched on failure
BAT_API bat_status bat_surface_fit(bat_surface_fit_data *data, const bat_surface_fit_options *options,
                                   bat_spline_surface *surface, bat_surface_fit_report *report, bat_error *error);

BAT_C_END

#endif

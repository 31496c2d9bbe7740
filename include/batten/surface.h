#ifndef BATTEN_SURFACE_H
#define BATTEN_SURFACE_H

#include "batten/cloud_parameterize.h"
#include "batten/surface_fit.h"

BAT_C_BEGIN

/// @file
/// From a cloud to a spline surface in one call. docs/surfaces.md describes the steps.

/// The source of the parameters.
typedef enum bat_surface_parameters
{
    BAT_SURFACE_PARAMETERS_AUTO,    ///< the best of learned and classical ones, by the measured fit (default)
    BAT_SURFACE_PARAMETERS_LEARNED, ///< the network
    BAT_SURFACE_PARAMETERS_UNIFORM,
    BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE,
    BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING,
    BAT_SURFACE_PARAMETERS_MEAN_VALUE, ///< for clouds that were meshes
    BAT_SURFACE_PARAMETERS_STRETCH_MINIMIZING,
    BAT_SURFACE_PARAMETERS_ISOMETRIC, ///< least distortion, for deep shapes
    BAT_SURFACE_PARAMETERS_GIVEN,     ///< those of the caller
    BAT_SURFACE_PARAMETERS_PLANAR,    ///< of a trimmed surface: a chart with free boundary
    BAT_SURFACE_PARAMETERS_COUNT      ///< how many there are
} bat_surface_parameters;

/// The choices by name; BAT_SURFACE_PARAMETERS_GIVEN and BAT_SURFACE_PARAMETERS_PLANAR are not listed.
extern BAT_API const bat_family bat_surface_parameters_family;

/// Options of a reconstruction. Begin with bat_surface_defaults().
typedef struct bat_surface_options
{
    bat_surface_fit_options fit;
    bat_surface_parameters parameters; ///< default BAT_SURFACE_PARAMETERS_AUTO
    bat_cloud_sides sides;             ///< default chord length
    bool published;                    ///< classical neighbourhoods as published, which may fail; default false
    const bat_surface_model *model;    ///< null: the built-in one
    const double *given; ///< count x 2 for BAT_SURFACE_PARAMETERS_GIVEN, each in [0, 1]^2, in the cloud's order; they
                         ///< are not unfolded
    /// Correction moves boundary parameters along their sides, without border curves (bat_surface_fit_data); default false.
    /// Published options and given parameters have no border curves either.
    bool slide_boundary;
    bool no_repair; ///< leave folds, only report them; default false
    bool force;     ///< give also a surface that is judged to be wrong; default false
    /// Fit a surface over a rectangle around the points, and trim it by their outline and holes; default false. The outline
    /// may be concave. `parameters` must be BAT_SURFACE_PARAMETERS_AUTO; a known boundary is not used.
    bool trim;
    double fill_holes; ///< of a trimmed surface: holes of at most this diameter are closed; at least 0; default 0
} bat_surface_options;

/// The default options.
BAT_API bat_surface_options bat_surface_defaults(void);
/// Check options; null passes.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the field out of range
BAT_API bat_status bat_surface_options_check(const bat_surface_options *options, bat_error *error);

/// What is wrong with a surface.
typedef enum bat_surface_fault
{
    BAT_SURFACE_FAULT_NONE,
    BAT_SURFACE_FAULT_MISSED, ///< points are far from it
    BAT_SURFACE_FAULT_STRAYS, ///< it is far from points
    BAT_SURFACE_FAULT_FOLDS,  ///< it stands across the points' tangent planes, or is turned over
    BAT_SURFACE_FAULT_AREA    ///< its area is not that of the points
} bat_surface_fault;

/// A judgement of a surface by its cloud, both ways. Shares are shares of the surface's area.
typedef struct bat_surface_verdict
{
    bat_surface_fault fault;
    double missed;      ///< distance from the surface of the 99th of 100 points, the nearest first
    double strays;      ///< distance from the points of 99 % of the surface
    double farthest;    ///< the largest distance from the points of a place of the surface
    double far_share;   ///< share that is farther from the points than three spacings and four times the noise
    double cross_share; ///< share whose normal is more than 60 degrees off the normal of the nearest points' tangent plane
    double area;        ///< of the surface
    double cloud_area;  ///< of the points, in their tangent planes
    double spacing;     ///< median over points of the mean distance of neighbours
    double place[3];    ///< where the fault is worst
} bat_surface_verdict;

/// Judge a surface by points: distances both ways, areas, normals.
/// @param cloud      the points; no two alike
/// @param parameters count x 2: theirs
/// @param distances  count: theirs from the surface
/// @param options    null for the defaults; their tolerance counts
/// @return BAT_OK; the failures of bat_cloud_check(); BAT_NO_MEMORY
BAT_API bat_status bat_surface_judge(const bat_spline_surface *surface, const bat_cloud *cloud, const double *parameters,
                                     const double *distances, const bat_surface_fit_options *options,
                                     bat_surface_verdict *verdict, bat_error *error);
/// BAT_OK for a surface that is right; else BAT_NO_CONVERGENCE with a text of what is wrong and where.
BAT_API bat_status bat_surface_verdict_check(const bat_surface_verdict *verdict, bat_error *error);
/// Whether noise keeps the share of points from the tolerance of a fit.
/// @param report of the fit
/// @param points their number
/// @param noise  standard deviation of a coordinate
BAT_API bool bat_surface_below_noise(const bat_surface_fit_options *options, const bat_surface_fit_report *report,
                                     size_t points, double noise);

/// One candidate of BAT_SURFACE_PARAMETERS_AUTO, or the one that was asked for.
typedef struct bat_surface_candidate
{
    bat_surface_parameters parameters;
    bat_error failure;                    ///< status BAT_OK when there was none
    double seconds;                       ///< of parameterizing
    bat_cloud_parameters_report folds;    ///< of `parameters`; given ones without a boundary: only `outside` is counted
    bat_cloud_parameters_report repaired; ///< after it; the same as `folds` where there was nothing to repair
    size_t functions;                     ///< of the fit on trial
    double mean_squared; ///< of its distances; with robust weights the median of their squares; NaN when it failed
    double expected_rms; ///< bat_surface_fit_report::expected_rms of the fit on trial; NaN when it failed, and without
    bool reached;        ///< bat_surface_fit_report::reached
    double stray; ///< one-sided Hausdorff distance from the surface, sampled at corners and centres of cells, to the points
    bool strays;  ///< that distance is twice that of another candidate, which excludes this one
    bat_surface_verdict verdict; ///< of the fit on trial to all points
    double fit_seconds;          ///< of the fit on trial
} bat_surface_candidate;

/// The largest number of candidates.
#define BAT_SURFACE_MAX_CANDIDATES 6

/// The result of a reconstruction. Release it with bat_surface_result_free().
typedef struct bat_surface_result
{
    bat_spline_surface surface;
    bat_surface_fit_report report;
    double *parameters; ///< count x 2 in the cloud's order, after correction
    bat_surface_parameters chosen;
    bat_surface_candidate candidates[BAT_SURFACE_MAX_CANDIDATES];
    size_t candidate_count;
    size_t trial_points;               ///< points of the trial fits: all of them, or a part of a large cloud
    bat_cloud_parameters_report folds; ///< of `parameters`; given ones without a boundary: only `outside` is counted
    bat_surface_verdict verdict;       ///< of the surface
    double noise;                      ///< standard deviation of a coordinate, by local quadratic fits (bat_cloud_noise())
    bool below_noise;                  ///< the tolerance is not reached, because it is below the noise
    double seconds[3];                 ///< of the boundary, of the measures of the cloud, and of the rest
    bool boundary_found;               ///< the boundary was unknown
    size_t filled_holes;               ///< of a trimmed surface
    bool corners_found;                ///< the corners were unknown
} bat_surface_result;

/// Free what a result owns and make it empty.
BAT_API void bat_surface_result_free(bat_surface_result *result);

/// Reconstruct a surface from a cloud: find unknown boundary and corners, parameterize, remove folds, fit adaptively.
///
/// The candidates of BAT_SURFACE_PARAMETERS_AUTO are the network, shape-preserving weights, stretch-minimizing ones and, for
/// a mesh, mean values. Each is repaired and fitted with the final options. A candidate is excluded when its surface is
/// twice as far from the points as another one's. Of two that reach the tolerance, the one with fewer functions is better;
/// else the one with the smaller expected distance of new points, or with a given number of functions or robust weights the
/// smaller mean or median squared distance. Clouds of more than 20,000 points are fitted in part on trial, with
/// at most a quarter as many functions. A candidate that fails, or folds at more than a quarter of the points, is excluded.
///
/// The result does not depend on the order of the points.
///
/// @param cloud   its points are sorted, and `order` tells their places in the input: boundary points come first, the others
///                by their distance from the centre of the bounding box. Boundary and corners are found where they are
///                unknown; given parameters need neither, and the cloud then keeps its order
/// @param options null for the defaults
/// @param result  untouched on failure
/// @return BAT_OK; the failures of bat_cloud_check(), bat_cloud_find_boundary(), bat_cloud_parameterize(),
///         bat_surface_model_read() and bat_surface_fit()
BAT_API bat_status bat_surface_reconstruct(bat_cloud *cloud, const bat_surface_options *options, bat_surface_result *result,
                                           bat_error *error);

// Reconstructions that several processes make together. The first process has all points, or a sample of them. It finds
// boundary, corners, parameters of a part, and the surface of this part, as bat_surface_reconstruct() does. Each process
// then locates its points, and bat_surface_fit_together() fits the surface. With all points in the first process, the
// surface is that of bat_surface_reconstruct() to the last bit.

/// Clouds with more points are parameterized and fitted in part first; only these have charts.
#define BAT_SURFACE_ALL_POINTS 20000

/// The parameters that a part of a cloud tells for all its points.
typedef struct bat_surface_chart bat_surface_chart;

/// Half the distance from the centre of the bounding box, by which bat_surface_reconstruct() sorts points; those at the same
/// distance by their coordinates.
/// @param centre half the sum of the least and the largest coordinates: low * 0.5 + high * 0.5
BAT_API double bat_surface_chart_order(const double point[3], const double centre[3]);
/// bat_cloud_find_boundary() as bat_surface_reconstruct() calls it.
/// @param again by the smaller disc that is tried where the first surface is wrong
/// @return as that call, or BAT_CANCELLED
BAT_API bat_status bat_surface_chart_boundary(bat_cloud *cloud, bool again, bat_progress progress, bat_error *error);
/// Move the boundary loop of a sample outwards to the points of a larger cloud. Each point of the loop has the points that
/// are nearer to it than to the others; the outermost of them takes its place. The first process makes the frames of the
/// loop's points.
/// @param cloud  with its boundary loop
/// @param frames receives boundary_count x BAT_SURFACE_LOOP_FRAME numbers
/// @return BAT_OK; BAT_INVALID_ARGUMENT without a boundary; BAT_NO_MEMORY
BAT_API bat_status bat_surface_loop_frames(const bat_cloud *cloud, double *frames, bat_error *error);
/// Numbers of a frame: place, outward and normal direction, and how far points may be.
#define BAT_SURFACE_LOOP_FRAME 10
/// Find the outermost of some points at each point of a loop.
/// @param frames   loop x BAT_SURFACE_LOOP_FRAME
/// @param points   count x 3
/// @param outwards receives the distance of each, [loop]; 0 for none beyond the point of the loop
/// @param outer    receives their indices, [loop]
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_surface_loop_outermost(const double *frames, size_t loop, const double *points, size_t count,
                                              double *outwards, size_t *outer, bat_error *error);

/// Find a chart: all that bat_surface_reconstruct() does before its fit to all points.
/// @param cloud   stays in use until the chart is freed; its points are sorted as by bat_surface_reconstruct()
/// @param options parameters are automatic, neither published nor trimmed; null for the defaults
/// @param chart   receives the chart; release it with bat_surface_chart_free()
/// @return as bat_surface_reconstruct(); BAT_INVALID_ARGUMENT also for other options, and for clouds with few points
BAT_API bat_status bat_surface_chart_find(bat_cloud *cloud, const bat_surface_options *options, bat_surface_chart **chart,
                                          bat_error *error);
/// Free a chart; null is allowed.
BAT_API void bat_surface_chart_free(bat_surface_chart *chart);
/// A chart as bytes, for other processes of the same build.
/// @param bytes receives an array from malloc()
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_surface_chart_pack(const bat_surface_chart *chart, void **bytes, size_t *size, bat_error *error);
/// The chart of these bytes.
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `chart` is untouched on failure
BAT_API bat_status bat_surface_chart_unpack(const void *bytes, size_t size, bat_surface_chart **chart, bat_error *error);
/// The parameters of points that are not on the boundary: those of their feet on the surface of the part.
/// @param points     count x 3
/// @param parameters receives count x 2
/// @return BAT_OK, BAT_NO_MEMORY or the failures of bat_spline_correct()
BAT_API bat_status bat_surface_chart_locate(const bat_surface_chart *chart, const double *points, size_t count,
                                            double *parameters, bat_error *error);
/// The boundary loop, with its parameters: the first points of the cloud.
/// @return the number of its points
BAT_API size_t bat_surface_chart_loop(const bat_surface_chart *chart, const double **points, const double **parameters);
/// The budget of functions of the fit to all points; bat_surface_fit_options::functions, unless that is 0.
BAT_API size_t bat_surface_chart_functions(const bat_surface_chart *chart);
/// Judge the surface that all processes have fitted, in the process that has found the chart.
/// @param surface    belongs to the result
/// @param report     belongs to the result; its distances are of any points
/// @param parameters of the points of the cloud after the fit, [cloud->count x 2]
/// @param distances  of these points, [cloud->count]
/// @param result     as by bat_surface_reconstruct(), of a surface that is right or wrong
/// @return BAT_OK; BAT_NO_CONVERGENCE for a one-sided surface; BAT_CANCELLED; BAT_NO_MEMORY
BAT_API bat_status bat_surface_chart_finish(bat_surface_chart *chart, bat_spline_surface *surface,
                                            bat_surface_fit_report *report, const double *parameters,
                                            const double *distances, bat_surface_result *result, bat_error *error);

BAT_C_END

#endif

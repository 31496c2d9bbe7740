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
    BAT_SURFACE_PARAMETERS_TENSOR,    ///< the same for a height field, kept, with a tensor-product surface
    BAT_SURFACE_PARAMETERS_COUNT      ///< how many there are
} bat_surface_parameters;

/// The choices by name; BAT_SURFACE_PARAMETERS_GIVEN and those of trimmed surfaces are not listed.
extern BAT_API const bat_family bat_surface_parameters_family;

/// Options of a reconstruction. Begin with bat_surface_reconstruct_defaults().
typedef struct bat_surface_reconstruct_options
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
    bool repair; ///< mend folds; false: only report them; default true
    bool force;  ///< give also a surface that is judged to be wrong; default false
    /// Fit a surface over a rectangle around the points, and trim it by their outline and holes; default false. The outline
    /// may be concave. `parameters` must be BAT_SURFACE_PARAMETERS_AUTO; a known boundary is not used.
    bool trim;
    double fill_holes; ///< of a trimmed surface: holes of at most this diameter are closed; at least 0; default 0
    double close_gaps; ///< of a trimmed surface: gaps whose largest empty circle has at most this diameter are closed; 0
} bat_surface_reconstruct_options;

/// The default options.
BAT_API bat_surface_reconstruct_options bat_surface_reconstruct_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_surface_reconstruct_fields;

/// How trimming curves follow the outermost points. docs/surfaces.md describes the ways.
typedef enum bat_surface_edges
{
    BAT_SURFACE_EDGES_AUTO,  ///< through points on the edge; smooth, outside of points at random places (default)
    BAT_SURFACE_EDGES_EXACT, ///< polygons of the points
    BAT_SURFACE_EDGES_FAIR   ///< smooth everywhere, as for points at random places
} bat_surface_edges;

/// The edges by name.
extern BAT_API const bat_family bat_surface_edges_family;

/// What is wrong with a surface.
typedef enum bat_surface_fault
{
    BAT_SURFACE_FAULT_NONE,
    BAT_SURFACE_FAULT_MISSES_POINTS, ///< points are far from it
    BAT_SURFACE_FAULT_LEAVES_POINTS, ///< it is far from points
    BAT_SURFACE_FAULT_FOLDS,         ///< it stands across the points' tangent planes, or is turned over
    BAT_SURFACE_FAULT_AREA           ///< its area is not that of the points
} bat_surface_fault;

/// The faults by name, in their order; a summary says what is wrong.
extern BAT_API const bat_family bat_surface_fault_family;

/// What a right surface may still have wrong, because its points say too little. See bat_surface_verdict::doubt_size.
typedef enum bat_surface_doubt
{
    BAT_SURFACE_DOUBT_NONE,
    BAT_SURFACE_DOUBT_PLANES,  ///< it leaves the tangent planes of the points beside it by `doubt_size`
    BAT_SURFACE_DOUBT_OUTLINE, ///< neighbours on its outline are `doubt_size` apart, several spacings
    BAT_SURFACE_DOUBT_RIM,     ///< points are sparse at its outline: the shape may go on for the spacing there
    BAT_SURFACE_DOUBT_GAP,     ///< a gap between points is closed, which is `doubt_size` across
    BAT_SURFACE_DOUBT_STRAY,   ///< a point is `doubt_size` from it, far beyond all others, and may bend it
    BAT_SURFACE_DOUBT_AREA,    ///< a trimmed surface of the points is smaller, by the area `doubt_size` squared; no place
    BAT_SURFACE_DOUBT_FEW      ///< the points are too few for a judgement; no size and no place
} bat_surface_doubt;

/// The doubts by name, in their order; a summary continues "right, but".
extern BAT_API const bat_family bat_surface_doubt_family;

/// A judgement of a surface by its cloud, both ways. Shares are shares of the surface's area.
typedef struct bat_surface_verdict
{
    bat_surface_fault fault;
    bat_surface_doubt doubt;      ///< of a right surface
    double distance_from_surface; ///< distance from the surface of the 99th of 100 points, the nearest first
    double distance_from_points;  ///< distance from the points of 99 % of the surface
    double farthest;              ///< the largest distance from the points of a place of the surface
    double far_share;             ///< share that is farther from the points than three spacings and four times the noise
    double cross_share; ///< share whose normal is more than 60 degrees off the normal of the nearest points' tangent plane
    double area;        ///< of the surface
    double cloud_area;  ///< of the points, in their tangent planes
    double spacing;     ///< median over points of the mean distance of neighbours
    double off_planes;  ///< distance of 99 % of the surface from the tangent plane of the nearest point
    double place[3];    ///< where the fault is worst
    double doubt_size, doubt_place[3]; ///< how large the doubt is, and where it is largest
} bat_surface_verdict;

/// BAT_OK for a surface that is right; else BAT_NO_CONVERGENCE with a text of what is wrong and where.
BAT_API bat_status bat_surface_verdict_check(const bat_surface_verdict *verdict, bat_error *error);
/// Whether noise keeps the share of points from the tolerance of a fit.
/// @param report of the fit
/// @param points their number
/// @param noise  standard deviation of a coordinate
BAT_API bool bat_surface_below_noise(const bat_surface_fit_options *options, const bat_surface_fit_report *report,
                                     size_t points, double noise);
/// Whether a fit was told a noise that is more than three times its estimate, or less than a third of it.
BAT_API bool bat_surface_noise_contradicts(const bat_surface_fit_options *options, double noise);

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
    double
        hausdorff; ///< one-sided Hausdorff distance from the surface, sampled at corners and centres of cells, to the points
    bool excluded; ///< that distance is twice that of another candidate, which excludes this one
    bat_surface_verdict verdict; ///< of the fit on trial to all points
    double fit_seconds;          ///< of the fit on trial
} bat_surface_candidate;

/// A hole of a trimmed surface, or a gap between its points that was closed.
typedef struct bat_surface_gap
{
    double place[3]; ///< mean of the points around it
    double diameter; ///< of the box around it
    double area;
    bool closed; ///< the surface covers it
} bat_surface_gap;

/// Clouds with more points are parameterized and fitted in part first.
#define BAT_SURFACE_ALL_POINTS 20000
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
    bat_surface_gap *gaps;             ///< gap_count, of a trimmed surface: its holes, and the largest gaps that are closed
    size_t gap_count;
    bool corners_found; ///< the corners were unknown
    bool is_plane;      ///< the control points are as near to a plane as the noise
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
BAT_API bat_status bat_surface_reconstruct(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                           bat_surface_result *result, bat_error *error);

/// bat_surface_reconstruct(), which is this call with BAT_SURFACE_EDGES_AUTO, with other trimming curves.
/// @param edges others than BAT_SURFACE_EDGES_AUTO go with bat_surface_reconstruct_options::trim
/// @return those of bat_surface_reconstruct(); BAT_INVALID_ARGUMENT also for edges without a trimmed surface
BAT_API bat_status bat_surface_reconstruct_edges(bat_cloud *cloud, const bat_surface_reconstruct_options *options,
                                                 bat_surface_edges edges, bat_surface_result *result, bat_error *error);

/// Simple shapes.
typedef enum bat_surface_primitive_kind
{
    BAT_SURFACE_PRIMITIVE_NONE,
    BAT_SURFACE_PRIMITIVE_PLANE,
    BAT_SURFACE_PRIMITIVE_SPHERE,
    BAT_SURFACE_PRIMITIVE_CYLINDER,
    BAT_SURFACE_PRIMITIVE_CONE
} bat_surface_primitive_kind;

/// The simple shapes by name.
extern BAT_API const bat_family bat_surface_primitive_kind_family;

/// A simple shape of least squared distance from points. Deviations are standard ones, for independent noise.
typedef struct bat_surface_primitive
{
    bat_surface_primitive_kind kind;
    double place[3];      ///< a point of the plane or the axis; the centre of a sphere, the apex of a cone
    double axis[3];       ///< unit: the normal of a plane, the axis of a cylinder, that of a cone from its apex
    double radius, angle; ///< of a sphere or cylinder; between the axis and the side of a cone; else NaN
    double place_deviation, axis_deviation, radius_deviation, angle_deviation; ///< NaN where unknown; angles in radians
    double rms, largest;                                                       ///< of the points' distances
    double pattern; ///< how alike distances of neighbours are, in standard deviations of independent ones
} bat_surface_primitive;

/// Find the simplest shape that the points lie on: their distances are at most one standard error larger than those expected
/// from the surface, without a pattern and outliers. More than 20,000 points are fitted in part.
/// @param result of the cloud
/// @param shape  BAT_SURFACE_PRIMITIVE_NONE where the points lie on none
/// @return BAT_OK or BAT_NO_MEMORY
BAT_API bat_status bat_surface_find_primitive(const bat_cloud *cloud, const bat_surface_result *result,
                                              bat_surface_primitive *shape, bat_error *error);

BAT_C_END

#endif

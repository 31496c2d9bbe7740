#ifndef BATTEN_CURVE_H
#define BATTEN_CURVE_H

#include "batten/curve_scheme.h"
#include "batten/space.h"

BAT_C_BEGIN

/// @file
/// Polylines in a space, and their refinement by subdivision schemes.

/// A polyline in a space; `points` holds `count` rows of `space->point_dim` coordinates.
typedef struct bat_curve
{
    const bat_space *space; ///< where the points live; never null; must outlive the curve
    double *points;         ///< count x point_dim, row-major
    size_t count;
    bool closed;      ///< the last point joins the first
    double *channels; ///< count x channel_count further values at the points, such as altitudes; may be null
    size_t channel_count;
    unsigned char *corners; ///< count flags, not 0 at corners, where bat_curve_refine() cuts the curve; may be null
} bat_curve;

/// Free what the library allocated for a curve and make it empty. Does nothing to a curve that is empty already.
BAT_API void bat_curve_free(bat_curve *curve);

/// Check that a curve can be refined: at least 2 points (3 when closed), each in its space, neighbours distinct and not
/// antipodal (on a sphere).
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT or BAT_CUT_LOCUS, with the index of the first point at fault
BAT_API bat_status bat_curve_check(const bat_curve *curve, bat_error *error);

/// The default scheme of a space: "learned" on the plane, the sphere S^2 and the disk, "angle-4" on other oriented surfaces,
/// "four-point" in other Euclidean spaces, "log-exp-4" elsewhere. All keep the given points.
/// @param name receives the scheme's name for bat_curve_scheme_by_name(); may be null
BAT_API bat_curve_scheme bat_curve_scheme_for(const bat_space *space, const char **name);

/// How an open curve is continued beyond its ends.
typedef enum bat_curve_end_rule
{
    BAT_CURVE_END_RULE_AUTO, ///< the default: BAT_CURVE_END_RULE_REFLECT
    /// Geodesic point reflection in the end point. The end has no curvature, and symmetric masks keep the end point. Works
    /// in every space.
    BAT_CURVE_END_RULE_REFLECT,
    /// The extrapolation that the scheme reproduces. Interpolatory linear and log-exp schemes: the cubic through the last
    /// four points, in the tangent space of the end point. Other linear schemes: the straight line. Angle-based schemes: the
    /// mirror image in the perpendicular bisector of the end edge, which continues an evenly sampled circular arc.
    BAT_CURVE_END_RULE_EXTRAPOLATE,
    /// No continuation: only points whose whole stencil lies inside are computed, so that the curve shrinks. Linear schemes
    /// only.
    BAT_CURVE_END_RULE_FREE
} bat_curve_end_rule;

/// The end rules by name.
extern BAT_API const bat_family bat_curve_end_rule_family;

/// Which curves stay simple: where the refined curve crosses or touches itself and the given polygon does not, new points
/// are drawn back towards their edges until nothing meets. docs/algorithms/simple-curves.md describes it. Only curves in the
/// plane, on the sphere S^2 and in the disk can cross themselves.
typedef enum bat_curve_simple
{
    BAT_CURVE_SIMPLE_AUTO, ///< the default: BAT_CURVE_SIMPLE_RINGS
    /// Closed curves that are simple when they come in; in other spaces none. A curve of a scheme that does not keep the
    /// given points is tested and not changed.
    BAT_CURVE_SIMPLE_RINGS,
    /// Open curves too. BAT_UNSUPPORTED in other spaces, and where a scheme that does not keep the given points gives a
    /// curve that crosses itself.
    BAT_CURVE_SIMPLE_ALWAYS,
    BAT_CURVE_SIMPLE_NEVER ///< No test.
} bat_curve_simple;

/// The choices of bat_curve_simple by name.
extern BAT_API const bat_family bat_curve_simple_family;

/// What refinement found and did; sums over the curves of a call.
typedef struct bat_curve_refine_report
{
    size_t checked;        ///< curves that were tested
    size_t given_crossing; ///< of these, curves whose given polygon is not simple; they are refined and left as they are
    size_t crossing;       ///< of the others, curves that crossed or touched themselves after refinement
    size_t crossings;      ///< pairs of their refined edges that did
    size_t drawn_back;     ///< edges of the given polygons whose new points were drawn back
    size_t straight;       ///< of these, edges that became straight
    size_t left_crossing;  ///< curves that still cross themselves: of schemes that do not keep the given points, or because
                           ///< given edges come so near to each other that rounding makes their new points cross
    size_t stopped;        ///< curves refined up to a stop in place of a number of levels
    size_t corners;        ///< vertices at which curves were cut, and flagged ends of open curves
    size_t min_levels;     ///< the fewest levels of a coarse edge; without stops, `levels`
    size_t max_levels;     ///< the most
    size_t smoothed;       ///< points of curves that were to be smoothed; with it also:
    double noise;          ///< the root mean square of the estimated noise of a coordinate; 0 where none is estimated
    double mean_move;      ///< the mean way of their points by smoothing
    double largest_move;   ///< the longest way
} bat_curve_refine_report;

/// Options of refinement. Begin with bat_curve_refine_defaults().
typedef struct bat_curve_refine_options
{
    bat_curve_scheme scheme; ///< default BAT_CURVE_SCHEME_KIND_AUTO: chosen for the space, bat_curve_scheme_for()
    size_t levels;           ///< 0 to 60; default 5
    bat_curve_end_rule ends; ///< open curves; default BAT_CURVE_END_RULE_REFLECT
    bool snap;               ///< linear schemes: move the result onto the limit curve with the limit stencil; default false
    size_t max_points;       ///< refuse larger results with BAT_TOO_LARGE; default BAT_MAX_POINTS
    int threads;             ///< 0 to 1024; 0: as many as OpenMP gives; the result does not depend on it; default 0
    bat_progress progress;   ///< default: none
    bat_curve_simple simple; ///< default BAT_CURVE_SIMPLE_RINGS
    /// Receives what was done when the call succeeds; of bat_curve_refine(), bat_curve_refine_into() and
    /// bat_curves_refine(). Default: null.
    bat_curve_refine_report *report;
    /// Radians, 0 to pi: a vertex is a corner where the exterior angle, that between -log(before) and log(after), is
    /// greater. 0: only vertices with a flag in bat_curve::corners are. Default 0.
    double corner_angle;
    /// Find corners, for schemes that keep them: right angles, where the curve has so many that they are meant, ends of
    /// straight runs, turns of simplified lines. docs/algorithms/curve-schemes.md tells the rules. Default false.
    bool find_corners;
    bool strict; ///< refuse curves that cross themselves and given edges of maps that meet, if `simple` tests; default false
    /// A stop, in the unit of the space's distance: each edge gets the smallest number of levels for which none of its
    /// pieces is longer, whatever its neighbours get. 0: none. Default 0.
    double max_edge;
    /// A stop: each edge gets the smallest number of levels for which the limit curve lies within this distance of its
    /// pieces. The distance is estimated, see docs/algorithms/curve-schemes.md. 0: none. Default 0.
    double tolerance;
    /// `tolerance` in median edges of the curve, of a map in those of all curves, for schemes that can be stopped; others go
    /// by `levels`. On the sphere, up to 70 degrees of latitude, lines that are straight in degrees are within it, too.
    /// Edges between corners are not divided. Does not count with `tolerance`. 0: none. Default 0.
    double relative_tolerance;
    size_t max_levels; ///< with a stop, in place of `levels`: the most levels of an edge, 0 to 40; default 20
    /// The level of the given curve, for rules that decide the first levels only: with 2, the first computed level is the
    /// rule's third. So refinement by 2 levels and then by 3 gives what 5 levels give. 0 to 60; default 0.
    size_t first_level;
    /// Smooth the points before refinement, by a spline in the geometry of the space that approximates them; ends and
    /// corners stay. A length in the unit of the space's distance: waves of that length keep half of their height, shorter
    /// ones less. NaN: by the noise of each curve, which is estimated; outliers count less, and borders of pixels lose their
    /// stairs. docs/algorithms/smoothing.md has the formulas. 0: no smoothing. Default 0.
    double smooth;
} bat_curve_refine_options;

/// The options' default values.
BAT_API bat_curve_refine_options bat_curve_refine_defaults(void);
/// Its table, for bat_options_check().
extern BAT_API const bat_options_table bat_curve_refine_fields;

/// The number of points that refinement gives. A closed curve gets count * 2^levels points. An open curve gets
/// (count - 1) * 2^levels + 1 points where the scheme has vertices at the ends: masks of odd length, all interpolatory
/// schemes. Other schemes add the ends, (count - 1) * 2^levels + 2 points. With BAT_CURVE_END_RULE_FREE there are fewer. A
/// curve with corners gets the points of its pieces, with each corner once. With a stop, an edge with k levels has 2^k
/// pieces, and the call costs as much as a refinement.
/// @return as bat_curve_refine(), but for BAT_NO_MEMORY and BAT_CANCELLED
BAT_API bat_status bat_curve_refined_count(const bat_curve *coarse, const bat_curve_refine_options *options, size_t *count,
                                           bat_error *error);

/// Refine a curve by repeated subdivision. A level doubles the number of edges. A closed curve that is simple stays so, see
/// bat_curve_simple.
/// Memory beyond the result: at most as much again; linear schemes need almost none.
///
/// The curve is cut at its corners: bat_curve::corners and bat_curve_refine_options::corner_angle. Each piece is refined as
/// an open curve with the end rule, and corners stay where they are. A piece of one edge becomes a geodesic with evenly
/// spaced points. Schemes that move points need a symmetric mask and BAT_CURVE_END_RULE_REFLECT where there are corners.
///
/// Stops (max_edge, tolerance) take the place of `levels`. They need a scheme that keeps its points, or `snap` and a
/// symmetric mask of odd length; and neither BAT_CURVE_END_RULE_FREE nor a rule that uses the mean length, nor `adaptive`.
///
/// @param coarse  at least 2 points (3 when closed), each valid in its space, neighbours distinct
/// @param options null for bat_curve_refine_defaults()
/// @param fine    receives the refined curve, with flags of its corners where `coarse` has flags or a corner angle is given;
///                release it with bat_curve_free()
/// @param error   receives what went wrong and at which point; may be null. BAT_TOO_LARGE names the first edge that needs
///                more than max_levels
/// @return BAT_OK, BAT_INVALID_ARGUMENT, BAT_INVALID_POINT (with BAT_CURVE_SIMPLE_ALWAYS also where edges of a simple
/// polygon
///         come so near to each other that rounding makes their new points cross), BAT_CUT_LOCUS, BAT_UNSUPPORTED,
///         BAT_TOO_LARGE, BAT_NO_MEMORY or BAT_CANCELLED; `fine` is untouched on failure
BAT_API bat_status bat_curve_refine(const bat_curve *coarse, const bat_curve_refine_options *options, bat_curve *fine,
                                    bat_error *error);

/// bat_curve_refine() of many curves. Threads share the curves.
///
/// @param fine         receives `count` curves; all empty on failure
/// @param error   its `curve` is the first failing one
/// @return as bat_curve_refine()
BAT_API bat_status bat_curves_refine(const bat_curve *coarse, size_t count, const bat_curve_refine_options *options,
                                     bat_curve *fine, bat_error *error);

/// bat_curve_refine() into the caller's arrays.
/// @param points   room for `capacity` rows
/// @param channels room for `capacity` rows of channels; null: they are not computed
/// @param capacity at least bat_curve_refined_count(), else BAT_TOO_LARGE
/// @return as bat_curve_refine(); the arrays may hold part of a result on failure
BAT_API bat_status bat_curve_refine_into(const bat_curve *coarse, const bat_curve_refine_options *options, double *points,
                                         double *channels, size_t capacity, bat_error *error);

/// The signed exterior angle at every vertex of a curve in an oriented surface (0 at the ends of an open one).
/// @param angles receives coarse->count numbers
/// @return BAT_OK or BAT_UNSUPPORTED
BAT_API bat_status bat_curve_exterior_angles(const bat_curve *curve, double *angles, bat_error *error);
/// The geodesic length of every edge: count numbers when closed, count - 1 when open.
BAT_API void bat_curve_edge_lengths(const bat_curve *curve, double *lengths);

BAT_C_END

#endif

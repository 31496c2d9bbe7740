#ifndef BATTEN_CURVE_SCHEME_H
#define BATTEN_CURVE_SCHEME_H

#include "batten/space.h"

BAT_C_BEGIN

/// @file
/// Subdivision schemes of curves, as plain values: masks, angle-based, log-exp and geodesic schemes, learned schemes.

/// The longest mask: enough for Lane-Riesenfeld of order 126.
#define BAT_MASK_MAX 128

/// The mask of a binary subdivision scheme: new point i is the sum over j of a(i - 2 j) times old point j.
/// `coefficients[k]` is a(first + k). The mask of a scheme that reproduces constants sums to 1 over the even indices and
/// to 1 over the odd ones.
typedef struct bat_mask
{
    double coefficients[BAT_MASK_MAX];
    size_t count; ///< 1 … BAT_MASK_MAX
    int first;    ///< index of the first coefficient; refinement takes -2 count … count
} bat_mask;

/// Chaikin's corner cutting (1974): [1, 3, 3, 1] / 4, the uniform quadratic B-spline.
BAT_API bat_mask bat_mask_chaikin(void);
/// Corner cutting with ratios 0 < r < s < 1: each edge (p, q) gives p + r (q - p) and p + s (q - p). Chaikin is r = 1/4,
/// s = 3/4. Source: Alam 2025, eq. 4.1, where the text has the two values swapped.
BAT_API bat_mask bat_mask_corner_cutting(double r, double s);
/// The interpolatory four-point scheme (Dyn, Gregory, Levin 1987): (1/2 + w) (p + q) - w (o + r); cubics at w = 1/16.
BAT_API bat_mask bat_mask_four_point(double w);
/// The interpolatory six-point scheme (Weissman 1990): w (n + s) - (1/16 + 3 w) (o + r) + (9/16 + 2 w) (p + q); quintics at
/// w = 3/256, the four-point scheme at w = 0.
BAT_API bat_mask bat_mask_six_point(double w);
/// Lane and Riesenfeld (1980): doubling followed by `order` averagings, the uniform B-spline of degree `order`;
/// 1 <= order <= BAT_MASK_MAX - 2, else the mask is empty, which every call refuses. Order 2 is Chaikin's.
BAT_API bat_mask bat_mask_lane_riesenfeld(size_t order);

/// The largest insertion angle of the angle-based schemes, pi/4 - 0.02 (Ugail and Howard 2026, Theorem 1).
#define BAT_CURVE_ANGLE_LIMIT 0.76539816339744830962
/// The weight of the four-point scheme that reproduces cubic polynomials.
#define BAT_MASK_FOUR_POINT_WEIGHT (1.0 / 16.0)
/// Weissman's weight of the six-point scheme that reproduces quintic polynomials.
#define BAT_MASK_SIX_POINT_WEIGHT (3.0 / 256.0)
/// The tension of the angle-based four-point and six-point schemes (Ugail and Howard 2026, section 3.4).
#define BAT_CURVE_TENSION_FOUR_POINT 0.0
#define BAT_CURVE_TENSION_SIX_POINT (-0.25)

/// The families of rules.
typedef enum bat_curve_scheme_kind
{
    BAT_CURVE_SCHEME_KIND_AUTO,     ///< none yet: chosen for the space, bat_curve_scheme_for()
    BAT_CURVE_SCHEME_KIND_LINEAR,   ///< a mask applied to coordinates of R^n; elsewhere BAT_CURVE_SCHEME_KIND_GEODESIC takes
                                    ///< its place for the masks that it has
    BAT_CURVE_SCHEME_KIND_ANGLE,    ///< a vertex over each edge at an angle made of exterior angles; plane, sphere, disk
    BAT_CURVE_SCHEME_KIND_LOG_EXP,  ///< a mask applied in the tangent space of one point; any space
    BAT_CURVE_SCHEME_KIND_GEODESIC, ///< Lane-Riesenfeld by midpoints of geodesics in place of arithmetic means, or corner
                                    ///< cutting at ratios of geodesics; any space
    BAT_CURVE_SCHEME_KIND_FOUR_POINT, ///< the cubic through four points at bat_curve_parameters, level after level; any
                                      ///< space
    BAT_CURVE_SCHEME_KIND_SPLINE ///< a spline through the points, of the row `spline`; any space; not a subdivision scheme
} bat_curve_scheme_kind;

/// The kinds by name.
extern BAT_API const bat_family bat_curve_scheme_kind_family;

/// The parameters at which an interpolating polynomial takes the points: the increment over an edge is its length to the
/// power alpha.
typedef enum bat_curve_parameters
{
    BAT_CURVE_PARAMETERS_UNIFORM,     ///< alpha = 0: all increments are equal
    BAT_CURVE_PARAMETERS_CENTRIPETAL, ///< alpha = 1/2: increments are square roots of lengths (Lee 1989)
    BAT_CURVE_PARAMETERS_CHORDAL      ///< alpha = 1: increments are lengths
} bat_curve_parameters;

/// The kinds of parameters by name.
extern BAT_API const bat_family bat_curve_parameters_family;

/// On which side of the edge an angle-based scheme inserts.
typedef enum bat_curve_angle_sign
{
    BAT_CURVE_ANGLE_SIGN_OUTWARD, ///< the negative of eq. (9) of Ugail and Howard: exact on circles of the plane; the
                                  ///< default
    BAT_CURVE_ANGLE_SIGN_PRINTED  ///< eq. (9) as printed, which pushes vertices inwards; only to reproduce the paper
} bat_curve_angle_sign;

/// The signs by name.
extern BAT_API const bat_family bat_curve_angle_sign_family;

/// The farthest reach of an angle rule.
#define BAT_CURVE_ANGLE_RULE_REACH 64
/// The most edges that an angle rule is given at a time.
#define BAT_CURVE_ANGLE_RULE_EDGES 512

/// A run of consecutive edges of a polygon, numbered from 0: the input of an angle rule. Edge j goes from vertex j to vertex
/// j + 1. All fields are invariant under orientation-preserving isometries, and so is a scheme that uses nothing else.
typedef struct bat_curve_angle_rule_view
{
    const bat_space *space;
    size_t count;          ///< edges whose angles are computed, 1 … BAT_CURVE_ANGLE_RULE_EDGES
    const double *angles;  ///< exterior angles, positive for left turns, of the vertices 1 - reach … count - 1 + reach
    const double *lengths; ///< geodesic lengths of the edges -reach … count - 1 + reach
    double mean_length;    ///< of all edges of the polygon, where the rule uses it; else 0
    double fairness;       ///< that of the scheme
    size_t level;          ///< levels before this one, where the rule decides the first levels only; else 0
    ptrdiff_t first;       ///< index of edge 0 in the polygon of the level, where the rule decides the first levels only
} bat_curve_angle_rule_view;

typedef struct bat_curve_angle_rule bat_curve_angle_rule;

/// A rule for the insertion angles of an angle-based scheme, in place of eq. (9) of Ugail and Howard. The angle of an edge
/// is a function of the angles and lengths around it. The library's learned schemes are such rules; a user defines another
/// by filling this struct. Open curves are continued beyond their ends before they are measured, by bat_curve_end_rule.
struct bat_curve_angle_rule
{
    const char *name;       ///< for messages
    size_t reach;           ///< edges and vertices used on either side of an edge, 1 … BAT_CURVE_ANGLE_RULE_REACH
    bool wants_mean_length; ///< true: levels are computed one after the other; false: all at once, in chunks that threads
                            ///< share
    size_t levels;          ///< the rule decides so many levels, computed one after the other, and the six-point rule in
                            ///< turns the levels after them; 0: all levels
    size_t scratch_size;    ///< bytes that one call of angles() needs
    const void *parameters; ///< the rule's own; not used by the library

    /// Optional: null for a supported space, else the reason in a few words.
    const char *(*fault)(const bat_curve_angle_rule *rule, const bat_space *space);
    /// Write view->count insertion angles, positive to the left of the edge. Larger ones become +-BAT_CURVE_ANGLE_LIMIT, as
    /// the theorem demands; NaN fails with BAT_INVALID_POINT. Several threads call it at once, on runs of any length: an
    /// angle may only depend on the `reach` edges and vertices around its edge.
    /// @param scratch scratch_size bytes, aligned to 64
    void (*angles)(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles, void *scratch);
};

/// The tangent space in which a log-exp scheme averages.
typedef enum bat_curve_base
{
    BAT_CURVE_BASE_AUTO,    ///< the default: BAT_CURVE_BASE_VERTEX
    BAT_CURVE_BASE_VERTEX,  ///< at the vertex that begins the edge (Ugail and Howard, section 7.1; Wallner and Dyn 2005)
    BAT_CURVE_BASE_MIDPOINT ///< at the geodesic midpoint of the edge, which makes the scheme symmetric under reversal
} bat_curve_base;

/// The bases by name.
extern BAT_API const bat_family bat_curve_base_family;

/// A rule that refines a curve by one level. The functions below make one; all fields may be changed afterwards.
typedef struct bat_curve_scheme
{
    bat_curve_scheme_kind kind;
    bat_mask mask;  ///< LINEAR: the mask; LOG_EXP: a mask that sums to 1 over its even indices and over its odd ones;
                    ///< GEODESIC: that of bat_mask_lane_riesenfeld(), whose order it tells, or one whose new points are
                    ///< convex means of two neighbours, as those of bat_mask_corner_cutting()
    double tension; ///< ANGLE: mu of eq. (9); FOUR_POINT: w, 1/16 for the cubic through the four points
    bat_curve_angle_sign sign; ///< ANGLE
    bool adaptive;             ///< ANGLE: the heuristic of section 7.1, which changes mu from edge to edge around `tension`
    bool turns; ///< ANGLE: eq. (9) of the turns y_i = 2 d_i e / max(e_(i-1) + e_i, e) in place of the exterior angles d_i,
                ///< for an edge of length e and neighbours of lengths e_i: for uneven spacing. The shorter edge bounds
                ///< the turn at a corner, and runs of collinear points stay straight
    const bat_curve_angle_rule
        *rule;           ///< ANGLE: the rule of the angles, in place of eq. (9) and the four fields above; or null
    double fairness;     ///< ANGLE with a rule: an input of the rule, 0 (nearest to the data) … 1 (smoothest)
    bat_curve_base base; ///< LOG_EXP, FOUR_POINT; it has no effect in R^n
    bat_curve_parameters parameters; ///< FOUR_POINT, SPLINE
    const bat_choice *spline;        ///< SPLINE: a row of bat_curve_scheme_family, as bat_curve_scheme_by_name() sets it
} bat_curve_scheme;

/// Weights of neighbouring points: the sum over k of weights[k] p(i + first + k).
typedef struct bat_mask_stencil
{
    double weights[BAT_MASK_MAX];
    size_t count; ///< 0 when there is no such stencil
    int first;    ///< offset of the first point, may be negative
} bat_mask_stencil;

/// The stencil that moves points of any level onto the limit curve. The limit at the parameter of point i is the sum over
/// k of weights[k] p(i + first + k). For an interpolatory mask it is [1]; for Chaikin's [1, 6, 1] / 8.
///
/// The weights are values of the basic limit function at the mask's shift plus integers. They are exact but for rounding of
/// the shift to 40 binary digits.
/// @return BAT_OK, BAT_INVALID_ARGUMENT for a malformed mask, BAT_NO_CONVERGENCE when the scheme is not proven to converge
///         by products of 12 steps, or BAT_NO_MEMORY
BAT_API bat_status bat_mask_limit_stencil(const bat_mask *mask, bat_mask_stencil *stencil, bat_error *error);

/// The linear scheme of a mask, for Euclidean spaces. In other spaces refinement replaces it by its geodesic analogue, where
/// there is one: midpoints of geodesics for masks of bat_mask_lane_riesenfeld() (bat_curve_scheme_geodesic()), and points at
/// the same ratios of geodesics for corner cutting, which is a mask whose new points are convex means of two neighbours.
/// bat_mask_chaikin() is both. Other masks are BAT_UNSUPPORTED there.
BAT_API bat_curve_scheme bat_curve_scheme_linear(bat_mask mask);
/// Angle-based with tension `mu`: BAT_CURVE_TENSION_FOUR_POINT, BAT_CURVE_TENSION_SIX_POINT or any other; outward sign.
BAT_API bat_curve_scheme bat_curve_scheme_angle(double mu);
/// Angle-based with the angles of a rule, which must outlive the scheme.
BAT_API bat_curve_scheme bat_curve_scheme_angle_rule(const bat_curve_angle_rule *rule);
/// Log-exp with a mask that sums to 1 over its even indices and over its odd ones, base at the vertex. Interpolatory masks
/// keep the given points.
BAT_API bat_curve_scheme bat_curve_scheme_log_exp(bat_mask mask);
/// Lane-Riesenfeld of an order by geodesic averages (Dyn and Sharon 2017): doubling followed by `order` rounds of midpoints.
/// In R^n it is the linear scheme. The order is that of bat_mask_lane_riesenfeld().
BAT_API bat_curve_scheme bat_curve_scheme_geodesic(size_t order);

/// The four-point scheme with parameters that depend on the points and are computed anew on each level (Dyn, Floater and
/// Hormann 2009). The new point is the value of the cubic Lagrange interpolant of the four points around an edge, at the
/// middle of the edge's interval of parameters. The weight w scales its displacement from the middle of the edge by
/// w / BAT_MASK_FOUR_POINT_WEIGHT; it must be within 1e6 of 0. In other spaces than R^n the interpolant is that of
/// logarithms. With uniform parameters it is the linear or log-exp four-point scheme, up to rounding. It keeps the given
/// points, and channels are interpolated at the same parameters.
BAT_API bat_curve_scheme bat_curve_scheme_four_point(bat_curve_parameters parameters, double w);
/// Check a scheme: its kind and the fields that the kind uses.
/// @return BAT_OK; BAT_INVALID_ARGUMENT with the field out of range; BAT_UNSUPPORTED for a mask that the kind cannot use
BAT_API bat_status bat_curve_scheme_check(const bat_curve_scheme *scheme, bat_error *error);

/// A scheme by name, as the program's `--scheme` takes it: a name and, after a colon, settings separated by commas.
///
///     chaikin   corner-cutting:r=0.25,s=0.75   four-point:w=0.0625   six-point:w=0.01171875   lane-riesenfeld:order=3
///     four-point:parameters=chordal            (uniform, centripetal or chordal; log-exp-4 too)
///     catmull-rom   cubic                      (each also with parameters=uniform, centripetal or chordal)
///     mask:1/4,3/4,3/4,1/4@-2                  (coefficients as numbers or fractions, then the first index; centred
///     without) angle-4   angle-6   angle:mu=-0.1        (each also with sign=printed; angle:adaptive=1,turns=1) log-exp-4
///     log-exp-6 (each also with base=midpoint) learned   learned:fairness=0.8           (bat_curve_scheme_learned())
///     log-exp-lane-riesenfeld:order=3          (also with base=midpoint)
///     geodesic:order=3
///
/// Splines (BAT_CURVE_SCHEME_KIND_SPLINE) have 2^levels - 1 new points on each edge, at equal steps of the parameter, and
/// interpolate channels alike. In other spaces than R^n their pieces are Bezier curves made of geodesics (Park and Ravani
/// 1995).
///
/// - catmull-rom: the velocity at a point is that of the parabola through it and its two neighbours, and cubics join the
///   points (Catmull and Rom 1974; Barry and Goldman 1988 for any parameters). C1.
/// - cubic: the cubic spline. In R^n it is C2: periodic where the curve is closed, else with de Boor's not-a-knot condition
///   at the ends, and natural through 2 or 3 points. In other spaces the equations of the velocities (de Boor 1978, chapter
///   IV) hold after parallel transport along the edges; the curve is C1.
///
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names the part at fault
BAT_API bat_status bat_curve_scheme_by_name(const char *name, bat_curve_scheme *scheme, bat_error *error);

/// The schemes by name, with their settings.
extern BAT_API const bat_family bat_curve_scheme_family;

// Learned curve schemes: the one that the library comes with, and those of networks that are read from files.

/// The learned scheme that the library comes with: for the plane, the sphere S^2 and the disk, curves of any scale and
/// spacing. A network corrects the angle of the six-point rule. Its features are 8 exterior angles and 9 edge lengths around
/// the edge. The scheme keeps the given points. It commutes with isometries, mirror images, reversal and, on the plane,
/// scaling. Angles stay below BAT_CURVE_ANGLE_LIMIT for all weights (Theorem 1 of Ugail and Howard 2026).
/// docs/algorithms/curve-network.md describes it; `batten train curve --recipe batten` trains it.
///
/// @param fairness from 0, nearest to the data, to 1, smoothest; refinement refuses other values
BAT_API bat_curve_scheme bat_curve_scheme_learned(double fairness);

/// A trained network. It is constant, and any number of calls may use it at once.
typedef struct bat_curve_model bat_curve_model;

/// Read a model from a safetensors file of `batten train curve --recipe batten`. Of a checkpoint, the best weights are
/// taken, or those of its last step. batten/research/networks.h reads published networks too.
///
/// @param path  null: the model that comes with the library (weights/batten.md), that of bat_curve_scheme_learned()
/// @param model receives the model; release it with bat_curve_model_free()
/// @return BAT_OK; BAT_BAD_FILE (an array is missing, has another shape, or holds a number that is not finite);
///         BAT_FILE_ACCESS, BAT_UNSUPPORTED or BAT_NO_MEMORY; `*model` is untouched on failure
BAT_API bat_status bat_curve_model_read(const char *path, bat_curve_model **model, bat_error *error);
/// The models that come with the library.
extern BAT_API const bat_family bat_curve_model_family;
/// Whether a model uses bat_curve_scheme's fairness.
BAT_API bool bat_curve_model_has_fairness(const bat_curve_model *model);
/// Does nothing to null.
BAT_API void bat_curve_model_free(bat_curve_model *model);

/// The scheme whose insertion angles are a model's, for the plane, the sphere S^2 and the disk. The model must outlive it.
/// Angles stay below BAT_CURVE_ANGLE_LIMIT for all weights (Theorem 1). `scheme.fairness` begins as 1/2; only models of the
/// library's own recipe use it.
BAT_API bat_curve_scheme bat_curve_scheme_of_model(const bat_curve_model *model);

BAT_C_END

#endif

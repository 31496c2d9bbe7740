#ifndef BATTEN_RESEARCH_MOTION_STUDY_H
#define BATTEN_RESEARCH_MOTION_STUDY_H

#include "batten/curve_picture.h"
#include "batten/motion_hermite.h"

BAT_C_BEGIN

/// @file
/// Measurements of the claims of Ben-Zion Vardi, Dyn and Sharon on Hermite schemes on manifolds, and their figures 1 to 4.

/// The manifold-Hermite De Casteljau average (algorithm 3 of Ben-Zion Vardi, Dyn and Sharon): a point and a direction at
/// share `weight` of the geodesic De Casteljau cubic between two points with directions. Weight 0 gives the first, 1 the
/// second, bit for bit; weights outside 0 … 1 extrapolate. Two equal points with equal directions are their own average.
///
/// All geodesics between points are the shortest ones, also those to inner control points beyond the injectivity radius.
/// The direction is the last geodesic's own velocity where it passes the point, not a difference of points.
///
/// @param p0, v0    a point and a direction there, of unit length to BAT_HERMITE_TANGENT_TOLERANCE; likewise p1, v1
/// @param point, direction receive the average; they may not overlap the inputs
/// @return BAT_OK; BAT_INVALID_ARGUMENT where the space lacks a function; BAT_CUT_LOCUS where a geodesic is not unique;
///         BAT_INVALID_POINT where a direction is not of unit length, the pair is not admissible, the points are equal but
///         not the directions, or the average has no direction
BAT_API bat_status bat_hermite_average(const bat_space *space, const double *p0, const double *v0, const double *p1,
                                       const double *v1, double weight, double *point, double *direction);

/// The measured quantities.
typedef enum bat_hermite_quantity
{
    BAT_HERMITE_QUANTITY_ERROR,           ///< largest distance of the refined curve from the smooth curve of its samples
    BAT_HERMITE_QUANTITY_GEODESIC_ERROR,  ///< largest distance from the geodesic whose end points and directions are refined
                                          ///< (proposition 3.5)
    BAT_HERMITE_QUANTITY_POINT_PROXIMITY, ///< largest |q - b| of De Casteljau and Bézier averages of the same data
                                          ///< (lemma 3.7, eq. 4.7)
    BAT_HERMITE_QUANTITY_ANGLE_PROXIMITY, ///< largest difference of their angles (eq. 4.8)
    BAT_HERMITE_QUANTITY_CONTRACTION,     ///< largest ratio of the longest edges of consecutive levels (eq. 4.2)
    BAT_HERMITE_QUANTITY_DISPLACEMENT, ///< largest distance of new point 2 i from old point i, relative to the longest edge
                                       ///< (eq. 4.3)
    BAT_HERMITE_QUANTITY_HALVING, ///< largest |L_H of half a pair / L_H of the pair - 1/2| of neighbours on a smooth curve:
                                  ///< 0 by the assumption of theorem 4.8 (eq. 4.14)
    BAT_HERMITE_QUANTITY_HALF_SHARE, ///< the largest such quotient of pairs with angles up to 45 degrees: mu of eq. (4.12)
    BAT_HERMITE_QUANTITY_TRIANGLE    ///< largest L_H(Q0, Q1) / (L_H(Q0, Q) + L_H(Q, Q1)): at most 1 by eq. (4.11)
} bat_hermite_quantity;

/// The longest mask of a linear Hermite scheme.
#define BAT_HERMITE_MASK_MAX 16

/// The mask of a linear Hermite scheme. New data i are the sum over j of A(i - 2 j) times the column (old point j, old
/// derivative j). Derivatives are by the index on every level, so that they halve where the curve stays the same.
/// `coefficients[k]` is the 2 x 2 matrix A(first + k).
typedef struct bat_hermite_mask
{
    double coefficients[BAT_HERMITE_MASK_MAX][2][2];
    size_t count; ///< 1 … BAT_HERMITE_MASK_MAX
    int first;    ///< index of the first matrix, may be negative
} bat_hermite_mask;

/// Merrien's interpolatory schemes (1992). The new point is (p + q) / 2 + lambda (d(q) - d(p)). The new derivative is
/// ((1 - mu) (q - p) + mu (d(p) + d(q)) / 2) / 2. lambda = -1/8, mu = -1/2 gives the cubic Hermite interpolant.
BAT_API bat_hermite_mask bat_hermite_mask_merrien(double lambda, double mu);
/// The cubic Hermite interpolant at 1/4 and 3/4 of every edge: corner cutting with derivatives. It is the de Rham transform
/// (Dubuc and Merrien 2008) of Merrien's scheme. Limits are C2, and cubics reproduced.
BAT_API bat_hermite_mask bat_hermite_mask_de_rham(void);

/// A linear Hermite scheme on manifolds.
typedef struct bat_hermite_linear
{
    bat_hermite_mask mask;
    bat_curve_base base; ///< in whose tangent space to sum
} bat_hermite_linear;

/// Refine by a linear Hermite scheme, with logarithms and parallel transport (Moosmüller 2017). Derivatives of evenly spaced
/// samples by the index become derivatives by the new index.
///
/// @param scheme null: bat_hermite_refine()
/// @return as bat_hermite_refine(), and BAT_INVALID_ARGUMENT for weights that do not sum to 1 and 0
BAT_API bat_status bat_hermite_transport_refine(const bat_hermite_curve *coarse, const bat_hermite_linear *scheme,
                                                const bat_hermite_refine_options *options, bat_hermite_curve *fine,
                                                bat_error *error);

/// A measurement. The strings are constants.
typedef struct bat_hermite_measure
{
    const char *space;  ///< "R^3", "sphere", "disk", "rotation", "rigid", "spd 2 x 2", …
    const char *scheme; ///< "hermite:order=1", "transport:mask=merrien", or a name for bat_curve_scheme_by_name()
    bat_hermite_quantity quantity;
    double
        h; ///< spacing: of the curve's parameter (errors, halving), between the two points (proximity); NaN for the others
    double value;
    double order; ///< log2 of the ratio of the row before, at twice the spacing, to this one; NaN if there is none
} bat_hermite_measure;

/// A table of measurements.
typedef struct bat_hermite_table
{
    bat_hermite_measure *rows; ///< grouped by space, scheme and quantity; h halves from row to row
    size_t count;
} bat_hermite_table;

/// The name of a quantity, a constant: "error", "geodesic error", "point proximity", …
BAT_API const char *bat_hermite_quantity_name(bat_hermite_quantity quantity);

/// Measure all quantities in nine spaces, on smooth closed curves sampled at 16, 32, 64 and 128 points and refined three
/// times. The results are reproducible.
///
/// Schemes with directions: Hermite Lane-Riesenfeld of orders 1, 2 and 3. With derivatives: parallel transport with
/// Merrien's interpolatory mask, summed at a vertex and at the midpoint, and with the C2 mask. With points alone: order 1
/// with estimated directions, the four-point scheme and cubic Lane-Riesenfeld by log-exp, and cubic Lane-Riesenfeld by
/// geodesic averages.
///
/// @param table receives the rows; release it with bat_hermite_table_free()
/// @return BAT_OK, BAT_CANCELLED or BAT_NO_MEMORY; `table` is untouched on failure
BAT_API bat_status bat_hermite_measure_orders(bat_progress progress, bat_hermite_table *table, bat_error *error);
BAT_API void bat_hermite_table_free(bat_hermite_table *table);

/// Numbers of figures, of panels, and of curves of a panel.
#define BAT_HERMITE_FIGURE_COUNT 4
#define BAT_HERMITE_FIGURE_PANELS 9
#define BAT_HERMITE_FIGURE_CURVES 40

/// A panel: the samples, the smooth curve, and the result of a scheme.
typedef struct bat_hermite_panel
{
    const char *data;   ///< short description of the data; a constant
    const char *scheme; ///< "hermite", "transport", or "transport of directions" as published: see bat_hermite_figure_make()
    size_t order;       ///< of "hermite"; else 0
    size_t samples;     ///< number of samples
    double error;       ///< largest distance of the scheme's points from the smooth curve, in the metric of its space
    bat_curve curves[BAT_HERMITE_FIGURE_CURVES]; ///< the curves to draw
    bat_curve_layer_role roles[BAT_HERMITE_FIGURE_CURVES];
    size_t curve_count;
} bat_hermite_panel;

/// A figure.
typedef struct bat_hermite_figure
{
    const char *name;  ///< "tensors", "orders", "spiral", "rotations"
    const char *title; ///< one line; both are constants
    bat_space *spaces; ///< the spaces of the curves
    bat_hermite_panel panels[BAT_HERMITE_FIGURE_PANELS];
    size_t panel_count;
    size_t columns; ///< panels in a row
} bat_hermite_figure;

/// Make figure `index`, 0 to BAT_HERMITE_FIGURE_COUNT - 1.
///
/// The paper does not specify the data. Figures 3 and 4 use the curves of the published program's outputs: the spiral (cos
/// t, sin t, 0.4 t) normalized to unit length, t from -10 to 10; and the rotations with rows (0, -s, c), (s, -c^2, -s c),
/// (c, s c, s^2), c = cos t and s = sin t, at 5 points. The data of figures 1 and 2 and the triangle of figure 4 are new.
/// "transport" is Merrien's interpolatory scheme by parallel transport, with derivatives with respect to the index.
/// "transport of directions" uses unit vectors instead, as in the published comparison; this is a deficiency of the data
/// rather than of the scheme. Figure 1 shows averages of all weights for "hermite", and in figure 4 the rotations act on a
/// triangle.
///
/// @param figure receives the figure; release it with bat_hermite_figure_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `figure` is untouched on failure
BAT_API bat_status bat_hermite_figure_make(size_t index, bat_hermite_figure *figure, bat_error *error);
/// Release a figure and make it empty. An empty figure is ignored.
BAT_API void bat_hermite_figure_free(bat_hermite_figure *figure);
/// Draw the panels of a figure.
///
/// @param path .png, .svg or .pdf
/// @return BAT_OK or the status of bat_curve_picture_write()
BAT_API bat_status bat_hermite_figure_draw(const char *path, const bat_hermite_figure *figure, bat_error *error);

/// A motion of which every `step`th pose is kept: root mean square errors of the poses between, of translations and of
/// angles in degrees.
typedef struct bat_keyframes_row
{
    const char *motion; ///< "quadrotor", "car", "arm", "satellite" or "fr1-xyz"; a constant
    bool noisy;         ///< poses are disturbed by uniform noise, up to half the mean step in each coordinate
    size_t step;        ///< 5, 10, 20 or 50
    double errors[2];   ///< of bat_motion_spline_make() by default
    double limited[2];  ///< of BAT_MOTION_SHAPE_LIMITED
    double peers[3]
                [2]; ///< of scipy 1.10: CubicSpline with RotationSpline, Akima with squad, lines with Slerp. Stored figures
} bat_keyframes_row;

/// Measure splines in time on motions by formulas, and on the recorded one in a folder.
///
/// @param folder has fr1-xyz.txt, the ground truth of the sequence freiburg1_xyz of the TUM RGB-D benchmark; null: without
/// it
/// @param rows   receives `count` rows; release them with free()
/// @return BAT_OK, BAT_CANCELLED, BAT_NO_MEMORY, or the failures of bat_curve_read(); `rows` is untouched on failure
BAT_API bat_status bat_keyframes_measure(const char *folder, bat_progress progress, bat_keyframes_row **rows, size_t *count,
                                         bat_error *error);

/// The two parts of the length of a pair of Hermite data, whose sum is L_H of eq. (4.10) of Ben-Zion Vardi, Dyn and Sharon.
typedef struct bat_hermite_length
{
    double path; ///< the length of the points' curve, in the unit of distance()
    double turn; ///< how far the direction turns against parallel transport along that curve, in radians
} bat_hermite_length;

/// The length L_H of the curve w -> bat_hermite_average(w) from one pair of a point and a direction to another (section 4.4,
/// eqs. 4.9 and 4.10): the integral over w in [0, 1] of |p'| + |Du/dw|, where Du/dw is the covariant derivative of the
/// direction along the points. docs/algorithms/hermite-schemes.md has what is known of it: it is not symmetric, and
/// depends on the unit of length.
///
/// Lengths and angles are summed along 16, 32, … 4096 parts and extrapolated, to a relative error of about 1e-9.
///
/// @param p0, v0, p1, v1 as of bat_hermite_average()
/// @param length receives both parts; both 0 for two equal points with equal directions
/// @param error  may be null
/// @return the failures of bat_hermite_average(), and BAT_NO_CONVERGENCE where the curve jumps or has a cusp; `length` is
///         untouched on failure
BAT_API bat_status bat_hermite_length_of(const bat_space *space, const double *p0, const double *v0, const double *p1,
                                         const double *v1, bat_hermite_length *length, bat_error *error);

BAT_C_END

#endif

#ifndef BATTEN_RESEARCH_MOTION_STUDY_H
#define BATTEN_RESEARCH_MOTION_STUDY_H

#include "batten/curve_picture.h"
#include "batten/motion_hermite.h"

BAT_C_BEGIN

/// @file
/// What Ben-Zion Vardi, Dyn and Sharon claim of Hermite schemes on manifolds, measured, and their figures 1 to 4.

/// What a number of the table is.
typedef enum bat_hermite_quantity
{
    BAT_HERMITE_ERROR,          ///< largest distance of the refined curve from the smooth one that its data are sampled from
    BAT_HERMITE_GEODESIC_ERROR, ///< largest distance from the geodesic whose ends and directions are refined
                                ///< (proposition 3.5)
    BAT_HERMITE_POINT_PROXIMITY, ///< largest |q - b| of De Casteljau and Bézier averages of the same data (lemma 3.7,
                                 ///< eq. 4.7)
    BAT_HERMITE_ANGLE_PROXIMITY, ///< largest difference of their angles (eq. 4.8)
    BAT_HERMITE_CONTRACTION,     ///< largest ratio of the longest edges of a level and the one before (eq. 4.2)
    BAT_HERMITE_DISPLACEMENT     ///< largest distance of new point 2 i from old point i over the longest edge (eq. 4.3)
} bat_hermite_quantity;

/// One measured number. The texts are constants.
typedef struct bat_hermite_measure
{
    const char *space;  ///< "R^3", "sphere", "disk", "rotation", "rigid", "spd 2 x 2", …
    const char *scheme; ///< "hermite:order=1", "transport:mask=merrien", or a name for bat_curve_scheme_by_name()
    bat_hermite_quantity quantity;
    double h; ///< spacing: of the curve's parameter (errors), between the two points (proximity); NaN for the others
    double value;
    double order; ///< log2 of the ratio to the row before, at twice the spacing; NaN where there is none
} bat_hermite_measure;

typedef struct bat_hermite_table
{
    bat_hermite_measure *rows; ///< in groups of the same space, scheme and quantity, h halving from row to row
    size_t count;
} bat_hermite_table;

/// The name of a quantity, a constant: "error", "geodesic error", "point proximity", …
BAT_API const char *bat_hermite_quantity_name(bat_hermite_quantity quantity);

/// Measure all of it, in nine spaces, on smooth closed curves sampled at 16, 32, 64 and 128 points and refined three times.
/// The same numbers come out every time.
///
/// Schemes given directions: Hermite Lane-Riesenfeld of orders 1, 2 and 3. Given derivatives: parallel transport with
/// Merrien's interpolatory mask, summed at a vertex and at the midpoint, and with the C2 mask. Given points alone: order 1
/// with estimated directions, the four-point scheme and cubic Lane-Riesenfeld by log-exp, and cubic Lane-Riesenfeld by
/// geodesic averages.
///
/// @param table receives the rows; release it with bat_hermite_table_free()
/// @return BAT_OK, BAT_CANCELLED or BAT_NO_MEMORY; `table` is untouched on failure
BAT_API bat_status bat_hermite_measure_orders(bat_progress progress, bat_hermite_table *table, bat_error *error);
BAT_API void bat_hermite_table_free(bat_hermite_table *table);

/// The figures 1 to 4.
#define BAT_HERMITE_FIGURE_COUNT 4
#define BAT_HERMITE_FIGURE_PANELS 9
#define BAT_HERMITE_FIGURE_CURVES 40

/// One panel: what was given, the smooth curve, and what one scheme makes.
typedef struct bat_hermite_panel
{
    const char *data;   ///< what was given, in a few words; a constant
    const char *scheme; ///< "hermite", "transport", or "transport of directions" as published: see bat_hermite_figure_make()
    size_t order;       ///< of "hermite"; else 0
    size_t samples;     ///< the number of points given
    double error;       ///< largest distance of the scheme's points from the smooth curve, in the metric of its space
    bat_curve curves[BAT_HERMITE_FIGURE_CURVES]; ///< what is drawn
    bat_curve_layer_role roles[BAT_HERMITE_FIGURE_CURVES];
    size_t curve_count;
} bat_hermite_panel;

typedef struct bat_hermite_figure
{
    const char *name;  ///< "tensors", "orders", "spiral", "rotations"
    const char *title; ///< one line; both are constants
    bat_space *spaces; ///< what the curves lie in
    bat_hermite_panel panels[BAT_HERMITE_FIGURE_PANELS];
    size_t panel_count;
    size_t columns; ///< panels in a row
} bat_hermite_figure;

/// Make figure `index`, 0 to BAT_HERMITE_FIGURE_COUNT - 1.
///
/// The text leaves the data open. Those of figures 3 and 4 are the curves behind the published program's outputs: the spiral
/// (cos t, sin t, 0.4 t) brought to unit length, t from -10 to 10, and the rotations with rows (0, -s, c), (s, -c^2, -s c),
/// (c, s c, s^2), c = cos t and s = sin t, at 5 points; those of figures 1 and 2 and the triangle of figure 4 are ours.
/// "transport" is Merrien's interpolatory scheme by parallel transport, given derivatives by the index; "transport of
/// directions" is given unit vectors in their place, as in the published comparison, which is a disadvantage of the data
/// rather than the scheme. Figure 1 shows averages of all weights for "hermite", and in figure 4 the rotations act on a
/// triangle.
///
/// @param figure receives the figure; release it with bat_hermite_figure_free()
/// @return BAT_OK, BAT_INVALID_ARGUMENT or BAT_NO_MEMORY; `figure` is untouched on failure
BAT_API bat_status bat_hermite_figure_make(size_t index, bat_hermite_figure *figure, bat_error *error);
/// Free what the library allocated for a figure and make it empty. Does nothing to a figure that is empty already.
BAT_API void bat_hermite_figure_free(bat_hermite_figure *figure);

BAT_C_END

#endif

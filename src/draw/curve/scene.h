#ifndef DRAW_CURVE_SCENE_H
#define DRAW_CURVE_SCENE_H

#include "batten/curve_picture.h"
#include "draw/curve/comb.h"
#include "draw/curve/map_choice.h"
#include "draw/curve/map_network.h"
#include "draw/curve/proxy.h"

#include <cairo.h>

/// @file
/// The content of a picture's panels, before any drawing.

/// The visible part of a panel's space. The panels of a row share it unless the options differ.
typedef struct scene_frame
{
    double low[2], high[2];         ///< flat spaces: the range of u and v
    double box_low[3], box_high[3]; ///< R^3: the range of the coordinates
    map_choice map;                 ///< sphere: the projection and its centre
    double comb_scale;              ///< 0 without combs
    double tensor_unit;             ///< tensors: the largest semi-axis
    size_t tensor_columns;          ///< tensors: the maximal number in a row
} scene_frame;

typedef struct scene_panel
{
    const bat_curve_picture_panel *source;
    const bat_curve_picture_panel *drawn; ///< the source, or its proxy's panel
    proxy proxied;                        ///< all zero where the source itself is drawn
    view_space space;                     ///< the space that is drawn
    size_t point_dim;
    comb *combs;         ///< one for each drawn layer, empty except for curves; null without combs
    bool polygons;       ///< whether a layer is a ring of a polygon
    bool given_only;     ///< whether no layer is a result; on a map the given curves stand for results then
    size_t given_points; ///< of all BAT_CURVE_LAYER_ROLE_CONTROL
    map_network network; ///< all zero without polygons
    scene_frame frame;
} scene_panel;

typedef struct scene
{
    const bat_curve_picture_options *options;
    scene_panel *panels;
    size_t count;
    size_t columns;
    size_t rows;
} scene;

/// Check and measure all panels. Release the scene with scene_free().
bat_status scene_make(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                      scene *made, bat_error *error);
/// The same without the networks of maps, enough to know what is shown.
bat_status scene_measure(const bat_curve_picture_panel *panels, size_t count, const bat_curve_picture_options *options,
                         scene *made, bat_error *error);
void scene_free(scene *made);

/// The number of panels in a row for `count` panels. Unless the options prescribe it, there are at most five, and each has
/// at least `min_width` of a prescribed width.
size_t scene_columns(const bat_curve_picture_options *options, size_t count, double min_width);

/// Whether any part of a layer is drawn.
bool scene_layer_shown(const bat_curve_picture_layer *layer, const bat_curve_picture_options *options);
/// Whether a panel is drawn in the style of maps.
bool scene_is_map(const scene_panel *panel);
/// Whether the given points of a panel are drawn: not where a map has many.
bool scene_points_shown(const scene_panel *panel, const bat_curve_picture_options *options);
/// The palette index of layer `index` of a panel.
int scene_colour(const bat_curve_picture_panel *panel, size_t index);

/// The aspect ratio of a flat panel, height over width.
static inline double scene_aspect(const scene_frame *frame)
{
    return (frame->high[1] - frame->low[1]) / (frame->high[0] - frame->low[0]);
}

/// A corner of the box in R^3; the bits of `corner` choose the high coordinates.
static inline void scene_corner(const scene_frame *frame, unsigned corner, double *point)
{
    for (unsigned k = 0; k < 3; k++)
    {
        point[k] = (corner >> k & 1u) != 0 ? frame->box_high[k] : frame->box_low[k];
    }
}

/// Curves of symmetric positive-definite matrices A are drawn as rows of ellipses or ellipsoids {x: x^T A^-1 x = 1}, whose
/// semi-axes are the square roots of the eigenvalues. Each layer is a row; positions in it are parameters of the curve.

/// Extend a frame by the rows of a panel.
/// @return BAT_OK, or BAT_NO_CONVERGENCE where eigenvalues cannot be computed
bat_status tensor_row_include(scene_frame *frame, const bat_curve_picture_panel *panel, bat_error *error);
/// Draw the rows of a panel. (u, v) are in units of the largest semi-axis.
bat_status tensor_row_draw(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_error *error);

#endif

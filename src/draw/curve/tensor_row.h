#ifndef DRAW_CURVE_TENSOR_ROW_H
#define DRAW_CURVE_TENSOR_ROW_H

#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// Curves of symmetric positive-definite matrices A as rows of ellipses or ellipsoids {x: x^T A^-1 x = 1}, whose semi-axes
/// are the square roots of the eigenvalues: a row for every layer, the share of the way along the curve to the right.

/// Make room in a frame for the rows of a panel.
/// @return BAT_OK, or BAT_NO_CONVERGENCE where eigenvalues cannot be computed
bat_status tensor_row_include(scene_frame *frame, const bat_curve_picture_panel *panel, bat_error *error);
/// Draw the rows of a panel. (u, v) are in units of the largest semi-axis, as the frame has them.
bat_status tensor_row_draw(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_error *error);

#endif

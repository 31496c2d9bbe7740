#ifndef DRAW_CURVE_PANEL_H
#define DRAW_CURVE_PANEL_H

#include "draw/common/legend.h"
#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// One panel of a picture.

/// The preferred height of a panel for a width; a flat drawing is at most `tallest` times as high as wide.
double panel_height(const scene_panel *panel, const bat_curve_picture_options *options, double tallest, double width);
/// Draw a panel into the box (x, y, width, height), centred and with equal scales of both axes.
bat_status panel_draw(cairo_t *cairo, const scene_panel *panel, const bat_curve_picture_options *options,
                      const double box[4], bat_error *error);
/// The legend item of a layer; the label may be null.
legend_item panel_legend_item(const scene_panel *panel, size_t index, const bat_curve_picture_options *options);

#endif

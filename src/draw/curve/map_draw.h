#ifndef DRAW_CURVE_MAP_DRAW_H
#define DRAW_CURVE_MAP_DRAW_H

#include "draw/common/style.h"
#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// Polygons and lines of maps.

/// The style of a layer of a map.
line_style map_line(const scene_panel *panel, size_t index);
/// Fill the polygons of the results, or the given ones where there are no results.
void map_draw_fills(cairo_t *cairo, const draw_view *view, const scene_panel *panel);
/// Draw the lines of a role, each distinct edge once. The panel has polygons.
bat_status map_draw_lines(cairo_t *cairo, const draw_view *view, const scene_panel *panel, bat_curve_layer_role role,
                          bat_error *error);

#endif

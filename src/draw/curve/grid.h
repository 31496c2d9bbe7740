#ifndef DRAW_CURVE_GRID_H
#define DRAW_CURVE_GRID_H

#include "draw/common/style.h"
#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// What lies under the curves and around them: graticules, tilings, axes.

/// The ball of a globe with its soft light.
void grid_globe_sphere(cairo_t *cairo, const draw_view *view);
/// The meridians and parallels of the front, every 15 or 30 degrees, the equator and the zero meridian stronger.
void grid_globe_lines(cairo_t *cairo, const draw_view *view);
/// The limb, with or without latitudes beside it and the middle's coordinates below.
void grid_globe_limb(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
/// The space that labels need on each side of a globe.
#define GRID_GLOBE_MARGIN 22.0

/// The paper, frame, graticule and labels of a world map.
void grid_map(cairo_t *cairo, const draw_view *view, bool lines);
/// Keep the lines that follow within the map's frame.
void grid_map_clip(cairo_t *cairo, const draw_view *view);
#define GRID_MAP_LEFT 26.0
#define GRID_MAP_BOTTOM 14.0
#define GRID_MAP_RIGHT 12.0

/// The disk's paper and, with `lines`, the geodesics of the tiling by right-angled pentagons, four around a vertex.
void grid_disk(cairo_t *cairo, const draw_view *view, bool lines);
void grid_disk_circle(cairo_t *cairo, const draw_view *view);

/// Light lines at round numbers with their labels on the left and below, within the box (x, y, width, height) on paper.
void grid_plane(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const double box[4]);
/// The space that the labels need on the left, top, right and below of the frame.
void grid_plane_room(const scene_frame *frame, double room[4]);

/// The box around the curves in R^3, its axes named at the low corner.
void grid_solid(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The space that the names of the axes need.
#define GRID_SOLID_MARGIN 10.0

#endif

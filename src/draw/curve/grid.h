#ifndef DRAW_CURVE_GRID_H
#define DRAW_CURVE_GRID_H

#include "draw/common/style.h"
#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// Backgrounds and frames of panels: graticules, tilings and axes.

/// Draw the sphere of a globe with soft shading.
void grid_globe_sphere(cairo_t *cairo, const draw_view *view);
/// Draw the meridians and parallels of the front, every 15 or 30 degrees, with a stronger equator and zero meridian.
void grid_globe_lines(cairo_t *cairo, const draw_view *view);
/// Draw the outline of a globe, optionally with latitudes beside it and the coordinates of its centre below.
void grid_globe_limb(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
/// Draw the meridians and parallels of a small part of a globe, frame->reach on each side of its centre, its frame, and the
/// coordinates of the centre below.
void grid_globe_region(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool lines);
/// Cut off what lies outside that part.
void grid_globe_region_clip(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margin for labels on each side of a globe.
#define GRID_GLOBE_MARGIN 22.0

/// Draw the background, frame, graticule and labels of a world map.
void grid_map(cairo_t *cairo, const draw_view *view, bool lines);
/// Clip the following drawing to the frame of the map.
void grid_map_clip(cairo_t *cairo, const draw_view *view);
#define GRID_MAP_LEFT 26.0
#define GRID_MAP_BOTTOM 14.0
#define GRID_MAP_RIGHT 12.0

/// Draw the background of the disk and, with `lines`, the geodesics of the tiling by right-angled pentagons, four at each
/// vertex.
void grid_disk(cairo_t *cairo, const draw_view *view, bool lines);
void grid_disk_circle(cairo_t *cairo, const draw_view *view);

/// Draw light lines at round numbers, with labels to the left and below, within the box (x, y, width, height).
void grid_plane(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const double box[4]);
/// The margins for labels to the left, above, to the right and below.
void grid_plane_room(const scene_frame *frame, double room[4]);

/// Draw the bounding box of curves in R^3, with its axes labelled at the lowest corner.
void grid_solid(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margin for the labels of the axes.
#define GRID_SOLID_MARGIN 10.0

#endif

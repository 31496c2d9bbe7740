#ifndef DRAW_CURVE_GRID_H
#define DRAW_CURVE_GRID_H

#include "draw/common/style.h"
#include "draw/curve/scene.h"

#include <cairo.h>

/// @file
/// Backgrounds and frames of panels: graticules, tilings and axes.

/// Margins of a drawing.
typedef struct insets
{
    double left, top, right, bottom;
} insets;

/// Draw the sphere of a globe with soft shading; `sea` is a background for polygons.
void grid_globe_sphere(cairo_t *cairo, const draw_view *view, bool sea);
/// Draw the meridians and parallels of the front, every 15 or 30 degrees, with a stronger equator and zero meridian.
void grid_globe_lines(cairo_t *cairo, const draw_view *view);
/// Draw the outline of a globe, optionally with latitudes beside it and the coordinates of its centre below.
void grid_globe_limb(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
/// The margin for labels on each side of a globe.
#define GRID_GLOBE_MARGIN 22.0

/// Fill the frame of a world map; `sea` is a background for polygons.
void grid_map_ground(cairo_t *cairo, const draw_view *view, bool sea);
/// Draw the graticule of a world map, every 30 degrees.
void grid_map_lines(cairo_t *cairo, const draw_view *view);
/// Draw the frame of a world map and, with `labels`, the latitudes and longitudes beside it.
void grid_map_frame(cairo_t *cairo, const draw_view *view, bool labels);
/// Clip the following drawing to the frame of the map.
void grid_map_clip(cairo_t *cairo, const draw_view *view);
#define GRID_MAP_LEFT 20.0
#define GRID_MAP_BOTTOM 14.0
#define GRID_MAP_RIGHT 6.0

/// Fill the window of a local map; `sea` is a background for polygons.
void grid_local_ground(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool sea);
void grid_local_lines(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// Draw the frame of a local map, its scale bar and, with `labels`, the latitudes and longitudes beside it.
void grid_local_frame(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels);
void grid_local_clip(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margins for labels and the scale bar to the left, above, to the right and below.
insets grid_local_room(const scene_frame *frame, bool labels);

/// The largest step of a graticule, in seconds of arc, that a range of so many seconds holds three times: 30, 20, 10, 5, 2
/// or 1 degrees, minutes or seconds, or a decimal fraction of a second.
double grid_step(double range);
/// Write "64°30′N": degrees, with minutes and seconds as far as the step needs them.
void grid_angle_label(double seconds, double step, const char *positive, const char *negative, char *label, size_t size);
/// The length of a scale bar, 1, 2 or 5 times a power of ten, up to a quarter of `width`.
double grid_scale_length(double width);
/// Draw a scale bar with its left end at (x, y), for a drawing that is `width` points and `extent` units wide. `unit` "m"
/// counts kilometres and centimetres, too.
void grid_scale_bar(cairo_t *cairo, double x, double y, double width, double extent, const char *unit);
/// The height that a scale bar takes.
#define GRID_SCALE_HEIGHT 15.0

/// Draw the background of the disk and, with `lines`, the geodesics of the tiling by right-angled pentagons, four at each
/// vertex.
void grid_disk(cairo_t *cairo, const draw_view *view, bool lines);
void grid_disk_circle(cairo_t *cairo, const draw_view *view);

/// Draw light lines at round numbers, with labels to the left and below, within the box (x, y, width, height).
void grid_plane(cairo_t *cairo, const draw_view *view, const scene_frame *frame, const double box[4]);
/// The margins for labels to the left, above, to the right and below.
insets grid_plane_room(const scene_frame *frame);

/// Draw the bounding box of curves in R^3, with its axes labelled at the lowest corner.
void grid_solid(cairo_t *cairo, const draw_view *view, const scene_frame *frame);
/// The margin for the labels of the axes.
#define GRID_SOLID_MARGIN 10.0

#endif

#include "draw/common/canvas.h"
#include "draw/common/text.h"
#include "draw/curve/grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/// @file
/// Graticules of the globe and of the equirectangular map.

static const double DEGREE = 3.14159265358979323846 / 180.0;
static const double TURN = 6.28318530717958647693;

/// The radius from which a globe has lines every 15 degrees.
#define FINE_RADIUS 110.0

void grid_globe_sphere(cairo_t *cairo, const draw_view *view)
{
    double x = view->origin_x;
    double y = view->origin_y;
    double radius = view->scale;
    cairo_pattern_t *light =
        cairo_pattern_create_radial(x - 0.3 * radius, y - 0.35 * radius, 0.1 * radius, x, y, 1.02 * radius);
    cairo_pattern_add_color_stop_rgb(light, 0.0, 1.0, 1.0, 1.0);
    cairo_pattern_add_color_stop_rgb(light, 0.6, 0.975, 0.98, 0.987);
    cairo_pattern_add_color_stop_rgb(light, 1.0, 0.905, 0.922, 0.942);
    cairo_arc(cairo, x, y, radius, 0.0, TURN);
    cairo_set_source(cairo, light);
    cairo_fill(cairo);
    cairo_pattern_destroy(light);
}

static void direction(double longitude, double latitude, double *point)
{
    point[0] = cos(latitude) * cos(longitude);
    point[1] = cos(latitude) * sin(longitude);
    point[2] = sin(latitude);
}

/// Draw a line from (longitude, latitude) in degrees, along a meridian or, with `parallel`, along the whole parallel.
static void trace_line(cairo_t *cairo, const draw_view *view, double longitude, double latitude, bool parallel)
{
    enum
    {
        STEPS = 180
    };
    double points[3 * (STEPS + 1)];
    for (int i = 0; i <= STEPS; i++)
    {
        double share = (double)i / STEPS;
        double turned = parallel ? longitude + 360.0 * share : longitude;
        double raised = parallel ? latitude : latitude * (1.0 - 2.0 * share);
        direction(turned * DEGREE, raised * DEGREE, points + (size_t)(3 * i));
    }
    path_simplifier path = simplifier_begin(canvas_sink(cairo), 0.05);
    view_trace(view, points, STEPS + 1, false, VIEW_FRONT, &path);
}

/// Meridians that are not multiples of 90 degrees end before the poles, where they would merge.
void grid_globe_lines(cairo_t *cairo, const draw_view *view)
{
    int step = view->scale >= FINE_RADIUS ? 15 : 30;
    for (int longitude = -180; longitude < 180; longitude += step)
    {
        bool long_one = longitude % 90 == 0;
        trace_line(cairo, view, longitude, long_one ? 90.0 : 90.0 - step, false);
    }
    for (int latitude = -90 + step; latitude < 90; latitude += step)
    {
        trace_line(cairo, view, 0.0, latitude, true);
    }
    style_use_line(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    cairo_stroke(cairo);
    trace_line(cairo, view, 0.0, 0.0, true);
    trace_line(cairo, view, 0.0, 90.0, false);
    style_use_line(cairo, (line_style){COLOUR_STRONG_GRID, LINE_GRID * 1.3, 0.0, 0.0});
    cairo_stroke(cairo);
}

/// Write "30°N", "0°" or "180°" for whole degrees.
static void degree_label(double degrees, const char *positive, const char *negative, char *label, size_t size)
{
    int whole = (int)lround(degrees);
    bool plain = whole == 0 || abs(whole) == 180;
    const char *side = plain ? "" : whole > 0 ? positive : negative;
    (void)snprintf(label, size, "%d\xc2\xb0%s", abs(whole), side);
}

/// Label the parallels where they meet the outline, at v = sin(latitude) / cos(latitude of the centre). Labels remain within
/// the globe's square.
static void limb_labels(cairo_t *cairo, const draw_view *view, double latitude)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    for (int degrees = -60; degrees <= 60; degrees += 30)
    {
        double v = sin(degrees * DEGREE) / cos(latitude);
        double distance = 1.0 + (4.0 + 4.0 * fabs(v)) / view->scale;
        if (fabs(v) * distance * view->scale + 0.5 * TEXT_TICK < view->scale)
        {
            char label[16];
            degree_label(degrees, "N", "S", label, sizeof label);
            double u = -sqrt(1.0 - v * v) * distance;
            text_draw_middle(cairo, label, view_x(view, u), view_y(view, v * distance), 1.0);
        }
    }
}

/// Write the coordinates of the centre in the lower right corner of the globe's square, reduced where space is short.
static void middle_label(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    char east[16];
    char north[16];
    char label[64];
    degree_label(remainder(frame->longitude / DEGREE, 360.0), "E", "W", east, sizeof east);
    degree_label(frame->latitude / DEGREE, "N", "S", north, sizeof north);
    (void)snprintf(label, sizeof label, "centre %s %s", north, east);
    text_use(cairo, TEXT_TICK, false);
    double radius = view->scale;
    double edge = radius + GRID_GLOBE_MARGIN - 4.0;
    double free_width = edge - sqrt(2.0 * radius * (TEXT_TICK + 3.0));
    double size = TEXT_TICK * fmin(1.0, free_width / text_width(cairo, label));
    if (size >= TEXT_SMALLEST)
    {
        text_use(cairo, size, false);
        style_use_colour(cairo, COLOUR_MUTED);
        text_draw(cairo, label, view->origin_x + edge, view->origin_y + radius, 1.0);
    }
}

void grid_globe_limb(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool labels)
{
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, TURN);
    style_use_line(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
    cairo_stroke(cairo);
    if (labels)
    {
        limb_labels(cairo, view, frame->latitude);
        middle_label(cairo, view, frame);
    }
}

/// The path of the square of a part of a globe.
static void region_path(cairo_t *cairo, const draw_view *view, double reach)
{
    double side = 2.0 * reach * view->scale;
    cairo_rectangle(cairo, view_x(view, -reach), view_y(view, reach), side, side);
}

void grid_globe_region_clip(cairo_t *cairo, const draw_view *view, const scene_frame *frame)
{
    region_path(cairo, view, frame->reach);
    cairo_clip(cairo);
}

/// Draw part of a parallel, or of a meridian, around a point. All angles are in degrees.
static void region_line(cairo_t *cairo, const draw_view *view, const double centre[2], double half, bool parallel)
{
    enum
    {
        STEPS = 60
    };
    double points[3 * (STEPS + 1)];
    for (int i = 0; i <= STEPS; i++)
    {
        double away = half * (2.0 * i / STEPS - 1.0);
        double longitude = centre[0] + (parallel ? away : 0.0);
        double latitude = fmin(fmax(centre[1] + (parallel ? 0.0 : away), -90.0), 90.0);
        direction(longitude * DEGREE, latitude * DEGREE, points + (size_t)(3 * i));
    }
    path_simplifier path = simplifier_begin(canvas_sink(cairo), 0.05);
    view_trace(view, points, STEPS + 1, false, VIEW_FRONT, &path);
}

/// The largest of the usual steps, in degrees, that gives at least five lines in a range.
static double region_step(double range)
{
    double step = 10.0;
    for (int i = 0; 5.0 * step > range && step > 1e-9; i++)
    {
        step *= i % 3 == 1 ? 0.4 : 0.5; // 10, 5, 2, 1, 0.5, 0.2, …
    }
    return step;
}

static void region_lines(cairo_t *cairo, const draw_view *view, const scene_frame *frame, double step)
{
    // Half the diagonal of the square, and the longitudes that it covers.
    double half = asin(fmin(1.42 * frame->reach, 1.0)) / DEGREE;
    double longitude = frame->longitude / DEGREE;
    double latitude = frame->latitude / DEGREE;
    double level = cos((fabs(latitude) + half) * DEGREE);
    bool pole = fabs(latitude) + half >= 90.0;
    double wide = pole ? 180.0 : fmin(half / level, 180.0);
    for (double at = ceil((latitude - half) / step) * step; at <= latitude + half; at += step)
    {
        region_line(cairo, view, (double[2]){longitude, at}, wide, true);
    }
    double across = pole ? fmax(step, 15.0) : step;
    while (wide > 20.0 * across)
    {
        across *= 2.0;
    }
    for (double at = ceil((longitude - wide) / across) * across; at <= longitude + wide; at += across)
    {
        region_line(cairo, view, (double[2]){at, latitude}, half, false);
    }
}

void grid_globe_region(cairo_t *cairo, const draw_view *view, const scene_frame *frame, bool lines)
{
    double step = region_step(2.0 * frame->reach / DEGREE);
    if (lines)
    {
        cairo_save(cairo);
        grid_globe_region_clip(cairo, view, frame);
        region_lines(cairo, view, frame, step);
        style_use_line(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
        cairo_stroke(cairo);
        cairo_restore(cairo);
    }
    region_path(cairo, view, frame->reach);
    style_use_line(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
    cairo_stroke(cairo);
    if (lines)
    {
        char label[96];
        double longitude = remainder(frame->longitude / DEGREE, 360.0);
        double latitude = frame->latitude / DEGREE;
        int digits = step >= 1.0 ? 1 : 1 + (int)ceil(-log10(step));
        (void)snprintf(label, sizeof label, "centre %.*f\xc2\xb0%s %.*f\xc2\xb0%s, lines every %g\xc2\xb0", digits,
                       fabs(latitude), latitude < 0 ? "S" : "N", digits, fabs(longitude), longitude < 0 ? "W" : "E", step);
        text_use(cairo, TEXT_TICK, false);
        style_use_colour(cairo, COLOUR_MUTED);
        text_draw(cairo, label, view_x(view, frame->reach), view_y(view, -frame->reach) + TEXT_TICK + 3.0, 1.0);
    }
}

static void map_line(cairo_t *cairo, const draw_view *view, double longitude, double latitude)
{
    bool meridian = isnan(latitude);
    double u = meridian ? longitude * DEGREE : TURN / 2.0;
    double v = meridian ? TURN / 4.0 : latitude * DEGREE;
    cairo_move_to(cairo, view_x(view, meridian ? u : -u), view_y(view, meridian ? -v : v));
    cairo_line_to(cairo, view_x(view, u), view_y(view, v));
}

static void map_graticule(cairo_t *cairo, const draw_view *view)
{
    for (int degrees = -150; degrees <= 150; degrees += 30)
    {
        map_line(cairo, view, degrees, NAN);
        if (abs(degrees) <= 60)
        {
            map_line(cairo, view, NAN, degrees);
        }
    }
    style_use_line(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    cairo_stroke(cairo);
    map_line(cairo, view, 0.0, NAN);
    map_line(cairo, view, NAN, 0.0);
    style_use_line(cairo, (line_style){COLOUR_STRONG_GRID, LINE_GRID * 1.3, 0.0, 0.0});
    cairo_stroke(cairo);
}

static void map_labels(cairo_t *cairo, const draw_view *view)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    double left = view_x(view, -TURN / 2.0) - 4.0;
    double bottom = view_y(view, -TURN / 4.0) + 10.0;
    double spacing = 30.0 * DEGREE * view->scale;
    int across = spacing > 34.0 ? 30 : spacing > 17.0 ? 60 : 90;
    int upwards = spacing > 12.0 ? 30 : 60;
    char label[16];
    for (int degrees = -180; degrees <= 180; degrees += across)
    {
        degree_label(degrees, "E", "W", label, sizeof label);
        text_draw(cairo, label, view_x(view, degrees * DEGREE), bottom, 0.5);
    }
    for (int degrees = -60; degrees <= 60; degrees += upwards)
    {
        degree_label(degrees, "N", "S", label, sizeof label);
        text_draw_middle(cairo, label, left, view_y(view, degrees * DEGREE), 1.0);
    }
}

/// Append the frame of the map, enlarged by `margin`, to the path.
static void map_frame(cairo_t *cairo, const draw_view *view, double margin)
{
    double left = view_x(view, -TURN / 2.0) - margin;
    double top = view_y(view, TURN / 4.0) - margin;
    double width = TURN * view->scale;
    cairo_rectangle(cairo, left, top, width + 2.0 * margin, 0.5 * width + 2.0 * margin);
}

void grid_map_clip(cairo_t *cairo, const draw_view *view)
{
    map_frame(cairo, view, 0.5 * LINE_FRAME);
    cairo_clip(cairo);
}

void grid_map(cairo_t *cairo, const draw_view *view, bool lines)
{
    map_frame(cairo, view, 0.0);
    cairo_set_source_rgb(cairo, 0.982, 0.986, 0.991);
    cairo_fill(cairo);
    if (lines)
    {
        map_graticule(cairo, view);
        map_labels(cairo, view);
    }
    map_frame(cairo, view, 0.0);
    style_use_line(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_MITER);
    cairo_stroke(cairo);
}

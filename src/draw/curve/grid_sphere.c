#include "draw/common/sheet.h"
#include "draw/curve/scene.h"

#include <stdio.h>

/// @file
/// Graticules of the globe and of the world map.

/// The radius from which a globe has lines every 15 degrees.
#define FINE_RADIUS 110.0

void grid_globe_sphere(cairo_t *cairo, const draw_view *view, bool sea)
{
    const double red = sea ? 0.945 : 1.0, green = sea ? 0.97 : 1.0;
    double x = view->origin_x, y = view->origin_y;
    double radius = view->scale;
    cairo_pattern_t *light =
        cairo_pattern_create_radial(x - 0.3 * radius, y - 0.35 * radius, 0.1 * radius, x, y, 1.02 * radius);
    cairo_pattern_add_color_stop_rgb(light, 0.0, red, green, 1.0);
    cairo_pattern_add_color_stop_rgb(light, 0.6, 0.975 * red, 0.98 * green, 0.987);
    cairo_pattern_add_color_stop_rgb(light, 1.0, 0.905 * red, 0.922 * green, 0.942);
    cairo_arc(cairo, x, y, radius, 0.0, ANGLE_TURN);
    cairo_set_source(cairo, light);
    cairo_fill(cairo);
    cairo_pattern_destroy(light);
}

#define LINE_STEPS 180

/// Draw a line from (longitude, latitude) in degrees, along a meridian or, with `parallel`, along the whole parallel.
static void trace_line(cairo_t *cairo, const draw_view *view, double longitude, double latitude, bool parallel)
{
    double points[3 * (LINE_STEPS + 1)];
    for (int i = 0; i <= LINE_STEPS; i++)
    {
        double share = (double)i / LINE_STEPS;
        double turned = parallel ? longitude + 360.0 * share : longitude;
        double raised = parallel ? latitude : latitude * (1.0 - 2.0 * share);
        double *point = points + (size_t)(3 * i);
        point[0] = cos(raised * ANGLE_DEGREE) * cos(turned * ANGLE_DEGREE);
        point[1] = cos(raised * ANGLE_DEGREE) * sin(turned * ANGLE_DEGREE);
        point[2] = sin(raised * ANGLE_DEGREE);
    }
    path_simplifier path = simplifier_begin(canvas_sink(cairo), 0.05);
    view_trace(view, points, LINE_STEPS + 1, false, VIEW_FRONT, &path);
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
        trace_line(cairo, view, 0.0, latitude, true);
    style_stroke(cairo, (line_style){COLOUR_GRID, LINE_GRID, 0.0, 0.0});
    trace_line(cairo, view, 0.0, 0.0, true);
    trace_line(cairo, view, 0.0, 90.0, false);
    style_stroke(cairo, (line_style){COLOUR_STRONG_GRID, LINE_GRID * 1.3, 0.0, 0.0});
}

/// Write "30°N", "0°" or "180°" for whole degrees.
static void degree_label(double degrees, const char *positive, const char *negative, char *label, size_t size)
{
    const double seconds = 3600.0;
    grid_angle_label(seconds * round(degrees), seconds, positive, negative, label, size);
}

/// Label the parallels where they meet the outline, at v = sin(latitude) / cos(latitude of the centre).
static void limb_labels(cairo_t *cairo, const draw_view *view, double latitude)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    for (int degrees = -60; degrees <= 60; degrees += 30)
    {
        double v = sin(degrees * ANGLE_DEGREE) / cos(latitude);
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
    char east[16], north[16], label[64];
    degree_label(remainder(frame->map.longitude / ANGLE_DEGREE, 360.0), "E", "W", east, sizeof east);
    degree_label(frame->map.latitude / ANGLE_DEGREE, "N", "S", north, sizeof north);
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
    cairo_arc(cairo, view->origin_x, view->origin_y, view->scale, 0.0, ANGLE_TURN);
    style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
    if (labels)
    {
        limb_labels(cairo, view, frame->map.latitude);
        middle_label(cairo, view, frame);
    }
}

static void graticule_line(cairo_t *cairo, const draw_view *view, double longitude, double latitude)
{
    static const int STEPS = 90;
    bool meridian = isnan(latitude);
    for (int i = 0; i <= STEPS; i++)
    {
        double share = 2.0 * i / STEPS - 1.0;
        double u, v;
        view_equal_earth(meridian ? longitude * ANGLE_DEGREE : share * ANGLE_TURN / 2.0,
                         meridian ? share * ANGLE_TURN / 4.0 : latitude * ANGLE_DEGREE, &u, &v);
        (i == 0 ? cairo_move_to : cairo_line_to)(cairo, view_x(view, u), view_y(view, v));
    }
}

/// The longitude of a map's middle in degrees.
static double map_middle(const draw_view *view)
{
    return atan2(view->rotation[0][1], view->rotation[0][0]) / ANGLE_DEGREE;
}

void grid_map_lines(cairo_t *cairo, const draw_view *view)
{
    double middle = map_middle(view);
    for (int degrees = -180; degrees < 180; degrees += 30)
    {
        double longitude = remainder(degrees - middle, 360.0);
        if (fabs(longitude) < 179.5)
            graticule_line(cairo, view, longitude, NAN);
        if (abs(degrees) <= 60 && degrees != 0)
            graticule_line(cairo, view, 0.0, degrees);
    }
    graticule_line(cairo, view, 0.0, 0.0);
    style_stroke(cairo, (line_style){COLOUR_GRATICULE, LINE_GRATICULE, 0.0, 0.0});
}

static void map_labels(cairo_t *cairo, const draw_view *view)
{
    text_use(cairo, TEXT_TICK, false);
    style_use_colour(cairo, COLOUR_MUTED);
    double u, v;
    double middle = map_middle(view);
    char label[16];
    view_equal_earth(30.0 * ANGLE_DEGREE, -ANGLE_TURN / 4.0, &u, &v);
    double bottom = view_y(view, v) + 10.0;
    double spacing = u * view->scale;
    int across = spacing > 34.0 ? 30 : spacing > 17.0 ? 60 : 90;
    for (int degrees = -180; degrees < 180; degrees += across)
    {
        double longitude = remainder(degrees - middle, 360.0);
        view_equal_earth(longitude * ANGLE_DEGREE, -ANGLE_TURN / 4.0, &u, &v);
        degree_label(degrees, "E", "W", label, sizeof label);
        text_draw(cairo, label, view_x(view, u), bottom, 0.5);
        if (fabs(longitude) > 179.5)
            text_draw(cairo, label, view_x(view, -u), bottom, 0.5);
    }
    view_equal_earth(0.0, 30.0 * ANGLE_DEGREE, &u, &v);
    int upwards = v * view->scale > 12.0 ? 30 : 60;
    for (int degrees = -60; degrees <= 60; degrees += upwards)
    {
        view_equal_earth(-ANGLE_TURN / 2.0, degrees * ANGLE_DEGREE, &u, &v);
        degree_label(degrees, "N", "S", label, sizeof label);
        text_draw_middle(cairo, label, view_x(view, u) - 4.0, view_y(view, v), 1.0);
    }
}

static void map_frame(cairo_t *cairo, const draw_view *view)
{
    static const int STEPS = 90;
    for (int i = 0; i < 2 * (STEPS + 1); i++)
    {
        double share = 2.0 * (i <= STEPS ? i : 2 * STEPS + 1 - i) / STEPS - 1.0;
        double u, v;
        view_equal_earth(i <= STEPS ? ANGLE_TURN / 2.0 : -ANGLE_TURN / 2.0, share * ANGLE_TURN / 4.0, &u, &v);
        (i == 0 ? cairo_move_to : cairo_line_to)(cairo, view_x(view, u), view_y(view, v));
    }
    cairo_close_path(cairo);
}

void grid_map_clip(cairo_t *cairo, const draw_view *view)
{
    map_frame(cairo, view);
    cairo_clip(cairo);
}

void grid_map_ground(cairo_t *cairo, const draw_view *view, bool sea)
{
    map_frame(cairo, view);
    style_use_colour(cairo, sea ? COLOUR_SEA : COLOUR_EMPTY);
    cairo_fill(cairo);
}

void grid_map_frame(cairo_t *cairo, const draw_view *view, bool labels)
{
    if (labels)
        map_labels(cairo, view);
    map_frame(cairo, view);
    style_stroke(cairo, (line_style){COLOUR_FRAME, LINE_FRAME, 0.0, 0.0});
}

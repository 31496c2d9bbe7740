#include "draw/curve/stroke.h"

#include "draw/curve/coverage.h"

#include <math.h>

/// A line that keeps more points is too rough to be drawn one by one.
#define MANY_POINTS 30000

/// A sink for cairo's current path that counts and measures, and gives up after MANY_POINTS.
typedef struct careful_pen
{
    cairo_t *cairo;
    size_t count;
    double low_x, low_y, high_x, high_y;
} careful_pen;

/// @return whether the point is to be drawn
static bool pen_measures(careful_pen *pen, double x, double y)
{
    pen->low_x = fmin(pen->low_x, x);
    pen->low_y = fmin(pen->low_y, y);
    pen->high_x = fmax(pen->high_x, x);
    pen->high_y = fmax(pen->high_y, y);
    return ++pen->count <= MANY_POINTS;
}

static void pen_move(void *context, double x, double y)
{
    careful_pen *pen = context;
    if (pen_measures(pen, x, y))
    {
        cairo_move_to(pen->cairo, x, y);
    }
}

static void pen_line(void *context, double x, double y)
{
    careful_pen *pen = context;
    if (pen_measures(pen, x, y))
    {
        cairo_line_to(pen->cairo, x, y);
    }
}

static void trace(const drawn_line *drawn, path_sink sink)
{
    path_simplifier path = simplifier_begin(sink, STROKE_TOLERANCE);
    view_trace(drawn->view, drawn->points, drawn->count, drawn->closed, drawn->side, &path);
}

bat_status stroke_line(cairo_t *cairo, const drawn_line *drawn, line_style line, bat_error *error)
{
    bat_status status = BAT_OK;
    careful_pen pen = {cairo, 0, INFINITY, INFINITY, -INFINITY, -INFINITY};
    trace(drawn, (path_sink){pen_move, pen_line, &pen});
    if (pen.count > MANY_POINTS)
    {
        coverage_map map;
        cairo_new_path(cairo);
        status = coverage_begin(pen.low_x, pen.low_y, pen.high_x, pen.high_y, &map, error);
        if (status != BAT_OK)
        {
            return status;
        }
        trace(drawn, coverage_sink(&map));
        coverage_trace(&map, cairo);
        coverage_free(&map);
        line.dash = 0.0;
    }
    style_use_line(cairo, line);
    cairo_stroke(cairo);
    return status;
}

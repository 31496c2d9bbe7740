#include "draw/curve/view.h"

#include <math.h>

/// The arc from p to q of the circle around `centre`, without p, in steps that deviate from it by at most the tolerance.
static void trace_arc(const draw_view *view, const double *centre, const double *p, const double *q, path_simplifier *path)
{
    double ax = p[0] - centre[0];
    double ay = p[1] - centre[1];
    double bx = q[0] - centre[0];
    double by = q[1] - centre[1];
    double radius = hypot(ax, ay);
    double sweep = atan2(ax * by - ay * bx, ax * bx + ay * by);
    double steps = ceil(fabs(sweep) / fmin(0.2, sqrt(8.0 * view->tolerance / (radius * view->scale))));
    for (double i = 1.0; i < steps; i += 1.0)
    {
        double turn = sweep * i / steps;
        double x = centre[0] + cos(turn) * ax - sin(turn) * ay;
        double y = centre[1] + sin(turn) * ax + cos(turn) * ay;
        simplifier_line(path, view_x(view, x), view_y(view, y));
    }
    simplifier_line(path, view_x(view, q[0]), view_y(view, q[1]));
}

/// The geodesic from p to q, without p: the arc of the circle through both that is orthogonal to the rim. Its centre c
/// solves 2 <c, p> = 1 + |p|^2 and 2 <c, q> = 1 + |q|^2.
static void trace_geodesic(const draw_view *view, const double *p, const double *q, path_simplifier *path)
{
    double chord = hypot(q[0] - p[0], q[1] - p[1]);
    double determinant = 2.0 * (p[0] * q[1] - p[1] * q[0]);
    double a = 1.0 + p[0] * p[0] + p[1] * p[1];
    double b = 1.0 + q[0] * q[0] + q[1] * q[1];
    double numerator_x = a * q[1] - b * p[1];
    double numerator_y = b * p[0] - a * q[0];
    double centre[2] = {numerator_x / determinant, numerator_y / determinant};
    double radius = sqrt(fmax(centre[0] * centre[0] + centre[1] * centre[1] - 1.0, 0.0));
    double sagitta = chord * chord / (8.0 * radius);
    bool tiny = chord * view->scale < view->tolerance;
    if (tiny || !isfinite(radius) || sagitta * view->scale < 0.1 * view->tolerance)
    {
        simplifier_line(path, view_x(view, q[0]), view_y(view, q[1]));
        return;
    }
    trace_arc(view, centre, p, q, path);
}

void view_trace_disk(const draw_view *view, const double *points, size_t count, bool closed, path_simplifier *path)
{
    simplifier_move(path, view_x(view, points[0]), view_y(view, points[1]));
    for (size_t i = 1; i < count + (closed ? 1 : 0); i++)
    {
        trace_geodesic(view, points + 2 * (i - 1), points + 2 * (i < count ? i : 0), path);
    }
}

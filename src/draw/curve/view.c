#include "draw/curve/view.h"

#include "base/error.h"

#include <stdio.h>
#include <string.h>

/// @file
/// Flat views, the Poincaré disk, and checks of curves for drawing.

/// Draw the arc from p to q around `centre`, without p, in steps that deviate from it by at most the tolerance.
static void trace_arc(const draw_view *view, const double *centre, const double *p, const double *q, path_simplifier *path)
{
    double ax = p[0] - centre[0], ay = p[1] - centre[1];
    double bx = q[0] - centre[0], by = q[1] - centre[1];
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

/// Draw the geodesic from p to q, without p: an arc whose centre c solves 2 <c, p> = 1 + |p|^2 and 2 <c, q> = 1 + |q|^2.
static void trace_geodesic(const draw_view *view, const double *p, const double *q, path_simplifier *path)
{
    double chord = hypot(q[0] - p[0], q[1] - p[1]);
    double determinant = 2.0 * (p[0] * q[1] - p[1] * q[0]);
    double a = 1.0 + p[0] * p[0] + p[1] * p[1], b = 1.0 + q[0] * q[0] + q[1] * q[1];
    double numerator_x = a * q[1] - b * p[1], numerator_y = b * p[0] - a * q[0];
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

/// The tolerance of points' lengths on the sphere; it admits single-precision data.
#define UNIT_TOLERANCE 1e-6

view_space view_space_of(const bat_space *space)
{
    if (strcmp(space->name, "plane") == 0 || strcmp(space->name, "euclidean") == 0)
        return space->point_dim == 3 ? VIEW_SOLID : space->point_dim >= 2 ? VIEW_PLANE : VIEW_NOTHING;
    if (strcmp(space->name, "sphere") == 0)
        return space->point_dim == 3 ? VIEW_SPHERE : VIEW_NOTHING;
    static const struct
    {
        const char *name;
        size_t point_dim;
        view_space kind;
    } others[] = {{"disk", 2, VIEW_DISK},         {"spd", 3, VIEW_TENSOR},  {"spd", 6, VIEW_TENSOR},
                  {"rotation", 4, VIEW_ROTATION}, {"rigid", 7, VIEW_RIGID}, {"hyperbolic", 3, VIEW_HYPERBOLIC}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strcmp(space->name, others[i].name) == 0 && space->point_dim == others[i].point_dim)
            return others[i].kind;
    return VIEW_NOTHING;
}

void view_set_globe(draw_view *view, double longitude, double latitude)
{
    double sine = sin(longitude), cosine = cos(longitude);
    double up = sin(latitude), level = cos(latitude);
    double rows[3][3] = {{-sine, cosine, 0.0}, {-up * cosine, -up * sine, level}, {level * cosine, level * sine, up}};
    memcpy(view->rotation, rows, sizeof rows);
}

void view_set_map(draw_view *view, double longitude)
{
    double sine = sin(longitude), cosine = cos(longitude);
    double rows[3][3] = {{cosine, sine, 0.0}, {-sine, cosine, 0.0}, {0.0, 0.0, 1.0}};
    memcpy(view->rotation, rows, sizeof rows);
}

void view_set_solid(draw_view *view)
{
    const double azimuth = -1.0821;  // -62 degrees: x points to the right, y to the right and backwards
    const double elevation = 0.3840; // 22 degrees
    view_set_globe(view, azimuth, elevation);
}

bool view_project(const draw_view *view, const double *point, double *u, double *v)
{
    double rotated[3] = {point[0], point[1], 0};
    if (view->space == VIEW_SOLID || (view->kind != VIEW_FLAT && view->kind != VIEW_POINCARE))
        view_rotate(view, point, rotated);
    if (view->kind == VIEW_LOCAL)
        view_equal_area(rotated, u, v);
    else if (view->kind == VIEW_MAP)
        view_equal_earth(atan2(rotated[1] + 0.0, rotated[0]), atan2(rotated[2], hypot(rotated[0], rotated[1])), u, v);
    else
    {
        *u = rotated[0];
        *v = rotated[1];
    }
    return view->kind != VIEW_GLOBE || rotated[2] >= 0.0;
}

bool view_place(const draw_view *view, const double *point, double *x, double *y)
{
    double u, v;
    bool front = view_project(view, point, &u, &v);
    *x = view_x(view, u);
    *y = view_y(view, v);
    return front;
}

void view_trace(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                path_simplifier *path)
{
    if (view->kind == VIEW_GLOBE)
        view_trace_globe(view, points, count, closed, side, path);
    else if (side == VIEW_FRONT && view->kind == VIEW_FLAT)
        for (size_t i = 0; i < count + (closed ? 1 : 0); i++)
        {
            double x, y;
            view_place(view, points + (i < count ? i : 0) * view->point_dim, &x, &y);
            (i == 0 ? simplifier_move : simplifier_line)(path, x, y);
        }
    else if (side == VIEW_FRONT && (view->kind == VIEW_MAP || view->kind == VIEW_LOCAL))
        view_trace_map(view, points, count, closed, path);
    else if (side == VIEW_FRONT)
    {
        simplifier_move(path, view_x(view, points[0]), view_y(view, points[1]));
        for (size_t i = 1; i < count + (closed ? 1 : 0); i++)
            trace_geodesic(view, points + 2 * (i - 1), points + 2 * (i < count ? i : 0), path);
    }
    simplifier_flush(path);
}

/// Null for a valid point, else an error text.
static const char *point_fault(view_space space, const double *point, size_t point_dim)
{
    double square = vector_square(point_dim, point);
    if (!isfinite(square))
        return "is not finite, or too large to draw";
    if (space == VIEW_SPHERE && fabs(sqrt(square) - 1.0) > UNIT_TOLERANCE)
        return "is not of unit length";
    return space == VIEW_DISK && square >= 1.0 ? "is not inside the unit disk" : NULL;
}

static bool antipodal(const double *p, const double *q)
{
    const double limit = 1e-10;
    return hypot(hypot(p[0] + q[0], p[1] + q[1]), p[2] + q[2]) < limit;
}

bat_status view_check(const bat_curve *curve, bat_error *error)
{
    if (curve == NULL || curve->space == NULL || curve->points == NULL || curve->count == 0)
        return ERROR_ARGUMENT(error, "a curve without points cannot be drawn");
    view_space space = view_space_of(curve->space);
    if (space == VIEW_NOTHING)
        return ERROR_UNSUPPORTED(error, 0, "the space %s of %zu coordinates has no picture", curve->space->name,
                                 curve->space->point_dim);
    size_t dim = curve->space->point_dim;
    for (size_t i = 0; i < curve->count; i++)
    {
        char text[128];
        const double *point = curve->points + i * dim;
        const char *fault = point_fault(space, point, dim);
        const char *foreign = fault == NULL && space >= VIEW_TENSOR ? curve->space->fault(curve->space, point) : NULL;
        if (foreign != NULL)
        {
            (void)snprintf(text, sizeof text, "is %s", foreign);
            fault = text;
        }
        if (fault != NULL)
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu %s", i, fault);
    }
    for (size_t i = 0; space == VIEW_SPHERE && i + (curve->closed ? 0 : 1) < curve->count; i++)
    {
        size_t next = i + 1 < curve->count ? i + 1 : 0;
        if (antipodal(curve->points + 3 * i, curve->points + 3 * next))
            return error_set(error, BAT_CUT_LOCUS, i, 0,
                             "points %zu and %zu are antipodal: their shortest arc is not unique", i, next);
    }
    return BAT_OK;
}

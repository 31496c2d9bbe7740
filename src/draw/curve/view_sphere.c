#include "draw/curve/view.h"

#include "linalg/dense.h"

#include <string.h>

/// @file
/// Geodesics on the sphere: on a globe as cut ellipses, on maps by adaptive bisection.

/// The path on one half of a globe. Points are rotated: the third coordinate points to the eye.
typedef struct globe_tracer
{
    const draw_view *view;
    path_simplifier *path;
    double sign; ///< 1 for the front, -1 for the back
    double point[3];
    bool visible;
} globe_tracer;

static bool globe_visible(const globe_tracer *tracer, const double *point)
{
    return tracer->sign * point[2] >= 0.0;
}

/// Draw an arc as its chord, which is short enough. It crosses the outline where the chord's great circle does.
static void globe_step(globe_tracer *tracer, const double *point)
{
    const draw_view *view = tracer->view;
    bool visible = globe_visible(tracer, point);
    if (visible != tracer->visible)
    {
        double share = tracer->point[2] / (tracer->point[2] - point[2]);
        double u = tracer->point[0] + share * (point[0] - tracer->point[0]);
        double v = tracer->point[1] + share * (point[1] - tracer->point[1]);
        double length = hypot(u, v);
        void (*draw)(path_simplifier *, double, double) = visible ? simplifier_move : simplifier_line;
        draw(tracer->path, view_x(view, u / length), view_y(view, v / length));
    }
    if (visible)
        simplifier_line(tracer->path, view_x(view, point[0]), view_y(view, point[1]));
    memcpy(tracer->point, point, sizeof tracer->point);
    tracer->visible = visible;
}

/// Draw the shortest arc to `target`, in steps of at most `step` radians.
static void globe_arc(globe_tracer *tracer, const double *target, double step)
{
    double from[3];
    memcpy(from, tracer->point, sizeof from);
    double angle = chord_angle(from, target);
    double steps = ceil(angle / step);
    for (double i = 1.0; i < steps; i += 1.0)
    {
        double ahead = sin(angle * i / steps) / sin(angle);
        double behind = sin(angle * (1.0 - i / steps)) / sin(angle);
        double point[3];
        for (int k = 0; k < 3; k++)
            point[k] = behind * from[k] + ahead * target[k];
        globe_step(tracer, point);
    }
    globe_step(tracer, target);
}

void view_trace_globe(const draw_view *view, const double *points, size_t count, bool closed, view_side side,
                      path_simplifier *path)
{
    double step = fmin(0.1, sqrt(8.0 * view->tolerance / view->scale));
    globe_tracer tracer = {.view = view, .path = path, .sign = side == VIEW_FRONT ? 1.0 : -1.0};
    view_rotate(view, points, tracer.point);
    tracer.visible = globe_visible(&tracer, tracer.point);
    if (tracer.visible)
        simplifier_move(path, view_x(view, tracer.point[0]), view_y(view, tracer.point[1]));
    for (size_t i = 1; i < count + (closed ? 1 : 0); i++)
    {
        double target[3];
        view_rotate(view, points + 3 * (i < count ? i : 0), target);
        if (chord_square(tracer.point, target) < step * step)
            globe_step(&tracer, target);
        else
            globe_arc(&tracer, target, step);
    }
}

/// The coefficients of Equal Earth: Šavrič, Patterson and Jenny (2019), equation 6.
#define A1 1.340264
#define A2 (-0.081106)
#define A3 0.000893
#define A4 0.003796

void view_equal_earth(double longitude, double latitude, double *u, double *v)
{
    const double root = 0.86602540378443864676; // sqrt(3) / 2
    double theta = asin(root * sin(latitude));
    double square = theta * theta;
    double sixth = square * square * square;
    *u = longitude * cos(theta) / (root * (A1 + 3.0 * A2 * square + sixth * (7.0 * A3 + 9.0 * A4 * square)));
    *v = theta * (A1 + A2 * square + sixth * (A3 + A4 * square));
}

void view_equal_area(const double *rotated, double *u, double *v)
{
    double across = rotated[0] * rotated[0] + rotated[1] * rotated[1];
    if (rotated[2] < 0.0 && across == 0.0)
    {
        *u = 2.0;
        *v = 0.0;
        return;
    }
    // 2 / (1 + z) = 2 (1 - z) / (x^2 + y^2) for points of unit length; the latter is accurate on the far half.
    double factor = sqrt(rotated[2] < 0.0 ? 2.0 * (1.0 - rotated[2]) / across : 2.0 / (1.0 + rotated[2]));
    *u = factor * rotated[0];
    *v = factor * rotated[1];
}

void view_local_point(const draw_view *view, double u, double v, double *point)
{
    double away = hypot(u, v), angle = 2.0 * asin(fmin(1.0, 0.5 * away));
    double factor = away > 0.0 ? sin(angle) / away : 0.0;
    for (int k = 0; k < 3; k++)
        point[k] =
            view->rotation[0][k] * (factor * u) + view->rotation[1][k] * (factor * v) + view->rotation[2][k] * cos(angle);
}

/// The path in a local view or on a map. Points are rotated.
typedef struct map_tracer
{
    const draw_view *view;
    path_simplifier *path;
    double point[3];
    double longitude, u, v; ///< of `point`; the longitude for maps only
} map_tracer;

static double latitude_of(const double *point)
{
    return atan2(point[2], sqrt(point[0] * point[0] + point[1] * point[1]));
}

/// The longitude in (-pi, pi]; -0 counts as 0.
static double longitude_of(const double *point)
{
    return atan2(point[1] + 0.0, point[0]);
}

/// Project a point; `longitude` receives its longitude for maps.
static void map_project(const map_tracer *tracer, const double *point, double *longitude, double *u, double *v)
{
    if (tracer->view->kind == VIEW_LOCAL)
    {
        view_equal_area(point, u, v);
        return;
    }
    *longitude = longitude_of(point);
    view_equal_earth(*longitude, latitude_of(point), u, v);
}

/// Draw an arc that is straight in the view, cut at the edge of a map.
static void map_step(map_tracer *tracer, const double *point)
{
    const draw_view *view = tracer->view;
    const double *from = tracer->point;
    if (view->kind == VIEW_MAP && (from[1] < 0.0) != (point[1] < 0.0))
    {
        double share = from[1] / (from[1] - point[1]);
        double x = from[0] + share * (point[0] - from[0]);
        double z = from[2] + share * (point[2] - from[2]);
        if (x < 0.0)
        {
            double u, v;
            view_equal_earth(from[1] < 0.0 ? -ANGLE_PI : ANGLE_PI, atan2(z, -x), &u, &v);
            simplifier_line(tracer->path, view_x(view, u), view_y(view, v));
            simplifier_move(tracer->path, view_x(view, -u), view_y(view, v));
        }
    }
    map_project(tracer, point, &tracer->longitude, &tracer->u, &tracer->v);
    simplifier_line(tracer->path, view_x(view, tracer->u), view_y(view, tracer->v));
    memcpy(tracer->point, point, sizeof tracer->point);
}

/// Whether the arc through the midpoint to `target` is straight in the view.
static bool map_straight(const map_tracer *tracer, const double *middle, const double *target)
{
    double half_u, half_v, whole_u, whole_v;
    if (tracer->view->kind == VIEW_LOCAL)
    {
        view_equal_area(middle, &half_u, &half_v);
        view_equal_area(target, &whole_u, &whole_v);
    }
    else
    {
        double whole = remainder(longitude_of(target) - tracer->longitude, 2.0 * ANGLE_PI);
        double half = remainder(longitude_of(middle) - tracer->longitude, 2.0 * ANGLE_PI);
        if (fabs(whole) >= 0.5 * ANGLE_PI)
            return false;
        view_equal_earth(tracer->longitude + half, latitude_of(middle), &half_u, &half_v);
        view_equal_earth(tracer->longitude + whole, latitude_of(target), &whole_u, &whole_v);
    }
    double bend = hypot(half_u - 0.5 * (tracer->u + whole_u), half_v - 0.5 * (tracer->v + whole_v));
    return bend * tracer->view->scale <= tracer->view->tolerance;
}

/// Draw the shortest arc to `target`, bisected until its parts are straight in the view or, near a pole, `depth` is 0.
static void map_arc(map_tracer *tracer, const double *target, int depth)
{
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = tracer->point[k] + target[k];
    (void)vector3_normalize(middle);
    if (depth == 0 || (chord_square(tracer->point, target) < 0.01 && map_straight(tracer, middle, target)))
    {
        map_step(tracer, target);
        return;
    }
    map_arc(tracer, middle, depth - 1);
    map_arc(tracer, target, depth - 1);
}

/// How a short arc to a point is drawn.
typedef enum map_pace
{
    MAP_SKIP,     ///< not at all unless it is the last
    MAP_STRAIGHT, ///< by its chord
    MAP_BEND
} map_pace;

/// The sagitta of an arc with chord c is below 0.18 c^2 on the nearer half of a local view, and below 0.2 c^2 / a^2 on a map
/// where a is the distance from the axis. Points are skipped within a tenth of the tolerance.
static map_pace map_pace_of(const map_tracer *tracer, const double *point)
{
    double square = chord_square(tracer->point, point);
    double unit = tracer->view->tolerance / tracer->view->scale;
    double across = 1.0;
    if (tracer->view->kind == VIEW_MAP)
    {
        across = point[0] * point[0] + point[1] * point[1];
        if ((tracer->point[1] < 0.0) != (point[1] < 0.0))
            return MAP_BEND;
    }
    else if (point[2] <= 0.0 || tracer->point[2] <= 0.0)
        return MAP_BEND;
    bool straight = square < fmin(0.01, 5.0 * unit) * across;
    return square < 0.01 * unit * unit * across ? MAP_SKIP : straight ? MAP_STRAIGHT : MAP_BEND;
}

void view_trace_map(const draw_view *view, const double *points, size_t count, bool closed, path_simplifier *path)
{
    const int depth = 18;
    map_tracer tracer = {.view = view, .path = path};
    view_rotate(view, points, tracer.point);
    map_project(&tracer, tracer.point, &tracer.longitude, &tracer.u, &tracer.v);
    simplifier_move(path, view_x(view, tracer.u), view_y(view, tracer.v));
    size_t end = count + (closed ? 1 : 0);
    for (size_t i = 1; i < end; i++)
    {
        double target[3];
        view_rotate(view, points + 3 * (i < count ? i : 0), target);
        map_pace pace = map_pace_of(&tracer, target);
        if (pace == MAP_SKIP && i + 1 < end)
            continue;
        if (pace == MAP_BEND)
            map_arc(&tracer, target, depth);
        else
            map_step(&tracer, target);
    }
}

/// Moments of curves on the sphere, from which the centre of a globe is chosen.
typedef struct globe_moments
{
    double weight;
    double mean[3];
    double square[3][3];
} globe_moments;

static void add_direction(globe_moments *moments, const double *direction, double weight)
{
    moments->weight += weight;
    for (int i = 0; i < 3; i++)
    {
        moments->mean[i] += weight * direction[i];
        for (int j = 0; j < 3; j++)
            moments->square[i][j] += weight * direction[i] * direction[j];
    }
}

/// Add the midpoints of the edges, weighted by length; of long curves an even selection of points.
static void add_curve(globe_moments *moments, const bat_curve *curve)
{
    const size_t enough = 65536;
    size_t stride = 1 + curve->count / enough;
    const double *last = curve->points + 3 * (curve->count - 1);
    const double *p = curve->closed ? last : curve->points;
    for (size_t i = 0; i < curve->count; i += stride)
    {
        const double *q = curve->points + 3 * i;
        double middle[3] = {p[0] + q[0], p[1] + q[1], p[2] + q[2]};
        double length = sqrt(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
        double chord = sqrt(chord_square(p, q));
        if (length > 0.0)
        {
            double direction[3] = {middle[0] / length, middle[1] / length, middle[2] / length};
            add_direction(moments, direction, 2.0 * atan2(chord, length));
        }
        p = q;
    }
    add_direction(moments, last, 1e-9);
}

/// The direction 25 degrees above the plane that fits the moments best, from the north, towards most of the curve.
static void oblique_direction(globe_moments *moments, double *direction)
{
    const double elevation = 25.0 * ANGLE_PI / 180.0;
    double values[3];
    if (decompose_symmetric(3, &moments->square[0][0], values, NULL) != BAT_OK)
        return;
    double normal[3], axis[3], along = 0.0;
    for (int k = 0; k < 3; k++)
    {
        double upwards = moments->square[2][0] < 0.0 ? -1.0 : 1.0;
        normal[k] = upwards * moments->square[k][0];
        axis[k] = moments->square[k][2];
        along += axis[k] * moments->mean[k];
    }
    for (int k = 0; k < 3; k++)
        direction[k] = cos(elevation) * (along < 0.0 ? -axis[k] : axis[k]) + sin(elevation) * normal[k];
}

void view_automatic(const bat_curve *const *curves, size_t count, double *longitude, double *latitude)
{
    const double min_share = 0.3; // relative to the total length; for smaller means the curve surrounds the sphere
    globe_moments moments = {0};
    for (size_t i = 0; i < count; i++)
        add_curve(&moments, curves[i]);
    double direction[3] = {moments.mean[0], moments.mean[1], moments.mean[2]};
    if (hypot(hypot(direction[0], direction[1]), direction[2]) < min_share * moments.weight)
        oblique_direction(&moments, direction);
    *longitude = atan2(direction[1], direction[0]);
    *latitude = atan2(direction[2], hypot(direction[0], direction[1]));
}

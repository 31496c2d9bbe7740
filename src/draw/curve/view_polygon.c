#include "draw/common/sheet.h"

/// @file
/// Regions bounded by geodesic polylines on the sphere.
///
/// A ring is traced in a continuous image of the sphere without one point or one line, of which a view shows a part. For an
/// azimuthal view it is the disk of radius 2, whose outline is the antipode of the centre; the globe's outline is the unit
/// circle in it. For the map it is the strip of unbounded longitudes; the traces of all turns that touch the frame are
/// drawn. So no ring is cut, and the even-odd rule holds after cairo's clip. A ring that encloses the excluded point on its
/// smaller side is complemented by a rectangle around everything.

/// Beyond everything in (u, v).
#define FAR_AWAY 12.0
/// The farthest coordinates on the page that are passed to cairo, whose numbers have 24 bits before the point.
#define LARGEST_PLACE 1e6

typedef struct ring_tracer
{
    const draw_view *view;
    path_simplifier *path; ///< null to measure only
    double point[3];       ///< rotated
    double longitude;      ///< map: of `point`, not reduced
    double u, v;           ///< of `point`
    double low, high;      ///< map: the range of longitudes
    double area_u, area_v; ///< of `point` in an equal-area projection
    double area;           ///< twice the signed area so far
    bool front, back;      ///< globe: whether a point was on that half
} ring_tracer;

/// The longitude next to that of the tracer; at a pole, the same.
static double continued_longitude(const ring_tracer *tracer, const double *point)
{
    bool pole = hypot(point[0], point[1]) < 1e-12;
    double step = remainder(atan2(point[1], point[0]) - tracer->longitude, 2.0 * ANGLE_PI);
    return pole ? tracer->longitude : tracer->longitude + step;
}

/// The globe's continuation: orthographic on the front, and beyond the outline up to radius 2.
static void beyond_outline(const double *point, double *u, double *v)
{
    double across = hypot(point[0], point[1]);
    double factor = point[2] >= 0.0 ? 1.0 : across > 0.0 ? (2.0 - across) / across : 0.0;
    *u = factor * point[0];
    *v = factor * point[1];
    if (point[2] < 0.0 && across == 0.0)
        *u = 2.0;
}

static void ring_project(const ring_tracer *tracer, const double *point, double *longitude, double *u, double *v)
{
    if (tracer->view->kind == VIEW_MAP)
    {
        *longitude = continued_longitude(tracer, point);
        view_equal_earth(*longitude, atan2(point[2], hypot(point[0], point[1])), u, v);
    }
    else if (tracer->view->kind == VIEW_LOCAL)
        view_equal_area(point, u, v);
    else
        beyond_outline(point, u, v);
}

static void page_line(const ring_tracer *tracer, double u, double v)
{
    if (tracer->path != NULL)
    {
        double x = fmin(fmax(view_x(tracer->view, u), -LARGEST_PLACE), LARGEST_PLACE);
        double y = fmin(fmax(view_y(tracer->view, v), -LARGEST_PLACE), LARGEST_PLACE);
        simplifier_line(tracer->path, x, y);
    }
}

/// Add the area beside a straight line to a point of an equal-area projection.
static void add_area(ring_tracer *tracer, double u, double v)
{
    tracer->area += tracer->area_u * v - tracer->area_v * u;
    tracer->area_u = u;
    tracer->area_v = v;
}

/// Continue straight to a point.
static void ring_line(ring_tracer *tracer, const double *point)
{
    ring_project(tracer, point, &tracer->longitude, &tracer->u, &tracer->v);
    double area_u = tracer->u, area_v = tracer->v;
    if (tracer->view->kind == VIEW_GLOBE)
        view_equal_area(point, &area_u, &area_v);
    add_area(tracer, area_u, area_v);
    box_include(1, &tracer->longitude, &tracer->low, &tracer->high);
    tracer->front = tracer->front || point[2] >= 0.0;
    tracer->back = tracer->back || point[2] < 0.0;
    memcpy(tracer->point, point, sizeof tracer->point);
    page_line(tracer, tracer->u, tracer->v);
}

/// Continue to a point by a short arc; near the antipode of the centre by steps around it.
static void ring_step(ring_tracer *tracer, const double *point)
{
    const double max_turn = 0.2;
    double from[3];
    memcpy(from, tracer->point, sizeof from);
    if (tracer->view->kind != VIEW_MAP && from[2] < 0.0 && point[2] < 0.0)
    {
        double start = atan2(from[1], from[0]);
        double turn = remainder(atan2(point[1], point[0]) - start, 2.0 * ANGLE_PI);
        double across[2] = {hypot(from[0], from[1]), hypot(point[0], point[1])};
        double steps = ceil(fabs(turn) / max_turn);
        for (double i = 1.0; i < steps; i += 1.0)
        {
            double share = i / steps;
            double radius = fmax((1.0 - share) * across[0] + share * across[1], 1e-9);
            double angle = start + share * turn;
            ring_line(tracer,
                      (double[3]){radius * cos(angle), radius * sin(angle), -sqrt(fmax(0.0, 1.0 - radius * radius))});
        }
    }
    ring_line(tracer, point);
}

static bool ring_straight(const ring_tracer *tracer, const double *middle, const double *target)
{
    double longitude = 0.0, half_u, half_v, whole_u, whole_v;
    ring_project(tracer, middle, &longitude, &half_u, &half_v);
    if (tracer->view->kind == VIEW_MAP && fabs(longitude - tracer->longitude) > 0.25 * ANGLE_PI)
        return false;
    ring_project(tracer, target, &longitude, &whole_u, &whole_v);
    double bend = hypot(half_u - 0.5 * (tracer->u + whole_u), half_v - 0.5 * (tracer->v + whole_v));
    return bend * tracer->view->scale <= 2.0 * tracer->view->tolerance || bend < 1e-9;
}

/// Continue by the shortest arc to `target`, bisected until its parts are straight or `depth` is 0.
static void ring_arc(ring_tracer *tracer, const double *target, int depth)
{
    double square = chord_square(tracer->point, target);
    double middle[3];
    for (int k = 0; k < 3; k++)
        middle[k] = tracer->point[k] + target[k];
    (void)vector3_normalize(middle);
    if (depth == 0 || (square < 0.01 && ring_straight(tracer, middle, target)))
    {
        ring_step(tracer, target);
        return;
    }
    ring_arc(tracer, middle, depth - 1);
    ring_arc(tracer, target, depth - 1);
}

/// Place the tracer at the first point of a ring, `shift` radians of longitude away on a map.
static void ring_begin(ring_tracer *tracer, const bat_curve *ring, double shift)
{
    view_rotate(tracer->view, ring->points, tracer->point);
    tracer->longitude = 0.0;
    tracer->longitude = continued_longitude(tracer, tracer->point) + shift;
    ring_project(tracer, tracer->point, &tracer->longitude, &tracer->u, &tracer->v);
    tracer->area_u = tracer->u;
    tracer->area_v = tracer->v;
    if (tracer->view->kind == VIEW_GLOBE)
        view_equal_area(tracer->point, &tracer->area_u, &tracer->area_v);
    tracer->low = tracer->high = tracer->longitude;
    tracer->area = 0.0;
    if (tracer->path != NULL)
        simplifier_move(tracer->path, view_x(tracer->view, tracer->u), view_y(tracer->view, tracer->v));
}

/// Go once around a ring.
static void ring_turn(ring_tracer *tracer, const bat_curve *ring)
{
    const int depth = 16;
    const double quick = fmin(1e-4, tracer->view->tolerance / tracer->view->scale);
    bool azimuthal = tracer->view->kind != VIEW_MAP;
    // Points within a quarter of the tolerance are left out; on a map, lengths near the poles are stretched.
    const double skip = pow(0.25 * tracer->view->tolerance / tracer->view->scale, 2.0);
    for (size_t i = 1; i <= ring->count; i++)
    {
        double target[3];
        view_rotate(tracer->view, ring->points + 3 * (i < ring->count ? i : 0), target);
        double across = azimuthal ? (target[2] > 0.0 ? 1.0 : 0.0) : target[0] * target[0] + target[1] * target[1];
        if (i < ring->count && chord_square(tracer->point, target) < skip * across)
            continue;
        bool front = azimuthal && target[2] > 0.0 && tracer->point[2] > 0.0;
        if (front && chord_square(tracer->point, target) < quick)
            ring_line(tracer, target);
        else
            ring_arc(tracer, target, depth);
    }
}

/// Continue straight to a longitude and latitude of a map.
static void map_line(ring_tracer *tracer, double longitude, double latitude)
{
    double u, v;
    view_equal_earth(longitude, latitude, &u, &v);
    add_area(tracer, u, v);
    page_line(tracer, u, v);
}

/// Close a ring around the axis of a map along the line of the south pole.
static void close_by_pole(ring_tracer *tracer, double start)
{
    static const int STEPS = 64;
    double latitude = atan2(tracer->point[2], hypot(tracer->point[0], tracer->point[1]));
    double end = tracer->longitude;
    for (int i = 1; i <= 2 * STEPS; i++)
    {
        double share = i <= STEPS ? (double)i / STEPS : (double)(2 * STEPS - i) / STEPS;
        if (i == STEPS + 1)
            map_line(tracer, start, -0.5 * ANGLE_PI);
        map_line(tracer, i <= STEPS ? end : start, latitude - share * (latitude + 0.5 * ANGLE_PI));
    }
}

/// Measure a ring.
/// @return whether the traced side is not the smaller one
static bool ring_measure(ring_tracer *tracer, const bat_curve *ring, double *winding)
{
    tracer->path = NULL;
    ring_begin(tracer, ring, 0.0);
    double start = tracer->longitude;
    ring_turn(tracer, ring);
    *winding = tracer->view->kind == VIEW_MAP ? tracer->longitude - start : 0.0;
    if (fabs(*winding) > ANGLE_PI)
        close_by_pole(tracer, start);
    return fabs(tracer->area) > 4.0 * ANGLE_PI; // twice half the sphere
}

/// Trace a ring wherever it touches the map, or once in other views.
static void ring_draw(ring_tracer *tracer, const bat_curve *ring, double winding, path_simplifier *path)
{
    double low = tracer->low, high = tracer->high;
    tracer->path = path;
    if (fabs(winding) > ANGLE_PI)
    {
        ring_begin(tracer, ring, winding > 0.0 ? -2.0 * ANGLE_PI : 2.0 * ANGLE_PI);
        double start = tracer->longitude;
        for (int turn = 0; turn < 3; turn++)
            ring_turn(tracer, ring);
        close_by_pole(tracer, start);
        simplifier_flush(path);
        return;
    }
    for (double turn = -1.0; turn <= 1.0; turn += 1.0)
    {
        bool touches = low + 2.0 * ANGLE_PI * turn < ANGLE_PI && high + 2.0 * ANGLE_PI * turn > -ANGLE_PI;
        if (turn == 0.0 || (tracer->view->kind == VIEW_MAP && touches))
        {
            ring_begin(tracer, ring, 2.0 * ANGLE_PI * turn);
            ring_turn(tracer, ring);
            simplifier_flush(path);
        }
    }
}

view_region view_trace_polygon(const draw_view *view, const bat_curve *const *rings, size_t count, cairo_t *cairo)
{
    path_simplifier path = simplifier_begin(canvas_sink(cairo), view->tolerance);
    view_region region = {view->kind != VIEW_GLOBE, false};
    bool complement = false;
    for (size_t i = 0; i < count; i++)
    {
        if (view->kind == VIEW_FLAT)
        {
            view_trace(view, rings[i]->points, rings[i]->count, true, VIEW_FRONT, &path);
            continue;
        }
        ring_tracer tracer = {.view = view};
        double winding;
        if (ring_measure(&tracer, rings[i], &winding))
            complement = !complement;
        if (view->kind == VIEW_GLOBE)
        {
            region.inside = region.inside || tracer.front;
            region.outside = region.outside || tracer.back;
        }
        else if (view->kind == VIEW_MAP)
            region.outside = region.outside || fabs(winding) > ANGLE_PI || tracer.low < -ANGLE_PI || tracer.high > ANGLE_PI;
        ring_draw(&tracer, rings[i], winding, &path);
    }
    if (complement)
    {
        double side = fmin(2.0 * FAR_AWAY * view->scale, LARGEST_PLACE);
        region = (view_region){true, true};
        cairo_rectangle(cairo, view->origin_x - 0.5 * side, view->origin_y - 0.5 * side, side, side);
    }
    return region;
}

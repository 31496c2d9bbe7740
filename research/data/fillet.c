/// @file
/// Rounded geodesic polygons in the plane, on the sphere and in the hyperbolic plane, in one projective model: the plane z =
/// 1, the unit sphere, and the hyperboloid z^2 - x^2 - y^2 = 1. Geodesics are sections by planes through the origin,
/// geodesic circles by other planes. An arc is a rational quadratic curve
///     (1 - s)^2 begin + 2 s (1 - s) w vertex + s^2 end,   projected to the surface.

#include "research/data/fillet.h"

#include "research/data/wave.h"

#include <math.h>

/// A point of the plane z = 1, of the unit sphere, or of the hyperboloid z^2 - x^2 - y^2 = 1, z > 0. On each, geodesics lie
/// in planes through the origin of R^3 and geodesic circles in any other planes.
typedef struct point
{
    double x, y, z;
} point;

/// The sign of the curvature.
static double curvature(bat_tension_space space)
{
    return space == BAT_TENSION_SPACE_PLANE ? 0 : space == BAT_TENSION_SPACE_SPHERE ? 1 : -1;
}

static double sine(bat_tension_space space, double x)
{
    return space == BAT_TENSION_SPACE_PLANE ? x : space == BAT_TENSION_SPACE_SPHERE ? sin(x) : sinh(x);
}

static double cosine(bat_tension_space space, double x)
{
    return space == BAT_TENSION_SPACE_PLANE ? 1 : space == BAT_TENSION_SPACE_SPHERE ? cos(x) : cosh(x);
}

/// a p + b q
static point combine(double a, point p, double b, point q)
{
    return (point){a * p.x + b * q.x, a * p.y + b * q.y, a * p.z + b * q.z};
}

/// Half the chord in the metric of the ambient space, which equals sine() of half the distance.
static double half_chord(bat_tension_space space, point p, point q)
{
    double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
    return 0.5 * sqrt(x * x + y * y + curvature(space) * z * z);
}

static double distance(bat_tension_space space, point p, point q)
{
    double half = half_chord(space, p, q);
    return 2 * (space == BAT_TENSION_SPACE_PLANE    ? half
                : space == BAT_TENSION_SPACE_SPHERE ? asin(fmin(half, 1))
                                                    : asinh(half));
}

/// The point of the surface on the ray through `p`.
static point project(bat_tension_space space, point p)
{
    double length = p.z;
    if (space == BAT_TENSION_SPACE_SPHERE)
        length = sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    else if (space == BAT_TENSION_SPACE_DISK)
        length = sqrt(p.z * p.z - p.x * p.x - p.y * p.y);
    return (point){p.x / length, p.y / length, p.z / length};
}

/// The point at distance `s` from `p` on the geodesic of length `length` to `q`.
static point along(bat_tension_space space, point p, point q, double length, double s)
{
    double complete = sine(space, length);
    return project(space, combine(sine(space, length - s) / complete, p, sine(space, s) / complete, q));
}

/// A corner with its arc from `begin` to `end`, tangent to both edges.
typedef struct corner
{
    point vertex, begin, end;
    double weight;
} corner;

/// The point of a corner's arc at parameter `s`. The rational quadratic with control points begin, vertex and end is tangent
/// to both edges for every weight. It is planar, hence a circle, for the weight sine(d(begin, end) / 2) / sine(d(begin,
/// vertex)).
static point on_arc(bat_tension_space space, const corner *c, double s)
{
    point middle = combine(2 * s * (1 - s) * c->weight, c->vertex, s * s, c->end);
    return project(space, combine((1 - s) * (1 - s), c->begin, 1, middle));
}

static void store(bat_tension_space space, point p, double *coordinates)
{
    double scale = space == BAT_TENSION_SPACE_DISK ? 1 / (1 + p.z) : 1;
    coordinates[0] = scale * p.x;
    coordinates[1] = scale * p.y;
    if (space == BAT_TENSION_SPACE_SPHERE)
        coordinates[2] = p.z;
}

/// Corner i's arc and its edge to the next corner.
typedef struct side
{
    corner corner;
    double arc, straight; ///< lengths; that of the arc is approximate
} side;

static void make_sides(bat_tension_space space, const fillet_polygon *polygon, side *sides)
{
    int count = polygon->count;
    double edges[FILLET_MAX_VERTICES];
    for (int i = 0; i < count; i++)
    {
        double radial = sine(space, polygon->radius[i]);
        sides[i].corner.vertex =
            (point){radial * cos(polygon->angle[i]), radial * sin(polygon->angle[i]), cosine(space, polygon->radius[i])};
    }
    for (int i = 0; i < count; i++)
        edges[i] = distance(space, sides[i].corner.vertex, sides[(i + 1) % count].corner.vertex);
    for (int i = 0; i < count; i++)
    {
        int before = (i + count - 1) % count;
        corner *c = &sides[i].corner;
        double reach = polygon->share[i] * fmin(edges[before], edges[i]);
        c->begin = along(space, c->vertex, sides[before].corner.vertex, edges[before], reach);
        c->end = along(space, c->vertex, sides[(i + 1) % count].corner.vertex, edges[i], reach);
        c->weight = half_chord(space, c->begin, c->end) / sine(space, reach);
        sides[i].arc = 2 * (distance(space, c->begin, c->end) + reach) / 3;
    }
    for (int i = 0; i < count; i++)
        sides[i].straight = distance(space, sides[i].corner.end, sides[(i + 1) % count].corner.begin);
}

fillet_polygon fillet_draw(bat_random *random, double low, double high)
{
    fillet_polygon polygon = {.count = draw_whole(random, 3, 7)};
    double turn = draw_angle(random), sector = 2 * WAVE_PI / polygon.count;
    for (int i = 0; i < polygon.count; i++)
    {
        polygon.radius[i] = draw_between(random, low, high);
        polygon.angle[i] = turn + sector * (i + draw_between(random, -0.3, 0.3));
        polygon.share[i] = draw_between(random, 0.15, 0.45);
    }
    return polygon;
}

void fillet_points(bat_tension_space space, const fillet_polygon *polygon, size_t count, double *points)
{
    side sides[FILLET_MAX_VERTICES] = {{.arc = 0}};
    make_sides(space, polygon, sides);
    double total = 0, passed = 0;
    for (int i = 0; i < polygon->count; i++)
        total += sides[i].arc + sides[i].straight;
    size_t dim = space == BAT_TENSION_SPACE_SPHERE ? 3 : 2;
    int current = 0;
    for (size_t j = 0; j < count; j++)
    {
        double reached = total * ((double)j / (double)count) - passed;
        while (current + 1 < polygon->count && reached >= sides[current].arc + sides[current].straight)
        {
            double length = sides[current].arc + sides[current].straight;
            passed += length;
            reached -= length;
            current++;
        }
        const side *now = &sides[current], *next = &sides[(current + 1) % polygon->count];
        point p = reached < now->arc ? on_arc(space, &now->corner, reached / now->arc)
                                     : along(space, now->corner.end, next->corner.begin, now->straight, reached - now->arc);
        store(space, p, points + j * dim);
    }
}

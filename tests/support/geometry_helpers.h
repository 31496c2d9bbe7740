#ifndef TESTS_SUPPORT_GEOMETRY_HELPERS_H
#define TESTS_SUPPORT_GEOMETRY_HELPERS_H

// Polygons to differentiate at, and derivatives by finite differences.

#include "batten/space.h"
#include "check.h"
#include "research/train/geometry_polygon.h"

enum
{
    MAX_COUNT = 128,
    MAX_COORDINATES = 3 * MAX_COUNT,
};

static const geometry_surface SURFACES[] = {GEOMETRY_DISK, GEOMETRY_PLANE, GEOMETRY_SPHERE};

/// What makes a polygon hard.
typedef enum polygon_kind
{
    EVEN,     ///< nothing
    UNEVEN,   ///< edges of very different lengths
    TWINS,    ///< two neighbours 1e-6 apart
    STRAIGHT, ///< open, along a geodesic but for 1e-6
    WIDE,     ///< reaches far: radius 0.9 in the disk, 60 in the plane, beyond the equator on the sphere
    KINDS
} polygon_kind;

static inline bat_space space_of(geometry_surface surface)
{
    return surface == GEOMETRY_DISK ? bat_disk() : surface == GEOMETRY_PLANE ? bat_euclidean(2) : bat_sphere(2);
}

static inline double symmetric_uniform(bat_random *random)
{
    return 2 * bat_random_uniform(random) - 1;
}

/// The point with polar coordinates; the radius is the geodesic one on the sphere and the Euclidean one else.
static inline void polar_point(geometry_surface surface, double radius, double angle, double *point)
{
    double r = surface == GEOMETRY_SPHERE ? sin(radius) : radius;
    point[0] = r * cos(angle);
    point[1] = r * sin(angle);
    if (surface == GEOMETRY_SPHERE)
        point[2] = cos(radius);
}

static inline void normalize(double *point)
{
    double length = sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
    for (int i = 0; i < 3; i++)
        point[i] /= length;
}

/// Two orthonormal directions in which a point can move; coordinate axes off the sphere.
static inline void tangent_frame(geometry_surface surface, const double *point, double frame[2][3])
{
    memset(frame, 0, 6 * sizeof(double));
    frame[0][0] = frame[1][1] = 1;
    if (surface != GEOMETRY_SPHERE)
        return;
    int axis = fabs(point[0]) < 0.6 ? 0 : 1;
    for (int i = 0; i < 3; i++)
        frame[0][i] = (i == axis) - point[axis] * point[i];
    normalize(frame[0]);
    for (int i = 0; i < 3; i++)
    {
        int k = (i + 1) % 3, l = (i + 2) % 3;
        frame[1][i] = point[k] * frame[0][l] - point[l] * frame[0][k];
    }
}

/// point + step direction, back on the sphere.
static inline void move_point(geometry_surface surface, const double *point, const double *direction, double step,
                              double *moved)
{
    for (size_t i = 0; i < geometry_dim(surface); i++)
        moved[i] = point[i] + step * direction[i];
    if (surface == GEOMETRY_SPHERE)
        normalize(moved);
}

static inline geometry_polygon make_polygon(geometry_surface surface, polygon_kind kind, size_t count, bat_random *random,
                                            double *points)
{
    static const double wide_radius[] = {0.9, 60, 2};
    size_t dim = geometry_dim(surface);
    double angle = 0, steps[MAX_COUNT], total = 0;
    for (size_t j = 0; j < count; j++)
        total += steps[j] = kind == UNEVEN ? exp(1.5 * symmetric_uniform(random)) : 1 + 0.4 * symmetric_uniform(random);
    double middle = kind == WIDE ? wide_radius[surface + 1] : 0.6, spread = kind == WIDE ? 0.3 : 0.2;
    for (size_t j = 0; j < count; j++)
    {
        angle += 6.28318530717958647693 * steps[j] / total;
        polar_point(surface, middle * (1 - spread * bat_random_uniform(random)), angle, points + j * dim);
        if (kind == STRAIGHT)
        {
            double along = 0.8 * ((double)j / (double)(count - 1) - 0.5), across = 1e-6 * symmetric_uniform(random);
            const double straight[3] = {along, across, sqrt(1 - along * along - across * across)};
            memcpy(points + j * dim, straight, dim * sizeof(double));
        }
    }
    if (kind == TWINS)
    {
        double frame[2][3];
        tangent_frame(surface, points + 2 * dim, frame);
        move_point(surface, points + 2 * dim, frame[1], 1e-6, points + 3 * dim);
    }
    if (surface != GEOMETRY_DISK || kind != WIDE)
    {
        geometry_isometry isometry = geometry_isometry_random(surface, 0.3, random);
        geometry_isometry_apply(&isometry, points, count, points);
        for (size_t j = 0; surface == GEOMETRY_SPHERE && j < count; j++)
            normalize(points + j * dim);
    }
    return (geometry_polygon){points, count, surface, kind != STRAIGHT};
}

/// (8 (f(h) - f(-h)) - (f(2h) - f(-2h))) / 12 h, from f at -2h, -h, h, 2h.
static inline double five_point(const double f[4], double h)
{
    return (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * h);
}

static const double FIVE_POINT_STEPS[4] = {-2, -1, 1, 2};

/// A number that depends on a polygon, and its gradient, which is added.
typedef double polygon_value(const geometry_polygon *polygon, const void *context);
typedef void polygon_gradient(const geometry_polygon *polygon, const void *context, double *gradients);

/// A hundredth of the distance to the nearer neighbour and to the rim of the disk, and at most 5e-4.
static inline double safe_step(const geometry_polygon *polygon, size_t vertex)
{
    size_t dim = geometry_dim(polygon->surface), count = polygon->count;
    double least = INFINITY;
    for (size_t side = 0; side < 2; side++)
    {
        const double *p = polygon->points + vertex * dim,
                     *q = polygon->points + (vertex + (side ? 1 : count - 1)) % count * dim;
        double square = 0;
        for (size_t i = 0; i < dim; i++)
            square += (q[i] - p[i]) * (q[i] - p[i]);
        least = fmin(least, sqrt(square));
    }
    const double *p = polygon->points + vertex * dim;
    double rim = polygon->surface == GEOMETRY_DISK ? 1 - p[0] * p[0] - p[1] * p[1] : 1;
    return fmin(1e-2 * fmin(least, rim), 5e-4);
}

/// Compare a gradient with finite differences along two directions at every vertex, relative to its size at the vertex.
/// @param step of the differences; 0 for safe_step()
static inline void check_polygon_gradient(const geometry_polygon *polygon, polygon_value *value, polygon_gradient *gradient,
                                          const void *context, double step, double tolerance)
{
    size_t dim = geometry_dim(polygon->surface), count = polygon->count;
    double gradients[MAX_COORDINATES] = {0}, points[MAX_COORDINATES];
    memcpy(points, polygon->points, count * dim * sizeof(double));
    geometry_polygon moved = *polygon;
    moved.points = points;
    gradient(polygon, context, gradients);
    for (size_t vertex = 0; vertex < count; vertex++)
    {
        const double *point = polygon->points + vertex * dim, *g = gradients + vertex * dim;
        double frame[2][3], size = 0, h = step > 0 ? step : safe_step(polygon, vertex);
        tangent_frame(polygon->surface, point, frame);
        for (size_t i = 0; i < dim; i++)
            size += g[i] * g[i];
        for (int axis = 0; axis < 2; axis++)
        {
            double values[4], analytic = 0;
            for (int k = 0; k < 4; k++)
            {
                // On the sphere an angle is moved by, so that steps h and 2 h stay in proportion.
                double distance = FIVE_POINT_STEPS[k] * h;
                move_point(polygon->surface, point, frame[axis],
                           polygon->surface == GEOMETRY_SPHERE ? tan(distance) : distance, points + vertex * dim);
                values[k] = value(&moved, context);
            }
            for (size_t i = 0; i < dim; i++)
                analytic += g[i] * frame[axis][i];
            double rounding = 2e-15 * (1 + fabs(values[0])) / h;
            check_near(analytic, five_point(values, h), tolerance * sqrt(size) + rounding);
        }
        memcpy(points + vertex * dim, point, dim * sizeof(double));
    }
}

#endif

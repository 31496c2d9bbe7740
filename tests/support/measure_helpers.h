#ifndef TESTS_SUPPORT_MEASURE_HELPERS_H
#define TESTS_SUPPORT_MEASURE_HELPERS_H

// Curves to measure, and a progress function that watches.

#include "check.h"

#include "batten/curve_measure.h"

static const double PI = 3.14159265358979323846;

/// A closed curve of `count` points, to be freed.
static inline bat_curve closed_curve(const bat_space *space, size_t count)
{
    double *points = calloc(count * space->point_dim, sizeof *points);
    return (bat_curve){.space = space, .points = points, .count = count, .closed = true};
}

/// A regular polygon about the origin of the plane or the disk (radius as the coordinates have it), or about a pole of the
/// sphere (radius the sine of the colatitude).
static inline bat_curve regular_polygon(const bat_space *space, size_t count, double radius)
{
    bat_curve polygon = closed_curve(space, count);
    for (size_t i = 0; i < count; i++)
    {
        double angle = 2 * PI * (double)i / (double)count, *p = polygon.points + i * space->point_dim;
        p[0] = radius * cos(angle);
        p[1] = radius * sin(angle);
        if (space->point_dim == 3)
            p[2] = sqrt(1 - radius * radius);
    }
    return polygon;
}

static inline bat_curve random_curve(const bat_space *space, size_t count, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_curve curve = closed_curve(space, count);
    for (size_t i = 0; i < count; i++)
        space->random_point(space, &random, curve.points + i * space->point_dim);
    return curve;
}

/// A copy of the curve, magnified.
static inline bat_curve magnified(const bat_curve *curve, double factor)
{
    bat_curve copy = closed_curve(curve->space, curve->count);
    for (size_t i = 0; i < curve->count * curve->space->point_dim; i++)
        copy.points[i] = factor * curve->points[i];
    return copy;
}

/// Without the published offset.
static inline bat_curve_fairness_values fairness_of(const bat_curve *curve)
{
    const bat_curve_measure_options options = {.bending_offset = 0};
    bat_curve_fairness_values fairness;
    check_status(bat_curve_fairness(curve, &options, &fairness, NULL), BAT_OK);
    return fairness;
}

/// What a progress function saw, and when it asks to stop.
typedef struct watch
{
    double last, stop_at;
    size_t calls;
    bool monotone;
} watch;

static inline bool look(void *context, double fraction)
{
    watch *seen = context;
    seen->monotone = seen->monotone && fraction >= seen->last && fraction <= 1 + 1e-12;
    seen->last = fraction;
    seen->calls++;
    return fraction < seen->stop_at;
}

static inline bat_progress watched(watch *seen, double stop_at)
{
    *seen = (watch){.stop_at = stop_at, .monotone = true};
    return (bat_progress){look, seen};
}

#endif

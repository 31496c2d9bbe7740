#include "curve/simplified.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/polygon.h"
#include "search/nearest.h"

#include <math.h>

/// A smaller exterior angle is rounding: half a degree.
static const double MIN_ANGLE = 0.008726646259971648;
/// Of the median deviation.
static const double MIN_SHARE = 0.33;
static const double CHANCE = 0.02;
/// Of the median length, and of the lowest deviation.
static const double MIN_LENGTH = 1.25, MAX_DISTANCE = 1.5;

enum
{
    LOWEST_PART = 32
};

/// Collect the deviations of the vertices. Returns how many there are.
static size_t find_deviations(const bat_curve *curve, const double *lengths, const double *angles, keyed *deviations)
{
    size_t found = 0, n = curve->count;
    for (size_t i = 0; i < n; i++)
    {
        double size = fabs(angles[i]); // 0 at the ends
        if (!(size > MIN_ANGLE))
            continue;
        double before = lengths[i == 0 ? n - 1 : i - 1], after = lengths[i];
        deviations[found] = (keyed){2 * sin(0.5 * size) * (before / (before + after)) * after, found};
        found++;
    }
    return found;
}

/// The deviation that `lowest` of `count` are below; 0 where too many are far below their median, or chance has so few.
static double lowest_deviation(keyed *deviations, size_t count)
{
    size_t middle = count / 2, lowest = count / LOWEST_PART, low = 0;
    if (middle == 0)
        return 0;
    select_nth(deviations, count, middle);
    double median = deviations[middle].key;
    for (size_t i = 0; i < middle; i++)
        low += deviations[i].key > MIN_SHARE * median ? 0 : 1;
    if (low > lowest)
        return 0;
    select_nth(deviations, middle, lowest);
    return pow(1 - deviations[lowest].key / median, (double)middle) <= CHANCE ? deviations[lowest].key : 0;
}

bat_status simplified_bound_find(const bat_curve *curve, simplified_bound *bound, bat_error *error)
{
    size_t n = curve->count;
    memory_pool pool = {0};
    double *lengths = memory_pool_array(&pool, n, sizeof *lengths), *angles = memory_pool_array(&pool, n, sizeof *angles);
    keyed *deviations = memory_pool_array(&pool, n, sizeof *deviations);
    *bound = (simplified_bound){0};
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK && bat_curve_exterior_angles(curve, angles, NULL) == BAT_OK)
    {
        bat_curve_edge_lengths(curve, lengths);
        double lowest = lowest_deviation(deviations, find_deviations(curve, lengths, angles, deviations));
        if (lowest > 0)
            *bound = (simplified_bound){MIN_LENGTH * sort_median(lengths, polygon_edges(n, curve->closed)),
                                        MAX_DISTANCE * lowest};
    }
    memory_pool_free(&pool);
    return status;
}

bat_status simplified_straighten(const simplified_bound *bound, const bat_space *space, const double *rows, size_t count,
                                 bool closed, size_t levels, double *fine, bat_error *error)
{
    edge_geometry geometry = polygon_geometry_of(space);
    size_t parts = (size_t)1 << levels, dim = space->point_dim, edges = polygon_edges(count, closed);
    for (size_t e = 0; e < edges && bound->distance > 0; e++)
    {
        const double *p = rows + e * dim, *q = rows + (e + 1 == count ? 0 : e + 1) * dim;
        double *points = fine + e * parts * dim, farthest = 0;
        if (!(space->distance(space, p, q) > bound->length))
            continue;
        for (size_t k = 1; k < parts; k++)
            farthest = fmax(farthest, polygon_edge_distance(space, geometry, p, q, points + k * dim));
        bat_status status = BAT_OK;
        for (size_t k = 1; k < parts && farthest > bound->distance && status == BAT_OK; k++)
            status = polygon_edge_point(space, p, q, k, parts, points + k * dim);
        if (status != BAT_OK)
            return error_point(error, status, e, "there is no new point after point", " (%s)", bat_status_name(status));
    }
    return BAT_OK;
}

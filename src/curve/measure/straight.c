#include "batten/curve_measure.h"

#include "curve/polygon.h"

#include <string.h>

/// So many vertices may be missing: a map joins and drops a few points, other schemes move all.
static const int MAX_MISSED = 16;

/// By how much the way over a point may exceed a straight edge: a middle point is within 1/1400 of its length then.
static const double MAX_EXCESS = 1e-6;

size_t bat_curve_straight_edges(const bat_curve *coarse, const bat_curve *fine)
{
    const bat_space *space = coarse->space;
    size_t dim = space->point_dim, edges = polygon_edges(coarse->count, coarse->closed), straight = 0, row = 0, missed = 0;
    for (size_t j = 0; j < edges; j++)
    {
        const double *p = coarse->points + j * dim, *q = coarse->points + (j + 1) % coarse->count * dim;
        double length = space->distance(space, p, q);
        bool is_straight = true;
        size_t at = row + 1;
        for (; at < fine->count && memcmp(fine->points + at * dim, q, dim * sizeof *q) != 0; at++)
        {
            const double *x = fine->points + at * dim;
            is_straight =
                is_straight && space->distance(space, p, x) + space->distance(space, x, q) <= length * (1 + MAX_EXCESS);
        }
        if (at == fine->count && !(coarse->closed && j + 1 == edges))
        {
            if (++missed > MAX_MISSED)
                return straight;
            continue;
        }
        straight += is_straight;
        row = at;
    }
    return straight;
}

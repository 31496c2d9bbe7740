#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/polygon.h"
#include "space/degrees.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double DEGREES_PER_RADIAN = 57.295779513082320876798154814105;
/// Runs that are shorter, in degrees or in units of the coarsest coordinates, are not meant.
static const double MIN_DEGREES = 1, MIN_UNITS = 20;

void degrees_along(const double *p, const double *q, double *from, double *along)
{
    static const double POLE = 90 - 1e-9;
    double to[2];
    for (int side = 0; side < 2; side++)
    {
        const double *point = side == 0 ? p : q;
        double *place = side == 0 ? from : to;
        place[0] = atan2(point[1], point[0]) * DEGREES_PER_RADIAN;
        place[1] = atan2(point[2], hypot(point[0], point[1])) * DEGREES_PER_RADIAN;
    }
    if (fabs(from[1]) > POLE)
        from[0] = to[0];
    along[0] = fabs(to[1]) > POLE ? 0 : to[0] - from[0] - 360 * rint((to[0] - from[0]) / 360);
    along[1] = to[1] - from[1];
}

/// Whether an edge of this kind can be straight in degrees.
static bool is_kind(const double *along, const degree_edges *how)
{
    double least = fmin(fabs(along[0]), fabs(along[1]));
    return how->edges == BAT_CURVE_MAP_EDGES_STRAIGHT || (how->edges == BAT_CURVE_MAP_EDGES_AUTO && least <= how->unit);
}

/// Whether an edge goes on in the direction of the edge before.
static bool goes_on(const double *before, const double *after, const degree_edges *how)
{
    double cross = before[0] * after[1] - before[1] * after[0], dot = before[0] * after[0] + before[1] * after[1];
    return dot > 0 && fabs(cross) <= how->unit * (hypot(before[0], before[1]) + hypot(after[0], after[1]));
}

bool degrees_straight(const bat_curve *arc, const degree_edges *how)
{
    double from[2], before[2], along[2];
    for (size_t i = 0; i + 1 < arc->count; i++)
    {
        degrees_along(arc->points + 3 * i, arc->points + 3 * (i + 1), from, along);
        if (!is_kind(along, how) || (i > 0 && !goes_on(before, along, how)))
            return false;
        memcpy(before, along, sizeof before);
    }
    return !arc->closed;
}

void degrees_edge_point(const double *p, const double *q, double share, double *point)
{
    double from[2], along[2];
    degrees_along(p, q, from, along);
    double longitude = from[0] + share * along[0];
    degrees_to_point(longitude - 360 * rint(longitude / 360), from[1] + share * along[1], point);
}

/// The unit of the coarsest power of ten that all coordinates are multiples of.
static double unit_of(const bat_curve *curve, const degree_edges *how)
{
    double unit = 1, from[2], along[2];
    for (size_t i = 0; i < curve->count && unit > how->unit; i++)
    {
        degrees_along(curve->points + 3 * i, curve->points + 3 * i, from, along);
        for (int c = 0; c < 2; c++)
            while (unit > how->unit && fabs(from[c] - unit * rint(from[c] / unit)) > how->unit)
                unit /= 10;
    }
    return unit;
}

/// Whether a vertex is a pole, where no point is by chance.
static bool is_pole(const bat_curve *curve, size_t vertex)
{
    const double *point = curve->points + 3 * (vertex % curve->count);
    return hypot(point[0], point[1]) < 1e-11;
}

/// Flag the vertices of a run of edges if it is long enough, or ends at a pole.
static void flag_run(const bat_curve *curve, size_t first, size_t edges, double length, double least, unsigned char *flags)
{
    bool meant = edges > 0 && (length >= least || is_pole(curve, first) || is_pole(curve, first + edges));
    for (size_t k = 0; k <= edges && meant; k++)
        flags[(first + k) % curve->count] = 1;
}

bat_status degrees_flag_runs(const bat_curve *curve, const degree_edges *how, unsigned char *flags, bat_error *error)
{
    size_t edges = polygon_edges(curve->count, curve->closed), start = 0;
    double(*along)[2] = memory_array(edges, sizeof *along), from[2];
    if (along == NULL)
        return error_memory(error, edges * sizeof *along);
    for (size_t j = 0; j < edges; j++)
        degrees_along(curve->points + 3 * j, curve->points + 3 * ((j + 1) % curve->count), from, along[j]);
    double least = how->edges == BAT_CURVE_MAP_EDGES_AUTO ? fmax(MIN_DEGREES, MIN_UNITS * unit_of(curve, how)) : MIN_DEGREES;
    while (curve->closed && start + 1 < edges && goes_on(along[(start + edges - 1) % edges], along[start], how))
        start++;
    size_t run = 0; // edges of the present run, and its length
    double length = 0;
    for (size_t k = 0; k < edges; k++)
    {
        const double *edge = along[(start + k) % edges];
        if (run > 0 && (!is_kind(edge, how) || !goes_on(along[(start + k - 1) % edges], edge, how)))
        {
            flag_run(curve, start + k - run, run, length, least, flags);
            run = 0;
            length = 0;
        }
        run += is_kind(edge, how);
        length += is_kind(edge, how) ? hypot(edge[0], edge[1]) : 0;
    }
    flag_run(curve, start + edges - run, run, length, least, flags);
    free(along);
    return BAT_OK;
}

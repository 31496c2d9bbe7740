#include "curve/map/arc_refine.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/threads.h"
#include "curve/polygon.h"
#include "space/builtin.h"
#include "space/degrees.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool chart_of_space(const bat_space *space, int decimals, map_chart *chart)
{
    *chart = (map_chart){.globe = space_is_sphere(space)};
    if (!chart->globe && !space_is_plane(space) && !space_is_disk(space))
        return false;
    chart->space = chart->globe ? bat_euclidean(2) : *space;
    if (chart->globe)
    {
        chart->units_per_degree = (double)degree_units_per_degree(decimals);
        chart->units_per_radian = degree_units_per_radian(decimals);
        chart->turn = 360 * chart->units_per_degree;
    }
    return true;
}

/// The longitude nearest to `near` that is the same up to whole turns.
static double nearest_longitude(const map_chart *chart, double longitude, double near)
{
    return longitude - chart->turn * rint((longitude - near) / chart->turn);
}

/// The chart of a point, near the longitude of the point before. A pole has the longitude of the point before.
static void chart_point(const map_chart *chart, const double *point, double near, double *flat)
{
    degree_units units = degrees_of_point(point, chart->units_per_radian);
    bool pole = fabs((double)units.latitude) == 90 * chart->units_per_degree;
    flat[0] = pole ? near : nearest_longitude(chart, (double)units.longitude, near);
    flat[1] = (double)units.latitude;
}

/// A longitude near which the chart of a curve begins: that of the first point off the poles.
static double first_longitude(const map_chart *chart, const bat_curve *curve)
{
    double flat[2] = {0, 0};
    for (size_t i = 0; i < curve->count; i++)
    {
        chart_point(chart, curve->points + 3 * i, 0, flat);
        if (fabs(flat[1]) < 90 * chart->units_per_degree)
            break;
    }
    return flat[0];
}

/// The chart of one curve, in room for one point more than it has.
static void chart_curve(const map_chart *chart, const bat_curve *curve, const bat_curve *coarse, const size_t *starts,
                        bat_curve *flat)
{
    size_t edges = polygon_edges(curve->count, curve->closed), next_kept = 0, kept_index = 0;
    size_t coarse_edges = coarse != NULL ? polygon_edges(coarse->count, coarse->closed) : 0;
    size_t step = coarse_edges > 0 ? edges / coarse_edges : 0;
    double near = first_longitude(chart, curve);
    for (size_t i = 0; i < curve->count; i++)
    {
        double *point = flat->points + 2 * i;
        if (coarse != NULL && i == next_kept)
        {
            memcpy(point, coarse->points + 2 * kept_index, 2 * sizeof *point);
            kept_index++;
            next_kept = kept_index < coarse->count ? (starts != NULL ? starts[kept_index] : kept_index * step) : SIZE_MAX;
        }
        else
            chart_point(chart, curve->points + 3 * i, near, point);
        near = point[0];
    }
    flat->count = curve->count;
    flat->closed = curve->closed;
    if (!curve->closed)
        return;
    double end = nearest_longitude(chart, flat->points[0], near);
    if (end == flat->points[0])
        return;
    flat->points[2 * flat->count] = end;
    flat->points[2 * flat->count + 1] = flat->points[1];
    flat->count++;
    flat->closed = false;
}

bat_status chart_curves_make(const map_chart *chart, const bat_curve *curves, size_t count, const chart_curves *coarse,
                             size_t *const *starts, int threads, chart_curves *charts, bat_error *error)
{
    (void)threads; // without OpenMP
    *charts = (chart_curves){.count = count, .curves = memory_array(count, sizeof *charts->curves)};
    if (charts->curves == NULL)
        return error_memory(error, count * sizeof *charts->curves);
    size_t room = 0;
    for (size_t i = 0; i < count; i++)
    {
        charts->curves[i] = curves[i];
        room += curves[i].count + 1;
    }
    if (!chart->globe)
        return BAT_OK;
    charts->points = memory_array(room, 2 * sizeof *charts->points);
    if (charts->points == NULL)
        return error_memory(error, room * 2 * sizeof *charts->points);
    double *at = charts->points;
    for (size_t i = 0; i < count; i++)
    {
        charts->curves[i] = (bat_curve){.space = &chart->space, .points = at};
        at += 2 * (curves[i].count + 1);
    }
    static const double WORK = 100; // arithmetic operations for a point
#pragma omp parallel for schedule(dynamic, 16) num_threads(threads_worth(threads, count, WORK *(double)room))
    for (size_t i = 0; i < count; i++)
        chart_curve(chart, &curves[i], coarse != NULL ? &coarse->curves[i] : NULL, starts != NULL ? starts[i] : NULL,
                    &charts->curves[i]);
    return BAT_OK;
}

void chart_curves_free(chart_curves *charts)
{
    free(charts->curves);
    free(charts->points);
    *charts = (chart_curves){0};
}

void chart_to_point(const map_chart *chart, const double *flat, double *point)
{
    degrees_to_point(nearest_longitude(chart, flat[0], 0) / chart->units_per_degree, flat[1] / chart->units_per_degree,
                     point);
}

void chart_move(const map_chart *chart, const bat_curve *coarse, bat_curve *fine, bat_curve *flat, size_t edge, size_t begin,
                size_t end, draw_move move)
{
    static const double SAME_CELL = 0.01; // of a unit: hardly ever rounds to another point than the start does
    const double *p = coarse->points + 2 * edge, *q = coarse->points + 2 * (edge + 1 == coarse->count ? 0 : edge + 1);
    for (size_t i = begin + 1; i < end; i++)
    {
        double share = (double)(i - begin) / (double)(end - begin), place[2], *point = fine->points + 3 * i;
        double reach = fmax(fabs(q[0] - p[0]), fabs(q[1] - p[1]));
        if (move == DRAW_TO_START)
            share *= fmin(1, SAME_CELL / reach);
        if (move == DRAW_TO_START || (reach < 1 && move == DRAW_ON_EDGE))
        {
            // The chart is too coarse: the points differ on the sphere alone.
            size_t last = end < fine->count ? end : 0;
            if (bat_space_geodesic(fine->space, fine->points + 3 * begin, fine->points + 3 * last, share, point) == BAT_OK)
                chart_point(chart, point, flat->points[2 * begin], flat->points + 2 * i);
            continue;
        }
        double across = hypot(point[0], point[1]);
        double now[2] = {atan2(point[1], point[0]) * chart->units_per_radian,
                         atan2(point[2], across) * chart->units_per_radian};
        now[0] = nearest_longitude(chart, now[0], flat->points[2 * i]);
        for (int c = 0; c < 2; c++)
        {
            double on_edge = p[c] + share * (q[c] - p[c]);
            place[c] = move == DRAW_HALF ? on_edge + (now[c] - on_edge) / 2 : on_edge;
        }
        chart_to_point(chart, place, point);
        chart_point(chart, point, place[0], flat->points + 2 * i);
    }
}

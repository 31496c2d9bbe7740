/// @file
/// Outline and holes of a chart: the boundary of an alpha shape (Edelsbrunner, Kirkpatrick and Seidel, "On the shape of a
/// set of points in the plane", 1983), with a radius that follows the local spacing. Triangles of the Delaunay triangulation
/// whose circumcircle is larger than RADIUS spacings are empty. Empty triangles that are connected with the outside are
/// outside; other components are gaps between points, which are filled, or holes.

#include "surface/trim/trimming.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "mesh/hash_table.h"
#include "surface/cloud/boundary.h"
#include "surface/cloud/delaunay.h"
#include "surface/spline/tensor_surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Radius of the largest empty circle in the inside, in spacings. Of thousands of random points, the largest has about two.
static const double RADIUS = 2.2;
/// A component of empty triangles is a hole when its largest circle has this radius, in spacings.
static const double HOLE_RADIUS = 2.75;
/// A second piece with so many of the points is an error; smaller ones are outliers.
static const double PIECE_SHARE = 0.05;

#define NONE UINT32_MAX

typedef struct outline_work
{
    const cloud_geometry *geometry;
    const planar_chart *chart;
    planar_triangles triangles;
    memory_pool pool;
    uint32_t *opposite; ///< 3 triangles: the same side of the neighbour; NONE on the hull. Side s of triangle t is 3 t + s,
                        ///< from corner s to the next one
    double *radius;     ///< of circumcircles, in spacings
    bool *solid;        ///< whether a triangle is inside
    uint32_t *stack;
    uint32_t *part; ///< of each triangle; NONE for not visited
} outline_work;

void outline_free(outline_loops *loops)
{
    free(loops->corners);
    free(loops->first);
    free(loops->filled);
    *loops = (outline_loops){0};
}

static const double *place_of(const outline_work *work, uint32_t point)
{
    return work->chart->places[point];
}

static double distance_of(const double *a, const double *b)
{
    return hypot(a[0] - b[0], a[1] - b[1]);
}

static void measure_triangle(outline_work *work, size_t triangle)
{
    const uint32_t *corners = work->triangles.corners + 3 * triangle;
    const double *a = place_of(work, corners[0]), *b = place_of(work, corners[1]), *c = place_of(work, corners[2]);
    double area = vector2_turn(a, b, c), spacing = 0;
    for (int k = 0; k < 3; k++)
        spacing += work->geometry->spacing[corners[k]] / 3;
    work->radius[triangle] = distance_of(a, b) * distance_of(b, c) * distance_of(c, a) / (2 * area) / spacing;
    work->solid[triangle] = work->radius[triangle] <= RADIUS;
}

static uint32_t side_end(const outline_work *work, uint32_t side)
{
    return work->triangles.corners[side % 3 == 2 ? side - 2 : side + 1];
}

static bat_status connect(outline_work *work, bat_error *error)
{
    key_map sides = {0};
    size_t count = 3 * work->triangles.count;
    bat_status status = BAT_OK;
    for (size_t s = 0; s < count; s++)
        work->opposite[s] = NONE;
    for (uint32_t s = 0; s < count && status == BAT_OK; s++)
    {
        uint32_t *first = key_map_at(&sides, key_of_pair(work->triangles.corners[s], side_end(work, s)));
        if (first == NULL)
            status = error_memory(error, count * sizeof(uint64_t));
        else if (*first == UINT32_MAX)
            *first = s;
        else
        {
            work->opposite[s] = *first;
            work->opposite[*first] = s;
        }
    }
    key_map_free(&sides);
    return status;
}

static bat_status work_make(outline_work *work, bat_error *error)
{
    bat_status status =
        planar_delaunay((const double(*)[2])work->chart->places, work->geometry->order.cloud.count, &work->triangles, error);
    size_t count = work->triangles.count;
    if (status != BAT_OK)
        return status;
    work->opposite = memory_pool_array(&work->pool, count, 3 * sizeof *work->opposite);
    work->radius = memory_pool_array(&work->pool, count, sizeof *work->radius);
    work->solid = memory_pool_array(&work->pool, count, sizeof *work->solid);
    work->stack = memory_pool_array(&work->pool, count, sizeof *work->stack);
    work->part = memory_pool_array(&work->pool, count, sizeof *work->part);
    status = memory_pool_check(&work->pool, error);
    for (size_t t = 0; t < count && status == BAT_OK; t++)
        measure_triangle(work, t);
    return status == BAT_OK ? connect(work, error) : status;
}

/// A component of triangles that are all solid, or all not.
typedef struct outline_part
{
    size_t count;
    double area, largest; ///< circumcircle, in spacings
    bool outside;         ///< it reaches the hull
} outline_part;

/// Visit the component of a triangle. Its triangles are at the beginning of the stack afterwards.
static outline_part flood(outline_work *work, uint32_t start, uint32_t name)
{
    outline_part part = {0};
    bool solid = work->solid[start];
    work->stack[part.count++] = start;
    work->part[start] = name;
    for (size_t head = 0; head < part.count; head++)
    {
        uint32_t triangle = work->stack[head];
        const uint32_t *corners = work->triangles.corners + 3 * (size_t)triangle;
        part.area += vector2_turn(place_of(work, corners[0]), place_of(work, corners[1]), place_of(work, corners[2])) / 2;
        part.largest = fmax(part.largest, work->radius[triangle]);
        for (uint32_t k = 0; k < 3; k++)
        {
            uint32_t other = work->opposite[3 * triangle + k];
            if (other == NONE)
                part.outside = true;
            else if (work->solid[other / 3] == solid && work->part[other / 3] == NONE)
            {
                work->part[other / 3] = name;
                work->stack[part.count++] = other / 3;
            }
        }
    }
    return part;
}

static void forget_parts(outline_work *work)
{
    for (size_t t = 0; t < work->triangles.count; t++)
        work->part[t] = NONE;
}

/// Make gaps between points solid.
static void fill_gaps(outline_work *work)
{
    forget_parts(work);
    for (uint32_t t = 0; t < work->triangles.count; t++)
    {
        if (work->solid[t] || work->part[t] != NONE)
            continue;
        outline_part part = flood(work, t, t);
        for (size_t k = 0; k < part.count && !part.outside && part.largest < HOLE_RADIUS; k++)
            work->solid[work->stack[k]] = true;
    }
    forget_parts(work);
}

/// Keep the largest solid component.
static bat_status choose_piece(outline_work *work, bat_error *error)
{
    size_t total = 0, most = 0, second = 0;
    uint32_t best = NONE;
    forget_parts(work);
    for (uint32_t t = 0; t < work->triangles.count; t++)
    {
        if (!work->solid[t] || work->part[t] != NONE)
            continue;
        size_t count = flood(work, t, t).count;
        total += count;
        second = count > most ? most : count > second ? count : second;
        best = count > most ? t : best;
        most = count > most ? count : most;
    }
    if (best == NONE)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "no outline was found: the points are too few or on a line");
    if ((double)second > PIECE_SHARE * (double)total)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the cloud has several pieces, with %.0f %% and %.0f %% of its area; give each alone",
                         100 * (double)most / (double)total, 100 * (double)second / (double)total);
    for (size_t t = 0; t < work->triangles.count; t++)
        work->solid[t] = work->part[t] == best;
    return BAT_OK;
}

static bool is_border(const outline_work *work, uint32_t side)
{
    return work->solid[side / 3] && (work->opposite[side] == NONE || !work->solid[work->opposite[side] / 3]);
}

/// The border's side after another one, the next one clockwise around their common corner.
static uint32_t next_border(const outline_work *work, uint32_t side)
{
    side = side % 3 == 2 ? side - 2 : side + 1;
    while (!is_border(work, side))
    {
        side = work->opposite[side];
        side = side % 3 == 2 ? side - 2 : side + 1;
    }
    return side;
}

static double side_length(const void *context, uint32_t a, uint32_t b)
{
    return distance_of(place_of(context, a), place_of(context, b));
}

static double loop_area(const outline_work *work, const uint32_t *corners, size_t count)
{
    double sum = 0;
    const double *origin = place_of(work, corners[0]);
    for (size_t i = 1; i + 1 < count; i++)
        sum += vector2_turn(origin, place_of(work, corners[i]), place_of(work, corners[i + 1])) / 2;
    return sum;
}

static double loop_diameter(const outline_work *work, const uint32_t *corners, size_t count)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++)
        for (int d = 0; d < 2; d++)
        {
            low[d] = fmin(low[d], place_of(work, corners[i])[d]);
            high[d] = fmax(high[d], place_of(work, corners[i])[d]);
        }
    return fmax(high[0] - low[0], high[1] - low[1]);
}

typedef struct traced_loop
{
    size_t begin, count;
    double area, diameter;
} traced_loop;

static int compare_loops(const void *a, const void *b)
{
    const traced_loop *p = a, *q = b;
    bool holes[2] = {p->area < 0, q->area < 0};
    if (holes[0] != holes[1])
        return holes[0] ? 1 : -1;
    if (fabs(p->area) != fabs(q->area))
        return fabs(p->area) > fabs(q->area) ? -1 : 1;
    return (p->begin > q->begin) - (p->begin < q->begin);
}

/// Trace all loops into `corners`. Returns their number.
static size_t trace_loops(outline_work *work, size_t *last, bool *visited, uint32_t *corners, traced_loop *traced)
{
    static const int MIN_CORNERS = 4;
    size_t sides = 3 * work->triangles.count, count = 0, made = 0;
    for (uint32_t s = 0; s < sides; s++)
    {
        if (visited[s] || !is_border(work, s))
            continue;
        size_t size = 0;
        for (uint32_t at = s; !visited[at]; at = next_border(work, at))
        {
            visited[at] = true;
            corners[made + size++] = work->triangles.corners[at];
        }
        size = loop_cut_pinches(side_length, work, corners + made, size, last);
        if (size < MIN_CORNERS)
            continue;
        traced[count++] = (traced_loop){.begin = made,
                                        .count = size,
                                        .area = loop_area(work, corners + made, size),
                                        .diameter = loop_diameter(work, corners + made, size)};
        made += size;
    }
    qsort(traced, count, sizeof *traced, compare_loops);
    return count;
}

static bat_status store_loops(const uint32_t *corners, const traced_loop *traced, size_t count, double fill,
                              outline_loops *loops, bat_error *error)
{
    size_t total = 0;
    for (size_t l = 0; l < count; l++)
        total += traced[l].count;
    *loops = (outline_loops){.corners = memory_array(total, sizeof *corners),
                             .first = memory_array(count + 1, sizeof *loops->first),
                             .filled = memory_array(count, sizeof *loops->filled)};
    if (loops->corners == NULL || loops->first == NULL || loops->filled == NULL)
    {
        outline_free(loops);
        return error_memory(error, total * sizeof *corners);
    }
    loops->first[0] = 0;
    for (size_t l = 0; l < count; l++)
    {
        if (l > 0 && traced[l].area > 0)
            continue;
        size_t at = loops->first[loops->count];
        memcpy(loops->corners + at, corners + traced[l].begin, traced[l].count * sizeof *corners);
        loops->filled[loops->count++] = l > 0 && traced[l].diameter <= fill;
        loops->first[loops->count] = at + traced[l].count;
    }
    return BAT_OK;
}

/// The area in space of the triangles inside. Those of a projection are divided by the cosine of their tilt.
static double solid_area(const outline_work *work)
{
    static const double MIN_COSINE = 0.2;
    const double *direction = work->chart->direction;
    bool projected = vector3_dot(direction, direction) > 0;
    double sum = 0;
    for (size_t t = 0; t < work->triangles.count; t++)
    {
        const uint32_t *corners = work->triangles.corners + 3 * t;
        double area = vector2_turn(place_of(work, corners[0]), place_of(work, corners[1]), place_of(work, corners[2])) / 2;
        double cosine = 0;
        for (size_t k = 0; k < 3; k++)
            cosine += fabs(vector3_dot(direction, work->geometry->oriented.planes[corners[k]].axes[2])) / 3;
        if (work->solid[t])
            sum += projected ? area / fmax(cosine, MIN_COSINE) : area;
    }
    return sum;
}

static bat_status find_loops(outline_work *work, double fill, outline_loops *loops, bat_error *error)
{
    size_t points = work->geometry->order.cloud.count, sides = 3 * work->triangles.count, borders = 0;
    for (uint32_t s = 0; s < sides; s++)
        borders += is_border(work, s);
    size_t *last = memory_pool_array(&work->pool, points, sizeof *last);
    bool *visited = memory_pool_zeros(&work->pool, sides, sizeof *visited);
    uint32_t *corners = memory_pool_array(&work->pool, borders, sizeof *corners);
    traced_loop *traced = memory_pool_array(&work->pool, borders, sizeof *traced);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < points; i++)
            last[i] = SIZE_MAX;
        size_t count = trace_loops(work, last, visited, corners, traced);
        status = count == 0 || traced[0].area <= 0
                     ? error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "no outline was found: the points are too few")
                     : store_loops(corners, traced, count, fill, loops, error);
        if (status == BAT_OK)
            loops->area = solid_area(work);
    }
    return status;
}

bat_status outline_find(const cloud_geometry *geometry, const planar_chart *chart, double fill, outline_loops *loops,
                        bat_error *error)
{
    outline_work work = {.geometry = geometry, .chart = chart};
    *loops = (outline_loops){0};
    bat_status status = work_make(&work, error);
    if (status == BAT_OK)
    {
        fill_gaps(&work);
        status = choose_piece(&work, error);
    }
    if (status == BAT_OK)
        status = find_loops(&work, fill, loops, error);
    memory_pool_free(&work.pool);
    planar_triangles_free(&work.triangles);
    return status;
}

// Trimmed surfaces; see trimming.h.

/// Room around the points, in spacings: the curves lie up to about one spacing outside.
static const double MARGIN = 2;

void trimming_free(surface_trimming *trimming)
{
    planar_chart_free(&trimming->chart);
    outline_free(&trimming->loops);
}

bat_status trimming_make(const cloud_geometry *geometry, double fill, surface_trimming *trimming, bat_error *error)
{
    *trimming = (surface_trimming){0};
    bat_status status = planar_chart_make(geometry, MARGIN, &trimming->chart, error);
    if (status == BAT_OK)
        status =
            outline_find(geometry, &trimming->chart, ldexp(fill, geometry->frame.exponent - 1), &trimming->loops, error);
    return status;
}

void trimming_parameters(const cloud_geometry *geometry, const surface_trimming *trimming, double *parameters)
{
    for (size_t i = 0; i < geometry->order.cloud.count; i++)
        for (size_t d = 0; d < 2; d++)
            parameters[2 * (size_t)geometry->order.places[i] + d] =
                fmin(fmax(trimming->chart.places[i][d] / trimming->chart.sides[d], 0), 1);
}

bat_status trimming_curves(const cloud_geometry *geometry, const surface_trimming *trimming, const double *parameters,
                           bat_spline_trim *trim, bat_error *error)
{
    size_t count = geometry->order.cloud.count;
    double *ordered = memory_array(count, 2 * sizeof *ordered);
    *trim = (bat_spline_trim){0};
    if (ordered == NULL)
        return error_memory(error, count * 2 * sizeof *ordered);
    for (size_t i = 0; i < count; i++)
        memcpy(ordered + 2 * i, parameters + 2 * (size_t)geometry->order.places[i], 2 * sizeof *ordered);
    bat_status status =
        fair_loops_make(&trimming->loops, trimming->chart.sides, ordered, geometry->spacing, geometry->noise, trim, error);
    free(ordered);
    return status;
}

size_t trimming_drop_filled(const surface_trimming *trimming, bat_spline_trim *trim)
{
    size_t kept = 0, pieces = 0, dropped = 0, begin = 0;
    for (size_t l = 0; l < trim->loop_count; l++)
    {
        size_t end = trim->loops[l + 1];
        for (size_t i = begin; i < end; i++)
            if (trimming->loops.filled[l])
                spline_curve_free(&trim->pieces[i]);
            else
            {
                bat_spline_curve piece = trim->pieces[i];
                trim->pieces[i] = (bat_spline_curve){0};
                trim->pieces[pieces++] = piece;
            }
        begin = end;
        if (trimming->loops.filled[l])
            dropped++;
        else
            trim->loops[++kept] = pieces;
    }
    trim->loop_count = kept;
    return dropped;
}

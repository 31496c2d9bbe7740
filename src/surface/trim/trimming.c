/// @file
/// Outline and holes of a chart. A Delaunay triangle is *large* at a level when its circumcircle is larger than a number of
/// spacings. Large triangles that touch each other are one gap. It is empty where the expected number of points in it, its
/// area in squared spacings, is more than points at random places leave free by chance. This finds narrow slots, which have
/// no large circle. Within the rest, the boundary is that of an alpha shape (Edelsbrunner, Kirkpatrick and Seidel, "On the
/// shape of a set of points in the plane", 1983), whose radius is that of the level.

#include "surface/trim/trimming.h"

#include "base/error.h"
#include "linalg/vector.h"
#include "mesh/hash_table.h"
#include "surface/cloud/delaunay.h"

#include <string.h>

/// A level of empty triangles.
typedef struct void_level
{
    double radius;   ///< of the largest circumcircle inside, in spacings
    double area;     ///< of the smallest gap that is no chance, in squared spacings,
    double outside;  ///< of one that touches the outside,
    double attached; ///< and of one that touches a hole
    double most;     ///< share of the area in large triangles above which the points are no even sample, such as scan lines
} void_level;

/// The areas are exceeded in one of some twenty sets of 4,000 points at random places.
static const void_level LEVELS[] = {{2.2, 18, 0, 6, 1}, {1.5, 22, 14, 10, 0.5}, {1.05, 40, 45, 12, 0.5}};
#define LEVEL_COUNT (sizeof LEVELS / sizeof *LEVELS)
/// Number of points that the areas are of, and their growth with its logarithm.
static const double LEVEL_POINTS = 4000;
static const double LEVEL_GROWTH = 0.1;
/// A level that leaves the largest piece less than this share of its triangles is not used.
static const double PIECE_KEPT = 0.95;
/// A gap that is closed is listed when it has this share of the area of an empty one.
static const double LISTED_SHARE = 0.6;
/// The spacing is the root of twice the mean area of triangles with circumcircles up to these radii, in spacings.
static const double SPACING_RADII[] = {1.6, 1.5, 1.4};
/// Points are at random places when this share of the area is in triangles with a larger circumcircle: of random ones .14.
static const double RANDOM_SHARE = 0.08;
static const double RANDOM_RADIUS = 1.1;
/// A second piece with so many of the points is an error; smaller ones are outliers.
static const double PIECE_SHARE = 0.05;

#define NONE UINT32_MAX ///< whose bytes are 0xff
/// The gap that reaches the hull.
#define OUTSIDE (UINT32_MAX - 1)

typedef struct outline_work
{
    const cloud_geometry *geometry;
    const planar_chart *chart;
    simplices triangles;
    memory_pool pool;
    uint32_t *opposite; ///< 3 triangles: the same side of the neighbour; NONE on the hull. Side s of triangle t is 3 t + s,
                        ///< from corner s to the next one
    double *spacing;    ///< of the points
    double *area;       ///< of triangles
    double *circle;     ///< radius of their circumcircles
    double *radius;     ///< the same in spacings
    uint8_t *level;     ///< of a triangle: that at which it became empty, from 1; 0 for inside
    uint8_t *before;    ///< the same before a level
    uint32_t *gap;      ///< of an empty triangle: the first one of its gap
    uint32_t *stack;
    uint32_t *part; ///< of each triangle; NONE for not visited
    double close;   ///< gaps whose circles have at most this diameter are closed
} outline_work;

void outline_free(outline_loops *loops)
{
    free(loops->corners);
    free(loops->first);
    free(loops->filled);
    free(loops->spacing);
    free(loops->gaps);
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

static double mean_spacing(const outline_work *work, size_t triangle)
{
    const uint32_t *corners = work->triangles.corners + 3 * triangle;
    return (work->spacing[corners[0]] + work->spacing[corners[1]] + work->spacing[corners[2]]) / 3;
}

static void measure_triangle(outline_work *work, size_t triangle)
{
    const uint32_t *corners = work->triangles.corners + 3 * triangle;
    const double *a = place_of(work, corners[0]), *b = place_of(work, corners[1]), *c = place_of(work, corners[2]);
    work->area[triangle] = vector2_turn(a, b, c) / 2;
    work->circle[triangle] = distance_of(a, b) * distance_of(b, c) * distance_of(c, a) / (4 * work->area[triangle]);
}

/// Whether a triangle counts for the spacing.
static bool is_dense(const outline_work *work, size_t triangle, double limit)
{
    return work->level[triangle] == 0 && work->circle[triangle] <= limit * mean_spacing(work, triangle);
}

/// Give each point its third of the area of its triangles, and the part of the full turn that they have around it.
/// @param sums   points x 2
/// @param number points: of its triangles
static void gather_areas(const outline_work *work, double limit, double *sums, double *number)
{
    for (size_t t = 0; t < work->triangles.count; t++)
    {
        const uint32_t *corners = work->triangles.corners + 3 * t;
        if (!is_dense(work, t, limit))
            continue;
        for (int k = 0; k < 3; k++)
        {
            const double *here = place_of(work, corners[k]);
            const double *a = place_of(work, corners[(k + 1) % 3]), *b = place_of(work, corners[(k + 2) % 3]);
            double along = (a[0] - here[0]) * (b[0] - here[0]) + (a[1] - here[1]) * (b[1] - here[1]);
            sums[2 * (size_t)corners[k]] += work->area[t] / 3;
            sums[2 * (size_t)corners[k] + 1] += atan2(2 * work->area[t], along) / ANGLE_TURN;
            number[corners[k]]++;
        }
    }
}

/// Share the sums of each point evenly among its triangles' corners. Their total stays.
static void spread_areas(const outline_work *work, double limit, const double *number, const double *sums, double *next)
{
    memset(next, 0, work->geometry->order.cloud.count * 2 * sizeof *next);
    for (size_t t = 0; t < work->triangles.count; t++)
    {
        const uint32_t *corners = work->triangles.corners + 3 * t;
        double sum[2] = {0, 0};
        if (!is_dense(work, t, limit))
            continue;
        for (size_t k = 0; k < 6; k++)
            sum[k % 2] += sums[2 * (size_t)corners[k / 2] + k % 2] / (3 * number[corners[k / 2]]);
        for (size_t k = 0; k < 6; k++)
            next[2 * (size_t)corners[k / 2] + k % 2] += sum[k % 2];
    }
}

/// Replace the spacings by those of triangles. That of the nearest neighbours is too large at edges.
static bat_status measure_spacing(outline_work *work, bat_error *error)
{
    static const int ROUNDS = 3;
    size_t points = work->geometry->order.cloud.count;
    double *sums = memory_pool_array(&work->pool, points, 2 * sizeof *sums);
    double *next = memory_pool_array(&work->pool, points, 2 * sizeof *next);
    double *number = memory_pool_array(&work->pool, points, sizeof *number);
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    memcpy(work->spacing, work->geometry->spacing, points * sizeof *work->spacing);
    for (size_t pass = 0; pass < sizeof SPACING_RADII / sizeof *SPACING_RADII; pass++)
    {
        memset(sums, 0, points * 2 * sizeof *sums);
        memset(number, 0, points * sizeof *number);
        gather_areas(work, SPACING_RADII[pass], sums, number);
        for (int round = 0; round < ROUNDS; round++)
        {
            spread_areas(work, SPACING_RADII[pass], number, sums, next);
            SWAP(sums, next);
        }
        for (size_t i = 0; i < points; i++)
            work->spacing[i] = sums[2 * i + 1] > 0 ? sqrt(sums[2 * i] / sums[2 * i + 1]) : work->spacing[i];
    }
    for (size_t t = 0; t < work->triangles.count; t++)
        work->radius[t] = work->circle[t] / mean_spacing(work, t);
    return BAT_OK;
}

static uint32_t next_side(uint32_t side)
{
    return side % 3 == 2 ? side - 2 : side + 1;
}

static bat_status connect(outline_work *work, bat_error *error)
{
    key_map sides = {0};
    size_t count = 3 * work->triangles.count;
    bat_status status = BAT_OK;
    memset(work->opposite, 0xff, count * sizeof *work->opposite);
    for (uint32_t s = 0; s < count && status == BAT_OK; s++)
    {
        uint32_t *first = key_map_at(&sides, key_of_pair(work->triangles.corners[s], work->triangles.corners[next_side(s)]));
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
    work->spacing = memory_pool_array(&work->pool, work->geometry->order.cloud.count, sizeof *work->spacing);
    work->area = memory_pool_array(&work->pool, count, sizeof *work->area);
    work->circle = memory_pool_array(&work->pool, count, sizeof *work->circle);
    work->radius = memory_pool_array(&work->pool, count, sizeof *work->radius);
    work->level = memory_pool_zeros(&work->pool, count, sizeof *work->level);
    work->gap = memory_pool_array(&work->pool, count, sizeof *work->gap);
    work->before = memory_pool_array(&work->pool, count, sizeof *work->before);
    work->stack = memory_pool_array(&work->pool, count, sizeof *work->stack);
    work->part = memory_pool_array(&work->pool, count, sizeof *work->part);
    status = memory_pool_check(&work->pool, error);
    for (size_t t = 0; t < count && status == BAT_OK; t++)
        measure_triangle(work, t);
    if (status == BAT_OK)
        status = measure_spacing(work, error);
    return status == BAT_OK ? connect(work, error) : status;
}

/// A component of triangles inside, or of large ones.
typedef struct outline_part
{
    size_t count;
    double area;   ///< in squared spacings
    double widest; ///< radius of its largest circle
    bool outside;  ///< it reaches the hull, or a gap that does
    bool attached; ///< it touches an empty triangle
    bool joins;    ///< it touches two gaps
} outline_part;

/// Visit a triangle's component among those inside with larger circumcircles; it comes to the beginning of the stack.
static outline_part flood(outline_work *work, uint32_t start, double radius)
{
    outline_part part = {0};
    uint32_t gap = NONE;
    work->stack[part.count++] = start;
    work->part[start] = start;
    for (size_t head = 0; head < part.count; head++)
    {
        uint32_t triangle = work->stack[head];
        double spacing = mean_spacing(work, triangle);
        part.area += work->area[triangle] / (spacing * spacing);
        part.widest = fmax(part.widest, work->circle[triangle]);
        for (uint32_t k = 0; k < 3; k++)
        {
            uint32_t side = work->opposite[3 * triangle + k], other = side / 3;
            if (side == NONE)
                part.outside = true;
            else if (work->level[other] > 0)
            {
                part.joins = part.joins || (part.attached && work->gap[other] != gap);
                part.attached = true;
                gap = work->gap[other];
                part.outside = part.outside || gap == OUTSIDE;
            }
            else if (work->radius[other] > radius && work->part[other] == NONE)
            {
                work->part[other] = start;
                work->stack[part.count++] = other;
            }
        }
    }
    return part;
}

/// The number of triangles in the largest piece inside, and in all.
static size_t largest_piece(outline_work *work, uint32_t *best, size_t *second, size_t *total)
{
    size_t most = 0;
    *best = NONE;
    *second = *total = 0;
    memset(work->part, 0xff, work->triangles.count * sizeof *work->part);
    for (uint32_t t = 0; t < work->triangles.count; t++)
    {
        if (work->level[t] > 0 || work->part[t] != NONE)
            continue;
        size_t count = flood(work, t, 0).count;
        *total += count;
        *second = count > most ? most : count > *second ? count : *second;
        *best = count > most ? t : *best;
        most = count > most ? count : most;
    }
    return most;
}

/// Describe the component at the beginning of the stack.
static bat_surface_gap gap_of(const outline_work *work, size_t count)
{
    bat_surface_gap gap = {.closed = true};
    double low[2], high[2];
    box_clear(2, low, high);
    for (size_t k = 0; k < count; k++)
    {
        uint32_t triangle = work->stack[k];
        gap.area += work->area[triangle];
        for (size_t c = 0; c < 3; c++)
        {
            uint32_t corner = work->triangles.corners[3 * (size_t)triangle + c];
            for (size_t d = 0; d < 3; d++)
                gap.place[d] += work->geometry->order.cloud.points[3 * (size_t)corner + d] / (3 * (double)count);
            box_include(2, place_of(work, corner), low, high);
        }
    }
    gap.diameter = fmax(high[0] - low[0], high[1] - low[1]);
    return gap;
}

static bat_status add_gap(outline_loops *loops, const bat_surface_gap *gap, bat_error *error)
{
    bat_surface_gap *more = realloc(loops->gaps, (loops->gap_count + 1) * sizeof *more);
    if (more == NULL)
        return error_memory(error, (loops->gap_count + 1) * sizeof *more);
    loops->gaps = more;
    loops->gaps[loops->gap_count++] = *gap;
    return BAT_OK;
}

static void name_gaps(outline_work *work)
{
    memset(work->gap, 0xff, work->triangles.count * sizeof *work->gap);
    for (uint32_t t = 0; t < work->triangles.count; t++)
    {
        if (work->level[t] == 0 || work->gap[t] != NONE)
            continue;
        size_t count = 0;
        bool outside = false;
        work->gap[t] = t;
        work->stack[count++] = t;
        for (size_t head = 0; head < count; head++)
            for (size_t k = 0; k < 3; k++)
            {
                uint32_t side = work->opposite[3 * (size_t)work->stack[head] + k], other = side / 3;
                outside = outside || side == NONE;
                if (side == NONE || work->level[other] == 0 || work->gap[other] != NONE)
                    continue;
                work->gap[other] = t;
                work->stack[count++] = other;
            }
        for (size_t k = 0; k < count && outside; k++)
            work->gap[work->stack[k]] = OUTSIDE;
    }
}

/// Empty the gaps of a level that are no chance.
/// @param loops receives those that are nearly as large; null for none
static bat_status empty_level(outline_work *work, size_t number, outline_loops *loops, bat_error *error)
{
    const void_level *level = &LEVELS[number];
    double growth = 1 + LEVEL_GROWTH * log((double)work->geometry->order.cloud.count / LEVEL_POINTS);
    bat_status status = BAT_OK;
    name_gaps(work);
    memset(work->part, 0xff, work->triangles.count * sizeof *work->part);
    for (uint32_t t = 0; t < work->triangles.count && status == BAT_OK; t++)
    {
        if (work->level[t] > 0 || work->radius[t] <= level->radius || work->part[t] != NONE)
            continue;
        outline_part part = flood(work, t, level->radius);
        bool touches = part.outside || part.attached;
        double least = part.outside ? level->outside : part.attached ? level->attached : level->area;
        bool found = part.area >= growth * least || (part.joins && number > 0),
             empty = found && 2 * part.widest > work->close;
        for (size_t k = 0; k < part.count && empty; k++)
            work->level[work->stack[k]] = (uint8_t)(number + 1);
        bool listed = found || (!touches && part.area >= LISTED_SHARE * growth * level->area);
        if (empty || loops == NULL || !listed)
            continue;
        bat_surface_gap gap = gap_of(work, part.count);
        status = add_gap(loops, &gap, error);
    }
    return status;
}

/// Share of the area inside that is in large triangles.
static double large_share(const outline_work *work, double radius)
{
    double large = 0, all = 0;
    for (size_t t = 0; t < work->triangles.count; t++)
    {
        all += work->level[t] == 0 ? work->area[t] : 0;
        large += work->level[t] == 0 && work->radius[t] > radius ? work->area[t] : 0;
    }
    return all > 0 ? large / all : 1;
}

/// Empty all gaps, level by level. A level that would take the points apart is left out.
static bat_status empty_gaps(outline_work *work, outline_loops *loops, bat_error *error)
{
    static const int PASSES = 4;
    size_t second, total;
    uint32_t best;
    bat_status status = BAT_OK;
    for (size_t k = 0; k < LEVEL_COUNT && status == BAT_OK; k++)
    {
        if (large_share(work, LEVELS[k].radius) > LEVELS[k].most)
            break;
        memcpy(work->before, work->level, work->triangles.count * sizeof *work->level);
        // Then those between two gaps, and those at the last ones.
        for (int pass = 0; pass < PASSES && status == BAT_OK; pass++)
            status = empty_level(work, k, k + 1 == LEVEL_COUNT && pass + 1 == PASSES ? loops : NULL, error);
        size_t piece = largest_piece(work, &best, &second, &total);
        if (k > 0 && (double)piece < PIECE_KEPT * (double)total)
            memcpy(work->level, work->before, work->triangles.count * sizeof *work->level);
    }
    return status;
}

/// Keep the largest piece.
static bat_status choose_piece(outline_work *work, bat_error *error)
{
    size_t second, total;
    uint32_t best;
    size_t most = largest_piece(work, &best, &second, &total);
    if (best == NONE)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "no outline was found: the points are too few or on a line");
    if ((double)second > PIECE_SHARE * (double)total)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                         "the cloud has several pieces, with %.0f %% and %.0f %% of its area; give each alone",
                         100 * (double)most / (double)total, 100 * (double)second / (double)total);
    for (size_t t = 0; t < work->triangles.count; t++)
        if (work->level[t] == 0 && work->part[t] != best)
            work->level[t] = 1;
    return BAT_OK;
}

static bool is_border(const outline_work *work, uint32_t side)
{
    return work->level[side / 3] == 0 && (work->opposite[side] == NONE || work->level[work->opposite[side] / 3] > 0);
}

/// The border's side after another one, the next one clockwise around their common corner.
static uint32_t next_border(const outline_work *work, uint32_t side)
{
    side = next_side(side);
    while (!is_border(work, side))
        side = next_side(work->opposite[side]);
    return side;
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
    double low[2], high[2];
    box_clear(2, low, high);
    for (size_t i = 0; i < count; i++)
        box_include(2, place_of(work, corners[i]), low, high);
    return fmax(high[0] - low[0], high[1] - low[1]);
}

typedef struct traced_loop
{
    size_t begin, count;
    double area, diameter;
} traced_loop;

/// All loops.
typedef struct trace
{
    uint32_t *corners;
    double *spacing; ///< see outline_loops
    size_t made;
    traced_loop *traced;
    size_t count;
} trace;

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

static void end_loop(const outline_work *work, const uint32_t *sides, size_t size, trace *out)
{
    static const size_t MIN_CORNERS = 4;
    if (size < MIN_CORNERS)
        return;
    for (size_t k = 0; k < size; k++)
    {
        out->corners[out->made + k] = work->triangles.corners[sides[k]];
        out->spacing[out->made + k] = work->spacing[out->corners[out->made + k]];
    }
    out->traced[out->count++] = (traced_loop){.begin = out->made,
                                              .count = size,
                                              .area = loop_area(work, out->corners + out->made, size),
                                              .diameter = loop_diameter(work, out->corners + out->made, size)};
    out->made += size;
}

/// Trace all loops. One that meets itself at a point is taken apart there.
static void trace_loops(const outline_work *work, size_t *last, bool *visited, uint32_t *path, trace *out)
{
    for (uint32_t s = 0; s < 3 * work->triangles.count; s++)
    {
        size_t size = 0;
        if (visited[s] || !is_border(work, s))
            continue;
        for (uint32_t at = s; !visited[at]; at = next_border(work, at))
        {
            uint32_t corner = work->triangles.corners[at];
            visited[at] = true;
            if (last[corner] != SIZE_MAX)
            {
                size_t begin = last[corner];
                for (size_t k = begin; k < size; k++)
                    last[work->triangles.corners[path[k]]] = SIZE_MAX;
                end_loop(work, path + begin, size - begin, out);
                size = begin;
            }
            last[corner] = size;
            path[size++] = at;
        }
        for (size_t k = 0; k < size; k++)
            last[work->triangles.corners[path[k]]] = SIZE_MAX;
        end_loop(work, path, size, out);
    }
    qsort(out->traced, out->count, sizeof *out->traced, compare_loops);
}

static bat_status store_loops(const trace *made, double fill, outline_loops *loops, bat_error *error)
{
    loops->corners = memory_array(made->made, sizeof *loops->corners);
    loops->spacing = memory_array(made->made, sizeof *loops->spacing);
    loops->first = memory_array(made->count + 1, sizeof *loops->first);
    loops->filled = memory_array(made->count, sizeof *loops->filled);
    if (loops->corners == NULL || loops->spacing == NULL || loops->first == NULL || loops->filled == NULL)
        return error_memory(error, made->made * sizeof *loops->spacing);
    loops->first[0] = 0;
    for (size_t l = 0; l < made->count; l++)
    {
        const traced_loop *loop = &made->traced[l];
        if (l > 0 && loop->area > 0)
            continue;
        size_t at = loops->first[loops->count];
        memcpy(loops->corners + at, made->corners + loop->begin, loop->count * sizeof *loops->corners);
        memcpy(loops->spacing + at, made->spacing + loop->begin, loop->count * sizeof *loops->spacing);
        loops->filled[loops->count++] = l > 0 && loop->diameter <= fill;
        loops->first[loops->count] = at + loop->count;
    }
    return BAT_OK;
}

static bat_status list_holes(const outline_work *work, outline_loops *loops, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t l = 1; l < loops->count && status == BAT_OK; l++)
    {
        const uint32_t *corners = loops->corners + loops->first[l];
        size_t count = loops->first[l + 1] - loops->first[l];
        bat_surface_gap gap = {.closed = loops->filled[l],
                               .area = -loop_area(work, corners, count),
                               .diameter = loop_diameter(work, corners, count)};
        for (size_t k = 0; k < 3 * count; k++)
            gap.place[k % 3] += work->geometry->order.cloud.points[3 * (size_t)corners[k / 3] + k % 3] / (double)count;
        status = add_gap(loops, &gap, error);
    }
    return status;
}

/// The area in space by the density of the points: the sum of their squared spacings, which know nothing of the loops. Those
/// of a projection are divided by the cosine of their tilt.
static double area_of_density(const outline_work *work)
{
    static const double MIN_COSINE = 0.2;
    const double *direction = work->chart->direction;
    bool projected = vector3_dot(direction, direction) > 0;
    double sum = 0;
    for (size_t i = 0; i < work->geometry->order.cloud.count; i++)
    {
        double cosine = fabs(vector3_dot(direction, work->geometry->oriented.planes[i].axes[2]));
        double area = work->spacing[i] * work->spacing[i];
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
    uint32_t *path = memory_pool_array(&work->pool, borders, sizeof *path);
    trace out = {.corners = memory_pool_array(&work->pool, borders, sizeof *out.corners),
                 .spacing = memory_pool_array(&work->pool, borders, sizeof *out.spacing),
                 .traced = memory_pool_array(&work->pool, borders, sizeof *out.traced)};
    bat_status status = memory_pool_check(&work->pool, error);
    if (status != BAT_OK)
        return status;
    memset(last, 0xff, points * sizeof *last); // SIZE_MAX
    trace_loops(work, last, visited, path, &out);
    if (out.count == 0 || out.traced[0].area <= 0)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "no outline was found: the points are too few");
    status = store_loops(&out, fill, loops, error);
    loops->area = area_of_density(work);
    loops->random = large_share(work, RANDOM_RADIUS) > RANDOM_SHARE;
    return status == BAT_OK ? list_holes(work, loops, error) : status;
}

bat_status outline_find(const cloud_geometry *geometry, const planar_chart *chart, double fill, double close,
                        outline_loops *loops, bat_error *error)
{
    outline_work work = {.geometry = geometry, .chart = chart, .close = close};
    *loops = (outline_loops){0};
    bat_status status = work_make(&work, error);
    if (status == BAT_OK)
        status = empty_gaps(&work, loops, error);
    if (status == BAT_OK)
        status = choose_piece(&work, error);
    // Now without the triangles across narrow gaps.
    if (status == BAT_OK)
        status = measure_spacing(&work, error);
    if (status == BAT_OK)
        status = find_loops(&work, fill, loops, error);
    memory_pool_free(&work.pool);
    simplices_free(&work.triangles);
    return status;
}

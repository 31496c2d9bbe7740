/// @file
/// Sampling of curves; see simplify.h.

#include "research/data/simplify.h"

#include "linalg/vector.h"
#include "research/data/wave.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

static int compare_indices(const void *a, const void *b)
{
    size_t x = *(const size_t *)a, y = *(const size_t *)b;
    return (x > y) - (x < y);
}

/// Indices at equal steps of a measure of the points.
/// @param measure count positive numbers, one for the piece after each point
static void sample_measure(const double *measure, size_t count, bool closed, size_t wanted, double start, size_t *samples)
{
    size_t pieces = closed ? count : count - 1;
    double total = 0, reached = 0;
    for (size_t i = 0; i < pieces; i++)
        total += measure[i];
    double steps = closed ? (double)wanted : (double)(wanted - 1), offset = closed ? start : 0;
    size_t point = 0;
    for (size_t k = 0; k < wanted; k++)
    {
        double target = total * ((double)k + offset) / steps;
        while (point + 1 < count && reached + 0.5 * measure[point] < target)
            reached += measure[point++];
        samples[k] = point;
    }
    if (!closed)
        samples[wanted - 1] = count - 1;
}

static void sample_uneven(size_t count, bool closed, size_t wanted, bat_random *random, size_t *samples)
{
    size_t gaps = closed ? wanted : wanted - 1;
    double deviation = draw_between(random, 0.3, 0.9), sum = 0, at = 0;
    double gap[SIMPLIFY_MAX_POINTS];
    for (size_t k = 0; k < gaps; k++)
        sum += gap[k] = exp(deviation * bat_random_normal(random));
    double start = closed ? bat_random_uniform(random) : 0, span = closed ? (double)count : (double)(count - 1);
    for (size_t k = 0; k < wanted; k++)
    {
        double share = start + at / sum;
        samples[k] = (size_t)(span * share + 0.5) % count;
        at += k < gaps ? gap[k] : 0;
    }
    if (!closed)
        samples[wanted - 1] = count - 1;
    qsort(samples, wanted, sizeof *samples, compare_indices);
}

/// The sine of the turning angle over a few points around each, between 0 and 1.
static double turning_at(const double *points, size_t count, bool closed, size_t i)
{
    enum
    {
        NEAR = 6
    };
    if (!closed && (i < NEAR || i + NEAR >= count))
        return 0;
    const double *p = points + 2 * ((i + count - NEAR) % count), *q = points + 2 * i;
    const double *r = points + 2 * ((i + NEAR) % count);
    double ax = q[0] - p[0], ay = q[1] - p[1], bx = r[0] - q[0], by = r[1] - q[1];
    return fabs(ax * by - ay * bx) / (hypot(ax, ay) * hypot(bx, by) + 1e-30);
}

static void sample_time(const double *points, size_t count, bool closed, size_t wanted, bat_random *random, size_t *samples)
{
    double time[SIMPLIFY_MAX_POINTS];
    double slower = draw_between(random, 0, 4), strength = draw_between(random, 0, 0.8);
    harmonics speed = harmonics_draw(random, 4, 0.7);
    wave t = wave_make(1, 0, count);
    for (size_t i = 0; i < count; i++, wave_step(&t))
        time[i] =
            exp(strength * harmonics_at(&speed, t.cosine, t.sine)) * (1 + slower * turning_at(points, count, closed, i));
    sample_measure(time, count, closed, wanted, bat_random_uniform(random), samples);
}

static void sample_curvature(const double *points, size_t count, bool closed, size_t wanted, bat_random *random,
                             size_t *samples)
{
    double turning[SIMPLIFY_MAX_POINTS], share = draw_between(random, 0.005, 0.05);
    for (size_t i = 0; i < count; i++)
        turning[i] = share + turning_at(points, count, closed, i);
    sample_measure(turning, count, closed, wanted, bat_random_uniform(random), samples);
}

/// A piece between two chosen points, and the point between them that is farthest from its chord.
typedef struct chord
{
    size_t begin, end; ///< end may be `count`, which is point 0 of a closed curve
    size_t farthest;
    double distance; ///< negative where there is no point between
} chord;

static chord chord_of(const double *points, size_t count, size_t begin, size_t end)
{
    const double *p = points + 2 * begin, *q = points + 2 * (end % count);
    double dx = q[0] - p[0], dy = q[1] - p[1], squared = dx * dx + dy * dy;
    chord c = {begin, end, begin, -1};
    for (size_t i = begin + 1; i < end; i++)
    {
        double x = points[2 * i] - p[0], y = points[2 * i + 1] - p[1];
        double share = squared > 0 ? (x * dx + y * dy) / squared : 0;
        share = share < 0 ? 0 : share > 1 ? 1 : share;
        x -= share * dx;
        y -= share * dy;
        double distance = x * x + y * y;
        if (distance > c.distance)
        {
            c.distance = distance;
            c.farthest = i;
        }
    }
    return c;
}

static void sample_douglas_peucker(const double *points, size_t count, bool closed, size_t wanted, size_t *samples)
{
    chord chords[SIMPLIFY_MAX_POINTS];
    size_t chord_count = 1;
    chords[0] = chord_of(points, count, 0, closed ? count : count - 1);
    size_t pieces = closed ? wanted : wanted - 1;
    while (chord_count < pieces)
    {
        size_t worst = 0;
        for (size_t i = 1; i < chord_count; i++)
            worst = chords[i].distance > chords[worst].distance ? i : worst;
        chord whole = chords[worst];
        assert(whole.distance >= 0);
        chords[worst] = chord_of(points, count, whole.begin, whole.farthest);
        chords[chord_count++] = chord_of(points, count, whole.farthest, whole.end);
    }
    for (size_t i = 0; i < chord_count; i++)
        samples[i] = chords[i].begin;
    if (!closed)
        samples[chord_count] = count - 1;
    qsort(samples, wanted, sizeof *samples, compare_indices);
}

/// A list of points that remain, linked in the order of the curve.
typedef struct remaining
{
    size_t before, after;
    double area; ///< of the triangle with the neighbours; infinite at the ends
    bool there;
} remaining;

static double triangle_area(const double *points, size_t before, size_t point, size_t after)
{
    const double *p = points + 2 * before, *q = points + 2 * point, *r = points + 2 * after;
    return fabs(vector2_turn(p, q, r));
}

/// A heap of points by area, the smallest first; an entry whose area has changed since is stale.
typedef struct entry
{
    double area;
    size_t point;
} entry;

static void heap_down(entry *heap, size_t size, size_t at)
{
    for (size_t child = 2 * at + 1; child < size; at = child, child = 2 * at + 1)
    {
        child += child + 1 < size && heap[child + 1].area < heap[child].area;
        if (heap[at].area <= heap[child].area)
            return;
        entry e = heap[at];
        heap[at] = heap[child];
        heap[child] = e;
    }
}

static void heap_push(entry *heap, size_t *size, entry e)
{
    size_t at = (*size)++;
    for (; at > 0 && heap[(at - 1) / 2].area > e.area; at = (at - 1) / 2)
        heap[at] = heap[(at - 1) / 2];
    heap[at] = e;
}

static void sample_visvalingam(const double *points, size_t count, bool closed, size_t wanted, size_t *samples)
{
    remaining list[SIMPLIFY_MAX_POINTS];
    entry heap[4 * SIMPLIFY_MAX_POINTS];
    size_t size = 0, left = count;
    for (size_t i = 0; i < count; i++)
    {
        bool end = !closed && (i == 0 || i + 1 == count);
        list[i] = (remaining){(i + count - 1) % count, (i + 1) % count, INFINITY, true};
        list[i].area = end ? INFINITY : triangle_area(points, list[i].before, i, list[i].after);
        if (!end)
            heap_push(heap, &size, (entry){list[i].area, i});
    }
    while (left > wanted && size > 0)
    {
        entry e = heap[0];
        heap[0] = heap[--size];
        heap_down(heap, size, 0);
        remaining *gone = &list[e.point];
        if (!gone->there || gone->area != e.area)
            continue;
        gone->there = false;
        left--;
        list[gone->before].after = gone->after;
        list[gone->after].before = gone->before;
        size_t neighbours[2] = {gone->before, gone->after};
        for (size_t k = 0; k < 2; k++)
        {
            remaining *n = &list[neighbours[k]];
            if (isinf(n->area))
                continue;
            n->area = fmax(e.area, triangle_area(points, n->before, neighbours[k], n->after));
            heap_push(heap, &size, (entry){n->area, neighbours[k]});
        }
    }
    size_t found = 0;
    for (size_t i = 0; i < count && found < wanted; i++)
        if (list[i].there)
            samples[found++] = i;
}

void curve_sample(curve_sampling how, const double *points, size_t count, bool closed, size_t wanted, bat_random *random,
                  size_t *samples)
{
    assert(count <= SIMPLIFY_MAX_POINTS && wanted <= count && wanted >= 4);
    double even[SIMPLIFY_MAX_POINTS];
    switch (how)
    {
    case CURVE_SAMPLING_UNEVEN:
        sample_uneven(count, closed, wanted, random, samples);
        return;
    case CURVE_SAMPLING_DOUGLAS_PEUCKER:
        sample_douglas_peucker(points, count, closed, wanted, samples);
        return;
    case CURVE_SAMPLING_VISVALINGAM:
        sample_visvalingam(points, count, closed, wanted, samples);
        return;
    case CURVE_SAMPLING_TIME:
        sample_time(points, count, closed, wanted, random, samples);
        return;
    case CURVE_SAMPLING_CURVATURE:
        sample_curvature(points, count, closed, wanted, random, samples);
        return;
    case CURVE_SAMPLING_EVEN:
    case CURVE_SAMPLING_COUNT:
        break;
    }
    for (size_t i = 0; i < count; i++)
        even[i] = 1;
    sample_measure(even, count, closed, wanted, bat_random_uniform(random), samples);
}

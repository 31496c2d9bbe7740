#include "research/studies/harm.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/curve_map.h"
#include "batten/curve_measure.h"
#include "batten/motion_spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Harm to curves, maps and motions. A map is two lands with a border of which some points are kept. A curve is a dense
/// polygon of which some points are kept; rivals are the polygon of these, and the same with rounded corners. A motion is a
/// function of time of which some poses are kept; the rivals are straight lines and Slerp.

enum
{
    TRUTH = 1500, ///< points of a true curve
    MAX_KEPT = 48,
    MIN_KEPT = 9,
    ROUND = 8, ///< points of half a rounded corner
    LEVELS = 5,
    MAX_PIECES = 12,
    MAX_WAVES = 8
};

static const double PI = 3.14159265358979323846;

// Curves

/// A true curve.
typedef struct line
{
    double points[2 * TRUTH];
    bool closed;
} line;

/// Spread TRUTH points evenly along a polygon of `count` points.
static void resample(const double *polygon, size_t count, bool closed, line *out)
{
    size_t edges = closed ? count : count - 1, at = 0;
    double total = 0, before = 0;
    for (size_t i = 0; i < edges; i++)
        total +=
            hypot(polygon[2 * ((i + 1) % count)] - polygon[2 * i], polygon[2 * ((i + 1) % count) + 1] - polygon[2 * i + 1]);
    for (size_t i = 0; i < TRUTH; i++)
    {
        double wanted = total * (double)i / (double)(closed ? TRUTH : TRUTH - 1), length;
        for (;; at++, before += length)
        {
            const double *a = polygon + 2 * at, *b = polygon + 2 * ((at + 1) % count);
            length = hypot(b[0] - a[0], b[1] - a[1]);
            if (wanted > before + length && at + 1 < edges)
                continue;
            double share = length > 0 ? fmin((wanted - before) / length, 1) : 0;
            out->points[2 * i] = a[0] + share * (b[0] - a[0]);
            out->points[2 * i + 1] = a[1] + share * (b[1] - a[1]);
            break;
        }
    }
    out->closed = closed;
}

/// A ring by a radius of few waves.
static void make_ring(bat_random *random, line *out)
{
    double height[MAX_WAVES], phase[MAX_WAVES];
    size_t waves = 2 + bat_random_bits(random) % (MAX_WAVES - 2);
    for (size_t k = 0; k < waves; k++)
    {
        height[k] = 0.25 * bat_random_normal(random) / (double)(k + 2);
        phase[k] = harm_between(random, 0, 2 * PI);
    }
    for (size_t i = 0; i < TRUTH; i++)
    {
        double angle = 2 * PI * (double)i / TRUTH, radius = 1;
        for (size_t k = 0; k < waves; k++)
            radius += height[k] * cos((double)(k + 2) * angle + phase[k]);
        out->points[2 * i] = radius * cos(angle);
        out->points[2 * i + 1] = radius * sin(angle);
    }
    out->closed = true;
}

/// A line of random directions that change slowly.
static void make_stroke(bat_random *random, line *out)
{
    double height[MAX_WAVES], phase[MAX_WAVES], x = 0, y = 0;
    for (size_t k = 0; k < MAX_WAVES; k++)
    {
        height[k] = 2 * bat_random_normal(random) / (double)(k + 1);
        phase[k] = harm_between(random, 0, 2 * PI);
    }
    for (size_t i = 0; i < TRUTH; i++)
    {
        double time = (double)i / TRUTH, angle = 0;
        for (size_t k = 0; k < MAX_WAVES; k++)
            angle += height[k] * sin(PI * (double)(k + 1) * time + phase[k]);
        x += cos(angle) / TRUTH;
        y += sin(angle) / TRUTH;
        out->points[2 * i] = x;
        out->points[2 * i + 1] = y;
    }
    out->closed = false;
}

/// Straight lines and arcs, with corners between them.
static void make_arcs(bat_random *random, line *out)
{
    enum
    {
        STEPS = 60
    };
    double polygon[2 * MAX_PIECES * STEPS], angle = harm_between(random, 0, 2 * PI), x = 0, y = 0;
    size_t pieces = 4 + bat_random_bits(random) % 6, count = 0;
    for (size_t p = 0; p < pieces; p++)
    {
        double length = harm_between(random, 0.3, 2),
               bend = bat_random_bits(random) % 3 == 0 ? 1.5 * bat_random_normal(random) : 0;
        for (size_t s = 0; s < STEPS; s++, count++)
        {
            angle += bend / STEPS;
            x += length / STEPS * cos(angle);
            y += length / STEPS * sin(angle);
            polygon[2 * count] = x;
            polygon[2 * count + 1] = y;
        }
        double turn = bat_random_bits(random) % 2 == 0 ? PI / 2 : harm_between(random, 0.3, 2);
        angle += bat_random_bits(random) % 2 == 0 ? turn : -turn;
    }
    resample(polygon, count, false, out);
}

/// A building: steps of right angles over a base.
static void make_steps(bat_random *random, line *out)
{
    double polygon[4 * MAX_PIECES], x = 0, y = 0, low = 0;
    size_t steps = 3 + bat_random_bits(random) % 6, count = 0;
    for (size_t i = 0; i < steps; i++)
    {
        y += (bat_random_bits(random) % 2 == 0 ? 1 : -1) * harm_between(random, 0.3, 2);
        low = fmin(low, y);
        for (int k = 0; k < 2; k++, count++)
        {
            polygon[2 * count] = x;
            polygon[2 * count + 1] = y;
            x += k == 0 ? harm_between(random, 0.3, 2) : 0;
        }
    }
    const double base[] = {x, low - 1, 0, low - 1};
    memcpy(polygon + 2 * count, base, sizeof base);
    resample(polygon, count + 2, true, out);
}

/// A rough line by displaced midpoints.
static void make_coast(bat_random *random, line *out)
{
    enum
    {
        HALVINGS = 10,
        POINTS = (1 << HALVINGS) + 1
    };
    double polygon[2 * POINTS] = {0}, roughness = harm_between(random, 0.4, 0.9);
    polygon[2 * (POINTS - 1)] = 1;
    for (int k = 0; k < HALVINGS; k++)
    {
        size_t step = (size_t)1 << (HALVINGS - k);
        for (size_t i = 0; i + step < POINTS; i += step)
            for (size_t c = 0; c < 2; c++)
                polygon[2 * (i + step / 2) + c] = (polygon[2 * i + c] + polygon[2 * (i + step) + c]) / 2 +
                                                  0.3 * pow(2, -roughness * (k + 1)) * bat_random_normal(random);
    }
    resample(polygon, POINTS, false, out);
}

/// Keep the points that a simplification by Douglas and Peucker keeps first. `kept` receives increasing indices.
static size_t keep_farthest(const line *truth, size_t wanted, size_t *kept)
{
    size_t count = 2;
    kept[0] = 0;
    kept[1] = TRUTH - 1;
    while (count < wanted)
    {
        size_t best = 0, after = 0;
        double most = -1;
        for (size_t k = 0; k + 1 < count; k++)
            for (size_t i = kept[k] + 1; i < kept[k + 1]; i++)
            {
                const double *a = truth->points + 2 * kept[k], *b = truth->points + 2 * kept[k + 1],
                             *p = truth->points + 2 * i;
                double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
                double share = square > 0 ? fmax(0, fmin(1, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square)) : 0;
                double distance = hypot(p[0] - a[0] - share * dx, p[1] - a[1] - share * dy);
                if (distance > most)
                {
                    most = distance;
                    best = i;
                    after = k;
                }
            }
        memmove(kept + after + 2, kept + after + 1, (count - after - 1) * sizeof *kept);
        kept[after + 1] = best;
        count++;
    }
    return count;
}

static int ascending_indices(const void *first, const void *second)
{
    size_t a = *(const size_t *)first, b = *(const size_t *)second;
    return (a > b) - (a < b);
}

/// Keep some of the points: evenly, at random, or those of a simplification.
static size_t keep_points(const line *truth, bat_random *random, size_t *kept)
{
    size_t wanted = MIN_KEPT + bat_random_bits(random) % (MAX_KEPT - MIN_KEPT + 1), how = bat_random_bits(random) % 3,
           count = 0;
    if (how == 2)
        return keep_farthest(truth, wanted, kept);
    for (size_t i = 0; i < wanted; i++)
        kept[i] =
            how == 1 ? bat_random_bits(random) % TRUTH : i * (truth->closed ? TRUTH : TRUTH - 1) / (wanted - !truth->closed);
    qsort(kept, wanted, sizeof *kept, ascending_indices);
    for (size_t i = 0; i < wanted; i++)
        if (count == 0 || kept[i] > kept[count - 1])
            kept[count++] = kept[i];
    return count;
}

/// The polygon with rounded corners: on either side of a vertex, a part of the edge is replaced, which is .3 of the shorter
/// edge beside it. `points` has room for 2 ROUND for each vertex.
static size_t round_corners(const bat_curve *polygon, double *points)
{
    static const double EXTENT = 0.3;
    size_t n = polygon->count, count = 0;
    const double *p = polygon->points;
    for (size_t i = 0; i < n; i++)
    {
        const double *at = p + 2 * i, *before = p + 2 * ((i + n - 1) % n), *after = p + 2 * ((i + 1) % n);
        bool end = !polygon->closed && (i == 0 || i + 1 == n);
        double back = hypot(at[0] - before[0], at[1] - before[1]), forth = hypot(after[0] - at[0], after[1] - at[1]);
        double reach = end ? 0 : EXTENT * fmin(back, forth);
        for (size_t k = 0; k < (end ? 1 : 2 * ROUND); k++, count++)
        {
            // A cubic of Bézier on either side of the vertex, which it passes along the mean of the directions.
            bool second = k >= ROUND;
            double t = (double)(k % ROUND) / ROUND, share = second ? t : t - 1, weight = 1 - fabs(share);
            for (size_t c = 0; c < 2 && !end; c++)
            {
                double u = (at[c] - before[c]) / back, v = (after[c] - at[c]) / forth,
                       mean = (u / back + v / forth) / (1 / back + 1 / forth);
                double along = share < 0 ? u : v;
                points[2 * count + c] = at[c] + reach * share * (along + (mean - along) * weight * weight);
            }
            if (end)
                memcpy(points + 2 * count, at, 2 * sizeof *at);
        }
    }
    return count;
}

/// The mean distance of a curve from the truth, both ways. Points are spread evenly along the curve first.
static bat_status error_of(const bat_curve *curve, const bat_curve *truth, double *mean, bat_error *error)
{
    bat_curve_measure_options options = bat_curve_measure_defaults();
    bat_curve_distance distance;
    line even;
    resample(curve->points, curve->count, curve->closed, &even);
    bat_curve spread = {.space = curve->space, .points = even.points, .count = TRUTH, .closed = curve->closed};
    options.to_segments = true;
    options.threads = 1;
    bat_status status = bat_curve_compare(&spread, truth, &options, &distance, error);
    if (status == BAT_OK)
        *mean = distance.mean_symmetric;
    return status;
}

/// The makers of true curves, and whether their files are drawings, in which corners are looked for.
static const struct
{
    void (*make)(bat_random *random, line *out);
    bool drawing;
} CURVES[] = {{make_ring, false}, {make_stroke, false}, {make_coast, false}, {make_arcs, true}, {make_steps, true}};

static bat_status run_curve(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const double RELATIVE_TOLERANCE = 0.02,
                        LEAST = 2e-3; // of files with features; of a mean edge, to count as an error
    bat_space plane = bat_euclidean(2);
    line truth;
    size_t kept[MAX_KEPT + 1];
    double points[2 * (MAX_KEPT + 1)], rounded[4 * ROUND * (MAX_KEPT + 1)], length = 0, of_polygon, of_rounded, ours;
    CURVES[variant].make(random, &truth);
    bat_curve exact = {.space = &plane, .points = truth.points, .count = TRUTH, .closed = truth.closed}, fine = {0};
    bat_curve coarse = {
        .space = &plane, .points = points, .count = keep_points(&truth, random, kept), .closed = truth.closed};
    for (size_t i = 0; i < coarse.count; i++)
        memcpy(points + 2 * i, truth.points + 2 * kept[i], 2 * sizeof *points);
    for (size_t i = 0; i + 1 < coarse.count; i++)
        length += hypot(points[2 * i + 2] - points[2 * i], points[2 * i + 3] - points[2 * i + 1]);
    bat_curve round = {.space = &plane, .points = rounded, .count = round_corners(&coarse, rounded), .closed = truth.closed};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    options.threads = 1;
    options.find_corners = CURVES[variant].drawing;
    options.relative_tolerance = CURVES[variant].drawing ? RELATIVE_TOLERANCE : 0;
    bat_status status = bat_curve_refine(&coarse, &options, &fine, error);
    if (status == BAT_OK)
        status = error_of(&coarse, &exact, &of_polygon, error);
    if (status == BAT_OK)
        status = error_of(&round, &exact, &of_rounded, error);
    if (status == BAT_OK)
        status = error_of(&fine, &exact, &ours, error);
    if (status == BAT_OK)
        *ratio = ours / fmax(fmin(of_polygon, of_rounded), LEAST * length / (double)(coarse.count - 1));
    bat_curve_free(&fine);
    return status;
}

// Maps

/// A land: the border there or back, and a corner far from it.
static bool add_land(const bat_curve *border, bool back, bat_curve *land)
{
    size_t n = border->count;
    *land = (bat_curve){.space = border->space, .points = memory_array(n + 1, 2 * sizeof(double)), .closed = true};
    if (land->points == NULL)
        return false;
    for (size_t i = 0; i < n; i++)
        memcpy(land->points + 2 * i, border->points + 2 * (back ? n - 1 - i : i), 2 * sizeof(double));
    const double corner[] = {0.5, back ? 9 : -9};
    memcpy(land->points + 2 * n, corner, sizeof corner);
    land->count = n + 1;
    return true;
}

/// The part of a refined land that was the border. `part` takes no memory of its own.
static bool find_border(const bat_curve *land, const double *first, const double *last, bat_curve *part)
{
    size_t begin = 0, end = 0;
    while (begin < land->count && memcmp(land->points + 2 * begin, first, 2 * sizeof *first) != 0)
        begin++;
    for (end = begin; end < land->count && memcmp(land->points + 2 * end, last, 2 * sizeof *last) != 0;)
        end++;
    *part = (bat_curve){.space = land->space, .points = land->points + 2 * begin, .count = end - begin + 1};
    return end < land->count;
}

/// Whether a border is another one backwards, to the bit.
static bool is_reverse(const bat_curve *border, const bat_curve *other)
{
    bool same = border->count == other->count;
    for (size_t i = 0; i < border->count && same; i++)
        same = memcmp(border->points + 2 * i, other->points + 2 * (other->count - 1 - i), 2 * sizeof(double)) == 0;
    return same;
}

/// A border that the lands do not share is harm without measure.
static bat_status run_map(bat_random *random, int variant, double *ratio, bat_error *error)
{
    bat_space plane = bat_euclidean(2);
    line truth;
    size_t kept[MAX_KEPT + 1];
    double points[2 * (MAX_KEPT + 1)], of_polygon = NAN, ours = NAN;
    CURVES[variant].make(random, &truth);
    bat_curve exact = {.space = &plane, .points = truth.points, .count = TRUTH}, borders[2];
    bat_curve coarse = {.space = &plane, .points = points, .count = keep_points(&truth, random, kept)};
    for (size_t i = 0; i < coarse.count; i++)
        memcpy(points + 2 * i, truth.points + 2 * kept[i], 2 * sizeof *points);
    const double *first = points, *last = points + 2 * (coarse.count - 1);
    bat_curve *lands = memory_array(2, sizeof *lands);
    if (lands == NULL)
        return error_memory(error, 2 * sizeof *lands);
    bool made = add_land(&coarse, false, &lands[0]);
    made = add_land(&coarse, true, &lands[1]) && made;
    bat_curve_set map = {0}, fine = {0};
    bat_status status = bat_curve_set_take(lands, 2, &map, error);
    bat_curve_map_refine_options options = bat_curve_map_refine_defaults();
    options.topology = BAT_CURVE_MAP_TOPOLOGY_ALWAYS; // as for files with features
    options.refine.threads = 1;
    if (status == BAT_OK)
        status = made ? bat_curve_map_refine(&map, &options, &fine, error) : error_memory(error, 0);
    bool found = status == BAT_OK && find_border(&fine.curves[0], first, last, &borders[0]) &&
                 find_border(&fine.curves[1], last, first, &borders[1]);
    if (found)
        status = error_of(&coarse, &exact, &of_polygon, error);
    if (found && status == BAT_OK)
        status = error_of(&borders[0], &exact, &ours, error);
    *ratio = found && is_reverse(&borders[0], &borders[1]) ? ours / of_polygon : INFINITY;
    bat_curve_set_free(&fine);
    bat_curve_set_free(&map);
    return status;
}

// Motions

enum
{
    KEYS = 40,
    SAMPLES = 8, ///< between two keys
    POSE = 7,    ///< numbers of a pose: x, y, z and a quaternion
};

/// A smooth motion of random waves.
typedef struct wavy
{
    double height[6][MAX_WAVES], phase[6][MAX_WAVES]; ///< of coordinates and of a rotation vector
    double stop;                                      ///< nothing moves from here on; beyond the end for none
    double rest[2];                                   ///< nothing moves between these times
} wavy;

static void pose_at(const wavy *motion, const bat_space *rigid, double time, double *pose)
{
    double values[6] = {0}, warped = fmin(time, motion->stop);
    warped = warped < motion->rest[0] ? warped : fmax(motion->rest[0], warped - (motion->rest[1] - motion->rest[0]));
    for (size_t c = 0; c < 6; c++)
        for (size_t k = 0; k < MAX_WAVES; k++)
            values[c] += motion->height[c][k] * sin((double)(k + 1) * warped + motion->phase[c][k]);
    const double unit[POSE] = {0, 0, 0, 1};
    (void)bat_space_exps(rigid, unit, values, 1, pose, NULL);
}

/// Times of the keys: even, uneven, in bursts.
static void key_times(bat_random *random, int variant, double *times)
{
    times[0] = 0;
    for (size_t i = 1; i < KEYS; i++)
    {
        double gap = variant == 1 ? harm_between(random, 0.3, 1.7) : variant == 2 && i % 8 != 0 ? 0.02 : 1;
        times[i] = times[i - 1] + 0.15 * gap;
    }
}

/// Distances of two poses: of places, and of rotations in radians.
static void add_squares(const double *first, const double *second, double sums[2])
{
    double dot = 0;
    for (size_t c = 0; c < 3; c++)
        sums[0] += (first[c] - second[c]) * (first[c] - second[c]);
    for (size_t c = 3; c < POSE; c++)
        dot += first[c] * second[c];
    double angle = 2 * atan2(sqrt(fmax(0, 1 - dot * dot)), fabs(dot));
    sums[1] += angle * angle;
}

static bat_status run_motion(bat_random *random, int variant, double *ratio, bat_error *error)
{
    static const double LEAST = 1e-6; // root mean square distances that count as none
    bat_space rigid;
    wavy motion = {.stop = INFINITY, .rest = {INFINITY, INFINITY}};
    double times[KEYS], keys[KEYS * POSE], ours[2] = {0}, lines[2] = {0};
    if (bat_space_by_name("rigid", 0, &rigid, error) != BAT_OK)
        return BAT_INVALID_ARGUMENT;
    for (size_t c = 0; c < 6; c++)
        for (size_t k = 0; k < MAX_WAVES; k++)
        {
            motion.height[c][k] = 0.4 * bat_random_normal(random) / (double)((k + 1) * (k + 1));
            motion.phase[c][k] = harm_between(random, 0, 2 * PI);
        }
    key_times(random, variant, times);
    if (variant == 3)
        motion.stop = harm_between(random, 0.4, 0.8) * times[KEYS - 1];
    if (variant == 4)
    {
        motion.rest[0] = harm_between(random, 0.2, 0.5) * times[KEYS - 1];
        motion.rest[1] = motion.rest[0] + harm_between(random, 0.1, 0.4) * times[KEYS - 1];
    }
    for (size_t i = 0; i < KEYS; i++)
        pose_at(&motion, &rigid, times[i], keys + i * POSE);
    bat_hermite_curve curve = {.space = &rigid, .points = keys, .times = times, .count = KEYS};
    bat_motion_spline *spline = NULL;
    bat_status status = bat_motion_spline_make(&curve, NULL, &spline, error);
    for (size_t i = 0; i + 1 < KEYS && status == BAT_OK; i++)
        for (size_t s = 1; s < SAMPLES && status == BAT_OK; s++)
        {
            double share = (double)s / SAMPLES, time = times[i] + share * (times[i + 1] - times[i]);
            double truth[POSE], pose[POSE], straight[POSE];
            pose_at(&motion, &rigid, time, truth);
            status = bat_motion_spline_at(spline, time, pose, NULL, NULL, error);
            if (status == BAT_OK)
                status = bat_space_geodesic(&rigid, keys + i * POSE, keys + (i + 1) * POSE, share, straight);
            add_squares(pose, truth, ours);
            add_squares(straight, truth, lines);
        }
    bat_motion_spline_free(spline);
    double count = (KEYS - 1) * (SAMPLES - 1), worst = 0;
    for (size_t c = 0; c < 2; c++)
        worst = fmax(worst, sqrt(ours[c] / count) / fmax(sqrt(lines[c] / count), LEAST));
    *ratio = worst;
    return status;
}

#define POLYGON "the polygon, or its corners rounded"
#define LINES "straight lines and Slerp"

const harm_kind HARM_LINES[] = {
    {"curves", "rings of few waves", POLYGON, run_curve, 0},
    {"curves", "strokes", POLYGON, run_curve, 1},
    {"curves", "rough lines", POLYGON, run_curve, 2},
    {"curves", "lines and arcs with corners, as drawings", POLYGON, run_curve, 3},
    {"curves", "buildings, as drawings", POLYGON, run_curve, 4},
    {"motions", "even keys", LINES, run_motion, 0},
    {"motions", "uneven keys", LINES, run_motion, 1},
    {"motions", "bursts of keys", LINES, run_motion, 2},
    {"motions", "with a sudden stop", LINES, run_motion, 3},
    {"motions", "with a rest", LINES, run_motion, 4},
};
const size_t HARM_LINE_COUNT = sizeof HARM_LINES / sizeof *HARM_LINES;

const harm_kind HARM_MAPS[] = {
    {"maps", "strokes as borders", "the polygon", run_map, 1},
    {"maps", "rough borders", "the polygon", run_map, 2},
};
const size_t HARM_MAP_COUNT = sizeof HARM_MAPS / sizeof *HARM_MAPS;

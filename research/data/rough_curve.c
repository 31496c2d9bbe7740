/// @file
/// Rough curves; see rough_curve.h.

#include "research/data/rough_curve.h"

#include "research/data/simplify.h"
#include "research/data/wave.h"

#include <assert.h>
#include <string.h>

enum
{
    MAX_HARMONICS = 300,
    /// Points of a curve before it is resampled.
    DENSE = 2 * SIMPLIFY_MAX_POINTS,
    MAX_CORNERS = 16
};

/// Add normal harmonics first … last of standard deviation k^-decay to `values`.
static void add_spectrum(bat_random *random, int first, int last, double decay, size_t count, double *values)
{
    for (int k = first; k <= last; k++)
    {
        double deviation = pow(k, -decay);
        double c = deviation * bat_random_normal(random), s = deviation * bat_random_normal(random);
        wave t = wave_make(k, 0, count);
        for (size_t i = 0; i < count; i++, wave_step(&t))
            values[i] += c * t.cosine + s * t.sine;
    }
}

/// A number of harmonics whose logarithm is uniform.
static int draw_harmonics(bat_random *random, int low)
{
    return (int)(low * pow((double)MAX_HARMONICS / low, bat_random_uniform(random)));
}

/// Resample a curve of `dense` points at `count` equal arc lengths.
static void resample(const double *from, size_t dense, bool closed, size_t count, double *points)
{
    double lengths[DENSE + 1];
    size_t pieces = closed ? dense : dense - 1;
    lengths[0] = 0;
    for (size_t i = 0; i < pieces; i++)
    {
        const double *p = from + 2 * i, *q = from + 2 * ((i + 1) % dense);
        lengths[i + 1] = lengths[i] + hypot(q[0] - p[0], q[1] - p[1]);
    }
    double step = lengths[pieces] / (double)(closed ? count : count - 1);
    size_t piece = 0;
    for (size_t k = 0; k < count; k++)
    {
        double target = step * (double)k;
        while (piece + 1 < pieces && lengths[piece + 1] < target)
            piece++;
        const double *p = from + 2 * piece, *q = from + 2 * ((piece + 1) % dense);
        double length = lengths[piece + 1] - lengths[piece], share = length > 0 ? (target - lengths[piece]) / length : 0;
        share = fmin(share, 1);
        points[2 * k] = p[0] + share * (q[0] - p[0]);
        points[2 * k + 1] = p[1] + share * (q[1] - p[1]);
    }
}

static size_t draw_radial(bat_random *random, double *points)
{
    double radius[DENSE] = {0}, largest = 0;
    double decay = draw_between(random, 0.9, 2.2);
    add_spectrum(random, 2, draw_harmonics(random, 10), decay, DENSE, radius);
    for (size_t i = 0; i < DENSE; i++)
        largest = fmax(largest, fabs(radius[i]));
    double strength = draw_between(random, 0.1, 0.6) / largest, aspect = draw_between(random, 0.3, 1);
    wave t = wave_make(1, 0, DENSE);
    for (size_t i = 0; i < DENSE; i++, wave_step(&t))
    {
        points[2 * i] = (1 + strength * radius[i]) * t.cosine;
        points[2 * i + 1] = aspect * (1 + strength * radius[i]) * t.sine;
    }
    return DENSE;
}

static size_t draw_spectral(bat_random *random, double *points)
{
    int last = draw_harmonics(random, 4);
    double decay = draw_between(random, 1.1, 2.5);
    double axis[2][DENSE] = {{0}, {0}};
    for (size_t a = 0; a < 2; a++)
        add_spectrum(random, 1, last, decay, DENSE, axis[a]);
    for (size_t i = 0; i < DENSE; i++)
        for (size_t a = 0; a < 2; a++)
            points[2 * i + a] = axis[a][i];
    return DENSE;
}

/// The direction has a few long waves, a meander of one wave length, and a rough part.
static size_t draw_direction(bat_random *random, double *points)
{
    double direction[DENSE] = {0}, rough[DENSE] = {0};
    add_spectrum(random, 1, 6, draw_between(random, 0.5, 1.5), DENSE, direction);
    int last = draw_harmonics(random, 8);
    double decay = draw_between(random, 0.5, 1.5), squares = 0;
    add_spectrum(random, 2, last, decay, DENSE, rough);
    for (size_t i = 0; i < DENSE; i++)
        squares += rough[i] * rough[i] / DENSE;
    double share = draw_between(random, 0.1, 1.2) / sqrt(squares + 1e-30);
    double meander = draw_coin(random) ? draw_between(random, 0, 1.6) : 0;
    double phase = draw_angle(random);
    wave t = wave_make(draw_between(random, 4, 25), phase, DENSE);
    double long_waves = draw_between(random, 0.2, 1.5), x = 0, y = 0;
    for (size_t i = 0; i < DENSE; i++, wave_step(&t))
    {
        double angle = long_waves * direction[i] + share * rough[i] + meander * t.cosine;
        points[2 * i] = x += cos(angle) / DENSE;
        points[2 * i + 1] = y += sin(angle) / DENSE;
    }
    return DENSE;
}

/// The corners of a star-shaped polygon, or of a row of columns with right angles.
static size_t draw_polygon(bat_random *random, double *corners)
{
    if (draw_coin(random))
    {
        size_t count = (size_t)draw_whole(random, 3, 12);
        for (size_t i = 0; i < count; i++)
        {
            double angle = 2 * WAVE_PI * ((double)i + draw_between(random, -0.4, 0.4)) / (double)count;
            double radius = draw_between(random, 0.35, 1.2);
            corners[2 * i] = radius * cos(angle);
            corners[2 * i + 1] = radius * sin(angle);
        }
        return count;
    }
    size_t columns = (size_t)draw_whole(random, 1, 4), count = 0;
    double x[5] = {0};
    for (size_t c = 0; c < columns; c++)
        x[c + 1] = x[c] + draw_between(random, 0.2, 1);
    for (int side = 0; side < 2; side++)
        for (size_t c = 0; c < columns; c++)
        {
            size_t column = side == 0 ? c : columns - 1 - c;
            bool flat = side == 0 && draw_coin(random);
            double y = side == 0 ? (flat ? -0.2 : -draw_between(random, 0.2, 1)) : draw_between(random, 0.2, 1);
            corners[2 * count] = x[side == 0 ? column : column + 1];
            corners[2 * count++ + 1] = y;
            corners[2 * count] = x[side == 0 ? column + 1 : column];
            corners[2 * count++ + 1] = y;
        }
    return count;
}

/// Rounds each corner with even chance, by the parabola that touches the sides.
static size_t draw_corners(bat_random *random, double *points)
{
    enum
    {
        ROUND = 64 ///< points of a rounded corner
    };
    double corners[2 * MAX_CORNERS];
    size_t count = draw_polygon(random, corners), made = 0;
    double rounding = draw_between(random, 0, 1);
    for (size_t i = 0; i < count; i++)
    {
        const double *p = corners + 2 * ((i + count - 1) % count), *q = corners + 2 * i,
                     *r = corners + 2 * ((i + 1) % count);
        bool round = bat_random_uniform(random) < rounding;
        double share = draw_between(random, 0.05, 0.5);
        for (int k = 0; k <= ROUND && (round || k == 0); k++)
            for (size_t a = 0; a < 2; a++)
            {
                double t = (double)k / ROUND, begin = q[a] + share * (p[a] - q[a]), end = q[a] + share * (r[a] - q[a]);
                double rounded = (1 - t) * (1 - t) * begin + 2 * t * (1 - t) * q[a] + t * t * end;
                points[2 * made + a] = round ? rounded : q[a];
                made += a;
            }
    }
    return made;
}

/// The two sides of a path of lines and arcs, joined by straight ends.
static size_t draw_stroke(bat_random *random, double *points)
{
    enum
    {
        STEPS = 120, ///< of a piece of the path
        MAX_PIECES = 4,
        MAX_PATH = MAX_PIECES * STEPS + 1
    };
    double width = draw_between(random, 0.05, 0.2), x = 0, y = 0, angle = 0;
    double side[2][2 * MAX_PATH];
    int pieces = draw_whole(random, 1, MAX_PIECES);
    size_t path = 0;
    for (int piece = 0; piece < pieces; piece++)
    {
        bool straight = draw_coin(random);
        double radius = width * 1.2 + draw_between(random, 0.05, 0.6);
        double turn = straight ? 0 : draw_between(random, 0.5, 3) * (draw_coin(random) ? 1 : -1);
        double step = (straight ? draw_between(random, 0.2, 1) : radius * fabs(turn)) / STEPS;
        for (int k = 0; k < STEPS + (piece + 1 == pieces); k++, path++)
        {
            for (int s = 0; s < 2; s++)
            {
                double out = s == 0 ? width : -width;
                side[s][2 * path] = x - out * sin(angle);
                side[s][2 * path + 1] = y + out * cos(angle);
            }
            angle += 0.5 * turn / STEPS;
            x += step * cos(angle);
            y += step * sin(angle);
            angle += 0.5 * turn / STEPS;
        }
    }
    memcpy(points, side[0], 2 * path * sizeof *points);
    for (size_t i = 0; i < path; i++)
        memcpy(points + 2 * (path + i), side[1] + 2 * (path - 1 - i), 2 * sizeof *points);
    return 2 * path;
}

/// A path of straight lines, arcs and rough pieces, with corners between them: borders, railways and surveyed lines.
static size_t draw_pieces(bat_random *random, double *points)
{
    enum
    {
        MAX_PIECES = 12,
    };
    enum
    {
        STRAIGHT,
        ARC,
        ROUGH,
        KINDS
    };
    static const double CORNERS[] = {0, 0, 0.5, 1};
    int pieces = draw_whole(random, 2, MAX_PIECES);
    double corner_share = CORNERS[draw_whole(random, 0, 3)], lengths[MAX_PIECES], total = 0, heading = draw_angle(random);
    for (int i = 0; i < pieces; i++)
        total += lengths[i] = exp(draw_between(random, -2, 1));
    double step = total / DENSE, x = 0, y = 0;
    size_t made = 0;
    for (int i = 0; i < pieces; i++)
    {
        int kind = draw_whole(random, 0, KINDS - 1);
        double turn = kind == ARC ? bat_random_normal(random) * 1.5 / lengths[i] : 0, wander = 0;
        // The direction of a rough piece wanders about its mean (an Ornstein-Uhlenbeck process).
        double return_rate = fmin(step / (lengths[i] * exp(draw_between(random, -5, -1))), 1);
        double deviation = kind == ROUGH ? draw_between(random, 0.2, 1.3) : 0;
        for (double along = 0; along < lengths[i] && made < DENSE; along += step)
        {
            wander += sqrt(2 * return_rate) * deviation * bat_random_normal(random) - return_rate * wander;
            heading += turn * step;
            points[2 * made] = x += step * cos(heading + wander);
            points[2 * made++ + 1] = y += step * sin(heading + wander);
        }
        if (bat_random_uniform(random) < corner_share)
            heading += (draw_coin(random) ? 1 : -1) * (draw_coin(random) ? WAVE_PI / 2 : draw_between(random, 0.2, 2.2));
    }
    return made;
}

/// Begin a closed curve at the point that is farthest from its mean.
static void begin_at_farthest(size_t count, double *points)
{
    double rotated[2 * SIMPLIFY_MAX_POINTS], largest = -1;
    size_t farthest = 0;
    for (size_t i = 0; i < count; i++)
    {
        double squared = points[2 * i] * points[2 * i] + points[2 * i + 1] * points[2 * i + 1];
        farthest = squared > largest ? i : farthest;
        largest = fmax(squared, largest);
    }
    memcpy(rotated, points + 2 * farthest, 2 * (count - farthest) * sizeof *points);
    memcpy(rotated + 2 * (count - farthest), points, 2 * farthest * sizeof *points);
    memcpy(points, rotated, 2 * count * sizeof *points);
}

bool rough_curve_draw(rough_family family, bat_random *random, size_t count, double *points)
{
    assert(count <= SIMPLIFY_MAX_POINTS);
    static size_t (*const DRAW[ROUGH_COUNT])(bat_random *, double *) = {
        [ROUGH_RADIAL] = draw_radial,   [ROUGH_SPECTRAL] = draw_spectral, [ROUGH_DIRECTION] = draw_direction,
        [ROUGH_CORNERS] = draw_corners, [ROUGH_STROKE] = draw_stroke,     [ROUGH_PIECES] = draw_pieces,
    };
    double dense[2 * DENSE];
    bool closed = family != ROUGH_DIRECTION && family != ROUGH_PIECES;
    size_t made = DRAW[family](random, dense);
    resample(dense, made, closed, count, points);
    centre_and_scale(count, 1, points);
    if (closed)
        begin_at_farthest(count, points);
    return closed;
}

void rough_curve_simplify(bat_random *random, bool closed, size_t corners, size_t count, double *points)
{
    static const curve_sampling HOW[] = {CURVE_SAMPLING_EVEN, CURVE_SAMPLING_UNEVEN, CURVE_SAMPLING_DOUGLAS_PEUCKER,
                                         CURVE_SAMPLING_VISVALINGAM};
    size_t samples[SIMPLIFY_MAX_POINTS];
    double polyline[2 * SIMPLIFY_MAX_POINTS];
    curve_sample(HOW[draw_whole(random, 0, 3)], points, count, closed, corners, random, samples);
    for (size_t i = 0; i < corners; i++)
        memcpy(polyline + 2 * i, points + 2 * samples[i], 2 * sizeof *points);
    resample(polyline, corners, closed, count, points);
    centre_and_scale(count, 1, points);
    if (closed)
        begin_at_farthest(count, points);
}

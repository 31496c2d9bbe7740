#include "curve/network/learned_features.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// A polygon that turns by less than this is straight.
static const double STRAIGHT = 1e-6;
/// Root mean square turn from which on an edge's surroundings count as coarse, in one of the features.
static const double FINE = 0.05;
/// Brings exterior angles to the size of the other features.
static const double ANGLE_UNIT = 0.6;

/// Added to 2 sin(|d| / 2) of a vertex, so that a straight one has a logarithm.
static const double FLAT = 1e-3;
/// Products of neighbouring angles below it hardly count as turns.
static const double FAINT = 1e-2;

enum
{
    R = LEARNED_REACH,
    W = LEARNED_RANGE,
    MIDDLE = 3 ///< on either side: the turns whose variance is taken
};
/// The six-point rule in turns, by distance from the edge.
static const double SIX_POINT[2] = {-5.0 / 32, 1.0 / 32};

/// What both directions need. Turn i of the polygon is turn[i + R - 1], i = 1 - R … R.
typedef struct edge_turns
{
    double turn[2 * R];
    double strength, strength_squared; ///< root mean square of the turns
    double mean, variance;             ///< of the middle turns
    double scale;
    double bend; ///< root mean square of the exterior angles
} edge_turns;

static double span_at(const double *lengths, int vertex)
{
    return fmax(lengths[vertex - 1] + lengths[vertex], lengths[0]);
}

static edge_turns turns_of(const double *angles, const double *lengths)
{
    edge_turns t = {.strength_squared = STRAIGHT * STRAIGHT};
    double squares = STRAIGHT * STRAIGHT;
    for (int i = 1 - R; i <= R; i++)
    {
        squares += angles[i] * angles[i] / (2 * R);
        double turn = 2 * angles[i] * lengths[0] / span_at(lengths, i);
        t.turn[i + R - 1] = turn;
        t.strength_squared += turn * turn / (2 * R);
    }
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        t.mean += t.turn[i] / (2 * MIDDLE);
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        t.variance += (t.turn[i] - t.mean) * (t.turn[i] - t.mean) / (2 * MIDDLE);
    t.strength = sqrt(t.strength_squared);
    t.scale = sqrt(t.variance + t.strength_squared * t.strength_squared) / (1 + t.strength);
    t.bend = sqrt(squares);
    return t;
}

/// ln(length / own) within (-3, 3).
static double log_ratio(double length, double own)
{
    double x = log(length / own);
    return x / sqrt(1 + x * x / 9);
}

/// The derivative by ln(length / own).
static double log_ratio_slope(double length, double own)
{
    double x = log(length / own), s = 1 / (1 + x * x / 9);
    return s * sqrt(s);
}

/// Sums of values and of their squares.
typedef struct moments
{
    double count, sum, squares;
} moments;

static void moments_add(moments *m, double value)
{
    m->count++;
    m->sum += value;
    m->squares += value * value;
}

/// The standard deviation x as x / (1 + x).
static double bounded_deviation(const moments *m)
{
    double mean = m->sum / m->count, deviation = sqrt(fmax(m->squares / m->count - mean * mean, 0));
    return deviation / (1 + deviation);
}

/// x within (-3, 3).
static double bounded(double x)
{
    return x / sqrt(1 + x * x / 9);
}

/// The ratio of a length to the edge's own, within bounds whose products are finite.
static double bounded_ratio(double length, double own)
{
    return fmin(fmax(length / own, 1e-100), 1e100);
}

/// The statistics of LEARNED_STATISTICS. Logarithms are those of ratios to the edge's own length.
static void find_statistics(const double *angles, const double *lengths, double *statistics)
{
    moments deviations = {0}, areas = {0}, sizes = {0};
    double same = 0;
    for (int i = -W; i <= W; i++)
        moments_add(&sizes, log(bounded_ratio(lengths[i], lengths[0])));
    for (int i = 1 - W; i <= W; i++)
    {
        double before = bounded_ratio(lengths[i - 1], lengths[0]), after = bounded_ratio(lengths[i], lengths[0]);
        double turn = 2 * sin(0.5 * fabs(angles[i])) + FLAT, area = before * after * turn;
        moments_add(&deviations, log(area / (before + after)));
        moments_add(&areas, log(area));
    }
    for (int i = 1 - W; i < W; i++)
    {
        double product = angles[i] * angles[i + 1];
        same += product / (fabs(product) + FAINT);
    }
    statistics[0] = bounded(deviations.sum / deviations.count);
    statistics[1] = bounded_deviation(&deviations);
    statistics[2] = bounded_deviation(&areas);
    statistics[3] = bounded_deviation(&sizes);
    statistics[4] = same / (2 * W - 1);
}

double learned_angle(learned_edge edge, double correction, double gate)
{
    return edge.base * (1 + tanh(gate)) + edge.scale * tanh(correction);
}

learned_edge learned_features_of(const double *angles, const double *lengths, learned_setting setting, double *features)
{
    const edge_turns t = turns_of(angles, lengths);
    const double *right = t.turn + R, *left = t.turn + R - 1, own = lengths[0];
    const double area = fmin(own * own, DBL_MAX); // of the plane's long edges, whose curvature is 0
    double *kept = features, *second = kept + R + LEARNED_SCALARS, *first = second + R + 1, *both = first + 2 * R;
    for (int i = 1; i <= R; i++)
    {
        double before = log_ratio(lengths[-i], own), after = log_ratio(lengths[i], own);
        kept[i - 1] = 0.5 * (after + before);
        second[i - 1] = 0.5 * (after - before);
    }
    kept[R] = t.strength / (1 + t.strength);
    kept[R + 1] = t.strength / (FINE + t.strength);
    kept[R + 2] = t.variance / t.strength_squared;
    kept[R + 3] = t.bend / (1 + t.bend);
    kept[R + 4] = setting.curvature * area / (1 + area);
    kept[R + 5] = setting.fairness;
    kept[R + 6] = setting.level;
    double *statistics = kept + R + LEARNED_PLAIN_SCALARS;
    memset(statistics, 0, LEARNED_STATISTICS * sizeof *statistics);
    if (setting.level == 0)
        find_statistics(angles, lengths, statistics);
    second[R] = setting.parity;
    for (int i = 0; i < R; i++)
    {
        first[i] = 0.5 * (right[i] + left[-i]) / t.strength;
        both[i] = 0.5 * (right[i] - left[-i]) / t.strength;
        first[R + i] = 0.5 * ANGLE_UNIT * (angles[1 + i] + angles[-i]);
        both[R + i] = 0.5 * ANGLE_UNIT * (angles[1 + i] - angles[-i]);
    }
    double base = 0;
    for (int i = 0; i < 2; i++)
        base += SIX_POINT[i] * (right[i] + left[-i]);
    return (learned_edge){base, t.scale};
}

/// The gradient with respect to the turns.
static void turns_back(const edge_turns *t, const double *feature_gradient, learned_edge edge, double *turn_gradient)
{
    const double *kept = feature_gradient, *first = kept + 2 * R + 1 + LEARNED_SCALARS, *both = first + 2 * R;
    double *right = turn_gradient + R, *left = turn_gradient + R - 1, inverse = 1 / t->strength;
    const double *right_turn = t->turn + R, *left_turn = t->turn + R - 1;
    double by_strength = kept[R] / ((1 + t->strength) * (1 + t->strength)) +
                         kept[R + 1] * FINE / ((FINE + t->strength) * (FINE + t->strength)) -
                         2 * kept[R + 2] * t->variance * inverse / t->strength_squared;
    double by_variance = kept[R + 2] / t->strength_squared;
    for (int i = 0; i < R; i++)
    {
        right[i] = 0.5 * inverse * (first[i] + both[i]);
        left[-i] = 0.5 * inverse * (first[i] - both[i]);
        by_strength -= inverse * (right[i] * right_turn[i] + left[-i] * left_turn[-i]);
    }
    // scale = sqrt(variance + strength^4) / (1 + strength)
    double root = t->scale * (1 + t->strength);
    by_variance += edge.scale / (2 * root * (1 + t->strength));
    by_strength += edge.scale * (2 * t->strength * t->strength_squared / root - t->scale) / (1 + t->strength);
    for (int i = 0; i < 2; i++)
    {
        right[i] += SIX_POINT[i] * edge.base;
        left[-i] += SIX_POINT[i] * edge.base;
    }
    for (int i = 0; i < 2 * R; i++)
        turn_gradient[i] += by_strength * t->turn[i] * inverse / (2 * R);
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        turn_gradient[i] += by_variance * (t->turn[i] - t->mean) / MIDDLE;
}

void learned_features_back(const double *angles, const double *lengths, learned_setting setting,
                           const double *feature_gradient, learned_edge edge_gradient, double *angle_gradient,
                           double *length_gradient)
{
    const edge_turns t = turns_of(angles, lengths);
    const double *kept = feature_gradient, *second = kept + R + LEARNED_SCALARS, own = lengths[0];
    const double *first = second + R + 1, *both = first + 2 * R;
    double turn_gradient[2 * R], by_own = 0;
    turns_back(&t, feature_gradient, edge_gradient, turn_gradient);
    double by_bend = kept[R + 3] / ((1 + t.bend) * (1 + t.bend));
    for (int i = 1 - R; i <= R; i++)
        angle_gradient[i] += by_bend * angles[i] / (t.bend * 2 * R);
    for (int i = 0; i < R; i++)
    {
        angle_gradient[1 + i] += 0.5 * ANGLE_UNIT * (first[R + i] + both[R + i]);
        angle_gradient[-i] += 0.5 * ANGLE_UNIT * (first[R + i] - both[R + i]);
    }
    for (int i = 1 - R; i <= R; i++)
    {
        double span = span_at(lengths, i), gradient = turn_gradient[i + R - 1], turn = t.turn[i + R - 1];
        angle_gradient[i] += gradient * 2 * own / span;
        by_own += gradient * turn / own;
        double by_span = -gradient * turn / span;
        if (lengths[i - 1] + lengths[i] > own)
        {
            length_gradient[i - 1] += by_span;
            length_gradient[i] += by_span;
        }
        else
            by_own += by_span;
    }
    for (int i = 1; i <= R; i++)
    {
        double before = 0.5 * (kept[i - 1] - second[i - 1]) * log_ratio_slope(lengths[-i], own);
        double after = 0.5 * (kept[i - 1] + second[i - 1]) * log_ratio_slope(lengths[i], own);
        length_gradient[-i] += before / lengths[-i];
        length_gradient[i] += after / lengths[i];
        by_own -= (before + after) / own;
    }
    double area = own * own;
    by_own += kept[R + 4] * setting.curvature * 2 * own / ((1 + area) * (1 + area));
    length_gradient[0] += by_own;
}

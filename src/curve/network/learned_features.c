#include "curve/network/learned_features.h"

#include "batten/curve_scheme.h"
#include "curve/edge_turns.h"

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
/// Share of the turns around an edge below which its own are rounding.
static const double ROUNDING = 1e-6;
/// Vertices with smaller angles count as nearly straight.
static const double NEARLY_STRAIGHT = 0.1;
/// The farthest that a new vertex lies from its edge, in lengths of the edge beside it.
static const double BULGE = 1;

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
    double scale;                      ///< without the factor
    double bend;                       ///< root mean square of the exterior angles
    double factor;                     ///< edge_straight_factor()
} edge_turns;

static edge_turns turns_of(const double *angles, const double *lengths)
{
    edge_turns t = {.strength_squared = STRAIGHT * STRAIGHT};
    double squares = STRAIGHT * STRAIGHT;
    for (int i = 1 - R; i <= R; i++)
    {
        squares += angles[i] * angles[i] / (2 * R);
        double turn = edge_turn(angles[i], lengths[i - 1], lengths[i], lengths[0]);
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
    // Within a long straight run all four turns are rounding, and only those beyond tell that it is none of a curve.
    double least = edge_least_turn(t.turn + R - 2) / (ROUNDING * t.strength);
    t.factor = edge_straight_factor(t.turn + R - 2) * fmin(least, 1);
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

/// Moments and extremes of a number of values.
typedef struct moments
{
    double count, sum, squares, least, greatest;
} moments;

static moments moments_make(void)
{
    return (moments){.least = INFINITY, .greatest = -INFINITY};
}

static void moments_add(moments *m, double value)
{
    m->count++;
    m->sum += value;
    m->squares += value * value;
    m->least = fmin(m->least, value);
    m->greatest = fmax(m->greatest, value);
}

static double mean_of(const moments *m)
{
    return m->sum / m->count;
}

static double variance_of(const moments *m)
{
    double mean = mean_of(m);
    return fmax(m->squares / m->count - mean * mean, 0);
}

/// The standard deviation x as x / (1 + x).
static double bounded_deviation(const moments *m)
{
    double deviation = sqrt(variance_of(m));
    return deviation / (1 + deviation);
}

/// x within (-3, 3).
static double bounded(double x)
{
    return x / sqrt(1 + x * x / 9);
}

/// The correlation of two sets of values, between -1 and 1, near 0 where one hardly varies.
static double correlation(const moments *a, const moments *b, double products)
{
    double covariance = products / a->count - mean_of(a) * mean_of(b);
    return covariance / sqrt((variance_of(a) + FAINT) * (variance_of(b) + FAINT));
}

/// The ratio of a length to the edge's own, within bounds whose products are finite.
static double bounded_ratio(double length, double own)
{
    return fmin(fmax(length / own, 1e-100), 1e100);
}

/// The statistics of LEARNED_STATISTICS. Logarithms are those of ratios to the edge's own length.
static void find_statistics(const double *angles, const double *lengths, double *statistics)
{
    moments deviations = moments_make(), areas = moments_make(), sizes = moments_make(), turns = moments_make(),
            spans = moments_make();
    double ratios[2 * W + 1], logs[2 * W + 1], same = 0, straight = 0, alike = 0, with_span = 0;
    for (int i = -W; i <= W; i++)
    {
        ratios[i + W] = bounded_ratio(lengths[i], lengths[0]);
        logs[i + W] = log(ratios[i + W]);
        moments_add(&sizes, logs[i + W]);
        alike += i > -W ? logs[i + W] * logs[i + W - 1] : 0;
    }
    alike += logs[0] * logs[2 * W]; // as many products as values
    for (int i = 1 - W; i <= W; i++)
    {
        double before = ratios[i + W - 1], after = ratios[i + W], size = fabs(angles[i]);
        double turn = log(2 * sin(0.5 * size) + FLAT), span = log(before + after);
        double area = logs[i + W - 1] + logs[i + W] + turn;
        moments_add(&deviations, area - span);
        moments_add(&areas, area);
        moments_add(&turns, size);
        moments_add(&spans, span);
        with_span += size * span;
        straight += NEARLY_STRAIGHT * NEARLY_STRAIGHT / (NEARLY_STRAIGHT * NEARLY_STRAIGHT + size * size);
    }
    for (int i = 1 - W; i < W; i++)
    {
        double product = angles[i] * angles[i + 1];
        same += product / (fabs(product) + FAINT);
    }
    const double found[LEARNED_STATISTICS] = {
        bounded(mean_of(&deviations)),
        bounded_deviation(&deviations),
        bounded_deviation(&areas),
        bounded_deviation(&sizes),
        same / (2 * W - 1),
        mean_of(&turns),
        sqrt(variance_of(&turns)),
        straight / (2 * W),
        bounded(mean_of(&deviations) - deviations.least),
        bounded(deviations.greatest - mean_of(&deviations)),
        bounded(mean_of(&areas) - areas.least),
        bounded(sizes.greatest - mean_of(&sizes)),
        correlation(&sizes, &sizes, alike),
        correlation(&turns, &spans, with_span),
    };
    memcpy(statistics, found, sizeof found);
}

/// The edge whose length bounds the insertion angle.
static int bounding_edge(const double *lengths, double parity)
{
    return parity > 0 ? -1 : parity < 0 ? 1 : lengths[-1] > lengths[1] ? -1 : 1;
}

/// The bound of the insertion angle that keeps the new vertex near its edge.
static double limit_of(const double *lengths, double parity)
{
    return fmin(atan(2 * BULGE * lengths[bounding_edge(lengths, parity)] / lengths[0]), BAT_CURVE_ANGLE_LIMIT);
}

static void limit_back(const double *lengths, double parity, double gradient, double *length_gradient)
{
    if (gradient == 0 || limit_of(lengths, parity) >= BAT_CURVE_ANGLE_LIMIT)
        return;
    int beside = bounding_edge(lengths, parity);
    double slope = 2 * BULGE * lengths[beside] / lengths[0], by_slope = gradient / (1 + slope * slope);
    length_gradient[beside] += by_slope * 2 * BULGE / lengths[0];
    length_gradient[0] -= by_slope * slope / lengths[0];
}

/// The six-point rule of four turns, without the factor.
static double rule_of(const double turns[EDGE_VERTICES])
{
    return SIX_POINT[0] * (turns[1] + turns[2]) + SIX_POINT[1] * (turns[0] + turns[3]);
}

double learned_later(const double *angles, const double *lengths)
{
    double turns[EDGE_VERTICES], factor = edge_turns_of(angles - 1, lengths - 2, turns);
    return factor * rule_of(turns);
}

double learned_angle(learned_edge edge, double correction, double gate)
{
    double angle = edge.base * (1 + tanh(gate)) + edge.scale * tanh(correction);
    return angle > edge.limit ? edge.limit : angle < -edge.limit ? -edge.limit : angle;
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
    return (learned_edge){t.factor * rule_of(t.turn + R - 2), t.factor * t.scale, limit_of(lengths, setting.parity)};
}

/// The derivative of edge_corner_weight().
static double edge_corner_slope(double angle)
{
    double sum = angle * angle + EDGE_CORNER_ANGLE * EDGE_CORNER_ANGLE;
    return 2 * angle * EDGE_CORNER_ANGLE * EDGE_CORNER_ANGLE / (sum * sum);
}

/// The gradient of edge_near_turn() with respect to the angle, besides that by the turn, which is returned.
static double near_turn_back(double angle, double turn, double own, double other, double gradient, double *by_angle,
                             double *by_own, double *by_other)
{
    double weight = edge_corner_weight(angle), share = edge_corner_share(own, other);
    double by_weight = gradient * (2 * angle * share - turn), by_share = gradient * weight * 2 * angle;
    *by_angle += gradient * weight * 2 * share + by_weight * edge_corner_slope(angle);
    *by_own += own > other ? -by_share * 0.5 * other / (own * own) : -by_share * 0.5 / other;
    *by_other += own > other ? by_share * 0.5 / own : by_share * 0.5 * own / (other * other);
    return gradient * (1 - weight);
}

/// The same of edge_far_turn().
static double far_turn_back(double angle, double turn, double own, double other, double gradient, double *by_angle,
                            double *by_own, double *by_other)
{
    if (other >= own)
        return gradient;
    double weight = edge_corner_weight(angle), loss = edge_far_loss(own, other);
    double ratio = other / own, squares = 1 + ratio * ratio;
    double by_ratio = gradient * turn * weight * 2 * (1 - ratio) * (1 + ratio) / (squares * squares);
    *by_angle -= gradient * turn * loss * edge_corner_slope(angle);
    *by_own -= by_ratio * ratio / own;
    *by_other += by_ratio / own;
    return gradient * (1 - weight * loss);
}

static double sign_of(double x)
{
    return x > 0 ? 1 : x < 0 ? -1 : 0;
}

/// The derivative of edge_inflection(u, v) with respect to u.
static double inflection_slope(double u, double v)
{
    double sum = fabs(u) + fabs(v) + DBL_MIN;
    return -u * v > 0 ? (u * v * sign_of(u) / sum - v) / sum : 0;
}

/// The gradient of edge_straight_factor() with respect to the turns.
static void straight_factor_back(const double *y, double gradient, double *by_turn)
{
    double factor = edge_straight_factor(y);
    if (factor >= 1 || factor == 0)
        return;
    double first = fabs(y[1]) + edge_inflection(y[0], y[2]), second = fabs(y[2]) + edge_inflection(y[1], y[3]);
    int largest = 0, end = first < second ? 1 : 2;
    for (int i = 1; i < EDGE_VERTICES; i++)
        largest = fabs(y[i]) > fabs(y[largest]) ? i : largest;
    double bound = EDGE_STRAIGHT_SHARE * fabs(y[largest]), by_least = gradient / bound;
    by_turn[end] += by_least * sign_of(y[end]);
    by_turn[end - 1] += by_least * inflection_slope(y[end - 1], y[end + 1]);
    by_turn[end + 1] += by_least * inflection_slope(y[end + 1], y[end - 1]);
    by_turn[largest] -= gradient * factor / fabs(y[largest]) * sign_of(y[largest]);
}

/// The gradient of edge_turns_of(). That with respect to the turns y_i is added to `by_turn`; that with respect to angles
/// and lengths does not contain it.
static void edge_turns_back(const double *angle, const double *length, const double gradient[EDGE_VERTICES],
                            double by_factor, double *by_turn, double *by_angle, double *by_length)
{
    double y[EDGE_VERTICES];
    for (int i = 0; i < EDGE_VERTICES; i++)
        y[i] = edge_turn(angle[i], length[i], length[i + 1], length[2]);
    by_turn[0] += far_turn_back(angle[0], y[0], length[2], length[1], gradient[0], by_angle, by_length + 2, by_length + 1);
    by_turn[1] +=
        near_turn_back(angle[1], y[1], length[2], length[1], gradient[1], by_angle + 1, by_length + 2, by_length + 1);
    by_turn[2] +=
        near_turn_back(angle[2], y[2], length[2], length[3], gradient[2], by_angle + 2, by_length + 2, by_length + 3);
    by_turn[3] +=
        far_turn_back(angle[3], y[3], length[2], length[3], gradient[3], by_angle + 3, by_length + 2, by_length + 3);
    straight_factor_back(y, by_factor, by_turn);
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
    // scale = factor sqrt(variance + strength^4) / (1 + strength)
    double root = t->scale * (1 + t->strength), by_scale = edge.scale * t->factor;
    by_variance += by_scale / (2 * root * (1 + t->strength));
    by_strength += by_scale * (2 * t->strength * t->strength_squared / root - t->scale) / (1 + t->strength);
    const double *turns = t->turn + R - 2;
    double *to = turn_gradient + R - 2, by_near = edge.base * t->factor * SIX_POINT[0];
    double by_far = edge.base * t->factor * SIX_POINT[1];
    to[0] += by_far;
    to[1] += by_near;
    to[2] += by_near;
    to[3] += by_far;
    straight_factor_back(turns, edge.base * rule_of(turns) + edge.scale * t->scale, to);
    for (int i = 0; i < 2 * R; i++)
        turn_gradient[i] += by_strength * t->turn[i] * inverse / (2 * R);
    for (int i = R - MIDDLE; i < R + MIDDLE; i++)
        turn_gradient[i] += by_variance * (t->turn[i] - t->mean) / MIDDLE;
}

/// The gradient of edge_turn() number i of the polygon, with respect to the angle and the lengths.
static void turn_back(const double *angles, const double *lengths, int i, double gradient, double *angle_gradient,
                      double *length_gradient)
{
    double own = lengths[0], span = fmax(lengths[i - 1] + lengths[i], own);
    double turn = edge_turn(angles[i], lengths[i - 1], lengths[i], own);
    angle_gradient[i] += gradient * 2 * own / span;
    length_gradient[0] += gradient * turn / own;
    double by_span = -gradient * turn / span;
    if (lengths[i - 1] + lengths[i] > own)
    {
        length_gradient[i - 1] += by_span;
        length_gradient[i] += by_span;
    }
    else
        length_gradient[0] += by_span;
}

void learned_later_back(const double *angles, const double *lengths, double gradient, double *angle_gradient,
                        double *length_gradient)
{
    double turns[EDGE_VERTICES], turn_gradient[EDGE_VERTICES] = {0};
    double factor = edge_turns_of(angles - 1, lengths - 2, turns);
    double by_near = gradient * factor * SIX_POINT[0], by_far = gradient * factor * SIX_POINT[1];
    const double by_bounded[EDGE_VERTICES] = {by_far, by_near, by_near, by_far};
    edge_turns_back(angles - 1, lengths - 2, by_bounded, gradient * rule_of(turns), turn_gradient, angle_gradient - 1,
                    length_gradient - 2);
    for (int i = 0; i < EDGE_VERTICES; i++)
        turn_back(angles, lengths, i - 1, turn_gradient[i], angle_gradient, length_gradient);
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
    limit_back(lengths, setting.parity, edge_gradient.limit, length_gradient);
    double by_bend = kept[R + 3] / ((1 + t.bend) * (1 + t.bend));
    for (int i = 1 - R; i <= R; i++)
        angle_gradient[i] += by_bend * angles[i] / (t.bend * 2 * R);
    for (int i = 0; i < R; i++)
    {
        angle_gradient[1 + i] += 0.5 * ANGLE_UNIT * (first[R + i] + both[R + i]);
        angle_gradient[-i] += 0.5 * ANGLE_UNIT * (first[R + i] - both[R + i]);
    }
    for (int i = 1 - R; i <= R; i++)
        turn_back(angles, lengths, i, turn_gradient[i + R - 1], angle_gradient, length_gradient);
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

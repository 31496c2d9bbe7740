#include "research/train/learned_features_back.h"

#include "curve/network/learned_turns.h"

#include <float.h>
#include <math.h>

enum
{
    R = LEARNED_REACH,
    MIDDLE = LEARNED_MIDDLE
};

/// The derivative by ln(length / own).
static double log_ratio_slope(double length, double own)
{
    double x = log(length / own), s = 1 / (1 + x * x / 9);
    return s * sqrt(s);
}

static void limit_back(const double *lengths, double parity, double gradient, double *length_gradient)
{
    if (gradient == 0 || learned_limit(lengths, parity) >= BAT_CURVE_ANGLE_LIMIT)
        return;
    int beside = learned_bounding_edge(lengths, parity);
    double slope = 2 * LEARNED_BULGE * lengths[beside] / lengths[0], by_slope = gradient / (1 + slope * slope);
    length_gradient[beside] += by_slope * 2 * LEARNED_BULGE / lengths[0];
    length_gradient[0] -= by_slope * slope / lengths[0];
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
static void turns_back(const learned_turns *t, const double *feature_gradient, learned_edge edge, double *turn_gradient)
{
    const double *kept = feature_gradient, *first = kept + 2 * R + 1 + LEARNED_SCALARS, *both = first + 2 * R;
    double *right = turn_gradient + R, *left = turn_gradient + R - 1, inverse = 1 / t->strength;
    const double *right_turn = t->turn + R, *left_turn = t->turn + R - 1;
    double by_strength = kept[R] / ((1 + t->strength) * (1 + t->strength)) +
                         kept[R + 1] * LEARNED_FINE / ((LEARNED_FINE + t->strength) * (LEARNED_FINE + t->strength)) -
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
    double *to = turn_gradient + R - 2, by_near = edge.base * t->factor * LEARNED_SIX_POINT[0];
    double by_far = edge.base * t->factor * LEARNED_SIX_POINT[1];
    to[0] += by_far;
    to[1] += by_near;
    to[2] += by_near;
    to[3] += by_far;
    straight_factor_back(turns, edge.base * learned_six_point(turns) + edge.scale * t->scale, to);
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

double learned_later(const double *angles, const double *lengths)
{
    double turns[EDGE_VERTICES], factor = edge_turns_of(angles - 1, lengths - 2, turns);
    return factor * learned_six_point(turns);
}

void learned_later_back(const double *angles, const double *lengths, double gradient, double *angle_gradient,
                        double *length_gradient)
{
    double turns[EDGE_VERTICES], turn_gradient[EDGE_VERTICES] = {0};
    double factor = edge_turns_of(angles - 1, lengths - 2, turns);
    double by_near = gradient * factor * LEARNED_SIX_POINT[0], by_far = gradient * factor * LEARNED_SIX_POINT[1];
    const double by_bounded[EDGE_VERTICES] = {by_far, by_near, by_near, by_far};
    edge_turns_back(angles - 1, lengths - 2, by_bounded, gradient * learned_six_point(turns), turn_gradient,
                    angle_gradient - 1, length_gradient - 2);
    for (int i = 0; i < EDGE_VERTICES; i++)
        turn_back(angles, lengths, i - 1, turn_gradient[i], angle_gradient, length_gradient);
}

void learned_features_back(const double *angles, const double *lengths, learned_setting setting,
                           const double *feature_gradient, learned_edge edge_gradient, double *angle_gradient,
                           double *length_gradient)
{
    const learned_turns t = learned_turns_of(angles, lengths);
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
        angle_gradient[1 + i] += 0.5 * LEARNED_ANGLE_UNIT * (first[R + i] + both[R + i]);
        angle_gradient[-i] += 0.5 * LEARNED_ANGLE_UNIT * (first[R + i] - both[R + i]);
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

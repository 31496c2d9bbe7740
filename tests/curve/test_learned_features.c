#include "check.h"

#include "batten/space.h"
#include "curve/edge_turns.h"
#include "curve/network/learned_features.h"
#include "research/train/geometry_insert.h"
#include "research/train/learned_features_back.h"

#include <float.h>

// The features of an edge: derivatives by central differences, mirror and reversal, and the six-point rule in turns.

enum
{
    R = LEARNED_RANGE,
    OWN = R,                 ///< place of the edge's own length, and of vertex 0
    WIDTH = 2 * R + 1,       ///< places; the first angle is nobody's
    BASE = LEARNED_FEATURES, ///< number of the base in what comes out
    SCALE,
    NUMBERS,
    DRAWS = 40
};

/// The surroundings of an edge: angle i lies at angles[OWN + i], length i at lengths[OWN + i].
typedef struct surroundings
{
    double angles[WIDTH], lengths[WIDTH];
    learned_setting setting;
} surroundings;

/// All that comes out: features, base and scale.
static void see(const surroundings *s, double *numbers)
{
    learned_logs logs[2 * LEARNED_RANGE];
    learned_logs_of(s->angles + OWN, s->lengths + OWN, 1, s->setting.level == 0, logs);
    learned_edge edge =
        learned_features_of(s->angles + OWN, s->lengths + OWN, s->setting, logs + LEARNED_RANGE - 1, numbers);
    numbers[BASE] = edge.base;
    numbers[SCALE] = edge.scale;
}

static double symmetric_uniform(bat_random *random)
{
    return 2 * bat_random_uniform(random) - 1;
}

/// Whether x and y differ by so much that small changes of the inputs do not exchange them.
static bool apart(double x, double y, double unit)
{
    return fabs(x - y) > 0.02 * unit;
}

/// Whether small changes carry nothing over a bound of the turns or of their factor, where the derivative jumps.
static bool far_from_bounds(const surroundings *s)
{
    const double *e = s->lengths + OWN, *d = s->angles + OWN;
    double y[EDGE_VERTICES], largest = 0;
    for (int i = 1 - LEARNED_REACH; i <= LEARNED_REACH; i++)
        if (!apart(e[i - 1] + e[i], e[0], e[0]))
            return false;
    for (int i = 0; i < EDGE_VERTICES; i++)
    {
        y[i] = edge_turn(d[i - 1], e[i - 2], e[i - 1], e[0]);
        largest = fmax(largest, fabs(y[i]));
    }
    if (!apart(e[-1], e[0], e[0]) || !apart(e[1], e[0], e[0]))
        return false;
    double first = fabs(y[1]) + edge_inflection(y[0], y[2]), second = fabs(y[2]) + edge_inflection(y[1], y[3]);
    bool fit = apart(first, second, largest) && apart(fmin(first, second), EDGE_STRAIGHT_SHARE * largest, largest);
    for (int i = 0; i < EDGE_VERTICES; i++)
        for (int j = 0; j < EDGE_VERTICES; j++)
            fit = fit && apart(fabs(y[i]), i == j ? 0 : fabs(y[j]), largest);
    return fit;
}

/// @param turning the largest angle
/// @param uneven  of the lengths' logarithms
static surroundings draw(double turning, double uneven, double curvature, bat_random *random)
{
    double level = bat_random_uniform(random) < 0.5;
    surroundings s = {.setting = {.curvature = curvature,
                                  .fairness = bat_random_uniform(random),
                                  .level = level,
                                  .parity = bat_random_uniform(random) < 0.5 ? level : -level}};
    for (int i = 0; i < WIDTH; i++)
    {
        s.angles[i] = turning * symmetric_uniform(random);
        s.lengths[i] = 0.4 * exp(uneven * symmetric_uniform(random));
    }
    return s;
}

/// Call `check` on edges of every kind.
static void for_many_edges(void (*check)(const surroundings *s))
{
    static const double turnings[] = {3, 0.3, 1e-3}, unevens[] = {0.1, 0.7, 3};
    bat_random random = bat_random_seed(11);
    for (size_t t = 0; t < 3; t++)
        for (size_t u = 0; u < 3; u++)
            for (int i = 0; i < DRAWS; i++)
            {
                surroundings s;
                do
                    s = draw(turnings[t], unevens[u], i % 3 - 1, &random);
                while (!far_from_bounds(&s));
                check(&s);
            }
}

// Derivatives

/// The differences of fourth order of all numbers by one input, which is part of *s.
static void differences(surroundings *s, double *input, double h, double *slopes)
{
    static const double factors[] = {1, -8, 8, -1};
    static const int steps[] = {-2, -1, 1, 2};
    const double kept = *input;
    memset(slopes, 0, NUMBERS * sizeof *slopes);
    for (int k = 0; k < 4; k++)
    {
        double numbers[NUMBERS];
        *input = kept + steps[k] * h;
        see(s, numbers);
        for (int n = 0; n < NUMBERS; n++)
            slopes[n] += factors[k] * numbers[n] / (12 * h);
    }
    *input = kept;
}

/// Number n by all inputs, by learned_features_back().
static void gradient_of(const surroundings *s, int n, surroundings *gradient)
{
    double features[LEARNED_FEATURES] = {0};
    learned_edge edge = {.base = n == BASE, .scale = n == SCALE};
    if (n < LEARNED_FEATURES)
        features[n] = 1;
    *gradient = (surroundings){0};
    learned_features_back(s->angles + OWN, s->lengths + OWN, s->setting, features, edge, gradient->angles + OWN,
                          gradient->lengths + OWN);
}

/// @param unit size of the inputs, which the step and the tolerance go by
static void check_slopes(surroundings *s, double *input, double unit, size_t place, bool is_angle)
{
    double slopes[NUMBERS], numbers[NUMBERS];
    see(s, numbers);
    differences(s, input, 3e-4 * unit, slopes);
    for (int n = 0; n < NUMBERS; n++)
    {
        // The statistics of the given polygon have no gradient.
        int statistic = n - LEARNED_REACH - LEARNED_PLAIN_SCALARS;
        if (s->setting.level == 0 && statistic >= 0 && statistic < LEARNED_STATISTICS)
            continue;
        surroundings gradient;
        gradient_of(s, n, &gradient);
        double analytic = is_angle ? gradient.angles[place] : gradient.lengths[place];
        check_near(analytic, slopes[n], 4e-9 * fabs(slopes[n]) + 2e-10 * (1e-2 + fabs(numbers[n])) / unit);
    }
}

static void check_derivatives(const surroundings *s)
{
    surroundings moved = *s;
    double turning = 0;
    for (size_t i = 1; i < WIDTH; i++)
        turning = fmax(turning, fabs(s->angles[i]));
    for (size_t i = 1; i < WIDTH; i++)
        check_slopes(&moved, &moved.angles[i], turning, i, true);
    for (size_t i = 0; i < WIDTH; i++)
        check_slopes(&moved, &moved.lengths[i], s->lengths[i], i, false);
}

static void derivatives_are_limits_of_differences(void **state)
{
    (void)state;
    for_many_edges(check_derivatives);
}

/// Gradients are added to what is there, and nobody reads the angle before the first.
static void gradients_add_up(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    surroundings s = draw(1, 1, 1, &random), gradient, once;
    gradient_of(&s, SCALE, &once);
    gradient = once;
    double features[LEARNED_FEATURES] = {0};
    learned_features_back(s.angles + OWN, s.lengths + OWN, s.setting, features, (learned_edge){.scale = 1},
                          gradient.angles + OWN, gradient.lengths + OWN);
    for (int i = 0; i < WIDTH; i++)
    {
        check_near(gradient.angles[i], 2 * once.angles[i], 1e-15);
        check_near(gradient.lengths[i], 2 * once.lengths[i], 1e-15);
    }
    check_near(gradient.angles[0], 0, 0);
}

// Symmetries

/// Two results of which one has the features' characters in `changed` with other signs, and maybe the base.
static void check_signs(const surroundings *s, const surroundings *other, const bool *changed, bool base_changed,
                        double tolerance)
{
    double numbers[NUMBERS], others[NUMBERS];
    see(s, numbers);
    see(other, others);
    klein_widths widths = learned_widths();
    assert_int_equal(klein_total(widths), LEARNED_FEATURES);
    for (size_t k = 0, n = 0; k < KLEIN_COUNT; k++)
        for (size_t c = 0; c < widths.of[k]; c++, n++)
            check_near(others[n], changed[k] ? -numbers[n] : numbers[n], tolerance);
    check_near(others[BASE], base_changed ? -numbers[BASE] : numbers[BASE], tolerance);
    check_near(others[SCALE], numbers[SCALE], tolerance * (1 + numbers[SCALE]));
}

static surroundings mirrored(const surroundings *s)
{
    surroundings other = *s;
    for (int i = 0; i < WIDTH; i++)
        other.angles[i] = -s->angles[i];
    return other;
}

/// Run through the other way, vertices 0 and 1 change places, and left turns become right ones.
static surroundings reversed(const surroundings *s)
{
    surroundings other = *s;
    for (int i = 1 - R; i <= R; i++)
        other.angles[OWN + i] = -s->angles[OWN + 1 - i];
    for (int i = -R; i <= R; i++)
        other.lengths[OWN + i] = s->lengths[OWN - i];
    other.setting.parity = -s->setting.parity;
    return other;
}

static void check_symmetries(const surroundings *s)
{
    const bool by_mirror[KLEIN_COUNT] = {[KLEIN_FIRST] = true, [KLEIN_BOTH] = true};
    const bool by_exchange[KLEIN_COUNT] = {[KLEIN_SECOND] = true, [KLEIN_BOTH] = true};
    const bool by_reversal[KLEIN_COUNT] = {[KLEIN_FIRST] = true, [KLEIN_SECOND] = true};
    surroundings mirror = mirrored(s), reversal = reversed(s), exchange = mirrored(&reversal);
    check_signs(s, &mirror, by_mirror, true, 0);
    check_signs(s, &reversal, by_reversal, true, 1e-12);
    check_signs(s, &exchange, by_exchange, false, 1e-12);
}

static void mirror_and_reversal_change_signs(void **state)
{
    (void)state;
    for_many_edges(check_symmetries);
}

/// Powers of two, so that not a bit changes.
static void check_scaling(const surroundings *s)
{
    static const int exponents[] = {-900, -1, 1, 900};
    const bool none[KLEIN_COUNT] = {false};
    surroundings flat = *s;
    flat.setting.curvature = 0;
    for (size_t k = 0; k < sizeof exponents / sizeof *exponents; k++)
    {
        surroundings other = flat;
        for (int i = 0; i < WIDTH; i++)
            other.lengths[i] = ldexp(flat.lengths[i], exponents[k]);
        check_signs(&flat, &other, none, false, 0);
    }
}

static void scaling_the_plane_changes_nothing(void **state)
{
    (void)state;
    for_many_edges(check_scaling);
}

// Where the rule begins

/// Equally long edges on a closed polygon's profile, no vertex of which is straight: eq. (9), outward.
static void equal_lengths_give_the_six_point_rule(void **state)
{
    (void)state;
    enum
    {
        COUNT = 2 * R + 1
    };
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 50; trial++)
    {
        surroundings s = draw(0.8, 0.1, 0, &random);
        for (int i = 0; i < WIDTH; i++)
            s.lengths[i] = 0.4;
        for (int i = 0; i < WIDTH; i++)
            s.angles[i] += s.angles[i] > 0 ? 0.1 : -0.1;
        double angles[COUNT], numbers[NUMBERS], tension[COUNT], points[2 * COUNT] = {0};
        // Vertex i of the polygon is vertex i - R of the edge.
        memcpy(angles, s.angles, sizeof angles);
        geometry_polygon polygon = {points, COUNT, GEOMETRY_PLANE, true};
        geometry_tension_angles(&polygon, (geometry_profile){angles, s.lengths}, -0.25, BAT_CURVE_ANGLE_SIGN_OUTWARD,
                                tension);
        see(&s, numbers);
        check_near(numbers[BASE], tension[R], 1e-15);
    }
}

/// Points of a geodesic circle in a space, at angles around its centre.
static void circle_point(const bat_space *space, double radius, double angle, double *point)
{
    double r = space->point_dim == 3 ? sin(radius) : radius;
    point[0] = r * cos(angle);
    point[1] = r * sin(angle);
    if (space->point_dim == 3)
        point[2] = cos(radius);
}

/// How far the base is from the angle that puts the new vertex on the circle, in the middle of the arc.
/// @param steps lengths of the arcs around the edge, in units of `h`
static double circle_error(const bat_space *space, double radius, const double *steps, double h)
{
    double points[WIDTH + 1][3], middle[3], numbers[NUMBERS], at = 0;
    surroundings s = {.setting = {.curvature = 0}};
    for (int i = 0; i <= WIDTH; i++)
    {
        circle_point(space, radius, at, points[i]);
        if (i == OWN)
            circle_point(space, radius, at + 0.5 * h * steps[i], middle);
        at += i < WIDTH ? h * steps[i] : 0;
    }
    for (int i = 0; i < WIDTH; i++)
    {
        s.lengths[i] = space->distance(space, points[i], points[i + 1]);
        s.angles[i] = i > 0 ? space->exterior_angle(space, points[i - 1], points[i], points[i + 1]) : 0;
    }
    see(&s, numbers);
    const double *before = points[OWN - 1], *p = points[OWN], *q = points[OWN + 1];
    double exact = space->exterior_angle(space, before, p, middle) - space->exterior_angle(space, before, p, q);
    assert_true(exact < 0);
    return fabs(numbers[BASE] - exact);
}

/// The angle itself falls with the edge, what is wrong with it with the edge's third power, however uneven the edges are, as
/// long as each is shorter than two others in a row.
static void uneven_circles_are_met_in_the_limit(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_random random = bat_random_seed(6);
    for (size_t space = 0; space < 3; space++)
        for (int trial = 0; trial < 30; trial++)
        {
            double steps[WIDTH], h = 0.02, radius = 0.2 + 0.6 * bat_random_uniform(&random);
            for (int i = 0; i < WIDTH; i++)
                steps[i] = 1.05 + 0.9 * bat_random_uniform(&random);
            double coarse = circle_error(&spaces[space], radius, steps, h);
            double fine = circle_error(&spaces[space], radius, steps, h / 4);
            // With steps of h, the angle is about h / 4.
            assert_true(coarse < 200 * h * h * h);
            assert_true(fine < coarse / 40 + 1e-13);
        }
}

/// With the edges of an ellipse, whose curvature varies smoothly.
static double ellipse_scale(double at, double h)
{
    const bat_space plane = bat_euclidean(2);
    double points[WIDTH + 1][2], numbers[NUMBERS];
    surroundings s = {.setting = {.curvature = 0}};
    for (int i = 0; i <= WIDTH; i++)
    {
        double t = at + (i - OWN) * h;
        points[i][0] = 2 * cos(t);
        points[i][1] = sin(t);
    }
    for (int i = 0; i < WIDTH; i++)
    {
        s.lengths[i] = plane.distance(&plane, points[i], points[i + 1]);
        s.angles[i] = i > 0 ? plane.exterior_angle(&plane, points[i - 1], points[i], points[i + 1]) : 0;
    }
    see(&s, numbers);
    return numbers[SCALE];
}

static void the_networks_share_falls_by_four(void **state)
{
    (void)state;
    for (double at = 0.1; at < 6; at += 0.31)
        for (double h = 0.04; h > 0.004; h /= 2)
        {
            double ratio = ellipse_scale(at, h) / ellipse_scale(at, h / 2);
            assert_true(ratio > 3.4 && ratio < 4.6);
        }
}

static void straight_polygons_are_left_straight(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(8);
    for (int curvature = -1; curvature <= 1; curvature++)
    {
        surroundings s = draw(0, 1, curvature, &random), gradient;
        double numbers[NUMBERS];
        see(&s, numbers);
        for (int n = 0; n < NUMBERS; n++)
        {
            assert_true(isfinite(numbers[n]));
            gradient_of(&s, n, &gradient);
            for (int i = 0; i < WIDTH; i++)
                assert_true(isfinite(gradient.angles[i]) && isfinite(gradient.lengths[i]));
        }
        check_near(numbers[BASE], 0, 0);
        assert_true(numbers[SCALE] >= 0 && numbers[SCALE] < 1e-11);
    }
}

/// Edges of any length beside one another, and the sharpest turns.
static void extremes_stay_finite(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    bat_random random = bat_random_seed(9);
    for (int trial = 0; trial < 3000; trial++)
    {
        surroundings s = draw(pi, 1, trial % 3 - 1, &random);
        for (int i = 0; i < WIDTH; i++)
        {
            s.lengths[i] = pow(10, 140 * symmetric_uniform(&random));
            s.angles[i] = bat_random_uniform(&random) < 0.5 ? copysign(pi, s.angles[i]) : s.angles[i];
        }
        double numbers[NUMBERS];
        see(&s, numbers);
        for (int n = 0; n < NUMBERS; n++)
            assert_true(fabs(numbers[n]) < 20);
        assert_true(numbers[SCALE] >= 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_limits_of_differences),
        cmocka_unit_test(gradients_add_up),
        cmocka_unit_test(mirror_and_reversal_change_signs),
        cmocka_unit_test(scaling_the_plane_changes_nothing),
        cmocka_unit_test(equal_lengths_give_the_six_point_rule),
        cmocka_unit_test(uneven_circles_are_met_in_the_limit),
        cmocka_unit_test(the_networks_share_falls_by_four),
        cmocka_unit_test(straight_polygons_are_left_straight),
        cmocka_unit_test(extremes_stay_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

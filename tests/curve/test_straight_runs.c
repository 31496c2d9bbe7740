#include "check.h"

#include "batten/curve.h"
#include "batten/curve_scheme.h"
#include "curve/edge_turns.h"
#include "curve/network/learned_network.h"
#include "learn/weights.h"

// What the learned scheme and its later levels promise by construction: straight runs stay straight, and an edge between
// short neighbours bends by no more than their length.

enum
{
    LEVELS = 5,
    PARTS = 1 << LEVELS
};

static bat_curve refined(double *points, size_t count, bool closed, double fairness)
{
    static bat_space plane;
    plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = points, .count = count, .closed = closed}, fine;
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.scheme = bat_curve_scheme_learned(fairness);
    options.levels = LEVELS;
    check_status(bat_curve_refine(&coarse, &options, &fine, NULL), BAT_OK);
    return fine;
}

/// The farthest distance of the refined edge from the edge's line.
static double largest_bend(const double *points, size_t count, size_t edge, const bat_curve *fine)
{
    const double *p = points + 2 * edge, *q = points + 2 * ((edge + 1) % count);
    double x = q[0] - p[0], y = q[1] - p[1], length = hypot(x, y), largest = 0;
    for (size_t i = 0; i <= PARTS; i++)
    {
        const double *r = fine->points + 2 * ((edge * PARTS + i) % fine->count);
        largest = fmax(largest, fabs(x * (r[1] - p[1]) - y * (r[0] - p[0])) / length);
    }
    return largest;
}

/// Runs of four, of three and of many points, between smooth pieces and beside corners.
static void runs_of_collinear_points_stay_straight(void **state)
{
    (void)state;
    double points[] = {0, 0, 1, 0, 2, 0, 3, 0, 3.7, 0.4, 4, 1, 4, 2, 4, 3, 3, 4, 2, 4.5, 1, 4, 0, 3};
    const size_t count = sizeof points / sizeof *points / 2, straight[] = {0, 1, 2, 5, 6};
    for (double fairness = 0; fairness <= 1; fairness += 0.5)
        for (double turn = 0; turn < 1.5; turn += 0.4)
        {
            double turned[sizeof points / sizeof *points];
            for (size_t i = 0; i < count; i++)
            {
                turned[2 * i] = cos(turn) * points[2 * i] - sin(turn) * points[2 * i + 1];
                turned[2 * i + 1] = sin(turn) * points[2 * i] + cos(turn) * points[2 * i + 1];
            }
            bat_curve fine = refined(turned, count, true, fairness);
            for (size_t i = 0; i < sizeof straight / sizeof *straight; i++)
                check_near(largest_bend(turned, count, straight[i], &fine), 0, 1e-12);
            assert_true(largest_bend(turned, count, 9, &fine) > 1e-3); // the smooth piece is no polygon
            bat_curve_free(&fine);
        }
}

/// Of random lines whose edges differ by up to a hundred times.
static void long_edges_bend_by_their_neighbours(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(21);
    enum
    {
        COUNT = 30
    };
    for (int trial = 0; trial < 40; trial++)
    {
        double points[2 * COUNT], lengths[COUNT], x = 0, y = 0, heading = 0;
        for (size_t i = 0; i < COUNT; i++)
        {
            points[2 * i] = x;
            points[2 * i + 1] = y;
            lengths[i] = pow(10, 2 * bat_random_uniform(&random));
            heading += 2 * bat_random_uniform(&random) - 1;
            x += lengths[i] * cos(heading);
            y += lengths[i] * sin(heading);
        }
        bat_curve fine = refined(points, COUNT, false, 0);
        for (size_t i = 1; i + 2 < COUNT; i++)
        {
            double beside = fmax(lengths[i - 1], lengths[i + 1]);
            assert_true(largest_bend(points, COUNT, i, &fine) < 2 * beside);
        }
        bat_curve_free(&fine);
    }
}

/// A line from the origin by edges of some lengths and the turns in degrees behind them.
static void draw(double (*edges)[2], size_t count, double *points)
{
    double heading = 0;
    points[0] = points[1] = 0;
    for (size_t i = 0; i < count; i++)
    {
        points[2 * i + 2] = points[2 * i] + edges[i][0] * cos(heading);
        points[2 * i + 3] = points[2 * i + 1] + edges[i][0] * sin(heading);
        heading += edges[i][1] / 180 * 3.14159265358979323846;
    }
}

/// Many short edges of an arc tell the tolerance of a simplified line; a long edge between corners would leave it.
static void long_edges_of_simplified_lines_stay_straight(void **state)
{
    (void)state;
    enum
    {
        ARC = 28,
        EDGES = ARC + 4,
        LONG = 2 ///< the long edge
    };
    double edges[EDGES][2] = {{1.6, 75}, {0.4, -20}, {1.8, -63}}, points[2 * EDGES + 2];
    for (size_t i = 0; i < ARC; i++)
    {
        edges[LONG + 1 + i][0] = i % 5 == 0 ? 0.08 : 0.065;
        edges[LONG + 1 + i][1] = i + 1 == ARC ? 77 : -1.5;
    }
    edges[EDGES - 1][0] = 1.1;
    draw(edges, EDGES, points);
    bat_curve fine = refined(points, EDGES + 1, false, 0.25);
    check_near(largest_bend(points, EDGES + 1, LONG, &fine), 0, 1e-12);
    for (size_t i = LONG + 4; i < LONG + ARC - 2; i++)
        assert_true(largest_bend(points, EDGES + 1, i, &fine) > 1e-4);
    bat_curve_free(&fine);

    // An even sample of a wave has deviations down to 0, and a long edge in a line of few points tells nothing.
    for (size_t i = 0; i < EDGES; i++)
    {
        edges[i][0] = 1;
        edges[i][1] = 25 * sin(0.37 * (double)i + 0.2);
    }
    draw(edges, EDGES, points);
    fine = refined(points, EDGES + 1, false, 0.25);
    for (size_t i = 1; i + 1 < EDGES; i++)
        assert_true(largest_bend(points, EDGES + 1, i, &fine) > 1e-9);
    bat_curve_free(&fine);

    double few[][2] = {{1, 40}, {3, 40}, {1, 0}};
    draw(few, 3, points);
    fine = refined(points, 4, false, 0.25);
    assert_true(largest_bend(points, 4, 1, &fine) > 0.1);
    bat_curve_free(&fine);
}

/// Rough lines with a lower end of their deviations bend less than by the network alone.
static void rough_simplified_lines_bend_less(void **state)
{
    (void)state;
    enum
    {
        EDGES = 40
    };
    double edges[EDGES][2], points[2 * EDGES + 2];
    for (size_t i = 0; i < EDGES; i++)
    {
        edges[i][0] = i % 3 == 0 ? 1.6 : 1;
        edges[i][1] = (i % 2 == 0 ? 55 : -60) + (double)(i * i % 17); // never the same again
    }
    draw(edges, EDGES, points);
    bat_space plane = bat_euclidean(2);
    bat_curve coarse = {.space = &plane, .points = points, .count = EDGES + 1}, fine;
    const bat_curve_angle_rule rule = learned_rule(weights_learned.arrays[0].values);
    bat_curve_refine_options options = bat_curve_refine_defaults();
    options.levels = LEVELS;
    for (double fairness = 0; fairness <= 1; fairness += 0.5)
    {
        bat_curve less = refined(points, EDGES + 1, false, fairness);
        options.scheme = bat_curve_scheme_angle_rule(&rule);
        options.scheme.fairness = fairness;
        check_status(bat_curve_refine(&coarse, &options, &fine, NULL), BAT_OK);
        double bends[2] = {0, 0};
        for (size_t i = 2; i + 2 < EDGES; i++)
        {
            bends[0] += largest_bend(points, EDGES + 1, i, &less);
            bends[1] += largest_bend(points, EDGES + 1, i, &fine);
        }
        if (fairness < 1)
            assert_true(bends[0] < 0.95 * bends[1]);
        else
            check_relative(bends[0], bends[1], 1e-12);
        bat_curve_free(&less);
        bat_curve_free(&fine);
    }
}

/// Right angles beside an edge of length r between edges of length 1: as far as a vertex counts as a corner, the insertion
/// over the edge stays within the shorter one.
static void corners_are_bounded_by_the_shorter_edge(void **state)
{
    (void)state;
    for (double r = 1; r < 1000; r *= 1.7)
    {
        const double right = 1.5707963267948966;
        double turns[EDGE_VERTICES], angles[EDGE_VERTICES] = {right, right, right, right};
        const double lengths[EDGE_LENGTHS] = {1, 1, r, 1, 1};
        check_near(edge_turns_of(angles, lengths, turns), 1, 0);
        double smooth = (1 - edge_corner_weight(right)) * edge_turn(right, 1, r, r);
        assert_true((turns[1] - smooth) * r <= right * (1 + 1e-12));
        assert_true(fabs(turns[1] - turns[2]) < 1e-12 * turns[1]);
        assert_true(turns[0] <= turns[1] + right);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_of_collinear_points_stay_straight),
        cmocka_unit_test(long_edges_bend_by_their_neighbours),
        cmocka_unit_test(long_edges_of_simplified_lines_stay_straight),
        cmocka_unit_test(rough_simplified_lines_bend_less),
        cmocka_unit_test(corners_are_bounded_by_the_shorter_edge),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "measure_helpers.h"

#include "batten/research/curve_study.h"

/// A vertex of a refined circle lies nowhere farther from the coarse one's chords than in the middle of an arc.
static void chords_of_a_circle(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2)};
    const double sizes[] = {1, 1e200, 1e-170};
    for (size_t s = 0; s < 2; s++)
        for (size_t n = 2; n <= 200; n *= 10)
            for (size_t k = 0; k < (s == 0 ? 3 : 1); k++)
            {
                bat_curve coarse = regular_polygon(&spaces[s], n, 0.5), fine = regular_polygon(&spaces[s], 64 * n, 0.5);
                bat_curve a = magnified(&coarse, sizes[k]), b = magnified(&fine, sizes[k]);
                for (int threads = 1; threads <= 3; threads += 2)
                {
                    bat_curve_measure_options options = {.threads = threads};
                    double distance;
                    check_status(bat_curve_chord_distance(&a, &b, &options, &distance, NULL), BAT_OK);
                    check_relative(distance, 0.5 * sizes[k] * (1 - cos(PI / (double)n)), 1e-9);
                    check_status(bat_curve_chord_distance(&a, &a, &options, &distance, NULL), BAT_OK);
                    check_near(distance, 0, 0);
                }
                bat_curve_free(&coarse);
                bat_curve_free(&fine);
                bat_curve_free(&a);
                bat_curve_free(&b);
            }
}

/// Where a curve comes near to itself, the other strand does not count.
static void chords_belong_to_their_place(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    enum
    {
        HALF = 20
    };
    double there_and_back[4 * HALF], apart[4 * HALF];
    for (size_t i = 0; i < 2 * HALF; i++)
    {
        there_and_back[2 * i] = i < HALF ? (double)i : (double)(2 * HALF - 1 - i);
        there_and_back[2 * i + 1] = 0;
        apart[2 * i] = there_and_back[2 * i];
        apart[2 * i + 1] = i < HALF ? 0 : 1;
    }
    bat_curve coarse = {.space = &plane, .points = apart, .count = 2 * HALF};
    bat_curve fine = {.space = &plane, .points = there_and_back, .count = 2 * HALF};
    double distance;
    check_status(bat_curve_chord_distance(&coarse, &fine, NULL, &distance, NULL), BAT_OK);
    check_near(distance, 1, 0);
}

/// Chaikin's limit stencil is [1, 6, 1] / 8: on a regular n-gon it moves vertices inwards by (1 - cos(2 pi / n)) / 4.
static void limits_of_a_circle(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), solid = bat_euclidean(3);
    const double sizes[] = {1, 1e200, 1e-170};
    bat_mask chaikin = bat_mask_chaikin(), four_point = bat_mask_four_point(1.0 / 16);
    bat_mask_stencil stencil, none;
    check_status(bat_mask_limit_stencil(&chaikin, &stencil, NULL), BAT_OK);
    check_status(bat_mask_limit_stencil(&four_point, &none, NULL), BAT_OK);
    for (size_t n = 2; n <= 20000; n *= 10)
        for (size_t k = 0; k < 3; k++)
        {
            bat_curve circle = regular_polygon(&plane, n, 1), curve = magnified(&circle, sizes[k]);
            double expected = sizes[k] * (1 - cos(2 * PI / (double)n)) / 4, distance;
            for (int threads = 1; threads <= 3; threads += 2)
            {
                bat_curve_measure_options options = {.threads = threads};
                check_status(bat_curve_limit_distance(&curve, &stencil, &options, &distance, NULL), BAT_OK);
                check_near(distance, expected, sizes[k] * 1e-15);
                check_status(bat_curve_limit_distance(&curve, &none, &options, &distance, NULL), BAT_OK);
                check_near(distance, 0, 0);
            }
            bat_curve_free(&circle);
            bat_curve_free(&curve);
        }
    // In space; the kink of an open curve moves by 2 / 8 of its height, and does not count next to the end.
    double kinked[] = {0, 0, 0, 1, 0, 0, 2, 0, 4, 3, 0, 0, 4, 0, 0, 5, 0, 0}, distance;
    bat_curve open = {.space = &solid, .points = kinked, .count = 6};
    check_status(bat_curve_limit_distance(&open, &stencil, NULL, &distance, NULL), BAT_OK);
    check_near(distance, 1, 1e-15);
    open.count = 3;
    check_status(bat_curve_limit_distance(&open, &stencil, NULL, &distance, NULL), BAT_OK);
    check_near(distance, 0, 0);
}

static void convergence_refuses_bad_input(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), solid = bat_euclidean(3), disk = bat_disk();
    bat_mask chaikin = bat_mask_chaikin();
    bat_mask_stencil stencil;
    check_status(bat_mask_limit_stencil(&chaikin, &stencil, NULL), BAT_OK);
    bat_curve good = random_curve(&plane, 30000, 28), empty = {.space = &plane}, point = good, other = good, curved = good;
    point.count = 1;
    other.space = &solid;
    other.count = 100;
    curved.space = &disk;
    double distance = -7;
    bat_error error;
    check_status(bat_curve_chord_distance(&point, &good, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_chord_distance(&good, &empty, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_chord_distance(&good, &other, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_limit_distance(&empty, &stencil, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_limit_distance(&curved, &stencil, NULL, &distance, &error), BAT_UNSUPPORTED);
    watch seen;
    bat_curve_measure_options options = {.threads = 1, .progress = watched(&seen, 0)};
    check_status(bat_curve_chord_distance(&good, &good, &options, &distance, &error), BAT_CANCELLED);
    options.progress = watched(&seen, 0);
    check_status(bat_curve_limit_distance(&good, &stencil, &options, &distance, &error), BAT_CANCELLED);
    good.points[2 * 12345] = -8e307;
    good.points[2 * 12346] = good.points[2 * 12346 + 1] = good.points[2 * 12345 + 1] = 8e307;
    check_status(bat_curve_limit_distance(&good, &stencil, NULL, &distance, &error), BAT_OK);
    stencil.weights[0] = stencil.weights[2] = 8;
    distance = -7;
    check_status(bat_curve_limit_distance(&good, &stencil, NULL, &distance, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 12344);
    good.points[2 * 20000] = INFINITY;
    check_status(bat_curve_chord_distance(&good, &good, NULL, &distance, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 20000);
    check_near(distance, -7, 0);
    bat_curve_free(&good);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chords_of_a_circle),
        cmocka_unit_test(chords_belong_to_their_place),
        cmocka_unit_test(limits_of_a_circle),
        cmocka_unit_test(convergence_refuses_bad_input),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "measure_helpers.h"

/// Half the interior angle b of a regular n-gon of radius r: cot b = c tan(pi / n), c = 1, cos r, cosh r in the three
/// geometries; half the edge e: sin(e/2), e/2, sinh(e/2) = sin r, r, sinh r times sin(pi / n).
static void regular_polygons_have_the_fairness_of_trigonometry(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t n = 3; n <= 3000; n *= 10)
        for (size_t s = 0; s < 3; s++)
        {
            double radius = 0.6, step = PI / (double)n, factor = 1, edge = 2 * radius * sin(step), coordinate = radius;
            if (s == 1)
            {
                factor = cos(radius);
                edge = 2 * asin(sin(radius) * sin(step));
                coordinate = sin(radius);
            }
            if (s == 2)
            {
                factor = cosh(radius);
                edge = 2 * asinh(sinh(radius) * sin(step));
                coordinate = tanh(radius / 2);
            }
            double angle = 2 * atan(factor * tan(step));
            bat_curve polygon = regular_polygon(&spaces[s], n, coordinate);
            bat_curve_fairness_values fairness = fairness_of(&polygon);
            check_relative(fairness.g1, angle, 1e-8);
            check_relative(fairness.length, (double)n * edge, 1e-8);
            check_relative(fairness.bending, pow(angle / edge, 2), 1e-8);
            bat_curve_fairness_values published;
            check_status(bat_curve_fairness(&polygon, NULL, &published, NULL), BAT_OK);
            check_relative(published.bending, pow(angle / (edge + BAT_CURVE_BENDING_OFFSET), 2), 1e-8);
            bat_curve_free(&polygon);
        }
}

static void more_dimensions_agree_with_two(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), many = bat_euclidean(5), sphere = bat_sphere(2), hypersphere = bat_sphere(4);
    bat_curve flat = random_curve(&plane, 40, 10), round = random_curve(&sphere, 40, 11);
    bat_curve wide = closed_curve(&many, 40), rounder = closed_curve(&hypersphere, 40);
    for (size_t i = 0; i < 40; i++)
    {
        memcpy(wide.points + 5 * i + 2, flat.points + 2 * i, 2 * sizeof(double));
        memcpy(rounder.points + 5 * i + 1, round.points + 3 * i, 3 * sizeof(double));
    }
    check_relative(fairness_of(&wide).g1, fairness_of(&flat).g1, 1e-13);
    check_relative(fairness_of(&wide).bending, fairness_of(&flat).bending, 1e-12);
    check_relative(fairness_of(&rounder).g1, fairness_of(&round).g1, 1e-13);
    check_relative(fairness_of(&rounder).bending, fairness_of(&round).bending, 1e-12);
    bat_curve_free(&flat);
    bat_curve_free(&round);
    bat_curve_free(&wide);
    bat_curve_free(&rounder);
}

static void small_angles_keep_their_digits(void **state)
{
    (void)state;
    bat_space solid = bat_euclidean(3);
    double points[] = {-1, 0, 0, 0, 0, 0, 1, 1e-9, 0};
    bat_curve curve = {.space = &solid, .points = points, .count = 3};
    check_relative(fairness_of(&curve).g1, 1e-9, 1e-14);
    points[6] = -1; // a spike, next to pi
    check_relative(PI - fairness_of(&curve).g1, 1e-9, 1e-6);
}

static void ends_of_open_curves_do_not_count(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double corner[] = {0, 0, 2, 0, 2, 2, 4, 2};
    bat_curve curve = {.space = &plane, .points = corner, .count = 4};
    check_near(fairness_of(&curve).g1, PI / 2, 1e-15);
    check_near(fairness_of(&curve).bending, PI * PI / 16, 1e-15);
    check_near(fairness_of(&curve).length, 6, 0);
    curve.count = 2;
    check_near(fairness_of(&curve).bending, 0, 0);
    curve.closed = true; // there and back
    check_near(fairness_of(&curve).g1, PI, 0);
    check_near(fairness_of(&curve).length, 4, 0);
    check_near(fairness_of(&curve).bending, PI * PI / 4, 1e-15);
    curve.count = 1;
    check_near(fairness_of(&curve).g1, 0, 0);
}

static void sets_are_measured_curve_by_curve(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double good[] = {0, 0, 1, 0, 1, 1}, bad[] = {0, 0, NAN, 0, 1, 1};
    bat_curve curves[40];
    bat_curve_fairness_values fairness[40];
    for (int i = 0; i < 40; i++)
        curves[i] = (bat_curve){.space = &plane, .points = good, .count = i % 2 == 0 ? 3 : 2};
    check_status(bat_curves_fairness(curves, 40, NULL, fairness, NULL), BAT_OK);
    for (int i = 0; i < 40; i++)
    {
        check_near(fairness[i].length, i % 2 == 0 ? 2 : 1, 0);
        check_near(fairness[i].g1, i % 2 == 0 ? PI / 2 : 0, 1e-15);
    }
    curves[33].points = curves[17].points = bad;
    bat_error error;
    check_status(bat_curves_fairness(curves, 40, NULL, fairness, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 17);
    assert_int_equal(error.index, 1);
}

static void repeated_points_are_passed_over(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_euclidean(3)};
    for (size_t s = 0; s < 2; s++)
    {
        size_t dim = spaces[s].point_dim;
        bat_curve curve = random_curve(&spaces[s], 6, 12), repeated = closed_curve(&spaces[s], 11);
        const size_t order[] = {0, 0, 1, 1, 1, 2, 3, 4, 5, 5, 0};
        for (size_t i = 0; i < 11; i++)
            memcpy(repeated.points + i * dim, curve.points + order[i] * dim, dim * sizeof(double));
        bat_curve_fairness_values once = fairness_of(&curve), again = fairness_of(&repeated);
        assert_memory_equal(&again, &once, sizeof once);
        for (size_t i = 0; i < 11; i++)
            memcpy(repeated.points + i * dim, curve.points, dim * sizeof(double));
        check_near(fairness_of(&repeated).bending, 0, 0);
        bat_curve_free(&curve);
        bat_curve_free(&repeated);
    }
}

static void fairness_refuses_bad_input(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[] = {1, 0, 0, 0, 1, 0, 0, -1, 0};
    bat_curve curve = {.space = &sphere, .points = points, .count = 3};
    bat_curve_fairness_values untouched = {-7, -7, -7}, fairness = untouched;
    bat_error error;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 2);
    points[8] = 0.5;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    curve.count = 2;
    bat_curve_measure_options options = bat_curve_measure_defaults();
    options.bending_offset = -1;
    check_status(bat_curve_fairness(&curve, &options, &fairness, &error), BAT_INVALID_ARGUMENT);
    options.bending_offset = NAN;
    check_status(bat_curve_fairness(&curve, &options, &fairness, &error), BAT_INVALID_ARGUMENT);
    curve.count = 0;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, NULL), BAT_INVALID_ARGUMENT);
    assert_memory_equal(&fairness, &untouched, sizeof fairness);
}

static void angles_do_not_change_with_the_size(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_euclidean(3), bat_disk()};
    const double factors[] = {1e200, 1e-170, 1e300, 1e-300};
    for (size_t s = 0; s < 3; s++)
        for (size_t f = 0; f < sizeof factors / sizeof *factors; f++)
        {
            bool disk = s == 2;
            if (disk && factors[f] > 1)
                continue;
            bat_curve curve = random_curve(&spaces[s], 40, 27);
            if (disk) // where it is as good as flat
                curve.space = &spaces[0];
            bat_curve other = magnified(&curve, factors[f]);
            other.space = &spaces[s];
            // With an offset much larger than the edges the bending energy is in range, and without digits of theirs.
            bat_curve_measure_options options = {.bending_offset = factors[f] < 1 ? 1 : 0};
            bat_curve_fairness_values expected = fairness_of(&curve), found;
            check_status(bat_curve_fairness(&other, &options, &found, NULL), BAT_OK);
            check_relative(found.g1, expected.g1, 1e-13);
            check_relative(found.length, expected.length * factors[f] * (disk ? 2 : 1), 1e-13);
            bat_error error;
            if (factors[f] < 1)
                check_status(bat_curve_fairness(&other, &(bat_curve_measure_options){0}, &found, &error), BAT_INVALID_POINT);
            bat_curve_free(&curve);
            bat_curve_free(&other);
        }
}

static void lengths_that_no_double_holds_are_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double step[] = {-1e308, 0, 1e308, 0}, sum[] = {-8e307, 0, 8e307, 0, -8e307, 1e300};
    bat_curve curve = {.space = &plane, .points = step, .count = 2};
    bat_curve_fairness_values fairness;
    bat_error error;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    curve.points = sum;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_OK);
    curve.count = 3;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regular_polygons_have_the_fairness_of_trigonometry),
        cmocka_unit_test(more_dimensions_agree_with_two),
        cmocka_unit_test(small_angles_keep_their_digits),
        cmocka_unit_test(ends_of_open_curves_do_not_count),
        cmocka_unit_test(sets_are_measured_curve_by_curve),
        cmocka_unit_test(repeated_points_are_passed_over),
        cmocka_unit_test(fairness_refuses_bad_input),
        cmocka_unit_test(angles_do_not_change_with_the_size),
        cmocka_unit_test(lengths_that_no_double_holds_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

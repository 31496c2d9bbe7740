// Limit points, tangents, basic limit functions and polynomials against refinement as such.

#include "analysis_helpers.h"

#include "batten/research/curve_analysis.h"

static void limit_stencils_agree_with_refinement(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    for (int trial = 0; trial < 20; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_six_point(0.02)
                              : trial == 2
                                  ? bat_mask_chaikin()
                                  : random_mask(&random, 1 + (size_t)trial % 5, 2 + (size_t)trial % 3, trial % 7 - 5);
        bat_analysis a = analyze(mask);
        assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_PROVEN);
        const row points = random_points(&random, 40);
        check_near(apply(&a.limit, &points, 0), brute_limit(&mask, &points, 0.0), 1e-7);
        for (int at = -2; at <= 2; ++at)
            check_near(apply(&a.vertex, &points, at), brute_limit(&mask, &points, at + a.shift), 1e-6);
        bat_analysis_free(&a);
    }
}

static void limit_stencil_is_the_same_at_every_level(void **state)
{
    (void)state;
    // Points of level 1 moved to the limit are limits of the points of level 0 at (i + shift) / 2.
    bat_random random = bat_random_seed(11);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 3, 3, -3 + trial % 3);
        bat_mask_stencil stencil;
        check_status(bat_mask_limit_stencil(&mask, &stencil, NULL), BAT_OK);
        double shift = 0.0;
        for (size_t k = 0; k < mask.count; ++k)
            shift += 0.5 * (mask.first + (int)k) * mask.coefficients[k];
        const row points = random_points(&random, 40);
        const row fine = refine(&mask, &points);
        for (int i = -2; i <= 2; ++i)
            check_near(apply(&stencil, &fine, i), brute_limit(&mask, &points, 0.5 * (i + shift)), 1e-6);
    }
}

static void limit_stencils_reproduce_straight_lines(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    row line = {.first = -40, .count = 81};
    for (int i = 0; i < line.count; ++i)
        line.values[i] = 2.0 + 3.0 * (line.first + i);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 4, 2, -4);
        bat_analysis a = analyze(mask);
        check_near(apply(&a.vertex, &line, 5), 17.0, 1e-11); // the shift is taken to 40 binary digits
        check_near(apply(&a.limit, &line, 0), 2.0 - 3.0 * a.shift, 1e-12);
        if (a.tangent.count > 0)
            check_near(apply(&a.tangent, &line, 0), 3.0, 1e-11);
        bat_analysis_free(&a);
    }
}

static void tangents_agree_with_difference_quotients(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(23);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 3, 4, -4);
        bat_analysis a = analyze(mask);
        assert_true(a.smooth_proven >= 2);
        assert_true(a.tangent.count > 0);
        const row points = random_points(&random, 40);
        const double step = 0x1p-8;
        const double slope = (brute_limit(&mask, &points, step) - brute_limit(&mask, &points, -step)) / (2.0 * step);
        check_near(apply(&a.tangent, &points, 0), slope, 0.05);
        bat_analysis_free(&a);
    }
}

static void basis_is_a_partition_of_one(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 8; ++trial)
    {
        const bat_mask mask =
            trial == 0 ? bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT) : random_mask(&random, 4, 2, -trial);
        bat_basis basis;
        check_status(bat_mask_basis(&mask, 5, &basis, NULL), BAT_OK);
        assert_int_equal(basis.count, (size_t)(basis.last - basis.first) * 32 + 1);
        check_near(basis.values[0], 0.0, 0.0);
        check_near(basis.values[basis.count - 1], 0.0, 1e-14);
        for (size_t offset = 0; offset < 32; ++offset)
        {
            double sum = 0.0;
            for (size_t i = offset; i < basis.count; i += 32)
                sum += basis.values[i];
            check_near(sum, 1.0, 1e-13);
        }
        bat_basis_free(&basis);
        bat_basis_free(&basis);
    }
}

static void basis_of_chaikin_is_the_quadratic_spline(void **state)
{
    (void)state;
    bat_basis basis;
    const bat_mask mask = bat_mask_chaikin();
    check_status(bat_mask_basis(&mask, 6, &basis, NULL), BAT_OK);
    assert_int_equal(basis.first, -2);
    assert_int_equal(basis.last, 1);
    for (size_t i = 0; i < basis.count; ++i)
    {
        const double x = (double)i / 64.0;
        const double expected = x < 1.0 ? 0.5 * x * x : x < 2.0 ? 0.75 - (x - 1.5) * (x - 1.5) : 0.5 * (3.0 - x) * (3.0 - x);
        check_near(basis.values[i], expected, 1e-14);
    }
    bat_basis_free(&basis);
}

static void reproduction_agrees_with_refinement(void **state)
{
    (void)state;
    // The degrees of polynomials that one step takes from the parameters i + shift to (i + shift) / 2.
    bat_random random = bat_random_seed(31);
    for (int trial = 0; trial < 12; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT)
                              : trial == 2 ? bat_mask_lane_riesenfeld(6)
                              : trial == 3 ? bat_mask_six_point(0.01)
                                           : random_mask(&random, 3, 1 + (size_t)trial % 3, -3);
        bat_analysis a = analyze(mask);
        size_t degree = 0;
        for (bool holds = true; holds && degree <= a.generation_degree;)
        {
            row points = {.first = -20, .count = 41};
            for (int i = 0; i < points.count; ++i)
                points.values[i] = pow(points.first + i + a.shift, (double)degree);
            const row fine = refine(&mask, &points);
            for (int i = -3; i <= 3; ++i)
                holds = holds && fabs(fine.values[i - fine.first] - pow(0.5 * (i + a.shift), (double)degree)) < 1e-9;
            degree += holds ? 1 : 0;
        }
        assert_int_equal(a.reproduction_degree, degree - 1);
        bat_analysis_free(&a);
    }
}

static void difference_masks_refine_differences(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(13);
    const bat_mask mask = bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT);
    row points = random_points(&random, 30);
    row fine = refine(&mask, &points);
    for (size_t order = 1; order <= 6; ++order)
    {
        bat_mask difference;
        check_status(bat_mask_difference(&mask, order, &difference, NULL), BAT_OK);
        for (row *r = &points;; r = &fine)
        {
            for (int i = 0; i + 1 < r->count; ++i)
                r->values[i] = r->values[i + 1] - r->values[i];
            r->first += 1;
            r->count -= 1;
            if (r == &fine)
                break;
        }
        const row refined = refine(&difference, &points);
        for (int i = -4; i <= 4; ++i)
            check_near(refined.values[i - refined.first], fine.values[i - fine.first], 1e-12);
    }
    bat_mask difference;
    check_status(bat_mask_difference(&mask, 7, &difference, NULL), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limit_stencils_agree_with_refinement),
        cmocka_unit_test(limit_stencil_is_the_same_at_every_level),
        cmocka_unit_test(limit_stencils_reproduce_straight_lines),
        cmocka_unit_test(tangents_agree_with_difference_quotients),
        cmocka_unit_test(basis_is_a_partition_of_one),
        cmocka_unit_test(basis_of_chaikin_is_the_quadratic_spline),
        cmocka_unit_test(reproduction_agrees_with_refinement),
        cmocka_unit_test(difference_masks_refine_differences),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// What is known of the classical schemes, and of schemes and masks that are none.

#include "analysis_helpers.h"

#include "batten/research/curve_analysis.h"

static void chaikin_is_the_quadratic_spline(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_chaikin());
    assert_int_equal(a.multiplicity, 3);
    assert_int_equal(a.quotient.count, 1);
    check_near(a.quotient.coefficients[0], 0.25, 0.0);
    assert_int_equal(a.generation_degree, 2);
    assert_int_equal(a.reproduction_degree, 1);
    check_near(a.shift, -0.5, 0.0);
    // Alam 2025, section 3.2: matrix [3 1; 1 3] / 4, eigenvalues 1 and 1/2, eigenvectors (1, 1) and (-1, 1).
    assert_int_equal(a.matrix_first, 0);
    assert_int_equal(a.matrix_size, 2);
    const double matrix[] = {0.75, 0.25, 0.25, 0.75};
    assert_memory_equal(a.matrix, matrix, sizeof matrix);
    assert_int_equal(a.eigenvalue_count, 2);
    check_near(a.eigenvalues[1].real, 0.5, 0.0);
    const double *second = a.eigenvectors + 4 * a.eigenvalues[1].vector;
    check_near(second[0], -1.0, 1e-14);
    check_near(second[2], 1.0, 1e-14);
    check_near(weight(&a.limit, 0), 0.5, 1e-15);
    check_near(weight(&a.limit, 1), 0.5, 1e-15);
    check_near(weight(&a.tangent, 0), -1.0, 1e-14);
    check_near(weight(&a.tangent, 1), 1.0, 1e-14);
    check_near(weight(&a.vertex, -1), 1.0 / 8.0, 1e-15);
    check_near(weight(&a.vertex, 0), 6.0 / 8.0, 1e-15);
    check_near(weight(&a.vertex, 1), 1.0 / 8.0, 1e-15);
    assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_true(a.is_stable);
    check_near(a.exponent_lower, 2.0, 0.0);
    check_near(a.exponent_upper, 2.0, 0.0);
    assert_int_equal(a.smooth_proven, 1);
    assert_int_equal(a.smooth_disproven, 2);
    assert_int_equal(a.lipschitz, BAT_ANALYSIS_VERDICT_PROVEN);
    bat_analysis_free(&a);
}

static void corner_cutting_has_its_limit_stencil(void **state)
{
    (void)state;
    const double cuts[][2] = {{0.3, 0.7}, {0.2, 0.6}, {0.05, 0.9}, {0.4, 0.45}};
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; ++i)
    {
        const double r = cuts[i][0], s = cuts[i][1];
        bat_analysis a = analyze(bat_mask_corner_cutting(r, s));
        assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_PROVEN);
        check_near(weight(&a.limit, 0), (1.0 - s) / (1.0 - s + r), 1e-14);
        check_near(weight(&a.limit, 1), r / (1.0 - s + r), 1e-14);
        check_near(a.eigenvalues[1].real, s - r, 1e-14);
        assert_int_equal(a.multiplicity, 1);
        assert_int_equal(a.smooth_proven, 0);
        assert_int_equal(a.smooth_disproven, 1);
        assert_true(a.exponent_upper < 1.0);
        bat_analysis_free(&a);
    }
}

static void corner_cutting_is_smooth_where_edges_halve(void **state)
{
    (void)state;
    // 1 + z divides the difference mask [r, s - r, 1 - s] exactly when s - r = 1/2; then the second differences are refined
    // by [r, 1 - s], so that the exponent is -log2 max(r, 1 - s). Of these, only Chaikin's ratios are symmetric.
    for (int i = 1; i < 10; ++i)
    {
        const double r = 0.05 * i;
        bat_analysis a = analyze(bat_mask_corner_cutting(r, r + 0.5));
        assert_int_equal(a.smooth_proven, 1);
        assert_int_equal(a.smooth_disproven, 2);
        check_near(a.exponent_lower, -log2(fmax(r, 0.5 - r)), 1e-12);
        check_near(a.exponent_upper, -log2(fmax(r, 0.5 - r)), 1e-12);
        assert_int_equal(a.is_symmetric, i == 5);
        bat_analysis_free(&a);
    }
}

static void four_point_is_just_not_twice_differentiable(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_four_point(1.0 / 16.0));
    assert_int_equal(a.generation_degree, 3);
    assert_int_equal(a.reproduction_degree, 3);
    // Alam 2025, section 5.2: eigenvalues 1, 1/2, 1/4, 1/4, 1/8. There is no second eigenvector for 1/4, against the paper's
    // zero.
    assert_int_equal(a.matrix_size, 5);
    assert_int_equal(a.matrix_first, -2);
    const double values[] = {1.0, 0.5, 0.25, 0.125};
    const size_t multiplicities[] = {1, 1, 2, 1};
    assert_int_equal(a.eigenvalue_count, 4);
    for (size_t e = 0; e < 4; ++e)
    {
        check_near(a.eigenvalues[e].real, values[e], 1e-15);
        check_near(a.eigenvalues[e].imaginary, 0.0, 0.0);
        assert_int_equal(a.eigenvalues[e].multiplicity, multiplicities[e]);
        assert_int_equal(a.eigenvalues[e].vector_count, 1);
    }
    for (int i = 0; i < 5; ++i)
        check_near(a.eigenvectors[10 * a.eigenvalues[3].vector + 2 * (size_t)i], pow((i - 2) / 2.0, 3), 1e-13);
    assert_int_equal(a.limit.count, 1);
    check_near(a.limit.weights[0], 1.0, 0.0);
    const double tangent[] = {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0};
    for (int i = 0; i < 5; ++i)
        check_near(weight(&a.tangent, i - 2), tangent[i], 1e-13);
    // The exponent of the derivative is 1 as a supremum only.
    assert_true(a.exponent_lower < 2.0);
    check_near(a.exponent_lower, 2.0, 1e-9);
    check_near(a.exponent_upper, 2.0, 1e-12);
    assert_int_equal(a.smooth_proven, 1);
    assert_int_equal(a.smooth_disproven, 2);
    assert_int_equal(a.lipschitz, BAT_ANALYSIS_VERDICT_DISPROVEN);
    bat_analysis_free(&a);
}

static void four_point_loses_its_tangent_at_a_cubic_root(void **state)
{
    (void)state;
    // Hechler, Mößner and Reif 2009: C^1 for 0 < w < w*, the real root of 32 w^3 + 4 w - 1 = 0.
    double low = 0.1, high = 0.3;
    for (int i = 0; i < 60; ++i)
    {
        const double middle = 0.5 * (low + high);
        if (32.0 * middle * middle * middle + 4.0 * middle < 1.0)
            low = middle;
        else
            high = middle;
    }
    check_near(low, 0.19273, 1e-5);
    bat_analysis below = analyze(bat_mask_four_point(low - 1e-5));
    assert_int_equal(below.smooth_proven, 1);
    bat_analysis above = analyze(bat_mask_four_point(low + 1e-5));
    assert_int_equal(above.smooth_proven, 0);
    assert_int_equal(above.smooth_disproven, 1);
    bat_analysis_free(&below);
    bat_analysis_free(&above);
}

static void known_exponents_are_found(void **state)
{
    (void)state;
    // Six-point: 2.830 (Deslauriers and Dubuc 1989), which is -log2(9/64).
    bat_analysis six = analyze(bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT));
    assert_int_equal(six.generation_degree, 5);
    assert_int_equal(six.reproduction_degree, 5);
    assert_int_equal(six.smooth_proven, 2);
    assert_int_equal(six.smooth_disproven, 3);
    check_near(six.exponent_lower, -log2(9.0 / 64.0), 1e-9);
    check_near(six.exponent_upper, -log2(9.0 / 64.0), 1e-9);
    bat_analysis_free(&six);
    // Daubechies' scaling function with two vanishing moments: 2 - log2(1 + sqrt 3) (Daubechies and Lagarias 1992).
    const double q = sqrt(3.0);
    const bat_mask d4 = {.coefficients = {(1 + q) / 4, (3 + q) / 4, (3 - q) / 4, (1 - q) / 4}, .count = 4};
    bat_analysis daubechies = analyze(d4);
    assert_int_equal(daubechies.multiplicity, 2);
    assert_int_equal(daubechies.smooth_proven, 0);
    check_near(daubechies.exponent_lower, 2.0 - log2(1.0 + q), 1e-9);
    check_near(daubechies.exponent_upper, 2.0 - log2(1.0 + q), 1e-9);
    bat_analysis_free(&daubechies);
}

static void lane_riesenfeld_is_a_spline(void **state)
{
    (void)state;
    const size_t orders[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 33, 80};
    for (size_t i = 0; i < sizeof orders / sizeof *orders; ++i)
    {
        const size_t order = orders[i];
        bat_analysis a = analyze(bat_mask_lane_riesenfeld(order));
        assert_int_equal(a.multiplicity, order + 1);
        assert_int_equal(a.generation_degree, order);
        assert_int_equal(a.reproduction_degree, 1);
        assert_int_equal(a.smooth_proven, order - 1);
        assert_int_equal(a.smooth_disproven, order);
        check_near(a.exponent_lower, (double)order, 1e-12);
        check_near(a.exponent_upper, (double)order, 1e-12);
        assert_int_equal(a.lipschitz, BAT_ANALYSIS_VERDICT_PROVEN);
        for (size_t e = 0; e < a.eigenvalue_count; ++e)
            check_near(a.eigenvalues[e].real, ldexp(1.0, -(int)e), 0.0);
        bat_analysis_free(&a);
    }
}

static void derivative_exponents_follow(void **state)
{
    (void)state;
    bat_analysis a = analyze(bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT));
    double lower, upper;
    assert_true(bat_analysis_derivative_exponent(&a, 0, &lower, &upper));
    check_near(lower, 1.0, 0.0);
    assert_true(bat_analysis_derivative_exponent(&a, 2, &lower, &upper));
    check_near(lower, 0.830074998, 1e-8);
    check_near(upper, 0.830074998, 1e-8);
    assert_false(bat_analysis_derivative_exponent(&a, 3, &lower, &upper));
    bat_analysis_free(&a);
}

// Schemes without limits, limits without proofs, and masks that are none.

static void divergent_schemes_are_told(void **state)
{
    (void)state;
    const bat_mask masks[] = {
        {.coefficients = {1.0, 1.0}, .count = 2, .first = 0},           // piecewise constant
        {.coefficients = {1.0, 0.0, 0.0, 1.0}, .count = 4, .first = 0}, // a comb
        bat_mask_four_point(0.5),
        bat_mask_four_point(-0.7),
        {.coefficients = {-1.0, 3.0, 2.0, -2.0}, .count = 4, .first = -2},
    };
    for (size_t m = 0; m < sizeof masks / sizeof *masks; ++m)
    {
        bat_analysis a = analyze(masks[m]);
        assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_DISPROVEN);
        assert_int_equal(a.smooth_proven, -1);
        assert_int_equal(a.smooth_disproven, 0);
        assert_int_equal(a.limit.count, 0);
        assert_int_equal(a.vertex.count, 0);
        double lower, upper;
        assert_false(bat_analysis_derivative_exponent(&a, 0, &lower, &upper));
        bat_analysis_free(&a);
        bat_mask_stencil stencil;
        bat_basis basis;
        bat_error error;
        check_status(bat_mask_limit_stencil(&masks[m], &stencil, &error), BAT_NO_CONVERGENCE);
        check_status(error.status, BAT_NO_CONVERGENCE);
        check_status(bat_mask_basis(&masks[m], 3, &basis, &error), BAT_NO_CONVERGENCE);
    }
}

static void unstable_masks_get_no_upper_bound(void **state)
{
    (void)state;
    // (1 + z) (1 + z^2) (1 + z + z^2) / 6 has the zeros i and -i; its limit function is the sum of two shifts of the one of
    // (1 + z)^2 (1 + z + z^2) / 6, and as smooth as that, although its own differences tell less.
    const bat_mask unstable = {.coefficients = {1.0 / 6, 2.0 / 6, 3.0 / 6, 3.0 / 6, 2.0 / 6, 1.0 / 6}, .count = 6};
    const bat_mask stable = {.coefficients = {1.0 / 6, 3.0 / 6, 4.0 / 6, 3.0 / 6, 1.0 / 6}, .count = 5};
    bat_analysis a = analyze(unstable);
    bat_analysis b = analyze(stable);
    assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_false(a.is_stable);
    assert_true(isinf(a.exponent_upper));
    assert_int_equal(a.smooth_disproven, -1);
    assert_true(b.is_stable);
    assert_true(a.exponent_lower < b.exponent_lower - 0.5);
    assert_int_equal(b.smooth_proven, 1);
    bat_analysis_free(&a);
    bat_analysis_free(&b);
    // 1 - z + z^2 vanishes at the negatives of the cube roots of unity, a cycle under squaring.
    bat_mask cycle = {.coefficients = {1.0, -1.0, 1.0}, .count = 3};
    for (size_t s = 0; s < 4; ++s)
    {
        for (size_t k = cycle.count; k > 0; --k)
            cycle.coefficients[k] = (k < cycle.count ? cycle.coefficients[k] : 0.0) + cycle.coefficients[k - 1];
        ++cycle.count;
    }
    for (size_t k = 0; k < cycle.count; ++k)
        cycle.coefficients[k] /= 8.0;
    bat_analysis c = analyze(cycle);
    assert_int_equal(c.converges, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_int_equal(c.multiplicity, 4);
    assert_false(c.is_stable);
    bat_analysis_free(&c);
}

static void check_refused(bat_mask mask, bat_status expected, const char *part)
{
    bat_analysis analysis;
    memset(&analysis, 0x5a, sizeof analysis);
    const bat_analysis before = analysis;
    bat_error error;
    check_status(bat_mask_analyze(&mask, NULL, &analysis, &error), expected);
    check_status(error.status, expected);
    assert_non_null(strstr(error.text, part));
    assert_memory_equal(&analysis, &before, sizeof analysis);
    check_status(bat_mask_analyze(&mask, NULL, &analysis, NULL), expected);
    bat_mask_stencil stencil;
    check_status(bat_mask_limit_stencil(&mask, &stencil, NULL), expected);
}

static void malformed_masks_are_refused(void **state)
{
    (void)state;
    check_refused((bat_mask){.count = 0}, BAT_INVALID_ARGUMENT, "coefficients");
    check_refused((bat_mask){.count = BAT_MASK_MAX + 1}, BAT_INVALID_ARGUMENT, "coefficients");
    check_refused((bat_mask){.coefficients = {1.0, NAN}, .count = 2}, BAT_INVALID_ARGUMENT, "coefficient 1");
    check_refused((bat_mask){.coefficients = {INFINITY, 1.0}, .count = 2}, BAT_INVALID_ARGUMENT, "coefficient 0");
    check_refused((bat_mask){.coefficients = {0.5, 0.5}, .count = 2}, BAT_INVALID_ARGUMENT, "even index sum to 0.5");
    check_refused((bat_mask){.coefficients = {0.5, 0.4, 0.5, 0.5}, .count = 4}, BAT_INVALID_ARGUMENT,
                  "odd index sum to 0.9");
    check_refused((bat_mask){.coefficients = {1.0}, .count = 1}, BAT_INVALID_ARGUMENT, "odd");
    check_refused((bat_mask){.coefficients = {0.5, 1.0, 0.5}, .count = 3, .first = 2000000000}, BAT_INVALID_ARGUMENT,
                  "first");
    check_refused((bat_mask){.coefficients = {1e308, 1e308, 1e308, 1e308}, .count = 4}, BAT_INVALID_ARGUMENT, "beyond");
}

static void options_are_checked(void **state)
{
    (void)state;
    const bat_mask mask = bat_mask_chaikin();
    bat_analysis analysis;
    bat_mask_analyze_options options = bat_mask_analyze_defaults();
    options.depth = 0;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options.depth = BAT_ANALYSIS_MAX_DEPTH + 1;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options = bat_mask_analyze_defaults();
    options.tolerance = NAN;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    options = bat_mask_analyze_defaults();
    options.vertices = 0;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_INVALID_ARGUMENT);
    bat_basis basis;
    check_status(bat_mask_basis(&mask, 60, &basis, NULL), BAT_TOO_LARGE);
    assert_string_equal(bat_choice_name(&bat_analysis_verdict_family, BAT_ANALYSIS_VERDICT_PROVEN), "proven");
}

static void long_masks_are_taken(void **state)
{
    (void)state;
    bat_mask mask = {.count = BAT_MASK_MAX, .first = -64};
    for (size_t k = 0; k < mask.count; ++k)
        mask.coefficients[k] = 2.0 / BAT_MASK_MAX;
    bat_analysis a = analyze_to_depth(mask, 2);
    // The symbol is (1 + z) (1 + z^2) … (1 + z^64) / 64, so it has the zeros i and -i.
    assert_int_equal(a.converges, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_int_equal(a.multiplicity, 1);
    assert_false(a.is_stable);
    bat_analysis_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chaikin_is_the_quadratic_spline),
        cmocka_unit_test(corner_cutting_has_its_limit_stencil),
        cmocka_unit_test(corner_cutting_is_smooth_where_edges_halve),
        cmocka_unit_test(four_point_is_just_not_twice_differentiable),
        cmocka_unit_test(four_point_loses_its_tangent_at_a_cubic_root),
        cmocka_unit_test(known_exponents_are_found),
        cmocka_unit_test(lane_riesenfeld_is_a_spline),
        cmocka_unit_test(derivative_exponents_follow),
        cmocka_unit_test(divergent_schemes_are_told),
        cmocka_unit_test(unstable_masks_get_no_upper_bound),
        cmocka_unit_test(malformed_masks_are_refused),
        cmocka_unit_test(options_are_checked),
        cmocka_unit_test(long_masks_are_taken),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

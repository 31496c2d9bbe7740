// Bounds of smoothness: invariances, tightening, and brute force.

#include "analysis_helpers.h"

#include "batten/research/curve_analysis.h"

static void shifts_and_zeros_change_nothing_else(void **state)
{
    (void)state;
    const bat_mask mask = bat_mask_corner_cutting(0.2, 0.55);
    bat_mask moved = {.count = mask.count + 5, .first = mask.first + 17 - 2};
    for (size_t k = 0; k < mask.count; ++k)
        moved.coefficients[k + 2] = mask.coefficients[k];
    bat_analysis a = analyze(mask);
    bat_analysis b = analyze(moved);
    assert_int_equal(b.mask.count, a.mask.count);
    assert_int_equal(b.mask.first, a.mask.first + 17);
    check_near(b.shift, a.shift + 17.0, 1e-13);
    assert_int_equal(b.matrix_first, a.matrix_first - 17);
    check_near(b.exponent_lower, a.exponent_lower, 1e-12);
    check_near(b.exponent_upper, a.exponent_upper, 1e-12);
    assert_int_equal(b.vertex.count, a.vertex.count);
    assert_int_equal(b.vertex.first, a.vertex.first);
    for (size_t k = 0; k < a.vertex.count; ++k)
        check_near(b.vertex.weights[k], a.vertex.weights[k], 1e-10);
    bat_analysis_free(&a);
    bat_analysis_free(&b);
}

static void reversal_reverses(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(17);
    for (int trial = 0; trial < 10; ++trial)
    {
        const bat_mask mask = random_mask(&random, 4, 1 + (size_t)trial % 3, -3);
        const bat_mask mirror = reversed(&mask);
        bat_analysis a = analyze(mask);
        bat_analysis b = analyze(mirror);
        check_near(b.shift, -a.shift, 1e-14);
        assert_int_equal(b.multiplicity, a.multiplicity);
        assert_int_equal(b.reproduction_degree, a.reproduction_degree);
        // Both pairs of bounds hold the same number.
        assert_true(a.exponent_lower <= b.exponent_upper && b.exponent_lower <= a.exponent_upper);
        for (int k = -6; k <= 6; ++k)
        {
            check_near(weight(&b.limit, k), weight(&a.limit, -k), 1e-13);
            check_near(weight(&b.vertex, k), weight(&a.vertex, -k), 1e-9);
            check_near(weight(&b.tangent, k), -weight(&a.tangent, -k), 1e-11);
        }
        bat_analysis_free(&a);
        bat_analysis_free(&b);
    }
}

static void smoothing_adds_one_derivative(void **state)
{
    (void)state;
    // Convolution with the unit box integrates: one more factor (1 + z) / 2 adds 1 to the exponent.
    bat_mask mask = bat_mask_corner_cutting(0.15, 0.6);
    bat_analysis before = analyze(mask);
    for (size_t k = mask.count; k > 0; --k)
        mask.coefficients[k] = 0.5 * ((k < mask.count ? mask.coefficients[k] : 0.0) + mask.coefficients[k - 1]);
    mask.coefficients[0] *= 0.5;
    ++mask.count;
    bat_analysis after = analyze(mask);
    assert_int_equal(after.multiplicity, before.multiplicity + 1);
    check_near(after.exponent_lower, before.exponent_lower + 1.0, 1e-9);
    check_near(after.exponent_upper, before.exponent_upper + 1.0, 1e-9);
    assert_int_equal(after.smooth_proven, before.smooth_proven + 1);
    bat_analysis_free(&before);
    bat_analysis_free(&after);
}

static void bounds_tighten_with_depth(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(41);
    for (int trial = 0; trial < 5; ++trial)
    {
        const bat_mask mask = trial == 0 ? bat_mask_six_point(0.02) : random_mask(&random, 5, 1, -3);
        double lower = -INFINITY;
        double upper = INFINITY;
        for (size_t depth = 1; depth <= 9; ++depth)
        {
            bat_analysis a = analyze_to_depth(mask, depth);
            assert_true(a.exponent_lower >= lower);
            assert_true(a.exponent_upper <= upper);
            assert_true(a.exponent_lower <= a.exponent_upper);
            lower = a.exponent_lower;
            upper = a.exponent_upper;
            bat_analysis_free(&a);
        }
        assert_true(upper - lower < 0.02);
    }
}

/// The growth of a mask's subdivision operator by |S^k|^(1/k) in the maximum norm, which is never below the true one.
static double measured_growth(const bat_mask *mask, int steps)
{
    static double values[1 << 16];
    static double next[1 << 16];
    size_t count = 1;
    values[0] = 1.0;
    for (int s = 0; s < steps; ++s)
    {
        const size_t arity = (size_t)1 << s;
        const size_t longer = count + (mask->count - 1) * arity;
        assert_true(longer <= sizeof next / sizeof *next);
        memset(next, 0, sizeof next);
        for (size_t k = 0; k < mask->count; ++k)
            for (size_t i = 0; i < count; ++i)
                next[i + k * arity] += mask->coefficients[k] * values[i];
        memcpy(values, next, sizeof values);
        count = longer;
    }
    double norm = 0.0;
    const size_t arity = (size_t)1 << steps;
    for (size_t residue = 0; residue < arity; ++residue)
    {
        double sum = 0.0;
        for (size_t i = residue; i < count; i += arity)
            sum += fabs(values[i]);
        norm = fmax(norm, sum);
    }
    return pow(norm, 1.0 / steps);
}

static void bounds_hold_measured_growth(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(43);
    for (int trial = 0; trial < 12; ++trial)
    {
        const bat_mask mask = trial == 0   ? bat_mask_four_point(1.0 / 16.0)
                              : trial == 1 ? bat_mask_four_point(0.19)
                                           : random_mask(&random, 3 + (size_t)trial % 4, (size_t)trial % 3 + 1, 0);
        bat_analysis a = analyze(mask);
        assert_true(a.radius_lower <= a.radius_upper);
        assert_true(a.radius_lower <= measured_growth(&a.quotient, 12) * (1.0 + 1e-12));
        // |S^12| is at most a moderate constant times radius^12.
        assert_true(a.radius_upper >= measured_growth(&a.quotient, 12) * pow(0.02, 1.0 / 12.0));
        bat_analysis_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shifts_and_zeros_change_nothing_else), cmocka_unit_test(reversal_reverses),
        cmocka_unit_test(smoothing_adds_one_derivative),        cmocka_unit_test(bounds_tighten_with_depth),
        cmocka_unit_test(bounds_hold_measured_growth),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// The masks of the named schemes, and what a mask says about itself.

#include "check.h"

#include "batten/curve_scheme.h"
#include "curve/mask.h"

static double coefficient(const bat_mask *mask, int index)
{
    const int k = index - mask->first;
    return k >= 0 && k < (int)mask->count ? mask->coefficients[k] : 0.0;
}

static double parity_sum(const bat_mask *mask, int parity)
{
    double sum = 0.0;
    for (int i = mask->first; i < mask->first + (int)mask->count; ++i)
        sum += (i - parity) % 2 == 0 ? coefficient(mask, i) : 0.0;
    return sum;
}

static void chaikin_takes_quarters(void **state)
{
    (void)state;
    const bat_mask mask = bat_mask_chaikin();
    // New point 0 is 3/4 p_0 + 1/4 p_1, new point 1 is 1/4 p_0 + 3/4 p_1: new point i weighs p_j by a(i - 2 j).
    check_near(coefficient(&mask, 0), 0.75, 0.0);
    check_near(coefficient(&mask, -2), 0.25, 0.0);
    check_near(coefficient(&mask, 1), 0.25, 0.0);
    check_near(coefficient(&mask, -1), 0.75, 0.0);
    assert_int_equal(mask.count, 4);
}

static void corner_cutting_takes_its_ratios(void **state)
{
    (void)state;
    const double r = 0.2, s = 0.65;
    const bat_mask mask = bat_mask_corner_cutting(r, s);
    check_near(coefficient(&mask, 0), 1.0 - r, 0.0);
    check_near(coefficient(&mask, -2), r, 0.0);
    check_near(coefficient(&mask, 1), 1.0 - s, 0.0);
    check_near(coefficient(&mask, -1), s, 0.0);
    const bat_mask chaikin = bat_mask_chaikin();
    const bat_mask same = bat_mask_corner_cutting(0.25, 0.75);
    for (int i = -2; i < 2; ++i)
        check_near(coefficient(&same, i), coefficient(&chaikin, i), 0.0);
}

/// The value at 1/2 of the polynomial through the points (j, j^power), j = 1 - half … half, is the mask's own at odd
/// index 1.
static void check_reproduces_power(const bat_mask *mask, int half, int power)
{
    double value = 0.0;
    for (int j = 1 - half; j <= half; ++j)
        value += coefficient(mask, 1 - 2 * j) * pow(j, power);
    check_near(value, pow(0.5, power), 1e-12);
}

static void interpolatory_masks_reproduce_polynomials(void **state)
{
    (void)state;
    const bat_mask four = bat_mask_four_point(1.0 / 16.0);
    for (int power = 0; power <= 3; ++power)
        check_reproduces_power(&four, 2, power);
    const bat_mask six = bat_mask_six_point(BAT_MASK_SIX_POINT_WEIGHT);
    for (int power = 0; power <= 5; ++power)
        check_reproduces_power(&six, 3, power);
    const bat_mask six_at_zero = bat_mask_six_point(0.0);
    for (int i = -5; i <= 5; ++i)
        check_near(coefficient(&six_at_zero, i), coefficient(&four, i), 0.0);
}

static double choose(int n, int k)
{
    double product = 1.0;
    for (int i = 1; i <= k; ++i)
        product *= (double)(n - k + i) / i;
    return round(product);
}

static void lane_riesenfeld_has_binomials(void **state)
{
    (void)state;
    for (int order = 1; order <= 20; ++order)
    {
        const bat_mask mask = bat_mask_lane_riesenfeld((size_t)order);
        assert_int_equal(mask.count, order + 2);
        // The centre is 0 for masks of odd length and -1/2 for those of even length.
        assert_int_equal(2 * mask.first + order + 1, order % 2 == 0 ? -1 : 0);
        for (int k = 0; k <= order + 1; ++k)
            check_near(mask.coefficients[k], ldexp(choose(order + 1, k), -order), 0.0);
    }
    const bat_mask chaikin = bat_mask_chaikin();
    const bat_mask second = bat_mask_lane_riesenfeld(2);
    assert_memory_equal(chaikin.coefficients, second.coefficients, 4 * sizeof(double));
    assert_int_equal(chaikin.first, second.first);
}

static void lane_riesenfeld_out_of_range_is_empty(void **state)
{
    (void)state;
    assert_int_equal(bat_mask_lane_riesenfeld(0).count, 0);
    const bat_mask longest = bat_mask_lane_riesenfeld(BAT_MASK_MAX - 2);
    assert_int_equal(longest.count, BAT_MASK_MAX);
    assert_int_equal(bat_mask_lane_riesenfeld(BAT_MASK_MAX - 1).count, 0);
    assert_int_equal(bat_mask_lane_riesenfeld((size_t)-1).count, 0);
    check_relative(longest.coefficients[0], 0x1p-126, 0.0);
    check_relative(longest.coefficients[1], 127.0 * 0x1p-126, 1e-15);
}

static void constants_are_reproduced(void **state)
{
    (void)state;
    const bat_mask masks[] = {bat_mask_chaikin(),           bat_mask_corner_cutting(0.3, 0.9), bat_mask_four_point(0.07),
                              bat_mask_six_point(0.013),    bat_mask_lane_riesenfeld(1),       bat_mask_lane_riesenfeld(9),
                              bat_mask_lane_riesenfeld(126)};
    for (size_t m = 0; m < sizeof masks / sizeof *masks; ++m)
    {
        check_near(parity_sum(&masks[m], 0), 1.0, 1e-14);
        check_near(parity_sum(&masks[m], 1), 1.0, 1e-14);
    }
}

static void interpolatory_masks_are_told(void **state)
{
    (void)state;
    bat_mask four = bat_mask_four_point(0.1);
    assert_true(mask_is_interpolatory(&four));
    const bat_mask six = bat_mask_six_point(0.01);
    assert_true(mask_is_interpolatory(&six));
    const bat_mask hat = bat_mask_lane_riesenfeld(1);
    assert_true(mask_is_interpolatory(&hat));
    const bat_mask chaikin = bat_mask_chaikin();
    assert_false(mask_is_interpolatory(&chaikin));
    const bat_mask cubic = bat_mask_lane_riesenfeld(3);
    assert_false(mask_is_interpolatory(&cubic));
    four.first += 1;
    assert_false(mask_is_interpolatory(&four));
    four.first += 1; // the 1 now stands at index 2
    assert_false(mask_is_interpolatory(&four));
    four.count = 0;
    assert_false(mask_is_interpolatory(&four));
}

static void symmetric_masks_are_told(void **state)
{
    (void)state;
    const bat_mask symmetric[] = {bat_mask_chaikin(),
                                  bat_mask_corner_cutting(0.3, 0.7),
                                  bat_mask_four_point(0.1),
                                  bat_mask_six_point(0.01),
                                  bat_mask_lane_riesenfeld(7),
                                  // zeros at one end do not count
                                  {.coefficients = {0.0, 0.0, 0.5, 1.0, 0.5}, .count = 5, .first = 3}};
    for (size_t m = 0; m < sizeof symmetric / sizeof *symmetric; ++m)
        assert_true(mask_is_symmetric(&symmetric[m]));
    const bat_mask others[] = {bat_mask_corner_cutting(0.3, 0.8),
                               {.coefficients = {0.5, 1.0, 0.5 + 1e-12}, .count = 3, .first = 0},
                               {.coefficients = {NAN, 1.0, NAN}, .count = 3, .first = 0},
                               {.coefficients = {0.0, 0.0}, .count = 2, .first = 0},
                               {.count = 0}};
    for (size_t m = 0; m < sizeof others / sizeof *others; ++m)
        assert_false(mask_is_symmetric(&others[m]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chaikin_takes_quarters),
        cmocka_unit_test(corner_cutting_takes_its_ratios),
        cmocka_unit_test(interpolatory_masks_reproduce_polynomials),
        cmocka_unit_test(lane_riesenfeld_has_binomials),
        cmocka_unit_test(lane_riesenfeld_out_of_range_is_empty),
        cmocka_unit_test(constants_are_reproduced),
        cmocka_unit_test(interpolatory_masks_are_told),
        cmocka_unit_test(symmetric_masks_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

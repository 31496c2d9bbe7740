// Orders of accuracy under halving, the distance between De Casteljau and Bezier averages, contraction and displacement.

#include "hermite_helpers.h"

/// log2 of the ratio of two errors, of which the second belongs to half the spacing.
static double observed_order(double coarse, double fine)
{
    return log2(coarse / fine);
}

static double error_of(const study_curve *curve, const study_setup *setup)
{
    double largest = 0;
    bat_error error;
    if (study_refinement_error(curve, setup, &largest, &error) != BAT_OK)
        fail_msg("%s: %s", curve->space->name, error.text);
    return largest;
}

/// Fail unless halving the spacing divides the error by 2^3.9 or more.
static void check_fourth_order(const study_curve *curve, study_setup setup)
{
    double error = error_of(curve, &setup);
    setup.count = setup.closed ? 2 * setup.count : 2 * setup.count - 1;
    double half = error_of(curve, &setup);
    if (!(observed_order(error, half) >= 3.9))
        fail_msg("%s: errors %g and %g, order %.2f", curve->space->name, error, half, observed_order(error, half));
}

/// Lane-Riesenfeld of order 1 is fourth-order accurate, and so is parallel transport with Merrien's mask, wherever it sums.
static void interpolation_is_of_fourth_order(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 6 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        bool closed = trial / SPACES % 2 == 0;
        size_t kind = trial / SPACES / 2;
        study_curve curve = smooth_curve(space, trial);
        bat_hermite_refine_options how = bat_hermite_refine_defaults();
        how.levels = 3;
        const bat_hermite_linear linear = {bat_hermite_mask_merrien(-0.125, -0.5),
                                           kind == 1 ? BAT_CURVE_BASE_MIDPOINT : BAT_CURVE_BASE_VERTEX};
        study_setup setup = {.count = closed ? 64 : 49, .closed = closed, .options = &how};
        setup.linear = kind == 0 ? NULL : &linear;
        check_fourth_order(&curve, setup);
        study_curve_free(&curve);
    }
}

/// So are the higher orders, which do not interpolate: every average lies on the curve up to the fourth power of the
/// spacing. (The splines that Lane-Riesenfeld makes of points alone are of second order.)
static void smoothing_is_of_fourth_order(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 3 * SPACES; trial++)
    {
        study_curve curve = smooth_curve(&spaces[trial % SPACES], trial);
        bat_hermite_refine_options how = bat_hermite_refine_defaults();
        how.levels = 3;
        how.order = 2 + trial / SPACES;
        check_fourth_order(&curve, (study_setup){.count = 64, .closed = true, .options = &how});
        study_curve_free(&curve);
    }
}

/// Directions of order 4 are good enough, and neither they nor the scheme mind uneven spacing.
static void points_alone_are_enough(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 2 * SPACES; trial++)
    {
        bool closed = trial < SPACES;
        study_curve curve = smooth_curve(&spaces[trial % SPACES], trial);
        bat_hermite_refine_options how = bat_hermite_refine_defaults();
        how.levels = 3;
        check_fourth_order(
            &curve,
            (study_setup){
                .count = closed ? 256 : 193, .closed = closed, .unevenness = 0.4, .estimated = true, .options = &how});
        study_curve_free(&curve);
    }
}

/// Lemma 3.7 and theorem 4.3 on the sphere in R^3: the points of the two averages are O(d^2) apart, angles O(d).
static void averages_are_near_beziers(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), rotation = bat_rotation();
    for (uint64_t seed = 0; seed < 20; seed++)
    {
        study_proximity near[2];
        for (int half = 0; half < 2; half++)
        {
            bat_random random = bat_random_seed(seed);
            hermite_pair pair = random_pair(&sphere, &random, half == 0 ? 2e-3 : 1e-3, 0.2);
            check_status(study_proximity_of(&sphere, pair.p0, pair.v0, pair.p1, pair.v1, &near[half]), BAT_OK);
        }
        check_near(near[0].length, 2e-3, 1e-12);
        assert_true(near[0].point < near[0].length * near[0].length);
        assert_true(near[0].angle < near[0].length);
        assert_true(near[1].point < 0.26 * near[0].point);
        assert_true(near[1].angle < 0.52 * near[0].angle);
    }
    bat_random random = bat_random_seed(1);
    study_proximity near;
    hermite_pair pair = random_pair(&sphere, &random, 0.1, 0.2);
    check_status(study_proximity_of(&rotation, pair.p0, pair.v0, pair.p1, pair.v1, &near), BAT_UNSUPPORTED);
}

/// Eq. (4.2) with a factor near 1/2, eq. (4.3) with displacements that do not grow with the order as fast as C_m = (m + 1)
/// / 4.
static void levels_contract_and_stay_near(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 5 * SPACES; trial++)
    {
        study_curve curve = smooth_curve(&spaces[trial % SPACES], trial);
        size_t order = 1 + trial / SPACES;
        bat_hermite_curve coarse = even_directions(&curve, 24, true);
        bat_hermite_refine_options how = bat_hermite_refine_defaults();
        how.levels = 1;
        how.order = order;
        for (int level = 0; level < 3; level++)
        {
            bat_hermite_curve fine = hermite_refined(&coarse, &how);
            double longest = study_longest_edge(&coarse);
            assert_true(study_longest_edge(&fine) < 0.55 * longest);
            double displaced = study_displacement(&coarse, &fine) / longest;
            assert_true(order == 1 ? displaced == 0 : displaced < 0.25 * ((double)order + 1));
            bat_hermite_free(&coarse);
            coarse = fine;
        }
        bat_hermite_free(&coarse);
        study_curve_free(&curve);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interpolation_is_of_fourth_order), cmocka_unit_test(smoothing_is_of_fourth_order),
        cmocka_unit_test(points_alone_are_enough),          cmocka_unit_test(averages_are_near_beziers),
        cmocka_unit_test(levels_contract_and_stay_near),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

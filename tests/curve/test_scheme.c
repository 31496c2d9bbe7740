#include "refine_helpers.h"

static void scheme_names_are_read_strictly(void **state)
{
    (void)state;
    const char *bad[] = {"",
                         "chaikins",
                         "chaikin:w=1",
                         "four-point:w=",
                         "four-point:w=x",
                         "four-point:w=1x",
                         "four-point:w",
                         "corner-cutting:r=0.8,s=0.2",
                         "lane-riesenfeld:order=0",
                         "lane-riesenfeld:order=2.5",
                         "lane-riesenfeld:order=127",
                         "angle-4:sign=inward",
                         "angle-4:mu=1",
                         "learned:fairness=1.5",
                         "learned:fairness=nan",
                         "log-exp-4:base=edge",
                         "four-point:parameters=length",
                         "four-point:parameters=",
                         "four-point:base=midpoint",
                         "six-point:parameters=chordal",
                         "catmull-rom:w=0.1",
                         "cubic:parameters=1",
                         "mask:",
                         "mask:1,",
                         "mask:1,x",
                         "mask:1/0",
                         "mask:1,1@a",
                         "mask:1,1@999999999999999999999",
                         "mask:1,1@0z",
                         "mask:1,1@99",
                         "mask:1,1@3",
                         "mask:1,1@-5",
                         "four-point:w=nan",
                         "angle:mu=1/0",
                         "angle-4:adaptive=7",
                         "angle-4:adaptive=0.5",
                         "angle-4:sign=printed,",
                         "mask:1e308/1e-308"};
    bat_curve_scheme result;
    bat_error error;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
    {
        error.text[0] = '\0';
        if (bat_curve_scheme_by_name(bad[i], &result, &error) == BAT_OK)
            fail_msg("'%s' was accepted", bad[i]);
        assert_true(error.text[0] != '\0');
    }
    assert_true(scheme("angle:mu=-1/8,sign=printed").tension == -0.125);
    assert_int_equal(scheme("angle:mu=-1/8,sign=printed").sign, BAT_CURVE_ANGLE_SIGN_PRINTED);
    assert_int_equal(scheme("log-exp-6:base=midpoint").base, BAT_CURVE_BASE_MIDPOINT);
    assert_int_equal(scheme("mask:1/4,3/4,3/4,1/4").mask.first, -2);
    check_status(bat_curve_scheme_by_name("mask:1,1@99", &result, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "from -4 to 2, not 99"));
    assert_int_equal(scheme("mask:1,1@2").mask.first, 2);
    assert_int_equal(scheme("mask:1,1@-4").mask.first, -4);
    size_t listed = 0;
    while (bat_choices(&bat_curve_scheme_family, listed) != NULL)
        listed++;
    assert_int_equal(listed, 17);
    assert_true(scheme("learned").rule != NULL && scheme("learned").fairness == 0.25);
    assert_true(scheme("learned:fairness=1").fairness == 1);
}

/// Every space begins with the scheme that its name is known by, and keeps the points it is given.
static void every_space_has_a_scheme(void **state)
{
    (void)state;
    const struct
    {
        bat_space space;
        const char *name;
    } cases[] = {{bat_euclidean(2), "learned"},    {bat_sphere(2), "learned"},   {bat_disk(), "learned"},
                 {bat_euclidean(3), "four-point"}, {bat_sphere(3), "log-exp-4"}, {bat_euclidean(1), "four-point"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
    {
        const bat_space *space = &cases[i].space;
        size_t dim = space->point_dim;
        const char *name;
        bat_curve_scheme chosen = bat_curve_scheme_for(space, &name);
        assert_string_equal(name, cases[i].name);
        double points[4 * 4];
        for (size_t k = 0; k < 4; k++)
        {
            double coordinates[4] = {0.5, 0.1 * (double)k, 0.03 * (double)(k * k), 0.2};
            check_status(space->project(space, coordinates, points + k * dim), BAT_OK);
            points[k * dim + dim - 1] += i == 5 ? 0.1 * (double)k : 0;
        }
        bat_curve coarse = {.space = space, .points = points, .count = 4};
        bat_curve_refine_options by_space = bat_curve_refine_defaults(), by_name = options(cases[i].name, 2);
        by_space.levels = 2;
        by_space.scheme = chosen;
        bat_curve one = refined(&coarse, &by_space), other = refined(&coarse, &by_name);
        assert_int_equal(one.count, 13);
        assert_memory_equal(one.points, other.points, one.count * dim * sizeof *one.points);
        for (size_t k = 0; k < 4 * dim; k++)
            assert_true(one.points[4 * (k / dim) * dim + k % dim] == points[k]);
        bat_curve_free(&one);
        bat_curve_free(&other);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scheme_names_are_read_strictly),
        cmocka_unit_test(every_space_has_a_scheme),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

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
    assert_int_equal(scheme("angle:mu=-1/8,sign=printed").sign, BAT_CURVE_ANGLE_PRINTED);
    assert_int_equal(scheme("log-exp-6:base=midpoint").base, BAT_CURVE_BASE_MIDPOINT);
    assert_int_equal(scheme("mask:1/4,3/4,3/4,1/4").mask.first, -2);
    check_status(bat_curve_scheme_by_name("mask:1,1@99", &result, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "from -4 to 2, not 99"));
    assert_int_equal(scheme("mask:1,1@2").mask.first, 2);
    assert_int_equal(scheme("mask:1,1@-4").mask.first, -4);
    bat_choice choice;
    size_t listed = 0;
    while (bat_curve_scheme_list(listed, &choice))
        listed++;
    assert_int_equal(listed, 14);
    assert_true(scheme("learned").rule != NULL && scheme("learned").fairness == 0.5);
    assert_true(scheme("learned:fairness=1").fairness == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scheme_names_are_read_strictly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

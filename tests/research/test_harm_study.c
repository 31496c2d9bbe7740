#include "check.h"

#include "batten/research/harm_study.h"
#include "research/studies/harm.h"

#include <math.h>

/// @file
/// The search for harm: its cases are the same again, and its rivals are what it says.

static void cases_depend_on_the_seed_alone(void **state)
{
    (void)state;
    for (size_t k = 0; k < HARM_LINE_COUNT; k++)
        for (uint64_t seed = 1; seed <= 2; seed++)
        {
            double ratios[2] = {0, 0};
            for (int i = 0; i < 2; i++)
            {
                bat_random random = bat_random_seed(seed);
                assert_int_equal(HARM_LINES[k].run(&random, HARM_LINES[k].variant, &ratios[i], NULL), BAT_OK);
            }
            assert_true(ratios[0] == ratios[1]);
            assert_true(ratios[0] > 0 && isfinite(ratios[0]));
        }
}

/// Splines of smooth motions with even keys are nearer than straight lines, and prisms keep their faces.
static void easy_kinds_are_not_harmed(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 5; seed++)
    {
        bat_random random = bat_random_seed(seed);
        double motion = NAN, prism = NAN;
        assert_string_equal(HARM_LINES[5].name, "even keys");
        assert_int_equal(HARM_LINES[5].run(&random, HARM_LINES[5].variant, &motion, NULL), BAT_OK);
        assert_true(motion < 0.5);
        assert_int_equal(HARM_SURFACES[0].run(&random, HARM_SURFACES[0].variant, &prism, NULL), BAT_OK);
        assert_true(prism >= 0 && prism < 0.5);
    }
}

/// Lands share their border to the bit. Smooth borders are nearer to the truth than polygons, rough ones little farther.
static void borders_of_maps_stay_shared(void **state)
{
    (void)state;
    for (size_t k = 0; k < HARM_MAP_COUNT; k++)
        for (uint64_t seed = 1; seed <= 10; seed++)
        {
            bat_random random = bat_random_seed(seed);
            double ratio = NAN;
            check_status(HARM_MAPS[k].run(&random, HARM_MAPS[k].variant, &ratio, NULL), BAT_OK);
            assert_true(ratio > 0 && ratio < (k == 0 ? 1 : 1.25));
        }
}

static void a_count_out_of_range_is_refused(void **state)
{
    (void)state;
    bat_harm_study_options options = bat_harm_study_defaults();
    bat_harm_row *rows = NULL;
    size_t count = 7;
    options.count = 0;
    assert_int_equal(bat_harm_study(&options, &rows, &count, NULL), BAT_INVALID_ARGUMENT);
    options.count = 100001;
    assert_int_equal(bat_harm_study(&options, &rows, &count, NULL), BAT_INVALID_ARGUMENT);
    assert_null(rows);
    assert_int_equal(count, 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cases_depend_on_the_seed_alone),
        cmocka_unit_test(easy_kinds_are_not_harmed),
        cmocka_unit_test(borders_of_maps_stay_shared),
        cmocka_unit_test(a_count_out_of_range_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

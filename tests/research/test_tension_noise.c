#include "check.h"

#include "batten/research/curve_study.h"

// Table 2: noise on control points.

static const bat_tension_noise_row *find(const bat_tension_noise_row *rows, const char *method)
{
    for (size_t i = 0; i < BAT_TENSION_NOISE_METHODS; i++)
        if (strcmp(rows[i].method, method) == 0)
            return &rows[i];
    fail_msg("no row %s", method);
    return NULL;
}

/// An exterior angle is at most pi, and so is any mean of them; the right sign keeps far below, and noise roughens.
static void check_noise(const bat_tension_noise_row *rows)
{
    for (size_t i = 0; i < BAT_TENSION_NOISE_METHODS; i++)
        for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        {
            assert_true(rows[i].g1[s].greatest <= 3.14159265358979324);
            assert_true(s == 0 || rows[i].g1[s].mean > rows[i].g1[s - 1].mean);
        }
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
        assert_true(find(rows, "six-point-outward")->g1[s].mean < 0.2 * find(rows, "six-point-printed")->g1[s].mean);
}

/// Without noise the means are those of table 1, also by the published figures.
static void without_noise_it_is_table_1(void **state)
{
    (void)state;
    static const struct
    {
        const char *method;
        double g1;
    } expected[] = {{"four-point-printed", 2.65493},
                    {"six-point-printed", 2.82397},
                    {"four-point-outward", 0.178192},
                    {"six-point-outward", 0.0867555}};
    bat_tension_noise_row rows[BAT_TENSION_NOISE_METHODS];
    check_status(bat_tension_table2(NULL, rows, NULL), BAT_OK);
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        check_relative(find(rows, expected[i].method)->g1[0].mean, expected[i].g1, 1e-5);
    assert_int_equal(rows[0].g1[0].count, 88);
    check_relative(find(rows, "four-point-printed")->g1[0].mean, find(rows, "four-point-printed")->published_g1[0], 1e-3);
    assert_true(isnan(find(rows, "four-point-outward")->published_g1[0]));
    check_near(find(rows, "adaptive-heuristic-printed")->tension, 0.05, 1e-12);
    assert_true(isnan(find(rows, "adaptive-heuristic")->published_deviation[3]));
    check_noise(rows);
}

/// The seed matters where there is noise, threads never, and the same noise gives the same row.
static void the_seed_decides_the_noise(void **state)
{
    (void)state;
    bat_tension_noise_options options = bat_tension_noise_defaults();
    bat_curve_scheme scheme = bat_curve_scheme_angle(BAT_CURVE_TENSION_SIX_POINT);
    bat_tension_noise_row row, same, other;
    options.threads = 1;
    check_status(bat_tension_table2_method("mine", &scheme, &options, &row, NULL), BAT_OK);
    options.threads = 2;
    check_status(bat_tension_table2_method(BAT_TENSION_LEARNED_PUBLISHED, &scheme, &options, &same, NULL), BAT_OK);
    options.seed = 2;
    options.noise[5] = 0.03;
    check_status(bat_tension_table2_method("mine", &scheme, &options, &other, NULL), BAT_OK);
    for (size_t s = 0; s < BAT_TENSION_NOISES; s++)
    {
        check_near(same.g1[s].mean, row.g1[s].mean, 0);
        check_near(same.g1[s].deviation, row.g1[s].deviation, 0);
        assert_true((other.g1[s].mean == row.g1[s].mean) == (s == 0));
    }
    check_near(other.g1[5].mean, other.g1[1].mean, 0);
    check_near(same.published_g1[2], 0.287, 0);
    assert_true(isnan(row.published_g1[0]));
    check_near(same.tension, BAT_CURVE_TENSION_SIX_POINT, 0);
}

static bool stop(void *context, double fraction)
{
    (void)context;
    return fraction < 0.1;
}

static void bad_noise_is_refused_and_work_stops(void **state)
{
    (void)state;
    bat_tension_noise_options options = bat_tension_noise_defaults();
    bat_tension_noise_row rows[BAT_TENSION_NOISE_METHODS];
    bat_error error;
    options.progress = (bat_progress){stop, NULL};
    check_status(bat_tension_table2(&options, rows, &error), BAT_CANCELLED);
    options.noise[2] = -1;
    check_status(bat_tension_table2(&options, rows, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "noise 2 is negative or not finite");
    options.noise[2] = NAN;
    check_status(bat_tension_table2(&options, rows, &error), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_noise_it_is_table_1),
        cmocka_unit_test(the_seed_decides_the_noise),
        cmocka_unit_test(bad_noise_is_refused_and_work_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "check.h"

#include "batten/research/curve_study.h"

/// The figures of shared/oracle/tension/baselines.json whose formulas are accurate, five digits of each.
static const struct
{
    const char *space, *method;
    double mean_nn, hausdorff, bending, bending_median, g1;
} REFERENCE[] = {
    {"plane", "four-point-printed", 0.0353808, 0.126779, 1477.52, 952.370, 2.65493},
    {"plane", "six-point-printed", 0.0362340, 0.131028, 2355.26, 1444.72, 2.82397},
    {"plane", "four-point-outward", 0.0128520, 0.0729492, 21.6494, 10.3290, 0.178192},
    {"plane", "six-point-outward", 0.0135888, 0.0744803, 18.7717, 8.49028, 0.0867555},
    {"plane", "log-exp-4", 0.00971013, 0.0685209, 2025.61, 24.2444, 0.496388},
    {"plane", "log-exp-6", 0.00883678, 0.0637965, 2788.32, 16.3986, 0.359353},
    {"sphere", "four-point-printed", 0.0608356, 0.281585, 515.827, 110.282, 2.14352},
    {"sphere", "six-point-printed", 0.0647368, 0.287687, 780.548, 172.258, 2.28847},
    {"sphere", "four-point-outward", 0.0475867, 0.212923, 7.10070, 1.84128, 0.192488},
    {"sphere", "six-point-outward", 0.0476852, 0.215089, 6.02727, 1.29061, 0.0899297},
    {"sphere", "log-exp-4", 0.0397016, 0.208033, 2136.40, 15.1680, 0.511619},
    {"sphere", "log-exp-6", 0.0399954, 0.191553, 1670.41, 13.0966, 0.410132},
    {"disk", "four-point-printed", 0.0293730, 0.0720097, 76713.5, 589.358, 2.75444},
    {"disk", "six-point-printed", 0.0293943, 0.0733002, 204202, 843.018, 2.91194},
    {"disk", "four-point-outward", 0.00366003, 0.0229642, 2112.68, 2.31081, 0.111301},
    {"disk", "six-point-outward", 0.00383579, 0.0229623, 1722.72, 2.20288, 0.0643731},
    {"disk", "log-exp-4", 0.00436223, 0.0264248, 2799.05, 2.64279, 0.309251},
    {"disk", "log-exp-6", 0.00337564, 0.0230613, 781.861, 2.35801, 0.204485},
};

static bat_tension_row table1[BAT_TENSION_TABLE1_ROWS];

static int make_table1(void **state)
{
    (void)state;
    return bat_tension_table1(BAT_TENSION_SET_KIND_PUBLISHED, table1, 0, (bat_progress){0}, NULL) == BAT_OK ? 0 : -1;
}

static const bat_tension_row *find(const bat_tension_row *rows, size_t count, const char *space, const char *method)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(rows[i].space, space) == 0 && strcmp(rows[i].method, method) == 0)
            return &rows[i];
    fail_msg("no row %s, %s", space, method);
    return NULL;
}

static void table1_meets_the_accurate_reference(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof REFERENCE / sizeof REFERENCE[0]; i++)
    {
        const bat_tension_row *row = find(table1, BAT_TENSION_TABLE1_ROWS, REFERENCE[i].space, REFERENCE[i].method);
        check_relative(row->mean_nn.mean, REFERENCE[i].mean_nn, 1e-5);
        check_relative(row->hausdorff.mean, REFERENCE[i].hausdorff, 1e-5);
        check_relative(row->bending.mean, REFERENCE[i].bending, 1e-4);
        check_relative(row->bending.median, REFERENCE[i].bending_median, 1e-4);
        check_relative(row->g1.mean, REFERENCE[i].g1, 1e-5);
    }
    // The published oracle, and that turning the sign round helps it by far.
    const bat_tension_row *printed = find(table1, BAT_TENSION_TABLE1_ROWS, "plane", "oracle-printed");
    check_near(printed->tension, 0.05, 1e-12);
    check_relative(printed->mean_nn.mean, printed->published_mean_nn, 1e-3);
    check_near(find(table1, BAT_TENSION_TABLE1_ROWS, "disk", "oracle-printed")->tension, -0.05, 1e-12);
    assert_true(find(table1, BAT_TENSION_TABLE1_ROWS, "plane", "oracle-outward")->mean_nn.mean <
                0.5 * printed->mean_nn.mean);
}

static void iss_figures_come_out_to_three_digits(void **state)
{
    (void)state;
    static const struct
    {
        const char *method;
        double mean_nn, hausdorff, bending, g1;
    } expected[] = {
        {"four-point-printed", .00414, .0275, 129.5, 2.235},
        {"six-point-printed", .00529, .0382, 253.5, 2.906},
        {"four-point-outward", .00241, .0263, 1.7, .138},
        {"six-point-outward", .00384, .0386, 1.4, .060},
        {"log-exp-4", .00216, .0226, 2.1, .143},
        {"log-exp-6", .00314, .0305, 1.6, .075},
    };
    bat_tension_row rows[BAT_TENSION_METHODS];
    bat_error error;
    assert_int_equal(bat_tension_table5(rows, 0, (bat_progress){0}, &error), BAT_OK);
    for (size_t i = 0; i < sizeof expected / sizeof expected[0]; i++)
    {
        const bat_tension_row *row = find(rows, BAT_TENSION_METHODS, "sphere", expected[i].method);
        check_near(row->mean_nn.mean, expected[i].mean_nn, 0.5e-5);
        check_near(row->hausdorff.mean, expected[i].hausdorff, 0.5e-4);
        check_near(row->bending.mean, expected[i].bending, 0.05);
        check_near(row->g1.mean, expected[i].g1, 0.5e-3);
    }
}

static bool stop(void *context, double fraction)
{
    (void)context;
    return fraction < 0.01;
}

static void a_table_can_be_stopped(void **state)
{
    (void)state;
    bat_tension_row rows[BAT_TENSION_TABLE1_ROWS];
    bat_error error;
    assert_int_equal(bat_tension_table1(BAT_TENSION_SET_KIND_PUBLISHED, rows, 1, (bat_progress){stop, NULL}, &error),
                     BAT_CANCELLED);
}

enum
{
    OWN = 2
};

static const char *const SPACES[] = {"plane", "sphere", "disk"};

static void own_methods(bat_tension_method *own)
{
    own[0] = (bat_tension_method){"mine", 0.25, bat_curve_scheme_angle(BAT_CURVE_TENSION_SIX_POINT)};
    own[1] = (bat_tension_method){BAT_TENSION_LEARNED_PUBLISHED, NAN,
                                  bat_curve_scheme_log_exp(bat_mask_four_point(BAT_MASK_FOUR_POINT_WEIGHT))};
}

static void own_methods_meet_the_built_in_ones(void **state)
{
    (void)state;
    const char *const same[OWN] = {"six-point-outward", "log-exp-4"};
    bat_tension_method own[OWN];
    bat_tension_row mine[3 * OWN];
    own_methods(own);
    check_status(bat_tension_table1_methods(BAT_TENSION_SET_KIND_PUBLISHED, own, OWN, mine, 0, (bat_progress){0}, NULL),
                 BAT_OK);
    for (size_t i = 0; i < 3 * OWN; i++)
    {
        const bat_tension_row *row = find(table1, BAT_TENSION_TABLE1_ROWS, SPACES[i / OWN], same[i % OWN]);
        assert_string_equal(mine[i].space, SPACES[i / OWN]);
        assert_string_equal(mine[i].method, own[i % OWN].name);
        assert_memory_equal(&mine[i].mean_nn, &row->mean_nn, sizeof row->mean_nn);
        assert_memory_equal(&mine[i].bending, &row->bending, sizeof row->bending);
        assert_true(isnan(row->fairness));
        assert_true(i % OWN == 0 ? mine[i].fairness == 0.25 : isnan(mine[i].fairness));
        assert_true(isfinite(mine[i].published_g1) == (i % OWN == 1));
    }
    check_near(mine[1].published_mean_nn, 0.01636, 0);
    check_near(mine[5].published_g1, 0.160, 0);
}

/// The mean, over a test set, of the mean nearest-neighbour distance.
static double mean_nn_of(bat_tension_space kind, bat_tension_set_kind curves, const bat_curve_scheme *scheme)
{
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_tension_set set;
    double mean = 0;
    check_status(bat_tension_set_make(kind, curves, BAT_TENSION_TEST_CURVES, BAT_TENSION_TEST_SEED, &set, NULL), BAT_OK);
    for (size_t c = 0; c < set.count; c++)
    {
        bat_curve control = bat_tension_control(&set, c, &spaces[kind]), truth = bat_tension_truth(&set, c, &spaces[kind]);
        bat_curve fine;
        bat_curve_distance distance;
        bat_curve_refine_options how = bat_curve_refine_defaults();
        how.scheme = *scheme;
        how.levels = BAT_TENSION_LEVELS;
        how.simple = BAT_CURVE_SIMPLE_NEVER; // as the study
        check_status(bat_curve_refine(&control, &how, &fine, NULL), BAT_OK);
        check_status(bat_curve_compare(&fine, &truth, NULL, &distance, NULL), BAT_OK);
        mean += distance.mean_nn / (double)set.count;
        bat_curve_free(&fine);
    }
    bat_tension_set_free(&set);
    return mean;
}

static void test_curves_are_those_of_the_set(void **state)
{
    (void)state;
    const bat_tension_set_kind kinds[] = {BAT_TENSION_SET_KIND_RESAMPLED, BAT_TENSION_SET_KIND_UNSEEN};
    bat_tension_method own[OWN];
    own_methods(own);
    for (size_t k = 0; k < 2; k++)
    {
        bat_tension_row rows[3 * OWN];
        check_status(bat_tension_table1_methods(kinds[k], own, OWN, rows, 0, (bat_progress){0}, NULL), BAT_OK);
        for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        {
            const bat_tension_row *row = &rows[OWN * s];
            check_relative(row->mean_nn.mean, mean_nn_of((bat_tension_space)s, kinds[k], &own[0].scheme), 1e-12);
            assert_int_equal(row->mean_nn.count, BAT_TENSION_TEST_CURVES);
            assert_true(isnan(row[1].published_mean_nn) && isnan(row[1].published_g1));
        }
    }
}

static void a_method_on_the_track_is_a_row(void **state)
{
    (void)state;
    bat_tension_row rows[BAT_TENSION_METHODS], mine;
    const bat_tension_method own = {"mine", 1, bat_curve_scheme_angle(BAT_CURVE_TENSION_FOUR_POINT)};
    check_status(bat_tension_table5(rows, 0, (bat_progress){0}, NULL), BAT_OK);
    check_status(bat_tension_table5_methods(&own, 1, &mine, 0, (bat_progress){0}, NULL), BAT_OK);
    check_near(mine.mean_nn.mean, find(rows, BAT_TENSION_METHODS, "sphere", "four-point-outward")->mean_nn.mean, 0);
    check_near(mine.fairness, 1, 0);
}

static void bad_tables_are_refused(void **state)
{
    (void)state;
    bat_tension_row rows[BAT_TENSION_TABLE1_ROWS];
    bat_progress silent = {0};
    bat_error error;
    check_status(bat_tension_table1((bat_tension_set_kind)9, rows, 1, silent, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_tension_table1_methods(BAT_TENSION_SET_KIND_RESAMPLED, NULL, 0, rows, 1, silent, &error),
                 BAT_INVALID_ARGUMENT);
    check_status(bat_tension_table5_methods(NULL, 0, rows, 1, silent, &error), BAT_INVALID_ARGUMENT);
}

/// Curves that were refined with a tension of the grid are found again; elsewhere the nearest one is.
static void a_search_finds_the_tension(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 2, 1, 3, 4, 1, 5, -1, 3, -2, 1}, turned[] = {0, 0, 1, 3, 4, 3, 5, 0};
    bat_curve coarse[] = {{.space = &plane, .points = points, .count = 6, .closed = true},
                          {.space = &plane, .points = turned, .count = 4}};
    const double wanted[] = {-0.25, 0, -0.2};
    for (size_t i = 0; i < 3; i++)
    {
        bat_curve_refine_options how = bat_curve_refine_defaults();
        bat_tension_search_options narrow = bat_tension_search_defaults();
        bat_curve truth[2] = {{0}};
        bat_error error;
        double tension = 7;
        how.scheme = bat_curve_scheme_angle(wanted[i]);
        how.levels = bat_tension_search_defaults().levels;
        for (size_t k = 0; k < 2; k++)
            check_status(bat_curve_refine(&coarse[k], &how, &truth[k], NULL), BAT_OK);
        check_status(bat_tension_search(coarse, truth, 2, NULL, &tension, &error), BAT_OK);
        check_near(tension, wanted[i], 1e-12);
        narrow.low = wanted[i] - 0.5;
        narrow.high = wanted[i] + 0.01;
        narrow.count = 2;
        check_status(bat_tension_search(coarse, truth, 2, &narrow, &tension, &error), BAT_OK);
        check_near(tension, wanted[i] + 0.01, 1e-12);
        tension = 7;
        narrow.progress = (bat_progress){stop, NULL};
        narrow.count = 200;
        check_status(bat_tension_search(coarse, truth, 2, &narrow, &tension, &error), BAT_CANCELLED);
        assert_true(tension == 7);
        bat_curve_free(&truth[0]);
        bat_curve_free(&truth[1]);
    }
}

static void bad_searches_are_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 2, 1, 3, 4}, tension = 7;
    bat_curve curve = {.space = &plane, .points = points, .count = 3};
    bat_tension_search_options bad[4];
    for (size_t i = 0; i < 4; i++)
        bad[i] = bat_tension_search_defaults();
    assert_true(bad[0].low < bad[0].high && bad[0].count >= 2);
    bad[0].count = 1;
    bad[1].low = bad[1].high;
    bad[2].scheme = bat_curve_scheme_linear(bat_mask_chaikin());
    bad[3].low = NAN;
    for (size_t i = 0; i < 4; i++)
        check_status(bat_tension_search(&curve, &curve, 1, &bad[i], &tension, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_tension_search(&curve, &curve, 0, NULL, &tension, NULL), BAT_INVALID_ARGUMENT);
    assert_true(tension == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table1_meets_the_accurate_reference),
        cmocka_unit_test(iss_figures_come_out_to_three_digits),
        cmocka_unit_test(own_methods_meet_the_built_in_ones),
        cmocka_unit_test(test_curves_are_those_of_the_set),
        cmocka_unit_test(a_method_on_the_track_is_a_row),
        cmocka_unit_test(a_table_can_be_stopped),
        cmocka_unit_test(bad_tables_are_refused),
        cmocka_unit_test(a_search_finds_the_tension),
        cmocka_unit_test(bad_searches_are_refused),
    };
    return cmocka_run_group_tests(tests, make_table1, NULL);
}

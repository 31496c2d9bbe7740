// Studies of parameters.

#include "patch_clouds.h"

#include "batten/research/surface_study.h"

#include <unistd.h>

static const bat_surface_method METHODS[] = {
    {"uniform", BAT_SURFACE_PARAMETERS_UNIFORM, false, NULL, false},
    {"inverse-distance", BAT_SURFACE_PARAMETERS_INVERSE_DISTANCE, false, NULL, false},
    {"shape-preserving", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, false, NULL, false},
    {"published", BAT_SURFACE_PARAMETERS_SHAPE_PRESERVING, true, NULL, false},
};
enum
{
    METHOD_COUNT = sizeof METHODS / sizeof METHODS[0]
};

static void study(const bat_surface_case *what, size_t clouds, uint64_t seed, int threads, bat_surface_score *scores)
{
    bat_surface_study_options options = bat_surface_study_defaults();
    bat_error error = {0};
    options.clouds = clouds;
    options.seed = seed;
    options.threads = threads;
    if (bat_surface_study_clouds(what, METHODS, METHOD_COUNT, &options, scores, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

/// Shape-preserving weights reproduce planes, uniform ones do not: the order of the methods in figure 5.
static void methods_rank_as_published(void **state)
{
    (void)state;
    bat_surface_score scores[METHOD_COUNT];
    study(&(bat_surface_case){300, 0, 2}, 6, 1, 2, scores);
    for (size_t m = 0; m < METHOD_COUNT; m++)
    {
        assert_int_equal(scores[m].succeeded, 6);
        assert_true(scores[m].seconds > 0);
        // The true parameters leave nothing of a clean cloud.
        check_relative(scores[m].excess, scores[m].mse, 1e-9);
    }
    assert_true(scores[1].mse < scores[0].mse);
    assert_true(5 * scores[2].mse < scores[1].mse);
    check_relative(scores[3].mse, scores[2].mse, 0.5);
}

static void threads_change_times_alone(void **state)
{
    (void)state;
    bat_surface_score one[METHOD_COUNT], three[METHOD_COUNT], other[METHOD_COUNT];
    const bat_surface_case what = {60, 0.02, 3};
    study(&what, 5, 1, 1, one);
    study(&what, 5, 1, 3, three);
    study(&what, 5, 2, 3, other);
    for (size_t m = 0; m < METHOD_COUNT; m++)
    {
        assert_int_equal(one[m].succeeded, three[m].succeeded);
        assert_memory_equal(&one[m].mse, &three[m].mse, sizeof(double));
        assert_true(isnan(one[m].mse) || one[m].mse != other[m].mse);
    }
}

/// What noise leaves with true parameters does not count: of noise alone the excess is small.
static void excess_leaves_noise_out(void **state)
{
    (void)state;
    bat_surface_score clean[METHOD_COUNT], noisy[METHOD_COUNT];
    study(&(bat_surface_case){300, 0, 2}, 4, 1, 2, clean);
    study(&(bat_surface_case){300, 0.01, 2}, 4, 1, 2, noisy);
    assert_true(noisy[0].mse > clean[0].mse);
    check_relative(noisy[0].excess, clean[0].mse, 0.2);
}

/// A failure is counted, and the means are over the others: neighbourhoods as published are too small here.
static void failures_are_counted(void **state)
{
    (void)state;
    bat_surface_score scores[METHOD_COUNT];
    study(&(bat_surface_case){1000, 0.05, 2}, 8, 1, 2, scores);
    assert_true(scores[3].succeeded < 8);
    assert_int_equal(scores[2].succeeded, 8);
    assert_true((scores[3].succeeded == 0) == isnan(scores[3].mse));
}

static void scans_are_studied(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_plane, 12, 200, 0, 1);
    bat_surface_score scores[METHOD_COUNT];
    check_status(bat_surface_study_scan(&made.cloud, 2, METHODS, METHOD_COUNT, scores, NULL), BAT_OK);
    assert_int_equal(scores[2].succeeded, 1);
    // A plane's shape-preserving parameters are affine.
    check_near(scores[2].mse, 0, 1e-20);
    assert_true(scores[0].mse > 1e-8);
    patch_free(&made);
}

/// Where published neighbourhoods fail, ours are taken, and that is said.
static void fits_fall_back(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 4, 60, 0.1, 2);
    bat_surface_fit_options fit = bat_surface_fit_defaults();
    bat_surface_trial trials[2] = {0};
    fit.functions = 30;
    check_status(bat_surface_study_fit(&made.cloud, &METHODS[3], &fit, &trials[0], NULL), BAT_OK);
    check_status(bat_surface_study_fit(&made.cloud, &METHODS[2], &fit, &trials[1], NULL), BAT_OK);
    assert_false(trials[1].own);
    if (trials[0].own)
        assert_memory_equal(trials[0].result.parameters, trials[1].result.parameters, 2 * made.cloud.count * sizeof(double));
    const char *path = "surface-study.svg";
    check_status(bat_surface_study_draw(path, &made.cloud, METHODS + 2, trials, 2, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    for (int k = 0; k < 2; k++)
        bat_surface_trial_free(&trials[k]);
    patch_free(&made);
}

static void what_is_wrong_is_refused(void **state)
{
    (void)state;
    bat_error error;
    bat_surface_score score;
    bat_surface_study_options options = bat_surface_study_defaults();
    const bat_surface_case what = {50, 0, 2};
    const bat_surface_method bad = {"auto", BAT_SURFACE_PARAMETERS_AUTO, false, NULL, false};
    check_status(bat_surface_study_clouds(&what, &bad, 1, &options, &score, &error), BAT_INVALID_ARGUMENT);
    options.clouds = 0;
    check_status(bat_surface_study_clouds(&what, METHODS, 1, &options, &score, &error), BAT_INVALID_ARGUMENT);
    options.clouds = 2;
    check_status(bat_surface_study_clouds(&(bat_surface_case){50, 0, 99}, METHODS, 1, &options, &score, &error),
                 BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(methods_rank_as_published), cmocka_unit_test(threads_change_times_alone),
        cmocka_unit_test(excess_leaves_noise_out),   cmocka_unit_test(failures_are_counted),
        cmocka_unit_test(scans_are_studied),         cmocka_unit_test(fits_fall_back),
        cmocka_unit_test(what_is_wrong_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

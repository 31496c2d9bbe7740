// The adaptive loop: when it stops, the weight of smoothing, outliers, threads, being stopped.

#include "surface/fit/points.h"
#include "surface/fit/system.h"
#include "surface_fit_helpers.h"

static bat_surface_fit_report run(surface_sample *sample, const bat_surface_fit_options *options,
                                  bat_spline_surface *surface)
{
    bat_surface_fit_report report;
    bat_error error;
    if (bat_surface_fit(&sample->data, options, surface, &report, &error) != BAT_OK)
        fail_msg("%s", error.text);
    const bat_surface_fit_round *last = &report.rounds[report.count - 1];
    // The report is that of the result.
    assert_int_equal(last->functions, bat_hierarchical_space_functions(surface->space));
    check_near(last->mean_squared, mean_squared(surface, &sample->data, sample->points), 1e-9 * last->mean_squared + 1e-25);
    check_near(report.distances[last->worst], last->largest, 0);
    for (size_t k = 1; k < report.count; k++)
        assert_true(report.rounds[k].functions > report.rounds[k - 1].functions);
    return report;
}

static void finish(bat_spline_surface *surface, bat_surface_fit_report *report)
{
    bat_spline_surface_free(surface);
    bat_surface_fit_report_free(report);
}

static void a_tolerance_is_reached(void **state)
{
    (void)state;
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.tolerance = 1e-3;
    size_t functions[2];
    for (int k = 0; k < 2; k++)
    {
        surface_sample sample = sample_make(shape_hills, 4000, 120, 0, 31);
        bat_spline_surface surface;
        options.share = k == 0 ? 1 : 0.9;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        const bat_surface_fit_round *last = &report.rounds[report.count - 1];
        assert_true(report.reached && last->within >= options.share);
        assert_true(k == 1 || last->largest <= options.tolerance);
        assert_true(report.count == 1 || report.rounds[report.count - 2].within < options.share);
        functions[k] = last->functions;
        finish(&surface, &report);
        sample_free(&sample);
    }
    assert_true(functions[1] < functions[0]);
}

static void a_budget_is_met_closely(void **state)
{
    (void)state;
    static const size_t BUDGETS[] = {300, 700, 1500};
    for (size_t k = 0; k < 6; k++)
    {
        surface_sample sample = sample_make(shape_hills, 6000, 120, 1e-3, 32);
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.functions = BUDGETS[k / 2];
        options.space.degree[0] = k % 2 == 0 ? 2 : 3;
        options.space.degree[1] = 2;
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        size_t functions = report.rounds[report.count - 1].functions;
        assert_true(report.reached);
        assert_true(functions <= options.functions && (double)functions > 0.96 * (double)options.functions);
        finish(&surface, &report);
        sample_free(&sample);
    }
}

/// Without a size, held-out points choose it: noise is not followed, and the true surface is nearer than with a quarter of
/// the points.
static void held_out_points_choose_the_size(void **state)
{
    (void)state;
    double errors[2];
    for (int k = 0; k < 2; k++)
    {
        surface_sample sample = sample_make(shape_hills, 5000, 80, 0.01, 33);
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.functions = k == 0 ? 0 : 1250;
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        assert_true(report.reached && report.stalled == (k == 0));
        assert_true(k == 1 || report.rounds[report.count - 1].functions < 600);
        assert_true(report.held_out_count > 480 && report.held_out_count < 510);
        assert_true(report.held_out_rms > 0.009 && report.held_out_rms < (k == 0 ? 0.013 : 0.02));
        assert_true(report.held_out_largest > report.held_out_rms);
        // A new point is as far as the noise across the surface at least, and about as far as the held-out ones.
        assert_true(report.expected_rms > 0.009 && report.expected_rms < 1.1 * report.held_out_rms);
        check_near(report.rounds[report.count - 1].held_out, report.held_out_rms, 0);
        memcpy(sample.points, sample.truth, 15000 * sizeof(double));
        check_status(spline_correct(&surface, &sample.data, NULL, NULL), BAT_OK);
        errors[k] = mean_squared(&surface, &sample.data, sample.truth);
        finish(&surface, &report);
        sample_free(&sample);
    }
    assert_true(errors[0] < errors[1]);
}

/// No tolerance below the noise makes a space grow without end.
static void a_tolerance_below_the_noise_stalls(void **state)
{
    (void)state;
    for (double tolerance = 1e-6; tolerance < 0.01; tolerance *= 10)
    {
        surface_sample sample = sample_make(shape_hills, 2000, 80, 0.01, 34);
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.tolerance = tolerance;
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        assert_true(!report.reached && report.stalled);
        assert_true(report.rounds[report.count - 1].functions < 500);
        finish(&surface, &report);
        sample_free(&sample);
    }
}

static void a_tolerance_beyond_the_budget_is_not_reached(void **state)
{
    (void)state;
    surface_sample sample = sample_make(shape_hills, 3000, 80, 0, 34);
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.tolerance = 1e-7;
    options.functions = 200;
    bat_spline_surface surface;
    bat_surface_fit_report report = run(&sample, &options, &surface);
    assert_false(report.reached);
    assert_true(report.rounds[report.count - 1].functions <= 200);
    finish(&surface, &report);
    sample_free(&sample);
}

static void iterations_and_a_fine_beginning_are_kept(void **state)
{
    (void)state;
    surface_sample sample = sample_make(shape_hills, 2000, 80, 0, 35);
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.iterations = 2;
    options.functions = 100000;
    bat_spline_surface surface;
    bat_surface_fit_report report = run(&sample, &options, &surface);
    assert_int_equal(report.count, 3);
    finish(&surface, &report);
    // More functions than the budget from the start: one fit and no refinement.
    options.space.spans[0] = options.space.spans[1] = 9;
    options.functions = 50;
    report = run(&sample, &options, &surface);
    assert_int_equal(report.count, 1);
    assert_int_equal(report.rounds[0].functions, 144);
    finish(&surface, &report);
    sample_free(&sample);
}

static void polynomials_need_no_refinement(void **state)
{
    (void)state;
    surface_sample sample = sample_make(shape_biquadratic, 2000, 80, 0, 36);
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    bat_spline_surface surface;
    bat_surface_fit_report report = run(&sample, &options, &surface);
    assert_int_equal(report.count, 1);
    assert_true(report.reached && report.rounds[0].functions == 16 && report.rounds[0].largest < 1e-12);
    finish(&surface, &report);
    sample_free(&sample);
}

static void corrections_make_distances_smaller(void **state)
{
    (void)state;
    double before = INFINITY;
    static const int CORRECTIONS[][2] = {{0, 0}, {1, 0}, {1, 3}};
    for (size_t k = 0; k < 3; k++)
    {
        surface_sample sample = sample_make(shape_hills, 3000, 120, 0, 37);
        // Parameters that are off by some hundredths.
        for (size_t i = 120; i < 3000; i++)
        {
            double *at = sample.data.parameters + 2 * i;
            at[0] += 0.1 * at[0] * (1 - at[0]) * sin(7 * at[1]);
            at[1] += 0.1 * at[1] * (1 - at[1]) * cos(5 * at[0]);
        }
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.space.degree[0] = options.space.degree[1] = 2;
        options.functions = 250;
        options.corrections = CORRECTIONS[k][0];
        options.final_corrections = CORRECTIONS[k][1];
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        double now = report.rounds[report.count - 1].mean_squared;
        assert_true(now < 0.9 * before);
        assert_true(options.corrections == 0 ? report.moved == 0 : report.moved > 2000);
        before = now;
        finish(&surface, &report);
        sample_free(&sample);
    }
}

/// A fit over 24 x 24 cells to noisy points with their true parameters.
static double true_error(bat_surface_smoothing smoothing, double weight, double noise, double *found, double *residual)
{
    surface_sample sample = sample_make(shape_hills, 3000, 0, noise, 38);
    bat_surface_fit_options options = bat_surface_fit_defaults();
    options.space.spans[0] = options.space.spans[1] = 24;
    options.iterations = 0;
    options.corrections = 0;
    options.smoothing = smoothing;
    options.weight = weight;
    options.noise = noise;
    bat_spline_surface surface;
    bat_surface_fit_report report = run(&sample, &options, &surface);
    double error = mean_squared(&surface, &sample.data, sample.truth);
    *found = report.rounds[0].weight;
    *residual = report.rounds[0].mean_squared;
    finish(&surface, &report);
    sample_free(&sample);
    return error;
}

static void weights_come_close_to_the_best(void **state)
{
    (void)state;
    for (double noise = 0.003; noise < 0.1; noise *= 5)
    {
        double best = INFINITY, found, residual;
        for (double weight = 1e-8; weight < 10; weight *= 5)
            best = fmin(best, true_error(BAT_SURFACE_SMOOTHING_GIVEN, weight, noise, &found, &residual));
        double likelihood = true_error(BAT_SURFACE_SMOOTHING_LIKELIHOOD, 0, noise, &found, &residual);
        double validated = true_error(BAT_SURFACE_SMOOTHING_CROSS_VALIDATION, 0, noise, &found, &residual);
        double told = true_error(BAT_SURFACE_SMOOTHING_NOISE, 0, noise, &found, &residual);
        assert_true(likelihood < 1.3 * best);
        assert_true(validated < 1.3 * best);
        // To know the noise does no harm.
        assert_true(told < 1.05 * likelihood);
        check_relative(residual, 3 * noise * noise, 0.15);
    }
}

static void a_weight_does_not_depend_on_the_unit(void **state)
{
    (void)state;
    double weights[2];
    for (int k = 0; k < 2; k++)
    {
        surface_sample sample = sample_make(shape_hills, 1000, 40, 0.01, 39);
        for (size_t i = 0; i < 3000; i++)
            sample.points[i] = k == 0 ? sample.points[i] : 1000 * sample.points[i] + 5e4;
        bat_surface_fit_options options = bat_surface_fit_defaults();
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        weights[k] = report.rounds[report.count - 1].weight;
        finish(&surface, &report);
        sample_free(&sample);
    }
    check_relative(weights[0], weights[1], 1e-3);
}

static void outliers_are_switched_off(void **state)
{
    (void)state;
    double errors[2];
    for (int k = 0; k < 2; k++)
    {
        surface_sample sample = sample_make(shape_hills, 4000, 0, 0.002, 40);
        bat_random random = bat_random_seed(41);
        for (size_t i = 0; i < 4000; i += 10)
            sample.points[3 * i + 2] += 0.1 + 0.5 * bat_random_uniform(&random);
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.functions = 300;
        options.robust = k == 1;
        bat_spline_surface surface;
        bat_surface_fit_report report = run(&sample, &options, &surface);
        // How far the true surface is off: from points without noise to their feet.
        memcpy(sample.points, sample.truth, 12000 * sizeof(double));
        check_status(spline_correct(&surface, &sample.data, NULL, NULL), BAT_OK);
        errors[k] = mean_squared(&surface, &sample.data, sample.truth);
        assert_true(k == 0 ? report.outliers == 0 : report.outliers >= 380 && report.outliers < 480);
        finish(&surface, &report);
        sample_free(&sample);
    }
    assert_true(errors[1] < 0.02 * errors[0]);
    assert_true(sqrt(errors[1]) < 0.002);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    bat_spline_surface surfaces[2];
    surface_sample samples[2];
    for (int k = 0; k < 2; k++)
    {
        samples[k] = sample_make(shape_hills, 6000, 120, 0.002, 42);
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.functions = 800;
        options.robust = true;
        options.threads = k + 1;
        bat_surface_fit_report report = run(&samples[k], &options, &surfaces[k]);
        bat_surface_fit_report_free(&report);
    }
    size_t functions = bat_hierarchical_space_functions(surfaces[0].space);
    assert_int_equal(functions, bat_hierarchical_space_functions(surfaces[1].space));
    assert_memory_equal(surfaces[0].control, surfaces[1].control, 3 * functions * sizeof(double));
    assert_memory_equal(samples[0].data.parameters, samples[1].data.parameters, 12000 * sizeof(double));
    for (int k = 0; k < 2; k++)
    {
        bat_spline_surface_free(&surfaces[k]);
        sample_free(&samples[k]);
    }
}

/// Stops after so many reports, which must never fall.
typedef struct stop_after
{
    int left;
    double last;
} stop_after;

static bool report_until(void *context, double fraction)
{
    stop_after *stop = context;
    assert_true(fraction >= stop->last && fraction <= 1);
    stop->last = fraction;
    return --stop->left > 0;
}

static void stopping_leaves_everything_as_it_was(void **state)
{
    (void)state;
    for (int calls = 1; calls < 40; calls += 6)
    {
        surface_sample sample = sample_make(shape_hills, 2000, 80, 0.002, 43);
        double *before = calloc(4000, sizeof *before);
        assert_non_null(before);
        memcpy(before, sample.data.parameters, 4000 * sizeof *before);
        stop_after stop = {.left = calls};
        bat_surface_fit_options options = bat_surface_fit_defaults();
        options.progress = (bat_progress){report_until, &stop};
        bat_spline_surface surface = {0};
        bat_surface_fit_report report = {0};
        check_status(bat_surface_fit(&sample.data, &options, &surface, &report, NULL), BAT_CANCELLED);
        assert_true(surface.space == NULL && report.rounds == NULL);
        assert_memory_equal(before, sample.data.parameters, 4000 * sizeof *before);
        free(before);
        sample_free(&sample);
    }
}

static void wrong_options_are_refused(void **state)
{
    (void)state;
    surface_sample sample = sample_make(shape_hills, 100, 0, 0, 44);
    const bat_surface_fit_options defaults = bat_surface_fit_defaults();
    bat_surface_fit_options wrong[8];
    for (size_t k = 0; k < 8; k++)
        wrong[k] = defaults;
    wrong[0].tolerance = -1;
    wrong[1].share = 0;
    wrong[2].iterations = -1;
    wrong[3].neighbours = 65;
    wrong[4].corrections = -1;
    wrong[5].smoothing = BAT_SURFACE_SMOOTHING_NOISE;
    wrong[6].smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    wrong[6].weight = NAN;
    wrong[7].space.degree[0] = 0;
    for (size_t k = 0; k < 8; k++)
    {
        bat_spline_surface surface;
        check_status(bat_surface_fit(&sample.data, &wrong[k], &surface, NULL, NULL), BAT_INVALID_ARGUMENT);
    }
    sample_free(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tolerance_is_reached),
        cmocka_unit_test(a_budget_is_met_closely),
        cmocka_unit_test(held_out_points_choose_the_size),
        cmocka_unit_test(a_tolerance_below_the_noise_stalls),
        cmocka_unit_test(a_tolerance_beyond_the_budget_is_not_reached),
        cmocka_unit_test(iterations_and_a_fine_beginning_are_kept),
        cmocka_unit_test(polynomials_need_no_refinement),
        cmocka_unit_test(corrections_make_distances_smaller),
        cmocka_unit_test(weights_come_close_to_the_best),
        cmocka_unit_test(a_weight_does_not_depend_on_the_unit),
        cmocka_unit_test(outliers_are_switched_off),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(stopping_leaves_everything_as_it_was),
        cmocka_unit_test(wrong_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

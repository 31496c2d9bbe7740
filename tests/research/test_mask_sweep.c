// Sweeps over families of masks.

#include "analysis_helpers.h"

#include "batten/research/mask_sweep.h"

static bat_mask four_point_family(void *context, double w)
{
    (void)context;
    return bat_mask_four_point(w);
}

static bat_mask cutting_family(void *context, double r)
{
    return bat_mask_corner_cutting(r, *(const double *)context);
}

static bat_mask bent_family(void *context, double x)
{
    (void)context;
    return bat_mask_four_point(x * x);
}

static bool stop_at_half(void *context, double fraction)
{
    *(double *)context = fraction;
    return fraction < 0.5;
}

static void sweep_finds_the_sharp_interval(void **state)
{
    (void)state;
    bat_mask_sweep_options options = bat_mask_sweep_defaults();
    options.end = 0.25;
    options.tolerance = 2e-4;
    bat_mask_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_OK);
    // 0 alone, undecided, proven, undecided, disproven.
    assert_int_equal(count, 5);
    assert_int_equal(intervals[0].verdict, BAT_ANALYSIS_VERDICT_DISPROVEN);
    check_near(intervals[0].end, 0.0, 0.0);
    assert_int_equal(intervals[2].verdict, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_true(intervals[2].begin < 3e-4);
    const double end = intervals[2].end;
    assert_true(32.0 * end * end * end + 4.0 * end < 1.0);
    const double begin = intervals[4].begin;
    assert_int_equal(intervals[4].verdict, BAT_ANALYSIS_VERDICT_DISPROVEN);
    assert_true(32.0 * begin * begin * begin + 4.0 * begin > 1.0);
    check_near(end, 0.19273, 3e-4);
    check_near(begin, 0.19273, 3e-4);
    check_near(intervals[4].end, 0.25, 0.0);
    for (size_t i = 1; i < count; ++i)
        check_near(intervals[i].begin, intervals[i - 1].end, 0.0);
    free(intervals);
}

static void sweep_finds_single_parameters(void **state)
{
    (void)state;
    bat_mask_sweep_options options = bat_mask_sweep_defaults();
    options.begin = 0.05;
    options.end = 0.6;
    double s = 0.75;
    bat_mask_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(cutting_family, &s, &options, &intervals, &count, NULL), BAT_OK);
    assert_int_equal(count, 3);
    assert_int_equal(intervals[0].verdict, BAT_ANALYSIS_VERDICT_DISPROVEN);
    assert_int_equal(intervals[1].verdict, BAT_ANALYSIS_VERDICT_PROVEN);
    assert_int_equal(intervals[2].verdict, BAT_ANALYSIS_VERDICT_DISPROVEN);
    check_near(intervals[1].begin, 0.25, 1e-15);
    check_near(intervals[1].end, intervals[1].begin, 0.0);
    free(intervals);
    options.smoothness = 0;
    check_status(bat_mask_sweep(cutting_family, &s, &options, &intervals, &count, NULL), BAT_OK);
    assert_int_equal(count, 1);
    assert_int_equal(intervals[0].verdict, BAT_ANALYSIS_VERDICT_PROVEN);
    free(intervals);
}

static void sweep_agrees_with_single_analyses(void **state)
{
    (void)state;
    bat_mask_sweep_options options = bat_mask_sweep_defaults();
    options.begin = -0.3;
    options.end = 0.3;
    options.tolerance = 0.01;
    bat_mask_interval *intervals;
    size_t count;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_OK);
    for (size_t i = 0; i < count; ++i)
    {
        if (intervals[i].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED)
            continue;
        for (int share = 1; share <= 7; share += 2)
        {
            const double w = intervals[i].begin + 0.125 * share * (intervals[i].end - intervals[i].begin);
            bat_analysis a = analyze(bat_mask_four_point(w));
            assert_int_equal(a.smooth_proven >= 1, intervals[i].verdict == BAT_ANALYSIS_VERDICT_PROVEN);
            bat_analysis_free(&a);
        }
    }
    free(intervals);
}

static void sweeps_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    bat_mask_sweep_options options = bat_mask_sweep_defaults();
    bat_mask_interval *intervals = NULL;
    size_t count;
    options.end = options.begin;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options.end = NAN;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options = bat_mask_sweep_defaults();
    check_status(bat_mask_sweep(bent_family, NULL, &options, &intervals, &count, NULL), BAT_UNSUPPORTED);
    options.smoothness = 1000;
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_INVALID_ARGUMENT);
    options = bat_mask_sweep_defaults();
    options.end = 0.2;
    double fraction = 0.0;
    options.progress = (bat_progress){.report = stop_at_half, .context = &fraction};
    check_status(bat_mask_sweep(four_point_family, NULL, &options, &intervals, &count, NULL), BAT_CANCELLED);
    assert_true(fraction >= 0.5);
    assert_null(intervals);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sweep_finds_the_sharp_interval),
        cmocka_unit_test(sweep_finds_single_parameters),
        cmocka_unit_test(sweep_agrees_with_single_analyses),
        cmocka_unit_test(sweeps_that_make_no_sense_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "picture_helpers.h"

#include "research/analysis/chart.h"

static size_t labelled(tick_list ticks)
{
    size_t count = 0;
    for (size_t i = 0; i < ticks.count; i++)
    {
        count += ticks.labelled[i] ? 1 : 0;
    }
    return count;
}

static void logarithmic_ticks_are_round(void **state)
{
    (void)state;
    tick_list ticks = ticks_logarithmic(0.5, 300.0, 6.0);
    for (size_t i = 0; i < ticks.count; i++)
    {
        assert_true(ticks.values[i] >= 0.5 * (1.0 - 1e-9) && ticks.values[i] <= 300.0);
        assert_true(i == 0 || ticks.values[i] > ticks.values[i - 1]);
    }
    for (int i = 0; i < 200; i++) // never none, whatever the range
    {
        double low = 1.1 * pow(10.0, -150.0 + i);
        double high = low * (1.5 + i);
        assert_true(labelled(ticks_logarithmic(low, high, 8.0)) >= 1);
        assert_true(labelled(ticks_logarithmic(low, low * pow(10.0, 0.7 * i + 0.4), 8.0)) >= 1);
    }
}

static void logarithmic_labels_have_powers(void **state)
{
    (void)state;
    tick_list ticks = ticks_logarithmic(1.1e6, 2e6, 5.0);
    char label[TICK_LABEL_SIZE];
    power_label(ticks.values[0], label);
    assert_string_equal(label, "1.2\xc3\x97"
                               "10");
}

static void writes_charts(void **state)
{
    (void)state;
    const double x[] = {0.1, 1.0, 10.0, 100.0};
    const double y[] = {3.0, 1e-9, 5e6, 2.0};
    for (int mark = 0; mark <= BAT_CHART_MARK_BARS; mark++)
    {
        for (int axes = 0; axes < 4; axes++)
        {
            bat_chart_series series = {x, y, 4, (bat_chart_mark)mark, "series", 0};
            bat_chart chart = bat_chart_defaults();
            chart.series = &series;
            chart.series_count = 1;
            chart.x_label = chart.y_label = chart.title = "text";
            chart.log_x = axes % 2 == 1;
            chart.log_y = axes >= 2 && mark != BAT_CHART_MARK_BARS;
            bat_curve_picture_options options = bat_curve_picture_defaults();
            options.width = 300;
            options.height = 200;
            for (int i = 0; i < 3; i++)
            {
                char name[16];
                char path[128];
                (void)snprintf(name, sizeof name, "chart.%s", endings[i]);
                path_of(path, name);
                assert_int_equal(bat_chart_write(path, &chart, 1, &options, NULL), BAT_OK);
                check_picture(path, 300, 200);
                assert_int_equal(unlink(path), 0);
            }
        }
    }
}

static void bad_charts_are_refused(void **state)
{
    (void)state;
    char path[128];
    path_of(path, "chart.svg");
    double x[] = {1.0, 2.0, 3.0};
    double y[] = {1.0, 0.0, 3.0};
    bat_chart_series series = {x, y, 3, BAT_CHART_MARK_LINE, NULL, 0};
    bat_chart chart = bat_chart_defaults();
    bat_error error;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    chart.series = &series;
    chart.series_count = 1;
    chart.log_y = true;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    chart.log_y = false;
    chart.x_low = chart.x_high = 2.0;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    chart.x_low = chart.x_high = NAN;
    y[2] = NAN;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    y[2] = 1.0;
    x[1] = 0.5;
    series.mark = BAT_CHART_MARK_BARS;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    series.count = 0;
    assert_int_equal(bat_chart_write(path, &chart, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_chart_write(path, NULL, 1, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(folder_entries(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(logarithmic_ticks_are_round),
        cmocka_unit_test(logarithmic_labels_have_powers),
        cmocka_unit_test(writes_charts),
        cmocka_unit_test(bad_charts_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

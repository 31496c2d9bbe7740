#include "picture_helpers.h"

#include "batten/research/chart_picture.h"

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
        cmocka_unit_test(writes_charts),
        cmocka_unit_test(bad_charts_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

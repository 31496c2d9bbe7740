// Charts: parameters that a part of a cloud tells for all its points, as bytes too; and loops of samples moved outwards.

#include "surface_fit_helpers.h"

#include "batten/research/surface_chart.h"
#include "batten/surface.h"

enum
{
    POINTS = 20500
};

/// Random points of a bent sheet, the order of which is that of reconstruction.
static bat_cloud sheet(size_t count)
{
    bat_random random = bat_random_seed(4);
    bat_cloud cloud = {.points = calloc(count, 3 * sizeof(double)), .count = count};
    for (size_t i = 0; i < count; i++)
    {
        double u = bat_random_uniform(&random), v = bat_random_uniform(&random);
        const double point[3] = {u, v, 0.2 * sin(4 * u) * v};
        memcpy(cloud.points + 3 * i, point, sizeof point);
    }
    return cloud;
}

static void other_processes_locate_points_alike(void **state)
{
    (void)state;
    bat_cloud cloud = sheet(POINTS);
    bat_surface_chart *chart, *other;
    void *bytes;
    size_t size;
    check_status(bat_surface_chart_boundary(&cloud, false, (bat_progress){0}, NULL), BAT_OK);
    check_status(bat_surface_chart_find(&cloud, NULL, &chart, NULL), BAT_OK);
    check_status(bat_surface_chart_pack(chart, &bytes, &size, NULL), BAT_OK);
    check_status(bat_surface_chart_unpack(bytes, size, &other, NULL), BAT_OK);
    const double *points, *parameters, *points_there, *parameters_there;
    size_t functions = 1;
    size_t loop = bat_surface_chart_loop(chart, &points, &parameters, &functions);
    assert_int_equal(loop, cloud.boundary_count);
    assert_int_equal(bat_surface_chart_loop(other, &points_there, &parameters_there, NULL), loop);
    assert_memory_equal(points, cloud.points, 3 * loop * sizeof(double));
    assert_memory_equal(points, points_there, 3 * loop * sizeof(double));
    assert_memory_equal(parameters, parameters_there, 2 * loop * sizeof(double));
    assert_int_equal(functions, 0);
    double *here = calloc(POINTS, 2 * sizeof *here), *there = calloc(POINTS, 2 * sizeof *there);
    check_status(bat_surface_chart_locate(chart, cloud.points, POINTS, here, NULL), BAT_OK);
    // In two parts.
    check_status(bat_surface_chart_locate(other, cloud.points, 777, there, NULL), BAT_OK);
    check_status(bat_surface_chart_locate(other, cloud.points + 3 * 777, POINTS - 777, there + 2 * 777, NULL), BAT_OK);
    assert_memory_equal(here, there, 2 * POINTS * sizeof(double));
    // Parameters of the interior are about those of the sheet, up to the symmetries of the square.
    size_t inside = 0;
    for (size_t i = loop; i < POINTS; i++)
        inside += here[2 * i] > 0 && here[2 * i] < 1 && here[2 * i + 1] > 0 && here[2 * i + 1] < 1;
    assert_true(inside > (POINTS - loop) * 98 / 100);
    // Bytes that are cut off; a verdict of a process that has not found the chart.
    bat_surface_chart *none = NULL;
    bat_surface_result result;
    check_status(bat_surface_chart_unpack(bytes, size - 1, &none, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_surface_chart_unpack(bytes, 3, &none, NULL), BAT_INVALID_ARGUMENT);
    assert_null(none);
    check_status(bat_surface_chart_finish(other, NULL, NULL, here, here, &result, NULL), BAT_INVALID_ARGUMENT);
    free(here);
    free(there);
    free(bytes);
    bat_surface_chart_free(chart);
    bat_surface_chart_free(other);
    bat_cloud_free(&cloud);
}

static void small_clouds_and_other_options_have_no_chart(void **state)
{
    (void)state;
    bat_cloud cloud = sheet(1000);
    bat_surface_reconstruct_options options = bat_surface_reconstruct_defaults();
    bat_surface_chart *chart = NULL;
    bat_error error;
    check_status(bat_surface_chart_find(&cloud, NULL, &chart, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "20000"));
    bat_cloud_free(&cloud);
    cloud = sheet(POINTS);
    options.trim = true;
    check_status(bat_surface_chart_find(&cloud, &options, &chart, NULL), BAT_INVALID_ARGUMENT);
    options = bat_surface_reconstruct_defaults();
    options.parameters = BAT_SURFACE_PARAMETERS_LEARNED;
    check_status(bat_surface_chart_find(&cloud, &options, &chart, NULL), BAT_INVALID_ARGUMENT);
    assert_null(chart);
    bat_cloud_free(&cloud);
}

/// The loop of a few points of a disc moves towards its edge by means of all points.
static void loops_of_samples_move_to_the_edge(void **state)
{
    (void)state;
    enum
    {
        ALL = 40000,
        FEW = 1000
    };
    bat_random random = bat_random_seed(9);
    double *points = calloc(ALL, 3 * sizeof *points);
    for (size_t i = 0; i < ALL; i++)
    {
        double radius = sqrt(bat_random_uniform(&random)), angle = 6.283185307179586 * bat_random_uniform(&random);
        const double point[3] = {radius * cos(angle), radius * sin(angle), 0.1 * radius};
        memcpy(points + 3 * i, point, sizeof point);
    }
    bat_cloud cloud = {.points = calloc(FEW, 3 * sizeof(double)), .count = FEW};
    memcpy(cloud.points, points, 3 * FEW * sizeof *points);
    double frame[BAT_SURFACE_LOOP_FRAME];
    check_status(bat_surface_loop_frames(&cloud, frame, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_cloud_find_boundary(&cloud, NULL), BAT_OK);
    size_t loop = cloud.boundary_count, *outer = calloc(loop, sizeof *outer);
    double *frames = calloc(loop, sizeof frame), *outwards = calloc(loop, sizeof *outwards), before = 0, after = 0;
    check_status(bat_surface_loop_frames(&cloud, frames, NULL), BAT_OK);
    check_status(bat_surface_loop_outermost(frames, loop, points, ALL, outwards, outer, NULL), BAT_OK);
    for (size_t k = 0; k < loop; k++)
    {
        const double *old = cloud.points + 3 * k, *now = outwards[k] > 0 ? points + 3 * outer[k] : old;
        before += 1 - hypot(old[0], old[1]);
        after += 1 - hypot(now[0], now[1]);
        for (size_t j = 0; j < k; j++)
            assert_true(outer[j] != outer[k] || outer[k] == BAT_NO_INDEX);
    }
    assert_true(after < 0.25 * before);
    free(points);
    free(outer);
    free(frames);
    free(outwards);
    bat_cloud_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(other_processes_locate_points_alike),
        cmocka_unit_test(small_clouds_and_other_options_have_no_chart),
        cmocka_unit_test(loops_of_samples_move_to_the_edge),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

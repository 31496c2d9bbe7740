// Border curves of a fit, corners between curved sides, and charts that are stopped.

#include "cloud_helpers.h"
#include "patch_clouds.h"

#include "batten/batten.h"

enum
{
    SIDE = 60,
    INTERIOR = 3000
};

static void patch_valley(double u, double v, double place[3])
{
    place[0] = u;
    place[1] = v;
    place[2] = 0.4 * u * u - 0.3 * v * v + 0.1 * u * v;
}

/// Turn the boundary into a rough loop: each point moves inwards by up to `depth`, but keeps its parameter.
static void roughen(patch *made, double depth)
{
    bat_random random = bat_random_seed(5);
    for (size_t i = 0; i < made->cloud.boundary_count; i++)
    {
        double *at = made->parameters + 2 * i, inside[2], step = depth * bat_random_uniform(&random);
        for (int d = 0; d < 2; d++)
            inside[d] = at[d] == 0 ? step : at[d] == 1 ? 1 - step : at[d];
        patch_valley(inside[0], inside[1], made->cloud.points + 3 * i);
    }
}

/// Distances of the border of a surface from the edge of the valley: root mean square of the distances in x and y, and of
/// the height over the valley.
static void measure_border(const bat_spline_surface *surface, double *edge, double *height)
{
    enum
    {
        SAMPLES = 400
    };
    double squares[2] = {0, 0};
    for (int k = 0; k < SAMPLES; k++)
    {
        // Corners are left out: rough loops cut them.
        double t = 0.08 + 0.84 * (double)(k / 4) / (SAMPLES / 4 - 1), level = k % 2, at[2], place[3], truth[3];
        size_t along = (size_t)(k / 2 % 2);
        at[along] = t;
        at[1 - along] = level;
        check_status(bat_spline_surface_evaluate(surface, at, 1, 0, place, NULL), BAT_OK);
        patch_valley(place[0], place[1], truth);
        squares[0] += pow(place[1 - along] - level, 2) / SAMPLES;
        squares[1] += pow(place[2] - truth[2], 2) / SAMPLES;
    }
    *edge = sqrt(squares[0]);
    *height = sqrt(squares[1]);
}

static void fit_and_measure(double depth, double noise, bool border, double *edge, double *height)
{
    patch made = patch_scatter(patch_valley, SIDE, INTERIOR, 0, 3);
    bat_random random = bat_random_seed(6);
    for (size_t k = 0; k < 3 * made.cloud.count; k++)
        made.cloud.points[k] += noise * bat_random_normal(&random);
    if (depth > 0)
        roughen(&made, depth);
    bat_surface_fit_data data = {.points = made.cloud.points,
                                 .parameters = made.parameters,
                                 .count = made.cloud.count,
                                 .dimension = 3,
                                 .boundary_count = made.cloud.boundary_count,
                                 .border = border};
    bat_spline_surface surface;
    bat_surface_fit_report report;
    check_status(bat_surface_fit(&data, NULL, &surface, &report, NULL), BAT_OK);
    assert_int_equal(report.rounds[report.count - 1].worst < made.cloud.count, true);
    measure_border(&surface, edge, height);
    for (size_t k = 0; k < 2 * data.count; k++)
        assert_true(data.parameters[k] >= 0 && data.parameters[k] <= 1);
    bat_surface_fit_report_free(&report);
    bat_spline_surface_free(&surface);
    patch_free(&made);
}

/// The border of a rough loop is smooth, and lies at the edge of the sheet.
static void rough_loops_end_at_the_edge(void **state)
{
    (void)state;
    double edge[2], height[2];
    for (int border = 0; border < 2; border++)
        fit_and_measure(0.03, 0, border, &edge[border], &height[border]);
    assert_true(edge[1] < 0.7 * edge[0]);
    assert_true(height[1] < 0.5 * height[0]);
}

/// Exact loops are met exactly, and noise in them is smoothed.
static void exact_and_noisy_loops_keep_their_edge(void **state)
{
    (void)state;
    double edge[1], height[1];
    fit_and_measure(0, 0, true, &edge[0], &height[0]);
    assert_true(edge[0] < 1e-5);
    assert_true(height[0] < 1e-5);
    fit_and_measure(0, 0.005, true, &edge[0], &height[0]);
    assert_true(edge[0] < 0.5 * 0.005);
    assert_true(height[0] < 0.25 * 0.005);
}

/// A helicoid of one turn, whose inner edge is a third as long as the outer one.
static void patch_helicoid(double u, double v, double place[3])
{
    double radius = 0.3 + 0.7 * u, turn = 2 * 3.14159265358979323846 * v;
    place[0] = radius * cos(turn);
    place[1] = radius * sin(turn);
    place[2] = 0.8 * v;
}

/// Distance of a place from the helicoid: from the nearest of many of its lines.
static double helicoid_distance(const double place[3])
{
    enum
    {
        LINES = 500
    };
    double least = INFINITY;
    for (int k = 0; k <= LINES; k++)
    {
        double start[3], end[3], square = 0;
        patch_helicoid(0, (double)k / LINES, start);
        patch_helicoid(1, (double)k / LINES, end);
        double along = ((place[0] - start[0]) * (end[0] - start[0]) + (place[1] - start[1]) * (end[1] - start[1])) / 0.49;
        along = fmin(fmax(along, 0), 1);
        for (int d = 0; d < 3; d++)
        {
            double step = start[d] + along * (end[d] - start[d]) - place[d];
            square += step * step;
        }
        least = fmin(least, square);
    }
    return sqrt(least);
}

/// A part of a cylinder of radius 0.5, three fifths of it.
static void patch_cylinder(double u, double v, double place[3])
{
    double angle = 3.14159265358979323846 * 1.2 * (u - 0.5);
    place[0] = 0.5 * cos(angle);
    place[1] = 0.5 * sin(angle);
    place[2] = 1.2 * v;
}

static double cylinder_distance(const double place[3])
{
    return fabs(hypot(place[0], place[1]) - 0.5);
}

/// Points at random places, none of which is at the edge. Beside them the surface runs on, but it neither folds nor swings.
static void edges_beyond_random_points_are_fair(void **state)
{
    (void)state;
    enum
    {
        STEPS = 100,
        POINTS = 5000
    };
    static const struct
    {
        patch_surface *surface;
        double (*distance)(const double place[3]);
        double mean, largest;
    } CASES[2] = {{patch_helicoid, helicoid_distance, 3e-3, 0.06}, {patch_cylinder, cylinder_distance, 2e-4, 0.01}};
    for (int k = 0; k < 2; k++)
        for (uint64_t seed = 1; seed <= 2; seed++)
        {
            bat_cloud cloud = {.points = calloc(POINTS, 3 * sizeof(double)), .count = POINTS};
            bat_random random = bat_random_seed(seed);
            for (size_t i = 0; i < POINTS; i++)
            {
                double u = bat_random_uniform(&random);
                CASES[k].surface(u, bat_random_uniform(&random), cloud.points + 3 * i);
            }
            bat_surface_result result;
            bat_error error;
            if (bat_surface_reconstruct(&cloud, NULL, &result, &error) != BAT_OK)
                fail_msg("%s", error.text);
            double squares = 0, largest = 0;
            for (int i = 0; i <= STEPS; i++)
                for (int j = 0; j <= STEPS; j++)
                {
                    double at[2] = {(double)i / STEPS, (double)j / STEPS}, place[3];
                    check_status(bat_spline_surface_evaluate(&result.surface, at, 1, 0, place, NULL), BAT_OK);
                    double distance = CASES[k].distance(place);
                    squares += distance * distance;
                    largest = fmax(largest, distance);
                }
            assert_true(sqrt(squares) / (STEPS + 1) < CASES[k].mean);
            assert_true(largest < CASES[k].largest);
            bat_surface_result_free(&result);
            bat_cloud_free(&cloud);
        }
}

static void corners_are_found_between_curved_sides(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_helicoid, SIDE, INTERIOR, 0, 7);
    made.cloud.has_corners = false;
    check_status(bat_cloud_find_corners(&made.cloud, NULL), BAT_OK);
    for (int k = 0; k < 4; k++)
    {
        const double *at = made.parameters + 2 * made.cloud.corners[k];
        assert_true((at[0] == 0 || at[0] == 1) && (at[1] == 0 || at[1] == 1));
    }
    patch_free(&made);
}

static bool stop_at_once(void *context, double fraction)
{
    ++*(int *)context;
    return fraction > 1;
}

static void charts_are_stopped(void **state)
{
    (void)state;
    static const bat_cloud_parameterization METHODS[] = {BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING,
                                                         BAT_CLOUD_PARAMETERIZATION_ISOMETRIC};
    patch made = patch_scatter(patch_helicoid, SIDE, INTERIOR, 0, 7);
    double *found = calloc(2 * made.cloud.count, sizeof *found);
    assert_non_null(found);
    for (int k = 0; k < 2; k++)
    {
        int calls = 0;
        bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
        options.method = METHODS[k];
        options.progress = (bat_progress){stop_at_once, &calls};
        check_status(bat_cloud_parameterize(&made.cloud, made.parameters, &options, found, NULL), BAT_CANCELLED);
        assert_true(calls > 0);
    }
    free(found);
    patch_free(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rough_loops_end_at_the_edge),
        cmocka_unit_test(exact_and_noisy_loops_keep_their_edge),
        cmocka_unit_test(edges_beyond_random_points_are_fair),
        cmocka_unit_test(corners_are_found_between_curved_sides),
        cmocka_unit_test(charts_are_stopped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

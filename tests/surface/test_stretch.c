// Parameters evened out until the surface is stretched the same all over (Yoshizawa, Belyaev and Seidel 2004).

#include "patch_clouds.h"

#include "surface/cloud/spatial_order.h"
#include "surface/parameterize/weights.h"

static double *numbers(size_t count)
{
    double *made = calloc(count > 0 ? count : 1, sizeof *made);
    assert_non_null(made);
    return made;
}

static double *find(const patch *from, bat_cloud_parameterization method, int threads)
{
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = method;
    options.threads = threads;
    double *found = numbers(2 * from->cloud.count);
    bat_error error = {0};
    if (bat_cloud_parameterize(&from->cloud, from->parameters, &options, found, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return found;
}

/// What is left of the unit sphere without a cap of half a radian around its lowest point, evenly filled by the square.
static void deep_sphere(double u, double v, double place[3])
{
    double x = 2 * u - 1, y = 2 * v - 1, reach = fmax(fabs(x), fabs(y)), turn = atan2(y, x);
    double height = 1 - reach * reach * (1 + cos(0.5)), from_axis = sqrt(1 - height * height);
    place[0] = from_axis * cos(turn);
    place[1] = from_axis * sin(turn);
    place[2] = height;
}

/// A tube of radius 1, 40 long, with a round end, evenly filled by the square.
static void test_tube(double u, double v, double place[3])
{
    double x = 2 * u - 1, y = 2 * v - 1, reach = fmax(fabs(x), fabs(y)), turn = atan2(y, x);
    double height = 1 - 41 * reach * reach, from_axis = height > 0 ? sqrt(1 - height * height) : 1;
    place[0] = from_axis * cos(turn);
    place[1] = from_axis * sin(turn);
    place[2] = height;
}

/// How far points are from their nearest ones in space, over how far they are in the square: the root mean square.
static double stretch_to_nearest(const bat_cloud *cloud, const double *parameters)
{
    double sum = 0;
    for (size_t i = cloud->boundary_count; i < cloud->count; i++)
    {
        double least = INFINITY, ratio = 0;
        for (size_t k = 0; k < cloud->count; k++)
        {
            double squares = 0;
            for (size_t d = 0; d < 3; d++)
                squares += pow(cloud->points[3 * i + d] - cloud->points[3 * k + d], 2);
            if (k == i || squares >= least)
                continue;
            double u = parameters[2 * i] - parameters[2 * k], v = parameters[2 * i + 1] - parameters[2 * k + 1];
            least = squares;
            ratio = squares / (u * u + v * v);
        }
        sum += ratio / (double)(cloud->count - cloud->boundary_count);
    }
    return sqrt(sum);
}

static void it_has_a_name(void **state)
{
    (void)state;
    assert_string_equal(bat_choice_name(&bat_cloud_parameterization_family, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING),
                        "stretch-minimizing");
}

static void the_stretch_of_deep_shapes_falls(void **state)
{
    (void)state;
    patch made = patch_scatter(deep_sphere, 8, 1000, 0, 1);
    double *before = find(&made, BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING, 1),
           *after = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
    assert_true(stretch_to_nearest(&made.cloud, after) < 0.5 * stretch_to_nearest(&made.cloud, before));
    bat_cloud_parameters_report report;
    check_status(bat_cloud_parameters_check(&made.cloud, after, &report, NULL), BAT_OK);
    // Stars of a cloud are no triangulation, so that Tutte promises nothing.
    assert_true(report.folded <= 2);
    free(before);
    free(after);
    patch_free(&made);
}

static void parameters_stay_in_the_square(void **state)
{
    (void)state;
    patch_surface *const surfaces[] = {deep_sphere, patch_waves, patch_sphere};
    for (size_t k = 0; k < 6; k++)
    {
        patch made = patch_scatter(surfaces[k / 2], 12, 500, k % 2 == 0 ? 0 : 0.02, k);
        double *found = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
        assert_memory_equal(found, made.parameters, 2 * made.cloud.boundary_count * sizeof *found);
        for (size_t i = 0; i < 2 * made.cloud.count; i++)
            assert_true(found[i] >= 0 && found[i] <= 1);
        free(found);
        patch_free(&made);
    }
}

/// Affine parameters of a plane stretch it the same everywhere: weights divided by equal numbers are the same weights.
static void planes_are_kept(void **state)
{
    (void)state;
    patch scattered = patch_scatter(patch_plane, 20, 400, 0, 3), grid = patch_mesh(patch_plane, 20, 0, 1);
    patch *const planes[] = {&scattered, &grid};
    for (size_t k = 0; k < 2; k++)
    {
        double *found = find(planes[k], BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
        for (size_t i = 0; i < 2 * planes[k]->cloud.count; i++)
            check_near(found[i], planes[k]->parameters[i], 1e-12);
        free(found);
        patch_free(planes[k]);
    }
}

static void threads_change_no_byte(void **state)
{
    (void)state;
    patch made = patch_scatter(deep_sphere, 13, 3000, 0.01, 5);
    double *one = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
    for (int threads = 0; threads < 5; threads += 2)
    {
        double *many = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, threads);
        assert_memory_equal(one, many, 2 * made.cloud.count * sizeof *one);
        free(many);
    }
    free(one);
    patch_free(&made);
}

/// The size of the cloud divides out.
static void size_does_not_matter(void **state)
{
    (void)state;
    patch made = patch_scatter(deep_sphere, 6, 500, 0, 6);
    double *before = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
    for (size_t i = 0; i < 3 * made.cloud.count; i++)
        made.cloud.points[i] *= 0x1p-20;
    double *after = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
    for (size_t i = 0; i < 2 * made.cloud.count; i++)
        check_near(after[i], before[i], 1e-12);
    free(before);
    free(after);
    patch_free(&made);
}

static size_t coincident_in(const patch *made, const double *parameters)
{
    bat_cloud_parameters_report report;
    check_status(bat_cloud_parameters_check(&made->cloud, parameters, &report, NULL), BAT_OK);
    assert_int_equal(report.outside, 0);
    return report.coincident;
}

/// Shape-preserving parameters fall off by e a radius, to where numbers end: even what coincides is spread again.
static void the_end_of_a_tube_is_seen(void **state)
{
    (void)state;
    patch made = patch_scatter(test_tube, 16, 4000, 0, 4);
    double *before = find(&made, BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING, 0),
           *after = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 0);
    assert_true(coincident_in(&made, before) > 100);
    assert_true(coincident_in(&made, after) < coincident_in(&made, before) / 10);
    free(before);
    free(after);
    patch_free(&made);
}

/// Rows of a cloud whose whole interior lies at one parameter: nothing tells its stretch, and weights remain weights.
static void coincident_parameters_are_no_failure(void **state)
{
    (void)state;
    patch made = patch_scatter(patch_waves, 10, 200, 0, 8);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    spatial_order order;
    sparse_rows rows;
    check_status(spatial_order_make(&made.cloud, &order, NULL), BAT_OK);
    check_status(weights_make(&order.cloud, &order.tree, &options, &rows, NULL), BAT_OK);
    double *parameters = numbers(2 * made.cloud.count);
    for (size_t i = 0; i < 2 * made.cloud.count; i++)
        parameters[i] = i < 2 * made.cloud.boundary_count ? made.parameters[i] : 0.5;
    check_status(stretch_minimize(&order.cloud, &rows, (bat_progress){0}, parameters, NULL), BAT_OK);
    for (size_t i = 0; i < 2 * made.cloud.count; i++)
        assert_true(parameters[i] >= 0 && parameters[i] <= 1);
    for (size_t row = 0; row < rows.row_count; row++)
    {
        double sum = 0;
        for (size_t e = rows.starts[row]; e < rows.starts[row + 1]; e++)
        {
            assert_true(rows.values[e] > 0);
            sum += rows.values[e];
        }
        check_near(sum, 1, 1e-14);
    }
    free(parameters);
    sparse_rows_free(&rows);
    spatial_order_free(&order);
    patch_free(&made);
}

static void few_points_are_no_different(void **state)
{
    (void)state;
    for (size_t interior = 0; interior < 4; interior++)
    {
        patch made = patch_scatter(patch_waves, 2, interior, 0, interior);
        double *found = find(&made, BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING, 1);
        for (size_t i = 0; i < 2 * made.cloud.count; i++)
            assert_true(found[i] >= 0 && found[i] <= 1);
        free(found);
        patch_free(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_has_a_name),
        cmocka_unit_test(the_stretch_of_deep_shapes_falls),
        cmocka_unit_test(parameters_stay_in_the_square),
        cmocka_unit_test(planes_are_kept),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(size_does_not_matter),
        cmocka_unit_test(the_end_of_a_tube_is_seen),
        cmocka_unit_test(coincident_parameters_are_no_failure),
        cmocka_unit_test(few_points_are_no_different),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

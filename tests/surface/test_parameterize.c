// Parameters of clouds by averages of neighbours.

#include "patch_clouds.h"

#include "surface/cloud/spatial_order.h"
#include "surface/parameterize/weights.h"

static const bat_cloud_parameterization MESHLESS[] = {BAT_CLOUD_PARAMETERIZATION_UNIFORM,
                                                      BAT_CLOUD_PARAMETERIZATION_INVERSE_DISTANCE,
                                                      BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING};

/// Parameters of a patch from its boundary's; release them with free().
static double *find(const patch *from, bat_cloud_parameterization method, bool published)
{
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = method;
    options.published = published;
    double *found = malloc(from->cloud.count * 2 * sizeof *found);
    bat_error error = {0};
    assert_non_null(found);
    if (bat_cloud_parameterize(&from->cloud, from->parameters, &options, found, &error) != BAT_OK)
    {
        print_error("%s\n", error.text);
        fail();
    }
    return found;
}

static double largest_difference(const double *a, const double *b, size_t count)
{
    double largest = 0;
    for (size_t k = 0; k < count; k++)
        largest = fmax(largest, fabs(a[k] - b[k]));
    return largest;
}

static void names_and_defaults(void **state)
{
    (void)state;
    assert_string_equal(bat_choice_name(&bat_cloud_parameterization_family, BAT_CLOUD_PARAMETERIZATION_UNIFORM), "uniform");
    assert_string_equal(bat_choice_name(&bat_cloud_parameterization_family, BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE),
                        "mean-value");
    assert_string_equal(bat_choice_name(&bat_cloud_parameterization_family, BAT_CLOUD_PARAMETERIZATION_COUNT), "unknown");
    assert_int_equal(bat_cloud_parameterize_defaults().method, BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING);
    assert_false(bat_cloud_parameterize_defaults().published);
}

/// Weights that make each point of a plane the average of its neighbours give every affine map back.
static void planes_are_parameterized_exactly(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 10; seed++)
    {
        patch cloud = patch_scatter(patch_plane, 10 + seed, 40 * seed * seed, 0, seed);
        patch mesh = patch_mesh(patch_plane, 8 + 3 * seed, 0.2, seed);
        double *ours = find(&cloud, BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING, false);
        double *means = find(&mesh, BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE, false);
        check_near(largest_difference(ours, cloud.parameters, 2 * cloud.cloud.count), 0, 1e-12);
        check_near(largest_difference(means, mesh.parameters, 2 * mesh.cloud.count), 0, 1e-12);
        patch_free(&cloud);
        patch_free(&mesh);
        free(ours);
        free(means);
    }
    patch cloud = patch_scatter(patch_plane, 22, 400, 0, 3);
    double *published = find(&cloud, BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING, true);
    check_near(largest_difference(published, cloud.parameters, 2 * cloud.cloud.count), 0, 1e-12);
    patch_free(&cloud);
    free(published);
}

/// On a regular grid uniform weights over symmetric neighbourhoods are exact too, away from the boundary's one-sided ones;
/// here all points satisfy their equation with the neighbours counted by hand.
static void published_weights_are_those_of_the_ball(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 20, 300, 0, 5);
    size_t count = cloud.cloud.count;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, side = 0;
    for (size_t k = 0; k < 3 * count; k++)
    {
        low[k % 3] = fmin(low[k % 3], cloud.cloud.points[k]);
        high[k % 3] = fmax(high[k % 3], cloud.cloud.points[k]);
    }
    for (size_t c = 0; c < 3; c++)
        side = fmax(side, high[c] - low[c]);
    double radius = 3 / sqrt((double)count) * side;
    for (size_t m = 0; m < 2; m++)
    {
        double *found = find(&cloud, MESHLESS[m], true);
        for (size_t i = cloud.cloud.boundary_count; i < count; i++)
        {
            double sum = 0, mean[2] = {0, 0};
            for (size_t k = 0; k < count; k++)
            {
                const double *a = cloud.cloud.points + 3 * i, *b = cloud.cloud.points + 3 * k;
                double distance =
                    sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
                if (k == i || distance > radius)
                    continue;
                double weight = m == 0 ? 1 : 1 / distance;
                sum += weight;
                mean[0] += weight * found[2 * k];
                mean[1] += weight * found[2 * k + 1];
            }
            check_near(mean[0] / sum, found[2 * i], 1e-13);
            check_near(mean[1] / sum, found[2 * i + 1], 1e-13);
        }
        free(found);
    }
    patch_free(&cloud);
}

static void weights_are_positive_and_sum_to_one(void **state)
{
    (void)state;
    patch patches[3] = {patch_scatter(patch_waves, 15, 200, 0, 1), patch_scatter(patch_waves, 15, 200, 0.05, 2),
                        patch_mesh(patch_waves, 20, 0.4, 3)};
    for (size_t p = 0; p < 3; p++)
        for (int method = BAT_CLOUD_PARAMETERIZATION_UNIFORM; method < BAT_CLOUD_PARAMETERIZATION_COUNT; method++)
        {
            if (method == BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE && p < 2)
                continue;
            bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
            options.method = (bat_cloud_parameterization)method;
            spatial_order order;
            sparse_rows rows;
            check_status(spatial_order_make(&patches[p].cloud, &order, NULL), BAT_OK);
            check_status(weights_make(&order.cloud, &order.tree, &options, &rows, NULL), BAT_OK);
            assert_int_equal(rows.row_count, patches[p].cloud.count - patches[p].cloud.boundary_count);
            for (size_t row = 0; row < rows.row_count; row++)
            {
                double sum = 0;
                for (size_t e = rows.starts[row]; e < rows.starts[row + 1]; e++)
                {
                    assert_true(rows.values[e] > 0);
                    assert_true(rows.columns[e] != row + patches[p].cloud.boundary_count);
                    sum += rows.values[e];
                }
                check_near(sum, 1, 1e-14);
            }
            sparse_rows_free(&rows);
            spatial_order_free(&order);
        }
    for (size_t p = 0; p < 3; p++)
        patch_free(&patches[p]);
}

static void parameters_stay_in_the_square(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 20; seed++)
        for (size_t m = 0; m < 3; m++)
        {
            patch cloud = patch_scatter(patch_waves, 12, 150, seed % 2 == 0 ? 0.05 : 0, seed);
            double *found = find(&cloud, MESHLESS[m], false);
            assert_memory_equal(found, cloud.parameters, 2 * cloud.cloud.boundary_count * sizeof *found);
            for (size_t k = 2 * cloud.cloud.boundary_count; k < 2 * cloud.cloud.count; k++)
                assert_true(found[k] >= 0 && found[k] <= 1);
            patch_free(&cloud);
            free(found);
        }
}

/// A convex boundary and averages over triangles: no triangle turns over (Tutte 1963, Floater 2003).
static void mean_values_never_fold_a_mesh(void **state)
{
    (void)state;
    patch_surface *surfaces[] = {patch_waves, patch_sphere};
    for (uint64_t seed = 1; seed <= 10; seed++)
    {
        patch mesh = patch_mesh(surfaces[seed % 2], 10 + 2 * seed, 0.45, seed);
        double *found = find(&mesh, BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE, false);
        for (size_t t = 0; t < mesh.cloud.triangle_count; t++)
        {
            const uint32_t *corner = mesh.cloud.triangles + 3 * t;
            const double *a = found + 2 * (size_t)corner[0], *b = found + 2 * (size_t)corner[1],
                         *c = found + 2 * (size_t)corner[2];
            assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0);
        }
        patch_free(&mesh);
        free(found);
    }
}

/// 50 points, noise of standard deviation 0.05: the case where the published way fails most.
static void noise_never_makes_it_fail(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 100; seed++)
        for (size_t m = 0; m < 3; m++)
        {
            patch cloud = patch_scatter(patch_waves, 9, 50, 0.05, seed);
            free(find(&cloud, MESHLESS[m], false));
            patch_free(&cloud);
        }
}

/// Moving, turning and scaling the cloud changes nothing, nor does the order of its interior points.
static void parameters_do_not_depend_on_place_or_order(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 20, 400, 0.002, 9), moved = patch_scatter(patch_waves, 20, 400, 0.002, 9);
    size_t count = cloud.cloud.count, boundary = cloud.cloud.boundary_count;
    for (size_t i = 0; i < count; i++)
    {
        // Interior points run backwards.
        size_t from = i < boundary ? i : count - 1 - (i - boundary);
        const double *p = cloud.cloud.points + 3 * from;
        double *q = moved.cloud.points + 3 * i;
        q[0] = 700 * (0.36 * p[0] + 0.48 * p[1] - 0.8 * p[2]) + 100;
        q[1] = 700 * (-0.8 * p[0] + 0.6 * p[1]) - 2000;
        q[2] = 700 * (0.48 * p[0] + 0.64 * p[1] + 0.6 * p[2]);
    }
    for (size_t m = 0; m < 3; m++)
    {
        double *first = find(&cloud, MESHLESS[m], false), *second = find(&moved, MESHLESS[m], false);
        for (size_t i = boundary; i < count; i++)
        {
            check_near(first[2 * i], second[2 * (count - 1 - (i - boundary))], 1e-9);
            check_near(first[2 * i + 1], second[2 * (count - 1 - (i - boundary)) + 1], 1e-9);
        }
        free(first);
        free(second);
    }
    patch_free(&cloud);
    patch_free(&moved);
}

static void threads_change_no_byte(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 40, 3000, 0.01, 4);
    for (int published = 0; published < 2; published++)
        for (size_t m = 0; m < 3; m++)
        {
            bat_cloud_parameterize_options options = {.method = MESHLESS[m], .published = published == 1, .threads = 1};
            double *one = malloc(cloud.cloud.count * 2 * sizeof *one),
                   *three = malloc(cloud.cloud.count * 2 * sizeof *three);
            assert_true(one != NULL && three != NULL);
            check_status(bat_cloud_parameterize(&cloud.cloud, cloud.parameters, &options, one, NULL), BAT_OK);
            options.threads = 3;
            check_status(bat_cloud_parameterize(&cloud.cloud, cloud.parameters, &options, three, NULL), BAT_OK);
            assert_memory_equal(one, three, cloud.cloud.count * 2 * sizeof *one);
            free(one);
            free(three);
        }
    patch_free(&cloud);
}

/// A clump of points far from everything: the published way tells the first of them by its place in the input, ours joins
/// it.
static void islands_are_joined_or_told(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 20, 330, 0, 6);
    size_t count = cloud.cloud.count, island = 30;
    cloud.cloud.order = malloc(count * sizeof *cloud.cloud.order);
    assert_non_null(cloud.cloud.order);
    for (size_t i = 0; i < count; i++)
    {
        cloud.cloud.order[i] = (i + 1000) % (2 * count);
        if (i + island >= count)
        {
            double *p = cloud.cloud.points + 3 * i;
            p[0] = 0.5 + 0.02 * p[0];
            p[1] = 0.5 + 0.02 * p[1];
            p[2] += 0.9;
        }
    }
    for (size_t m = 0; m < 3; m++)
    {
        bat_cloud_parameterize_options options = {.method = MESHLESS[m], .published = true};
        double *found = malloc(count * 2 * sizeof *found);
        bat_error error = {0};
        assert_non_null(found);
        check_status(bat_cloud_parameterize(&cloud.cloud, cloud.parameters, &options, found, &error), BAT_NO_CONVERGENCE);
        assert_int_equal(error.index, cloud.cloud.order[count - island]);
        free(found);
        free(find(&cloud, MESHLESS[m], false));
    }
    patch_free(&cloud);
}

static void small_neighbourhoods_are_told(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 20, 300, 0, 6);
    size_t lonely = cloud.cloud.boundary_count + 17;
    cloud.cloud.points[3 * lonely + 2] = 0.8;
    for (size_t m = 0; m < 3; m++)
    {
        bat_cloud_parameterize_options options = {.method = MESHLESS[m], .published = true};
        double *found = malloc(cloud.cloud.count * 2 * sizeof *found);
        bat_error error = {0};
        assert_non_null(found);
        check_status(bat_cloud_parameterize(&cloud.cloud, cloud.parameters, &options, found, &error), BAT_NO_CONVERGENCE);
        assert_int_equal(error.index, lonely);
        free(found);
    }
    patch_free(&cloud);
}

static void check_refused(const bat_cloud *cloud, const double *boundary, const bat_cloud_parameterize_options *options,
                          bat_status status, const char *text)
{
    double parameters[2000];
    bat_error error = {0};
    check_status(bat_cloud_parameterize(cloud, boundary, options, parameters, &error), status);
    assert_non_null(strstr(error.text, text));
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 9, 50, 0, 1);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults(), wrong = options;
    wrong.method = BAT_CLOUD_PARAMETERIZATION_COUNT;
    check_refused(&cloud.cloud, cloud.parameters, &wrong, BAT_INVALID_ARGUMENT, "method is");
    wrong = options;
    wrong.radius = -1;
    check_refused(&cloud.cloud, cloud.parameters, &wrong, BAT_INVALID_ARGUMENT, "radius");
    wrong.radius = NAN;
    check_refused(&cloud.cloud, cloud.parameters, &wrong, BAT_INVALID_ARGUMENT, "radius");
    wrong = options;
    wrong.method = BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE;
    check_refused(&cloud.cloud, cloud.parameters, &wrong, BAT_UNSUPPORTED, "triangles");
    cloud.parameters[6] = INFINITY;
    check_refused(&cloud.cloud, cloud.parameters, &options, BAT_INVALID_ARGUMENT, "point 3");
    bat_cloud open = cloud.cloud;
    open.boundary_count = 0;
    open.has_corners = false;
    check_refused(&open, cloud.parameters, &options, BAT_INVALID_ARGUMENT, "boundary");
    patch_free(&cloud);
}

/// Clouds of few points, among them one without an interior.
static void few_points_do(void **state)
{
    (void)state;
    for (size_t interior = 0; interior <= 6; interior++)
        for (size_t m = 0; m < 3; m++)
        {
            patch cloud = patch_scatter(patch_waves, 2, interior, 0, 8);
            double *found = find(&cloud, MESHLESS[m], false);
            for (size_t k = 0; k < 2 * cloud.cloud.count; k++)
                assert_true(found[k] >= 0 && found[k] <= 1);
            patch_free(&cloud);
            free(found);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_defaults),
        cmocka_unit_test(planes_are_parameterized_exactly),
        cmocka_unit_test(published_weights_are_those_of_the_ball),
        cmocka_unit_test(weights_are_positive_and_sum_to_one),
        cmocka_unit_test(parameters_stay_in_the_square),
        cmocka_unit_test(mean_values_never_fold_a_mesh),
        cmocka_unit_test(noise_never_makes_it_fail),
        cmocka_unit_test(parameters_do_not_depend_on_place_or_order),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(islands_are_joined_or_told),
        cmocka_unit_test(small_neighbourhoods_are_told),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(few_points_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

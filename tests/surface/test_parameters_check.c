// Folds of parameters, found and undone.

#include "patch_clouds.h"

#include "surface/cloud/local_plane.h"

static bat_cloud_parameters_report check(const patch *of, const double *parameters)
{
    bat_cloud_parameters_report report;
    check_status(bat_cloud_parameters_check(&of->cloud, parameters, &report, NULL), BAT_OK);
    return report;
}

static double *copy_parameters(const patch *of)
{
    double *copy = malloc(2 * of->cloud.count * sizeof *copy);
    assert_non_null(copy);
    memcpy(copy, of->parameters, 2 * of->cloud.count * sizeof *copy);
    return copy;
}

/// Repairs and returns what is left; the boundary must stay, the rest be in the square.
static bat_cloud_parameters_report repair(const patch *of, double *parameters)
{
    bat_cloud_parameters_report report, again;
    check_status(bat_cloud_parameters_repair(&of->cloud, parameters, &report, NULL), BAT_OK);
    again = check(of, parameters);
    assert_int_equal(report.folded, again.folded);
    assert_int_equal(report.first, again.first);
    assert_int_equal(report.coincident, again.coincident);
    assert_int_equal(again.outside, 0);
    assert_memory_equal(parameters, of->parameters, 2 * of->cloud.boundary_count * sizeof *parameters);
    return again;
}

static void true_parameters_have_no_faults(void **state)
{
    (void)state;
    patch_surface *surfaces[] = {patch_plane, patch_waves, patch_sphere};
    for (size_t s = 0; s < 3; s++)
        for (uint64_t seed = 1; seed <= 3; seed++)
        {
            patch cloud = patch_scatter(surfaces[s], 25, 600, 0, seed);
            bat_cloud_parameters_report report = check(&cloud, cloud.parameters);
            assert_int_equal(report.folded, 0);
            assert_int_equal(report.first, BAT_NO_INDEX);
            assert_int_equal(report.outside, 0);
            assert_int_equal(report.coincident, 0);
            assert_true(report.stretch >= 1);
            patch_free(&cloud);
        }
}

/// Of an affine map the ratio of singular values is known: the plane's own axes have lengths and a product.
static void stretch_is_the_ratio_of_singular_values(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_plane, 20, 300, 0, 2);
    const double along[3] = {2, 0.3, 0.7}, across[3] = {0.5, 1.5, -0.4};
    double a = 0, b = 0, c = 0;
    for (size_t k = 0; k < 3; k++)
    {
        a += along[k] * along[k];
        b += along[k] * across[k];
        c += across[k] * across[k];
    }
    double root = sqrt((a - c) * (a - c) + 4 * b * b), expected = sqrt((a + c + root) / (a + c - root));
    check_relative(check(&cloud, cloud.parameters).stretch, expected, 1e-9);
    patch_free(&cloud);
}

/// Where the loop runs the other way round in the parameters, so must everything.
static void orientation_is_the_boundarys(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_sphere, 25, 600, 0, 4);
    double *mirrored = copy_parameters(&cloud);
    for (size_t i = 0; i < cloud.cloud.count; i++)
        mirrored[2 * i] = 1 - mirrored[2 * i];
    assert_int_equal(check(&cloud, mirrored).folded, 0);
    // The interior alone: now nearly all of it is turned over.
    memcpy(mirrored, cloud.parameters, 2 * cloud.cloud.boundary_count * sizeof *mirrored);
    bat_cloud_parameters_report report = check(&cloud, mirrored);
    assert_true(report.folded > 400);
    assert_true(report.first >= cloud.cloud.boundary_count);
    patch_free(&cloud);
    free(mirrored);
}

/// On a sphere all normals point outwards, or all inwards as the loop has it.
static void planes_agree_on_a_sphere(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_sphere, 40, 2000, 0, 1);
    for (int turned = 0; turned < 2; turned++)
    {
        nearest_tree tree;
        oriented_planes oriented;
        check_status(neighbours_build(cloud.cloud.points, cloud.cloud.count, &tree, NULL), BAT_OK);
        check_status(oriented_planes_make(&cloud.cloud, &tree, &oriented, NULL), BAT_OK);
        for (size_t i = 0; i < cloud.cloud.count; i++)
        {
            const double *p = cloud.cloud.points + 3 * i;
            double(*axes)[3] = oriented.planes[i].axes;
            double out = p[0] * axes[2][0] + p[1] * axes[2][1] + p[2] * axes[2][2];
            assert_true(turned ? out < -0.9 : out > 0.9);
            double up = axes[0][0] * axes[1][1] - axes[0][1] * axes[1][0];
            check_near(up, axes[2][2], 1e-12);
        }
        oriented_planes_free(&oriented);
        nearest_free(&tree);
        // Turn the loop round.
        double *points = cloud.cloud.points;
        for (size_t i = 0, last = cloud.cloud.boundary_count - 1; i < last; i++, last--)
            for (size_t c = 0; c < 3; c++)
            {
                double kept = points[3 * i + c];
                points[3 * i + c] = points[3 * last + c];
                points[3 * last + c] = kept;
            }
    }
    patch_free(&cloud);
}

/// Mirrors the parameters within a disc about a place; returns how many points it holds.
static size_t fold_disc(const patch *of, double *parameters, double u, double v, double radius)
{
    size_t found = 0;
    for (size_t i = of->cloud.boundary_count; i < of->cloud.count; i++)
        if (hypot(parameters[2 * i] - u, parameters[2 * i + 1] - v) < radius)
        {
            parameters[2 * i] = 2 * u - parameters[2 * i];
            found++;
        }
    return found;
}

static void folded_discs_are_found_and_undone(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 35, 1100, 0, 3);
    double *folded = copy_parameters(&cloud);
    size_t turned = fold_disc(&cloud, folded, 0.6, 0.4, 0.15);
    bat_cloud_parameters_report before = check(&cloud, folded);
    assert_true(before.folded > turned / 2 && before.folded < 2 * turned);
    const double *first = cloud.parameters + 2 * before.first;
    assert_true(hypot(first[0] - 0.6, first[1] - 0.4) < 0.25);
    bat_cloud_parameters_report after = repair(&cloud, folded);
    assert_int_equal(after.folded, 0);
    assert_int_equal(after.coincident, 0);
    // Far from the disc nothing moved; within it all are near the truth.
    for (size_t i = cloud.cloud.boundary_count; i < cloud.cloud.count; i++)
    {
        const double *was = cloud.parameters + 2 * i, *is = folded + 2 * i;
        double distance = hypot(was[0] - 0.6, was[1] - 0.4);
        check_near(hypot(is[0] - was[0], is[1] - was[1]), 0, distance > 0.4 ? 0 : 0.08);
    }
    patch_free(&cloud);
    free(folded);
}

static void clean_parameters_are_left_alone(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 25, 600, 0, 3);
    double *same = copy_parameters(&cloud);
    assert_int_equal(repair(&cloud, same).folded, 0);
    assert_memory_equal(same, cloud.parameters, 2 * cloud.cloud.count * sizeof *same);
    patch_free(&cloud);
    free(same);
}

/// Garbage of all kinds: random, all in one place, not numbers, far outside.
static void garbage_is_repaired(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(9);
    for (int kind = 0; kind < 4; kind++)
    {
        patch cloud = patch_scatter(kind % 2 == 0 ? patch_waves : patch_sphere, 25, 500, 0, (uint64_t)kind + 1);
        double *parameters = copy_parameters(&cloud);
        for (size_t k = 2 * cloud.cloud.boundary_count; k < 2 * cloud.cloud.count; k++)
            parameters[k] = kind == 0   ? bat_random_uniform(&random)
                            : kind == 1 ? 0.5
                            : kind == 2 ? NAN
                                        : 100 * bat_random_normal(&random);
        bat_cloud_parameters_report before = check(&cloud, parameters);
        assert_true(before.folded + before.coincident + before.outside > 200);
        bat_cloud_parameters_report after = repair(&cloud, parameters);
        assert_int_equal(after.folded, 0);
        assert_int_equal(after.coincident, 0);
        patch_free(&cloud);
        free(parameters);
    }
}

static void faults_are_counted(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 25, 600, 0, 3);
    size_t first = cloud.cloud.boundary_count;
    double *parameters = copy_parameters(&cloud);
    // One point at another, one at a boundary point, two outside, one nowhere.
    parameters[2 * first] = parameters[2 * (first + 1)];
    parameters[2 * first + 1] = parameters[2 * (first + 1) + 1];
    parameters[2 * (first + 2)] = parameters[6];
    parameters[2 * (first + 2) + 1] = parameters[7];
    parameters[2 * (first + 3)] = -1e-9;
    parameters[2 * (first + 4) + 1] = 1.5;
    parameters[2 * (first + 5)] = NAN;
    bat_cloud_parameters_report report = check(&cloud, parameters);
    assert_int_equal(report.coincident, 3);
    assert_int_equal(report.outside, 3);
    patch_free(&cloud);
    free(parameters);
}

/// Meshes are looked at triangle by triangle: one vertex beyond its neighbours turns some over.
static void meshes_are_checked_by_triangles(void **state)
{
    (void)state;
    patch mesh = patch_mesh(patch_waves, 20, 0.2, 5);
    assert_int_equal(check(&mesh, mesh.parameters).folded, 0);
    double *parameters = copy_parameters(&mesh);
    size_t moved = patch_grid_number(9, 11, 20);
    parameters[2 * moved] += 2.0 / 19;
    bat_cloud_parameters_report before = check(&mesh, parameters);
    assert_true(before.folded >= 3 && before.folded <= 7);
    assert_int_equal(repair(&mesh, parameters).folded, 0);
    // Triangles that all run the other way mean the same.
    for (size_t t = 0; t < mesh.cloud.triangle_count; t++)
    {
        uint32_t *corner = mesh.cloud.triangles + 3 * t, kept = corner[0];
        corner[0] = corner[1];
        corner[1] = kept;
    }
    assert_int_equal(check(&mesh, mesh.parameters).folded, 0);
    patch_free(&mesh);
    free(parameters);
}

/// Noise thicker than the distance of neighbours: planes are wide enough that few true parameters look folded.
static void noise_is_not_taken_for_folds(void **state)
{
    (void)state;
    size_t folded = 0, points = 0, found = 0;
    for (uint64_t seed = 1; seed <= 5; seed++)
    {
        patch cloud = patch_scatter(patch_waves, 34, 1000, 0.04, seed);
        folded += check(&cloud, cloud.parameters).folded;
        points += 1000;
        double *turned = copy_parameters(&cloud);
        (void)fold_disc(&cloud, turned, 0.5, 0.5, 0.3);
        found += check(&cloud, turned).folded;
        patch_free(&cloud);
        free(turned);
    }
    assert_true(folded * 200 <= points);
    assert_true(found > points / 10);
}

/// What uniform weights do not fold is not folded after a repair, noise or not.
static void repair_is_as_good_as_uniform_weights(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    for (uint64_t seed = 1; seed <= 12; seed++)
    {
        patch cloud = patch_scatter(patch_waves, 16, 200, seed % 3 == 0 ? 0.05 : 0, seed);
        bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
        options.method = BAT_CLOUD_PARAMETERIZATION_UNIFORM;
        double *uniform = copy_parameters(&cloud), *garbage = copy_parameters(&cloud);
        check_status(bat_cloud_parameterize(&cloud.cloud, cloud.parameters, &options, uniform, NULL), BAT_OK);
        for (size_t k = 2 * cloud.cloud.boundary_count; k < 2 * cloud.cloud.count; k++)
            garbage[k] = bat_random_uniform(&random);
        size_t left = repair(&cloud, garbage).folded;
        assert_true(left <= check(&cloud, uniform).folded);
        patch_free(&cloud);
        free(uniform);
        free(garbage);
    }
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    patch cloud = patch_scatter(patch_waves, 9, 50, 0, 1);
    bat_cloud_parameters_report report;
    bat_error error = {0};
    bat_cloud open = cloud.cloud;
    open.boundary_count = 0;
    open.has_corners = false;
    check_status(bat_cloud_parameters_check(&open, cloud.parameters, &report, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_cloud_parameters_repair(&open, cloud.parameters, NULL, &error), BAT_INVALID_ARGUMENT);
    cloud.parameters[5] = NAN;
    check_status(bat_cloud_parameters_repair(&cloud.cloud, cloud.parameters, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 2);
    patch_free(&cloud);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(true_parameters_have_no_faults),
        cmocka_unit_test(stretch_is_the_ratio_of_singular_values),
        cmocka_unit_test(orientation_is_the_boundarys),
        cmocka_unit_test(planes_agree_on_a_sphere),
        cmocka_unit_test(folded_discs_are_found_and_undone),
        cmocka_unit_test(clean_parameters_are_left_alone),
        cmocka_unit_test(garbage_is_repaired),
        cmocka_unit_test(faults_are_counted),
        cmocka_unit_test(meshes_are_checked_by_triangles),
        cmocka_unit_test(noise_is_not_taken_for_folds),
        cmocka_unit_test(repair_is_as_good_as_uniform_weights),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

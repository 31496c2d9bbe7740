// Models for clouds as the library's users see them: what is read, what is refused, and what holds of every result.

#include "check.h"

#include "batten/cloud_parameterize.h"
#include "batten/research/networks.h"
#include "batten/research/surface_shapes.h"
#include "research/learn/parameters.h"
#include "research/train/bezier_fit.h"
#include "research/train/surface_network_tape.h"

#include <unistd.h>

static char path[60];
static bat_surface_model *model;

static void write_model(const char *recipe)
{
    learn_parameters parameters = {0};
    const safetensors_note note = {"recipe", recipe};
    check_status(surface_tape_published.kind->make(NULL, &parameters, NULL), BAT_OK);
    surface_tape_published.start(&parameters, 3);
    check_status(learn_parameters_write(&parameters, path, &note, recipe != NULL, NULL), BAT_OK);
    learn_parameters_free(&parameters);
}

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(path, sizeof path, "/tmp/batten-surface-model-XXXXXX");
    int file = mkstemp(path);
    if (file < 0 || close(file) != 0)
        return -1;
    write_model("surface published, of nothing");
    return bat_surface_model_read_published(path, &model, NULL) == BAT_OK ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    bat_surface_model_free(model);
    return unlink(path);
}

static double *numbers(size_t count)
{
    double *made = calloc(count, sizeof *made);
    assert_non_null(made);
    return made;
}

static bat_cloud draw(size_t interior, uint64_t seed, double **parameters)
{
    bat_cloud_bezier_options options = bat_cloud_bezier_defaults();
    bat_random random = bat_random_seed(seed);
    bat_cloud cloud;
    options.interior = interior;
    check_status(bat_cloud_bezier(&options, &random, &cloud, parameters, NULL), BAT_OK);
    return cloud;
}

static double *parameterize(const bat_cloud *cloud, const double *boundary, int threads)
{
    double *parameters = numbers(2 * cloud->count);
    check_status(bat_surface_model_parameterize(model, cloud, boundary, threads, parameters, NULL), BAT_OK);
    for (size_t i = 0; i < 2 * cloud->count; i++)
        assert_true(parameters[i] >= 0 && parameters[i] <= 1);
    assert_memory_equal(parameters, boundary, 2 * cloud->boundary_count * sizeof *boundary);
    return parameters;
}

static void place_size_and_threads_do_not_matter(void **state)
{
    (void)state;
    double *truth;
    bat_cloud cloud = draw(500, 1, &truth);
    double *one = parameterize(&cloud, truth, 1), *two = parameterize(&cloud, truth, 2);
    assert_memory_equal(one, two, 2 * cloud.count * sizeof *one);
    free(two);
    // Powers of two change no digit.
    for (size_t i = 0; i < 3 * cloud.count; i++)
        cloud.points[i] *= 1024;
    two = parameterize(&cloud, truth, 1);
    assert_memory_equal(one, two, 2 * cloud.count * sizeof *one);
    free(two);
    for (size_t i = 0; i < 3 * cloud.count; i++)
        cloud.points[i] += (double)(1 << (i % 3 + 10));
    two = parameterize(&cloud, truth, 0);
    for (size_t i = 0; i < 2 * cloud.count; i++)
        check_near(two[i], one[i], 1e-3);
    free(one);
    free(two);
    free(truth);
    bat_cloud_free(&cloud);
}

/// The order of interior points is that of their parameters, and says nothing else.
static void the_order_of_points_does_not_matter(void **state)
{
    (void)state;
    double *truth;
    bat_cloud cloud = draw(300, 2, &truth);
    double *before = parameterize(&cloud, truth, 1);
    size_t bound = cloud.boundary_count, interior = cloud.count - bound;
    double *points = numbers(3 * interior);
    memcpy(points, cloud.points + 3 * bound, 3 * interior * sizeof *points);
    for (size_t i = 0; i < 3 * interior; i++)
        cloud.points[3 * bound + i] = points[3 * (interior - 1 - i / 3) + i % 3];
    double *after = parameterize(&cloud, truth, 1);
    for (size_t i = 0; i < 2 * interior; i++)
        check_near(after[2 * bound + i], before[2 * (bound + interior - 1 - i / 2) + i % 2], 1e-3);
    free(points);
    free(before);
    free(after);
    free(truth);
    bat_cloud_free(&cloud);
}

static void flat_and_small_clouds_are_no_different(void **state)
{
    (void)state;
    for (size_t interior = 1; interior < 40; interior += 6)
    {
        double *truth;
        bat_cloud cloud = draw(interior, interior, &truth);
        for (size_t i = 0; i < 3 * cloud.count; i++)
            cloud.points[i] = i % 3 == 2 ? 7 : truth[i / 3 * 2 + i % 3];
        free(parameterize(&cloud, truth, 1));
        free(truth);
        bat_cloud_free(&cloud);
    }
    // No interior at all: the boundary's parameters are there, and that is all.
    double *truth;
    bat_cloud cloud = draw(9, 3, &truth);
    cloud.count = cloud.boundary_count;
    free(parameterize(&cloud, truth, 1));
    free(truth);
    bat_cloud_free(&cloud);
}

static void bad_clouds_are_refused(void **state)
{
    (void)state;
    double *truth;
    bat_cloud cloud = draw(30, 5, &truth);
    double *parameters = numbers(2 * cloud.count), kept = cloud.points[17];
    cloud.points[17] = NAN;
    check_status(bat_surface_model_parameterize(model, &cloud, truth, 1, parameters, NULL), BAT_INVALID_POINT);
    cloud.points[17] = kept;
    cloud.boundary_count = cloud.count + 1;
    check_status(bat_surface_model_parameterize(model, &cloud, truth, 1, parameters, NULL), BAT_INVALID_ARGUMENT);
    free(parameters);
    free(truth);
    bat_cloud_free(&cloud);
}

static void files_that_are_no_models_are_refused(void **state)
{
    (void)state;
    static const char *const recipes[] = {
        NULL, "", "surface ", "surface publishe", "surface published2, x", "mesh published", "surface uninformed of old"};
    bat_surface_model *none = NULL;
    bat_error error;
    for (size_t i = 0; i < sizeof recipes / sizeof *recipes; i++)
    {
        write_model(recipes[i]);
        check_status(bat_surface_model_read_published(path, &none, &error), BAT_BAD_FILE);
        assert_null(none);
    }
    check_status(bat_surface_model_read_published("/nowhere/at/all", &none, &error), BAT_FILE_ACCESS);
    bat_surface_model_free(NULL);
}

/// The model that comes with the library finds what a patch was sampled at.
static void the_builtin_model_parameterizes(void **state)
{
    (void)state;
    bat_surface_model *builtin;
    check_status(bat_surface_model_read_published(NULL, &builtin, NULL), BAT_OK);
    double mean = 0;
    for (uint64_t seed = 0; seed < 10; seed++)
    {
        double *truth;
        bat_cloud cloud = draw(1000, 50 + seed, &truth);
        double *parameters = numbers(2 * cloud.count);
        bezier_fit fit = {.patch.degree = 2, .residual = numbers(3 * cloud.count)};
        check_status(bat_surface_model_parameterize(builtin, &cloud, truth, 0, parameters, NULL), BAT_OK);
        check_status(bezier_fit_make(cloud.points, parameters, cloud.count, &fit, NULL), BAT_OK);
        mean += fit.error / 10;
        free(fit.residual);
        free(parameters);
        free(truth);
        bat_cloud_free(&cloud);
    }
    assert_true(mean < 1e-3);
    bat_surface_model_free(builtin);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_builtin_model_parameterizes),
        cmocka_unit_test(place_size_and_threads_do_not_matter),
        cmocka_unit_test(the_order_of_points_does_not_matter),
        cmocka_unit_test(flat_and_small_clouds_are_no_different),
        cmocka_unit_test(bad_clouds_are_refused),
        cmocka_unit_test(files_that_are_no_models_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

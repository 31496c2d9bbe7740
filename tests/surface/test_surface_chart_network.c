// Our network for clouds: all derivatives against central differences, inference against the tape, and what holds of any
// weights. Built in single and double precision.

#include "patch_clouds.h"

#include "batten/cloud_parameterize.h"
#include "research/learn/parameters.h"
#include "research/train/surface_network_tape.h"
#include "surface/network/chart_network.h"

#include <unistd.h>

static const bool DOUBLE = sizeof(real) == sizeof(double);
static const surface_network_tape *const TRAINING = &surface_tape_batten;

static double *numbers(size_t count)
{
    double *made = calloc(count > 0 ? count : 1, sizeof *made);
    assert_non_null(made);
    return made;
}

static surface_sample random_sample(size_t points, double noise, uint64_t seed)
{
    surface_sample_range range = {
        .min_points = points, .max_points = points, .min_degree = 2, .max_degree = 2, .noise = noise};
    bat_random random = bat_random_seed(seed);
    surface_sample sample;
    check_status(surface_sample_draw(&range, &random, &sample, NULL), BAT_OK);
    return sample;
}

/// Weights of no special kind: biases, and a last layer that speaks.
static learn_parameters random_weights(double deviation, uint64_t seed)
{
    learn_parameters parameters = {0};
    bat_random random = bat_random_seed(seed);
    check_status(TRAINING->kind->make(NULL, &parameters, NULL), BAT_OK);
    TRAINING->start(&parameters, seed);
    for (size_t i = 0; i < parameters.total; i++)
        parameters.values[i] += (real)(deviation * bat_random_normal(&random));
    return parameters;
}

// The tape

static double loss_of(learn_tape *tape, const learn_parameters *parameters, const surface_sample *sample, real *gradient)
{
    learn_tape_begin(tape, parameters, gradient);
    learn_array *interior = TRAINING->predict(tape, &sample->cloud, sample->parameters);
    learn_array *loss = TRAINING->loss(tape, sample, interior);
    if (gradient != NULL)
        learn_tape_backward(tape, loss, 1);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    return (double)*loss->value;
}

/// @param interior receives interior points x 2
static void predict(const learn_parameters *parameters, const surface_sample *sample, double *interior)
{
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, parameters, NULL);
    const learn_array *made = TRAINING->predict(&tape, &sample->cloud, sample->parameters);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    assert_int_equal(made->rows, sample->cloud.count - sample->cloud.boundary_count);
    for (size_t i = 0; i < 2 * made->rows; i++)
        interior[i] = (double)made->value[i];
    learn_tape_free(&tape);
}

/// A cloud none of whose points is held at the rim, where there is no derivative.
static surface_sample free_sample(const learn_parameters *parameters, size_t points)
{
    for (uint64_t seed = 1;; seed++)
    {
        surface_sample sample = random_sample(points, 0, seed);
        double *interior = numbers(2 * points);
        bool held = false;
        predict(parameters, &sample, interior);
        for (size_t i = 0; i < 2 * points; i++)
            held = held || interior[i] < 1e-3 || interior[i] > 1 - 1e-3;
        free(interior);
        if (!held)
            return sample;
        surface_sample_free(&sample);
        assert_true(seed < 1000);
    }
}

static double difference_at(learn_tape *tape, const learn_parameters *parameters, const surface_sample *sample, real *value)
{
    const double step = 1e-6;
    real kept = *value;
    double sides[2];
    for (int side = 0; side < 2; side++)
    {
        *value = (real)((double)kept + (side == 0 ? -step : step));
        sides[side] = loss_of(tape, parameters, sample, NULL);
    }
    *value = kept;
    return (sides[1] - sides[0]) / (2 * step);
}

static void derivatives_are_those_of_differences(void **state)
{
    (void)state;
    learn_parameters parameters = random_weights(0.002, 5);
    surface_sample sample = free_sample(&parameters, 40);
    learn_tape tape = learn_tape_make();
    real *gradient = calloc(parameters.total, sizeof *gradient);
    double greatest = 0;
    assert_non_null(gradient);
    (void)loss_of(&tape, &parameters, &sample, gradient);
    for (size_t i = 0; i < parameters.total; i++)
    {
        assert_true(isfinite(gradient[i]));
        greatest = fmax(greatest, fabs((double)gradient[i]));
    }
    assert_true(greatest > 1e-2);
    for (size_t p = 0; p < parameters.count && DOUBLE; p++)
    {
        size_t size = parameters.list[p].rows * parameters.list[p].columns;
        for (size_t i = p % 7; i < size; i += 1 + size / 11)
            check_near((double)gradient[parameters.list[p].offset + i],
                       difference_at(&tape, &parameters, &sample, learn_parameter_values(&parameters, p) + i),
                       1e-7 * greatest);
    }
    free(gradient);
    learn_tape_free(&tape);
    learn_parameters_free(&parameters);
    surface_sample_free(&sample);
}

/// What training begins with says next to nothing.
static void first_weights_leave_the_chart(void **state)
{
    (void)state;
    surface_sample sample = random_sample(100, 0, 3);
    learn_parameters parameters = random_weights(0, 1);
    double *interior = numbers(200), *memory = numbers(400), *moved = numbers(200), moves[CHART_MOVES] = {0};
    surface_chart chart;
    predict(&parameters, &sample, interior);
    check_status(surface_chart_make(&sample.cloud, sample.parameters, memory, &chart, NULL), BAT_OK);
    surface_chart_move(&chart, moves, moved);
    for (size_t i = 0; i < 200; i++)
        check_near(interior[i], moved[i], 0.15);
    free(interior);
    free(memory);
    free(moved);
    learn_parameters_free(&parameters);
    surface_sample_free(&sample);
}

// Inference

static void infer(const learn_parameters *parameters, const surface_sample *sample, int threads, double *interior)
{
    void *network;
    check_status(TRAINING->kind->pack(NULL, parameters, &network, NULL), BAT_OK);
    check_status(((const surface_rule *)TRAINING->kind->rule)
                     ->infer(network, &sample->cloud, sample->parameters, threads, interior, NULL),
                 BAT_OK);
    TRAINING->kind->free(network);
}

static void inference_says_the_same_on_any_number_of_threads(void **state)
{
    (void)state;
    static const size_t POINTS[] = {1, 4, 50, 97, 1000, 3000};
    for (size_t i = 0; i < sizeof POINTS / sizeof *POINTS; i++)
        for (uint64_t noisy = 0; noisy < 2; noisy++)
        {
            size_t count = 2 * POINTS[i];
            surface_sample sample = random_sample(POINTS[i], 0.02 * (double)noisy, 7 * i + noisy);
            learn_parameters parameters = random_weights(0.01, i);
            double *one = numbers(count), *many = numbers(count), *tape = numbers(count);
            infer(&parameters, &sample, 1, one);
            infer(&parameters, &sample, 3, many);
            predict(&parameters, &sample, tape);
            assert_memory_equal(one, many, count * sizeof *one);
            for (size_t j = 0; j < count; j++)
            {
                assert_true(one[j] >= 0 && one[j] <= 1);
                check_near(one[j], tape[j], DOUBLE ? 1e-12 : 1e-5);
            }
            free(one);
            free(many);
            free(tape);
            learn_parameters_free(&parameters);
            surface_sample_free(&sample);
        }
}

/// Points that all lie in one line have no plane to be seen in: the network is not asked, and all ends well.
static void clouds_in_a_line_are_parameterized(void **state)
{
    (void)state;
    surface_sample sample = random_sample(30, 0, 1);
    learn_parameters parameters = random_weights(0.01, 2);
    double *interior = numbers(60), *tape = numbers(60);
    for (size_t i = 0; i < 3 * sample.cloud.count; i++)
        sample.cloud.points[i] = (double)(i / 3) / (double)sample.cloud.count;
    infer(&parameters, &sample, 1, interior);
    predict(&parameters, &sample, tape);
    for (size_t i = 0; i < 60; i++)
        assert_true(interior[i] >= 0 && interior[i] <= 1 && tape[i] >= 0 && tape[i] <= 1);
    free(interior);
    free(tape);
    learn_parameters_free(&parameters);
    surface_sample_free(&sample);
}

// Through the library's own door

static bat_surface_model *model_of(const learn_parameters *parameters)
{
    char path[] = "/tmp/batten-chart-network-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && close(file) == 0);
    const safetensors_note note = {"recipe", "surface batten, of nothing"};
    bat_surface_model *model;
    check_status(learn_parameters_write(parameters, path, &note, 1, NULL), BAT_OK);
    check_status(bat_surface_model_read(path, &model, NULL), BAT_OK);
    assert_int_equal(unlink(path), 0);
    return model;
}

static bat_surface_model *random_model(uint64_t seed)
{
    learn_parameters parameters = random_weights(0.01, seed);
    bat_surface_model *model = model_of(&parameters);
    learn_parameters_free(&parameters);
    return model;
}

static double *parameterize(const bat_surface_model *model, const bat_cloud *cloud, const double *boundary)
{
    double *parameters = numbers(2 * cloud->count);
    bat_error error = {0};
    if (bat_surface_model_parameterize(model, cloud, boundary, 1, parameters, &error) != BAT_OK)
        fail_msg("%s", error.text);
    assert_memory_equal(parameters, boundary, 2 * cloud->boundary_count * sizeof *boundary);
    return parameters;
}

static void turn_cloud(bat_cloud *cloud)
{
    static const double ANGLES[] = {0.7, 2.1};
    for (size_t k = 0; k < 2; k++)
        for (size_t i = 0; i < cloud->count; i++)
        {
            double *a = cloud->points + 3 * i + k, *b = a + 1, x = *a, y = *b;
            *a = cos(ANGLES[k]) * x - sin(ANGLES[k]) * y;
            *b = sin(ANGLES[k]) * x + cos(ANGLES[k]) * y;
        }
}

static void enlarge_cloud(bat_cloud *cloud, double size, double shift)
{
    for (size_t i = 0; i < 3 * cloud->count; i++)
        cloud->points[i] = size * cloud->points[i] + shift * (double)(i % 3);
}

/// Place and size do not matter at all. A turn changes the unit box, and so what the coefficients cost where loops are
/// coarse or noisy: that is little, and nothing where they are clean and fine.
static void place_size_and_turn_do_not_matter(void **state)
{
    (void)state;
    static const size_t POINTS[] = {5, 60, 1000};
    static const double BY_TURN[] = {5e-3, 1e-3, 1e-5};
    bat_surface_model *model = random_model(4);
    for (size_t k = 0; k < 12; k++)
    {
        surface_sample sample = random_sample(POINTS[k % 3], 0, k);
        double *before = parameterize(model, &sample.cloud, sample.parameters);
        enlarge_cloud(&sample.cloud, k % 2 == 0 ? 1e-4 : 300, (double)k);
        double *enlarged = parameterize(model, &sample.cloud, sample.parameters);
        turn_cloud(&sample.cloud);
        double *turned = parameterize(model, &sample.cloud, sample.parameters);
        for (size_t i = 0; i < 2 * sample.cloud.count; i++)
        {
            check_near(enlarged[i], before[i], 1e-5);
            check_near(turned[i], before[i], BY_TURN[k % 3]);
        }
        free(before);
        free(enlarged);
        free(turned);
        surface_sample_free(&sample);
    }
    bat_surface_model_free(model);
}

/// The order of interior points is that of their parameters, and says nothing else.
static void the_order_of_points_does_not_matter(void **state)
{
    (void)state;
    bat_surface_model *model = random_model(6);
    surface_sample sample = random_sample(200, 0.01, 3);
    size_t bound = sample.cloud.boundary_count;
    double *before = parameterize(model, &sample.cloud, sample.parameters), *points = numbers(600);
    memcpy(points, sample.cloud.points + 3 * bound, 600 * sizeof *points);
    for (size_t i = 0; i < 600; i++)
        sample.cloud.points[3 * bound + i] = points[3 * (199 - i / 3) + i % 3];
    double *after = parameterize(model, &sample.cloud, sample.parameters);
    for (size_t i = 0; i < 400; i++)
        check_near(after[2 * bound + i], before[2 * (bound + 199 - i / 2) + i % 2], DOUBLE ? 1e-9 : 1e-5);
    free(points);
    free(before);
    free(after);
    surface_sample_free(&sample);
    bat_surface_model_free(model);
}

static void plane(double u, double v, double place[3])
{
    place[0] = 3 + u;
    place[1] = v;
    place[2] = -1;
}

static void flat_and_small_clouds_are_no_different(void **state)
{
    (void)state;
    static const size_t SIDES[] = {2, 3, 20}, INTERIORS[] = {0, 1, 2, 300};
    bat_surface_model *model = random_model(5);
    for (size_t k = 0; k < 12; k++)
    {
        patch made = patch_scatter(plane, SIDES[k / 4], INTERIORS[k % 4], 0, k);
        double *found = parameterize(model, &made.cloud, made.parameters);
        for (size_t i = 0; i < 2 * made.cloud.count; i++)
            assert_true(found[i] >= 0 && found[i] <= 1);
        free(found);
        patch_free(&made);
    }
    bat_surface_model_free(model);
}

static void bad_clouds_are_refused(void **state)
{
    (void)state;
    bat_surface_model *model = random_model(5);
    patch made = patch_scatter(plane, 5, 30, 0, 1);
    double *found = numbers(2 * made.cloud.count);
    bat_error error;
    made.parameters[9] = INFINITY;
    check_status(bat_surface_model_parameterize(model, &made.cloud, made.parameters, 1, found, &error),
                 BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 4);
    made.parameters[9] = 1e200;
    check_status(bat_surface_model_parameterize(model, &made.cloud, made.parameters, 1, found, NULL), BAT_NO_CONVERGENCE);
    made.parameters[9] = 0;
    made.cloud.points[0] = -1.5e308;
    made.cloud.points[3] = 1.5e308;
    check_status(bat_surface_model_parameterize(model, &made.cloud, made.parameters, 1, found, NULL), BAT_INVALID_ARGUMENT);
    made.cloud.points[0] = 0;
    made.cloud.has_corners = false;
    made.cloud.boundary_count = 0;
    check_status(bat_surface_model_parameterize(model, &made.cloud, made.parameters, 1, found, NULL), BAT_INVALID_ARGUMENT);
    free(found);
    patch_free(&made);
    bat_surface_model_free(model);
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

static void deep_shapes_get_parameters_of_little_stretch(void **state)
{
    (void)state;
    bat_surface_model *model = random_model(8);
    patch made = patch_scatter(deep_sphere, 8, 1000, 0, 3);
    double *found = parameterize(model, &made.cloud, made.parameters), *classical = numbers(2 * made.cloud.count);
    bat_cloud_parameterize_options options = bat_cloud_parameterize_defaults();
    options.method = BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING;
    check_status(bat_cloud_parameterize(&made.cloud, made.parameters, &options, classical, NULL), BAT_OK);
    for (size_t i = 0; i < 2 * made.cloud.count; i++)
        check_near(found[i], classical[i], 1e-6);
    bat_cloud_parameters_report report;
    check_status(bat_cloud_parameters_check(&made.cloud, found, &report, NULL), BAT_OK);
    assert_int_equal(report.folded, 0);
    assert_int_equal(report.outside, 0);
    free(found);
    free(classical);
    patch_free(&made);
    bat_surface_model_free(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(derivatives_are_those_of_differences),
        cmocka_unit_test(first_weights_leave_the_chart),
        cmocka_unit_test(inference_says_the_same_on_any_number_of_threads),
        cmocka_unit_test(clouds_in_a_line_are_parameterized),
        cmocka_unit_test(place_size_and_turn_do_not_matter),
        cmocka_unit_test(the_order_of_points_does_not_matter),
        cmocka_unit_test(flat_and_small_clouds_are_no_different),
        cmocka_unit_test(bad_clouds_are_refused),
        cmocka_unit_test(deep_shapes_get_parameters_of_little_stretch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// The published network for clouds on a tape: an independent program's forward and backward pass, all derivatives against
// central differences, and what holds of any weights. Built in single and double precision.

#include "check.h"

#include "learn/safetensors.h"
#include "research/train/surface_network_tape.h"
#include "research/train/surface_sample.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

static void *test_memory(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size);
    assert_non_null(memory);
    return memory;
}

// An independent program's results

static size_t rows_in(const safetensors *content, const char *name)
{
    const safetensors_array *array = safetensors_find(content, name);
    assert_non_null(array);
    return array->shape[0];
}

/// The numbers of an array, behind `skip` others.
static void read_numbers(const safetensors *content, const char *name, double *numbers)
{
    const safetensors_array *array = safetensors_find(content, name);
    assert_non_null(array);
    check_status(safetensors_doubles(content, name, array->count, numbers, NULL), BAT_OK);
}

static surface_sample sample_in(const safetensors *content)
{
    size_t boundary = rows_in(content, "boundary.point"), interior = rows_in(content, "interior.point");
    surface_sample sample = {.degree = 2,
                             .cloud = {.count = boundary + interior, .boundary_count = boundary},
                             .parameters = test_memory(boundary + interior, 2 * sizeof(double))};
    sample.cloud.points = test_memory(sample.cloud.count, 3 * sizeof(double));
    read_numbers(content, "boundary.point", sample.cloud.points);
    read_numbers(content, "interior.point", sample.cloud.points + 3 * boundary);
    read_numbers(content, "boundary.parameter", sample.parameters);
    read_numbers(content, "interior.true_parameter", sample.parameters + 2 * boundary);
    return sample;
}

static void check_edges(const safetensors *content, const surface_edges *edges)
{
    int64_t expected[2 + SURFACE_HIDDEN];
    check_status(safetensors_integers(content, "edges", 2 + SURFACE_HIDDEN, expected, NULL), BAT_OK);
    // In single precision points on the rim may fall to the other side.
    for (size_t i = 0; i < 2 + SURFACE_HIDDEN; i++)
        check_near((double)edges->count[i], (double)expected[i], DOUBLE ? 0 : 2e-3 * (double)expected[i]);
}

static void check_array(const safetensors *content, const char *name, const real *ours)
{
    const safetensors_array *array = safetensors_find(content, name);
    assert_non_null(array);
    double *theirs = test_memory(array->count, sizeof *theirs), most = 0;
    read_numbers(content, name, theirs);
    for (size_t i = 0; i < array->count; i++)
        most = fmax(most, fabs(theirs[i]));
    // What normalization takes off has no derivative but theirs and our rounding.
    for (size_t i = 0; i < array->count; i++)
        check_near((double)ours[i], theirs[i], DOUBLE ? 1e-9 * most + 1e-15 : 2e-2 * most + 1e-6);
    free(theirs);
}

static void an_independent_program_agrees(void **state)
{
    (void)state;
    const char *path = SHARED_DATA "/oracle/bidgcn/network.safetensors";
    safetensors content;
    if (safetensors_read(path, &content, NULL) != BAT_OK)
    {
        print_message("%s is not there\n", path);
        skip();
    }
    surface_sample sample = sample_in(&content);
    learn_parameters parameters = {0};
    check_status(surface_tape_published.kind->make(NULL, &parameters, NULL), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &content, "weight.", parameters.values, NULL), BAT_OK);
    real *gradient = test_memory(parameters.total, sizeof *gradient);
    double loss;
    learn_tape tape = learn_tape_make();
    surface_edges edges;
    learn_tape_begin(&tape, &parameters, gradient);
    learn_array *interior = surface_network_predict(&tape, &sample.cloud, sample.parameters, &edges);
    learn_array *made = surface_sample_residual(&tape, &sample, interior);
    learn_tape_backward(&tape, made, 1);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    check_edges(&content, &edges);
    check_array(&content, "interior.parameter", interior->value);
    read_numbers(&content, "loss", &loss);
    check_relative((double)*made->value, loss, DOUBLE ? 1e-12 : 1e-4);
    for (size_t p = 0; p < parameters.count; p++)
    {
        char name[2 * LEARN_NAME_SIZE];
        (void)snprintf(name, sizeof name, "grad.%s", parameters.list[p].name);
        check_array(&content, name, gradient + parameters.list[p].offset);
    }
    learn_tape_free(&tape);
    free(gradient);
    learn_parameters_free(&parameters);
    surface_sample_free(&sample);
    safetensors_free(&content);
}

// What holds of any weights

static surface_sample random_sample(size_t points, uint64_t seed)
{
    surface_sample_range range = {
        .min_points = points, .max_points = points, .min_degree = 2, .max_degree = 2, .noise = 0.01};
    bat_random random = bat_random_seed(seed);
    surface_sample sample;
    check_status(surface_sample_draw(&range, &random, &sample, NULL), BAT_OK);
    return sample;
}

/// Weights of no special kind: gains and shifts too.
static learn_parameters random_weights(const surface_network_tape *training, uint64_t seed)
{
    learn_parameters parameters = {0};
    bat_random random = bat_random_seed(seed);
    check_status(training->kind->make(NULL, &parameters, NULL), BAT_OK);
    training->start(&parameters, seed);
    for (size_t i = 0; i < parameters.total; i++)
        parameters.values[i] += (real)(0.05 * bat_random_normal(&random));
    return parameters;
}

static void predict(const surface_network_tape *training, const learn_parameters *parameters, const surface_sample *sample,
                    double *interior)
{
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, parameters, NULL);
    const learn_array *made = training->predict(&tape, &sample->cloud, sample->parameters);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    assert_int_equal(made->rows, sample->cloud.count - sample->cloud.boundary_count);
    for (size_t i = 0; i < 2 * made->rows; i++)
        interior[i] = (double)made->value[i];
    learn_tape_free(&tape);
}

static void infer(const surface_network_tape *training, const learn_parameters *parameters, const surface_sample *sample,
                  int threads, double *interior)
{
    void *network;
    check_status(training->kind->pack(NULL, parameters, &network, NULL), BAT_OK);
    check_status(((const surface_rule *)training->kind->rule)
                     ->infer(network, &sample->cloud, sample->parameters, threads, interior, NULL),
                 BAT_OK);
    training->kind->free(network);
}

static void inference_says_the_same_on_any_number_of_threads(void **state)
{
    (void)state;
    static const surface_network_tape *const trainings[] = {&surface_tape_published, &surface_tape_uninformed};
    static const size_t points[] = {1, 5, 50, 97, 1000, 1500};
    for (size_t k = 0; k < 2; k++)
        for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        {
            surface_sample sample = random_sample(points[i], 7 * i + k);
            learn_parameters parameters = random_weights(trainings[k], i);
            double *one = test_memory(points[i], 2 * sizeof *one), *many = test_memory(points[i], 2 * sizeof *many);
            double *tape = test_memory(points[i], 2 * sizeof *tape);
            infer(trainings[k], &parameters, &sample, 1, one);
            infer(trainings[k], &parameters, &sample, 3, many);
            predict(trainings[k], &parameters, &sample, tape);
            assert_memory_equal(one, many, 2 * points[i] * sizeof *one);
            // In single precision a neighbour on the rim may be one here and none there.
            for (size_t j = 0; j < 2 * points[i]; j++)
                check_near(one[j], tape[j], DOUBLE ? 1e-11 : 2e-3);
            free(one);
            free(many);
            free(tape);
            learn_parameters_free(&parameters);
            surface_sample_free(&sample);
        }
}

static double loss_of(learn_tape *tape, const surface_network_tape *training, const learn_parameters *parameters,
                      const surface_sample *sample, real *gradient)
{
    learn_tape_begin(tape, parameters, gradient);
    learn_array *interior = training->predict(tape, &sample->cloud, sample->parameters);
    learn_array *loss = surface_sample_residual(tape, sample, interior);
    if (gradient != NULL)
        learn_tape_backward(tape, loss, 1);
    check_status(learn_tape_status(tape, NULL), BAT_OK);
    return (double)*loss->value;
}

static void derivatives_are_those_of_differences(void **state)
{
    (void)state;
    static const surface_network_tape *const trainings[] = {&surface_tape_published, &surface_tape_uninformed};
    const double step = 1e-7;
    for (size_t k = 0; k < 2; k++)
    {
        surface_sample sample = random_sample(60, 11 + k);
        learn_parameters parameters = random_weights(trainings[k], 5);
        learn_tape tape = learn_tape_make();
        real *gradient = test_memory(parameters.total, sizeof *gradient);
        (void)loss_of(&tape, trainings[k], &parameters, &sample, gradient);
        for (size_t p = 0; p < parameters.count && DOUBLE; p++)
        {
            real *values = learn_parameter_values(&parameters, p);
            size_t size = parameters.list[p].rows * parameters.list[p].columns;
            for (size_t i = p % 7; i < size; i += 1 + size / 5)
            {
                real kept = values[i];
                double sides[2];
                for (int side = 0; side < 2; side++)
                {
                    values[i] = (real)((double)kept + (side == 0 ? -step : step));
                    sides[side] = loss_of(&tape, trainings[k], &parameters, &sample, NULL);
                }
                values[i] = kept;
                check_near((double)gradient[parameters.list[p].offset + i], (sides[1] - sides[0]) / (2 * step), 2e-8);
            }
        }
        for (size_t i = 0; i < parameters.total; i++)
            assert_true(isfinite(gradient[i]));
        free(gradient);
        learn_tape_free(&tape);
        learn_parameters_free(&parameters);
        surface_sample_free(&sample);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_independent_program_agrees),
        cmocka_unit_test(derivatives_are_those_of_differences),
        cmocka_unit_test(inference_says_the_same_on_any_number_of_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

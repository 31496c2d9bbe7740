#include "train_helpers.h"

#include "batten/curve_measure.h"
#include "learn/blas.h"
#include "research/networks/tension_network.h"
#include "research/train/curve_train.h"
#include "research/train/tension_sample.h"

#include <jansson.h>

// The published recipe: the loss of a sample and its gradient, validation, and whole trainings on a few curves. Built in
// single and double precision.

#define ORACLE SHARED_DATA "/oracle/tension/"

static const bool DOUBLE = sizeof(real) == sizeof(double);

static const char *const SPACE_NAMES[BAT_TENSION_SPACE_COUNT] = {"euclidean", "spherical", "hyperbolic"};

/// A predictor with a tape and a gradient.
typedef struct fixture
{
    bat_tension_data data;
    learn_parameters parameters;
    real *gradient;
    learn_tape tape;
    bat_curve_train_options options;
} fixture;

static fixture fixture_make(void)
{
    fixture f = {.options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED)};
    check_status(bat_tension_data_make(&f.data, NULL), BAT_OK);
    check_status(tension_predictor_make(BAT_TENSION_EMBEDDING_LEARNED, &f.parameters, NULL), BAT_OK);
    tension_network_start(&f.parameters, 7);
    f.gradient = calloc(f.parameters.total, sizeof *f.gradient);
    assert_non_null(f.gradient);
    return f;
}

static void fixture_free(fixture *f)
{
    bat_tension_data_free(&f->data);
    learn_parameters_free(&f->parameters);
    learn_tape_free(&f->tape);
    free(f->gradient);
}

// The loss of a sample

typedef struct published_step
{
    safetensors weights, arrays;
    json_t *values;
} published_step;

static bool step_load(published_step *step)
{
    step->values = json_load_file(ORACLE "training-step.json", 0, NULL);
    if (step->values == NULL)
    {
        print_message("no %s: skipped\n", ORACLE "training-step.json");
        return false;
    }
    check_status(safetensors_read(ORACLE "network.safetensors", &step->weights, NULL), BAT_OK);
    check_status(safetensors_read(ORACLE "training-step.safetensors", &step->arrays, NULL), BAT_OK);
    return true;
}

static void step_free(published_step *step)
{
    safetensors_free(&step->weights);
    safetensors_free(&step->arrays);
    json_decref(step->values);
}

/// The gradient by the weights of a name, relative to its largest entry.
static void check_gradient(const fixture *f, const published_step *step, size_t space, const char *name, double tolerance)
{
    char full[128];
    (void)snprintf(full, sizeof full, "%s.grad.%s", SPACE_NAMES[space], name);
    for (size_t i = 0; i < f->parameters.count; i++)
    {
        const learn_parameter *p = &f->parameters.list[i];
        size_t count = p->rows * p->columns;
        if (strcmp(p->name, name) != 0)
            continue;
        double *expected = malloc(count * sizeof *expected), largest = 0;
        check_status(safetensors_doubles(&step->arrays, full, count, expected, NULL), BAT_OK);
        for (size_t k = 0; k < count; k++)
            largest = fmax(largest, fabs(expected[k]));
        for (size_t k = 0; k < count; k++)
            check_near((double)f->gradient[p->offset + k], expected[k], tolerance * largest);
        free(expected);
        return;
    }
    fail_msg("there are no weights %s", name);
}

static void check_published_step(fixture *f, const published_step *step, size_t space)
{
    double control[3 * BAT_TENSION_CONTROL_POINTS], truth[3 * BAT_TENSION_TRUTH_POINTS];
    const bat_tension_set *set = &f->data.train[space];
    tension_sample sample = tension_sample_of(set, (bat_tension_space)space, 0);
    char name[64];
    (void)snprintf(name, sizeof name, "%s.control", SPACE_NAMES[space]);
    check_status(safetensors_doubles(&step->arrays, name, BAT_TENSION_CONTROL_POINTS * set->dim, control, NULL), BAT_OK);
    (void)snprintf(name, sizeof name, "%s.truth", SPACE_NAMES[space]);
    check_status(safetensors_doubles(&step->arrays, name, BAT_TENSION_TRUTH_POINTS * set->dim, truth, NULL), BAT_OK);
    sample.control.points = control;
    sample.truth = truth;
    memset(f->gradient, 0, f->parameters.total * sizeof *f->gradient);
    learn_tape_begin(&f->tape, &f->parameters, f->gradient);
    bat_random random = bat_random_seed(1);
    tension_loss loss = tension_sample_loss(&f->tape, &sample, &f->options, &random);
    learn_tape_backward(&f->tape, loss.total, 1);
    check_status(learn_tape_status(&f->tape, NULL), BAT_OK);
    // On the sphere the stored points are of unit length to single precision only, and formulas differ in the seventh digit.
    double values = DOUBLE && space != BAT_TENSION_SPACE_SPHERE ? 1e-12 : 5e-6;
    double gradients = DOUBLE && space != BAT_TENSION_SPACE_SPHERE ? 1e-10 : 2e-4;
    const json_t *expected = json_array_get(step->values, space);
    check_relative((double)*loss.chamfer->value, json_real_value(json_object_get(expected, "chamfer")), values);
    check_relative((double)*loss.smoothness->value, json_real_value(json_object_get(expected, "smoothness")), values);
    check_relative((double)*loss.bending->value, json_real_value(json_object_get(expected, "bending")), values);
    check_relative((double)*loss.total->value, json_real_value(json_object_get(expected, "loss")), values);
    // Without dropout the features of a rotated polygon give the same angles.
    check_near((double)*loss.consistency->value, 0, DOUBLE ? 1e-20 : 1e-10);
    check_gradient(f, step, space, "geom_embed.weight", gradients);
    check_gradient(f, step, space, "input_proj.0.weight", gradients);
    check_gradient(f, step, space, "head.2.weight", gradients);
}

static void the_loss_of_a_sample_is_that_of_a_published_step(void **state)
{
    (void)state;
    published_step step;
    if (!step_load(&step))
        skip();
    fixture f = fixture_make();
    check_status(learn_parameters_extract(&f.parameters, &step.weights, "weight.", f.parameters.values, NULL), BAT_OK);
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        check_published_step(&f, &step, space);
    fixture_free(&f);
    step_free(&step);
}

/// A loss that depends on the weights.
typedef learn_array *loss_function(fixture *f, const tension_sample *sample);

/// Everything but the term whose polygon is held fixed.
static learn_array *refined_loss(fixture *f, const tension_sample *sample)
{
    bat_curve_train_options options = f->options;
    options.consistency = 0;
    return tension_sample_loss(&f->tape, sample, &options, NULL).total;
}

static learn_array *consistency_loss(fixture *f, const tension_sample *sample)
{
    bat_random random = bat_random_seed(3);
    return tension_consistency(&f->tape, &sample->control, f->options.embedding, &random);
}

static double loss_at(fixture *f, loss_function *function, const tension_sample *sample, real *gradient)
{
    learn_tape_begin(&f->tape, &f->parameters, gradient);
    learn_tape_drop(&f->tape, 5);
    learn_array *loss = function(f, sample);
    learn_tape_backward(&f->tape, loss, 1);
    check_status(learn_tape_status(&f->tape, NULL), BAT_OK);
    return (double)*loss->value;
}

/// Compare the gradient by some weights with differences of fourth order.
static void check_differences(fixture *f, loss_function *function, const tension_sample *sample)
{
    const double h = 3e-6; // small, as neighbours in the Chamfer distance change
    memset(f->gradient, 0, f->parameters.total * sizeof *f->gradient);
    (void)loss_at(f, function, sample, f->gradient);
    double largest = 0;
    for (size_t k = 0; k < f->parameters.total; k++)
        largest = fmax(largest, fabs((double)f->gradient[k]));
    assert_true(largest > 0);
    for (size_t i = 0; i < f->parameters.count; i += 3)
    {
        const learn_parameter *p = &f->parameters.list[i];
        size_t place = p->offset + p->rows * p->columns / 2;
        real value = f->parameters.values[place];
        double values[5];
        for (int step = -2; step <= 2; step++)
        {
            f->parameters.values[place] = (real)((double)value + step * h);
            values[step + 2] = step == 0 ? 0 : loss_at(f, function, sample, NULL);
        }
        f->parameters.values[place] = value;
        double difference = (8 * (values[3] - values[1]) - (values[4] - values[0])) / (12 * h);
        check_near((double)f->gradient[place], difference, 1e-7 * largest);
    }
}

static void gradients_are_limits_of_differences(void **state)
{
    (void)state;
    if (!DOUBLE)
        skip();
    fixture f = fixture_make();
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        tension_sample sample = tension_sample_of(&f.data.train[space], (bat_tension_space)space, 3);
        check_differences(&f, refined_loss, &sample);
        check_differences(&f, consistency_loss, &sample);
    }
    fixture_free(&f);
}

/// The consistency term moves no vertex: the loss with it less its share is the loss without.
static void terms_add_up_to_the_loss(void **state)
{
    (void)state;
    fixture f = fixture_make();
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        tension_sample sample = tension_sample_of(&f.data.train[space], (bat_tension_space)space, 1);
        bat_random random = bat_random_seed(2);
        learn_tape_begin(&f.tape, &f.parameters, NULL);
        learn_tape_drop(&f.tape, 9);
        tension_loss loss = tension_sample_loss(&f.tape, &sample, &f.options, &random);
        check_status(learn_tape_status(&f.tape, NULL), BAT_OK);
        double smoothness = space == BAT_TENSION_SPACE_SPHERE ? 0.15 : 0.05, consistency = (double)*loss.consistency->value;
        double sum = (double)*loss.chamfer->value + smoothness * (double)*loss.smoothness->value +
                     1e-4 * (double)*loss.bending->value + 0.1 * consistency;
        check_relative((double)*loss.total->value, sum, DOUBLE ? 1e-14 : 1e-6);
        // Dropout makes the network disagree with itself.
        assert_true(consistency > 1e-8);
    }
    fixture_free(&f);
}

// Validation

/// Weights of zero insert geodesic midpoints, which leaves all angles at the control points as they are.
static void midpoints_keep_the_largest_angle(void **state)
{
    (void)state;
    fixture f = fixture_make();
    memset(f.parameters.values, 0, f.parameters.total * sizeof *f.parameters.values);
    bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT];
    check_status(
        curve_published_validate(&f.parameters, BAT_TENSION_EMBEDDING_LEARNED, f.data.validation, NULL, 2, scores, NULL),
        BAT_OK);
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        const bat_tension_set *set = &f.data.validation[space];
        double g1 = 0;
        for (size_t i = 0; i < set->count; i++)
        {
            bat_curve_fairness_values fairness;
            bat_curve control = bat_tension_control(set, i, &spaces[space]);
            check_status(bat_curve_fairness(&control, NULL, &fairness, NULL), BAT_OK);
            g1 += fairness.g1 / (double)set->count;
        }
        check_near(scores[space].g1, g1, 1e-6);
        assert_true(scores[space].mean_nn > 0 && scores[space].bending > 0);
    }
    check_relative(curve_published_metric(scores), (scores[0].mean_nn + scores[1].mean_nn + scores[2].mean_nn) / 3, 1e-15);
    fixture_free(&f);
}

/// The mean distance is that of the library's own measure.
static void distances_are_those_of_the_library(void **state)
{
    (void)state;
    fixture f = fixture_make();
    bat_tension_set sets[BAT_TENSION_SPACE_COUNT];
    memcpy(sets, f.data.validation, sizeof sets);
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        sets[space].count = space == BAT_TENSION_SPACE_SPHERE ? 1 : 0;
    bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT];
    check_status(curve_published_validate(&f.parameters, BAT_TENSION_EMBEDDING_LEARNED, sets, NULL, 0, scores, NULL),
                 BAT_OK);
    assert_true(isnan(scores[BAT_TENSION_SPACE_PLANE].mean_nn));
    check_near(curve_published_metric(scores), scores[BAT_TENSION_SPACE_SPHERE].mean_nn, 0);

    tension_sample sample = tension_sample_of(sets + BAT_TENSION_SPACE_SPHERE, BAT_TENSION_SPACE_SPHERE, 0);
    learn_tape_begin(&f.tape, &f.parameters, NULL);
    tape_polygon *polygon = tape_polygon_given(&f.tape, &sample.control);
    blas_single_begin();
    for (int level = 0; level < 5; level++)
        polygon = tension_step(&f.tape, polygon, BAT_TENSION_EMBEDDING_LEARNED);
    blas_single_end();
    assert_int_equal(polygon->shape.count, 384);
    bat_space sphere = bat_sphere(2);
    bat_curve fine = {.space = &sphere, .points = (double *)polygon->shape.points, .count = 384, .closed = true};
    bat_curve truth = bat_tension_truth(sets + BAT_TENSION_SPACE_SPHERE, 0, &sphere);
    bat_curve_distance distance;
    bat_curve_fairness_values fairness;
    check_status(bat_curve_compare(&fine, &truth, NULL, &distance, NULL), BAT_OK);
    check_status(bat_curve_fairness(&fine, NULL, &fairness, NULL), BAT_OK);
    check_relative(scores[BAT_TENSION_SPACE_SPHERE].mean_nn, distance.mean_nn, 1e-12);
    check_relative(scores[BAT_TENSION_SPACE_SPHERE].bending, fairness.bending, 1e-9);
    check_relative(scores[BAT_TENSION_SPACE_SPHERE].g1, fairness.g1, 1e-9);
    fixture_free(&f);
}

// Whole trainings

enum
{
    CURVES = 9, ///< of each space, so that the last of four batches is not full
    STEPS = 4
};

/// A few of the published curves.
static bat_tension_data few(const bat_tension_data *data)
{
    bat_tension_data part = *data;
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        part.train[space].count = CURVES;
        part.validation[space].count = 2;
    }
    return part;
}

/// Column 4 of the log, the loss, of an epoch.
static double logged_loss(const char *folder, size_t epoch)
{
    size_t size;
    char *text = read_file(folder, "log.csv", &size), *line = text;
    for (size_t i = 0; i <= epoch; i++)
    {
        line = strchr(line, '\n');
        assert_non_null(line);
        line++;
    }
    double loss = NAN;
    assert_int_equal(sscanf(line, "%*g,%*g,%*g,%lg", &loss), 1);
    free(text);
    return loss;
}

/// Train on a few curves.
static bat_status train_on(const bat_tension_data *data, const bat_curve_train_options *options,
                           bat_curve_train_report *report, bat_error *error)
{
    return curve_train_sized(options, &(curve_train_size){.data = data}, report, error);
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    const train_folders *folders = *state;
    const char *a = folders->a, *b = folders->b;
    bat_tension_data all;
    check_status(bat_tension_data_make(&all, NULL), BAT_OK);
    bat_tension_data data = few(&all);
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    bat_curve_train_report whole, resumed;
    options.run.epochs = 3;
    options.run.threads = 1;
    options.run.folder = a;
    check_status(train_on(&data, &options, &whole, NULL), BAT_OK);
    assert_int_equal(whole.run.epochs, 3);
    assert_int_equal(whole.run.best_epoch, 3);
    assert_false(whole.run.stopped);
    check_near(whole.run.best, curve_published_metric(whole.scores[0]), 0);
    assert_int_equal(whole.fairness_count, 1);

    // In the middle of the second epoch.
    stopping stop = {.steps = STEPS + 2};
    options.run.progress = (bat_progress){stop_at, &stop};
    options.run.threads = 2;
    options.run.folder = b;
    check_status(train_on(&data, &options, NULL, NULL), BAT_CANCELLED);
    stop = (stopping){.steps = SIZE_MAX};
    options.run.resume = true;
    check_status(train_on(&data, &options, &resumed, NULL), BAT_OK);
    assert_int_equal(resumed.run.best_epoch, whole.run.best_epoch);
    check_near(resumed.run.best, whole.run.best, 0);
    check_near(resumed.run.loss, whole.run.loss, 0);
    assert_memory_equal(whole.scores[0], resumed.scores[0], sizeof whole.scores[0]);
    assert_true(same_file(a, b, "model.safetensors"));
    assert_true(same_file(a, b, "checkpoint.safetensors"));
    check_near(logged_loss(a, 1), logged_loss(b, 1), 0);
    check_near(logged_loss(a, 2), logged_loss(b, 2), 0);

    bat_error error;
    options.run.seed = 2;
    check_status(train_on(&data, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    options.run.seed = 1;
    options.bending = 0;
    check_status(train_on(&data, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    bat_tension_data_free(&all);
}

/// The mean loss of an epoch falls, with each kind of embedding, whose numbers of weights are those of table 3.
static void every_embedding_learns(void **state)
{
    static const size_t weights[] = {140505, 139841, 139457};
    const char *folder = ((const train_folders *)*state)->a;
    bat_tension_data all;
    check_status(bat_tension_data_make(&all, NULL), BAT_OK);
    bat_tension_data data = few(&all);
    for (int kind = 0; kind < 3; kind++)
    {
        bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
        options.embedding = (bat_tension_embedding)kind;
        options.run.epochs = 2;
        options.run.folder = folder;
        bat_curve_train_report report;
        check_status(train_on(&data, &options, &report, NULL), BAT_OK);
        assert_true(logged_loss(folder, 1) < logged_loss(folder, 0));
        safetensors content;
        char path[200];
        check_status(safetensors_read(path_in(folder, "model.safetensors", path), &content, NULL), BAT_OK);
        size_t total = 0;
        for (size_t i = 0; i < content.array_count; i++)
            total += content.arrays[i].count;
        assert_int_equal(total, weights[kind]);
        assert_string_equal(safetensors_find_note(&content, "seed"), "1");
        safetensors_free(&content);
    }
    bat_tension_data_free(&all);
}

static bat_status train_with_run(const bat_train_options *run, bat_error *error)
{
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    options.run = *run;
    return bat_curve_train(&options, NULL, error);
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    check_common_options(train_with_run);
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    assert_int_equal(options.run.seed, 1);
    assert_int_equal(options.run.epochs, 300);
    options.recipe = (bat_recipe)-1;
    check_refused(bat_curve_train(&options, NULL, refusal), "recipe", "0 to 1");
    options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    options.embedding = (bat_tension_embedding)3;
    check_refused(bat_curve_train(&options, NULL, refusal), "embedding is 3", "0 to 2");
    static const char *const spaces[] = {"smoothness of the plane", "smoothness of the sphere", "smoothness of the disk"};
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
        options.smoothness[space] = -1;
        check_refused(bat_curve_train(&options, NULL, refusal), spaces[space], "finite and at least 0");
        options.smoothness[space] = NAN;
        check_refused(bat_curve_train(&options, NULL, refusal), spaces[space], "finite and at least 0");
    }
    options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    options.bending = INFINITY;
    check_refused(bat_curve_train(&options, NULL, refusal), "bending", "finite and at least 0");
    options = bat_curve_train_defaults(BAT_RECIPE_PUBLISHED);
    options.consistency = -1e-9;
    check_refused(bat_curve_train(&options, NULL, refusal), "consistency", "finite and at least 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_loss_of_a_sample_is_that_of_a_published_step),
        cmocka_unit_test(gradients_are_limits_of_differences),
        cmocka_unit_test(terms_add_up_to_the_loss),
        cmocka_unit_test(midpoints_keep_the_largest_angle),
        cmocka_unit_test(distances_are_those_of_the_library),
        cmocka_unit_test_setup_teardown(neither_threads_nor_stops_change_a_byte, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(every_embedding_learns, make_folders, remove_folders),
        cmocka_unit_test(options_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

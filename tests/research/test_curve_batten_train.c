// Trainings of the shipped rule with short epochs: neither threads nor interruptions change a byte, and the loss falls.
// Built in single and double precision.

#include "train_helpers.h"

#include "batten/curve_measure.h"
#include "curve/network/learned_network.h"
#include "learn/safetensors.h"
#include "research/train/curve_network_tape.h"
#include "research/train/curve_train.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

static const curve_train_size SHORT = {.steps = 2, .validation_curves = 1};

static void train(const char *folder, uint64_t seed, int threads, bat_curve_train_report *report)
{
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_BATTEN);
    bat_error error;
    options.run.folder = folder;
    options.run.seed = seed;
    options.run.threads = threads;
    options.run.epochs = 2;
    if (curve_train_sized(&options, &SHORT, report, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    const train_folders *folders = *state;
    const char *a = folders->a, *b = folders->b, *c = folders->c;
    bat_curve_train_report whole, resumed;
    train(a, 1, 1, &whole);
    assert_int_equal(whole.run.epochs, 2);
    assert_true(isfinite(whole.run.loss));

    // In the middle of the second epoch.
    stopping stop = {.steps = 3};
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_BATTEN);
    options.run.epochs = 2;
    options.run.threads = 2;
    options.run.folder = b;
    options.run.resume = true; // from nothing at first
    options.run.progress = (bat_progress){stop_at, &stop};
    check_status(curve_train_sized(&options, &SHORT, NULL, NULL), BAT_CANCELLED);
    assert_int_equal(stop.asked, 4);
    stop = (stopping){.steps = SIZE_MAX};
    check_status(curve_train_sized(&options, &SHORT, &resumed, NULL), BAT_OK);
    assert_int_equal(stop.asked, 1);
    assert_true(same_file(a, b, "model.safetensors"));
    assert_true(same_file(a, b, "checkpoint.safetensors"));
    assert_int_equal(resumed.run.epochs, 2);
    assert_memory_equal(resumed.scores, whole.scores, sizeof whole.scores);

    // What is done stays done.
    stop = (stopping){0};
    check_status(curve_train_sized(&options, &SHORT, &resumed, NULL), BAT_OK);
    assert_int_equal(stop.asked, 0);
    assert_int_equal(resumed.run.epochs, 2);
    assert_memory_equal(resumed.scores, whole.scores, sizeof whole.scores);
    assert_true(same_file(a, b, "model.safetensors"));

    bat_error error;
    options.run.seed = 2;
    check_status(curve_train_sized(&options, &SHORT, NULL, &error), BAT_INVALID_ARGUMENT);
    options.run.seed = 1;
    options.run.epochs = 3;
    check_status(curve_train_sized(&options, &SHORT, NULL, &error), BAT_INVALID_ARGUMENT);
    train(c, 2, 2, NULL);
    assert_false(same_file(a, c, "model.safetensors"));
}

/// The validation curves.
static void make_validation(size_t count, bat_tension_set *sets)
{
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        check_status(
            bat_tension_set_make((bat_tension_space)space, BAT_TENSION_SET_KIND_RESAMPLED, count, 2, &sets[space], NULL),
            BAT_OK);
}

static void free_validation(bat_tension_set *sets)
{
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        bat_tension_set_free(&sets[space]);
}

/// The folder's model has the scores of the report, and its notes describe the training.
static void models_are_what_was_trained(void **state)
{
    const char *a = ((const train_folders *)*state)->a;
    bat_curve_train_report report;
    bat_curve_train_score scores[BAT_TENSION_SPACE_COUNT];
    safetensors content;
    learn_parameters parameters = {0};
    bat_tension_set sets[BAT_TENSION_SPACE_COUNT];
    char path[200];
    train(a, 1, 0, &report);
    check_status(safetensors_read(path_in(a, "model.safetensors", path), &content, NULL), BAT_OK);
    assert_string_equal(safetensors_find_note(&content, "recipe"), "tension batten, 2 epochs");
    assert_string_equal(safetensors_find_note(&content, "seed"), "1");
    assert_string_equal(safetensors_find_note(&content, "epochs"), "2");
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &content, "", parameters.values, NULL), BAT_OK);
    make_validation(SHORT.validation_curves, sets);
    for (size_t i = 0; i < BAT_CURVE_TRAIN_FAIRNESSES; i++)
    {
        check_status(curve_batten_validate(&parameters, sets, 0.5 * (double)i, NULL, 1, scores, NULL), BAT_OK);
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            check_relative(scores[space].mean_nn, report.scores[i][space].mean_nn, 1e-6);
            check_relative(scores[space].bending, report.scores[i][space].bending, 1e-4);
            check_relative(scores[space].g1, report.scores[i][space].g1, 1e-4);
            assert_true(scores[space].mean_nn > 0 && scores[space].mean_nn < 0.5);
        }
    }
    free_validation(sets);
    learn_parameters_free(&parameters);
    safetensors_free(&content);
}

/// Mean over the spaces of the distances relative to those of untrained weights.
static double relative_distance(const bat_curve_train_score *scores, const bat_curve_train_score *untrained)
{
    double sum = 0;
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        sum += scores[space].mean_nn / untrained[space].mean_nn / BAT_TENSION_SPACE_COUNT;
    return sum;
}

/// Batches differ too much for their losses to fall from epoch to epoch so soon: validation curves show it. After sixty
/// steps they are closer to the data at fairness 0, and fairer at fairness 1.
static void sixty_steps_teach_something(void **state)
{
    (void)state;
    if (DOUBLE)
        skip(); // twice as long, and no more is learned
    const curve_train_size size = {.steps = 20, .validation_curves = 10};
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_BATTEN);
    bat_curve_train_report report;
    bat_curve_train_score untrained[BAT_TENSION_SPACE_COUNT];
    bat_tension_set sets[BAT_TENSION_SPACE_COUNT];
    options.run.epochs = 3;
    check_status(curve_train_sized(&options, &size, &report, NULL), BAT_OK);
    learn_parameters parameters = {0};
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    learned_network_start(&parameters, options.run.seed);
    make_validation(size.validation_curves, sets);
    check_status(curve_batten_validate(&parameters, sets, 0, NULL, 0, untrained, NULL), BAT_OK);
    assert_true(relative_distance(report.scores[0], untrained) < 0.95);
    double angles[2] = {0, 0};
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        assert_true(report.scores[2][space].bending < report.scores[0][space].bending);
        angles[0] += report.scores[0][space].g1;
        angles[1] += report.scores[2][space].g1;
    }
    assert_true(angles[1] < angles[0]);
    free_validation(sets);
    learn_parameters_free(&parameters);
}

static bat_status train_with_run(const bat_train_options *run, bat_error *error)
{
    bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_BATTEN);
    options.run = *run;
    return curve_train_sized(&options, &SHORT, NULL, error);
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    check_common_options(train_with_run);
    for (int i = 0; i < 4; i++)
    {
        bat_curve_train_options options = bat_curve_train_defaults(BAT_RECIPE_BATTEN);
        assert_int_equal(options.run.epochs, 300);
        assert_null(options.run.folder);
        if (i == 0)
            options.embedding = BAT_TENSION_EMBEDDING_NONE;
        if (i == 1)
            options.smoothness[BAT_TENSION_SPACE_SPHERE] = 0.1;
        if (i == 2)
            options.bending = 0.1;
        if (i == 3)
            options.consistency = NAN;
        check_refused(bat_curve_train(&options, NULL, refusal), "embedding, smoothness", "must be 0");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(neither_threads_nor_stops_change_a_byte, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(models_are_what_was_trained, make_folders, remove_folders),
        cmocka_unit_test(sixty_steps_teach_something),
        cmocka_unit_test(options_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

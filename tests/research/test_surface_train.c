// Short trainings of the network for clouds: neither threads nor interruptions change a byte, the loss falls, files tell
// what they hold, and options out of range are refused. Built in single and double precision.

#include "train_helpers.h"

#include "batten/cloud_parameterize.h"
#include "batten/research/networks.h"
#include "batten/research/surface_train.h"
#include "learn/safetensors.h"

static bat_surface_train_options short_options(const char *folder)
{
    bat_surface_train_options options = bat_surface_train_defaults(BAT_RECIPE_PUBLISHED);
    options.run.epochs = 2;
    options.steps = 3;
    options.min_points = 20;
    options.max_points = 40;
    options.max_degree = 3;
    options.noise = 0.01;
    options.run.folder = folder;
    options.run.threads = 1;
    return options;
}

static void train(const bat_surface_train_options *options, bat_surface_train_report *report)
{
    bat_error error;
    if (bat_surface_train(options, report, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

static bool stop_in_the_second_epoch(void *context, double fraction)
{
    (void)context;
    return fraction < 0.6;
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    const train_folders *folders = *state;
    const char *a = folders->a, *b = folders->b, *c = folders->c;
    bat_surface_train_report whole, resumed;
    for (int adam = 0; adam < 2; adam++)
    {
        bat_surface_train_options options = short_options(a);
        options.adam = adam == 1;
        options.batch = 3;
        train(&options, &whole);
        assert_int_equal(whole.run.epochs, 2);
        options.run.folder = b;
        options.run.threads = 3;
        train(&options, &resumed);
        assert_true(same_file(a, b, "model.safetensors"));
        options.run.folder = c;
        options.run.resume = true; // from nothing at first
        options.run.progress.report = stop_in_the_second_epoch;
        check_status(bat_surface_train(&options, &resumed, NULL), BAT_CANCELLED);
        options.run.progress.report = NULL;
        train(&options, &resumed);
        assert_true(same_file(a, c, "model.safetensors"));
        assert_true(same_file(a, c, "checkpoint.safetensors"));
        assert_true(resumed.run.best == whole.run.best && resumed.run.loss == whole.run.loss);
        // Another training's checkpoint.
        options.noise = 0.02;
        check_status(bat_surface_train(&options, &resumed, NULL), BAT_INVALID_ARGUMENT);
        remove_files(c);
    }
}

static void both_rules_learn(void **state)
{
    (void)state;
    for (int form = 0; form < 3; form++)
    {
        bat_surface_train_report early, late;
        bat_surface_train_options options = short_options(NULL);
        options.max_degree = 2;
        options.noise = 0;
        options.min_points = options.max_points = 150;
        options.adam = form > 0;
        options.rate = options.adam ? 1e-3 : 0.1;
        options.uninformed = form == 2;
        options.run.epochs = options.steps = 1;
        train(&options, &early);
        options.steps = 120;
        train(&options, &late);
        assert_int_equal(late.run.epochs, 1);
        assert_true(isfinite(late.run.loss) && late.run.loss > 0);
        assert_true(late.run.best < 0.85 * early.run.best);
    }
}

/// Of checkpoints too.
static void models_say_what_they_are(void **state)
{
    const char *a = ((const train_folders *)*state)->a;
    for (int form = 0; form < 4; form++)
    {
        bat_surface_train_options options = short_options(a);
        bat_surface_model *model;
        safetensors content;
        char path[200];
        options.run.epochs = options.steps = 1;
        options.uninformed = form % 2 == 1;
        train(&options, NULL);
        check_status(safetensors_read(path_in(a, TRAIN_FILES[form / 2], path), &content, NULL), BAT_OK);
        const char *recipe = safetensors_find_note(&content, "recipe");
        assert_non_null(recipe);
        assert_int_equal(strncmp(recipe, options.uninformed ? "surface uninformed," : "surface published,", 18), 0);
        safetensors_free(&content);
        check_status(bat_surface_model_read_published(path, &model, NULL), BAT_OK);
        bat_surface_model_free(model);
    }
}

static bat_status train_with_run(const bat_train_options *run, bat_error *error)
{
    bat_surface_train_options options = short_options(NULL);
    options.run = *run;
    return bat_surface_train(&options, NULL, error);
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    enum
    {
        FIELDS = 18
    };
    check_common_options(train_with_run);
    for (int i = 0; i < FIELDS; i++)
    {
        bat_surface_train_options options = short_options(NULL);
        const struct
        {
            size_t *count;
            int *degree;
            double *number;
            double value;
            const char *field, *range;
        } fields[FIELDS] = {
            {&options.steps, NULL, NULL, 0, "steps", "1 to 1000000000"},
            {&options.steps, NULL, NULL, 1e10, "steps", "1 to 1000000000"},
            {&options.batch, NULL, NULL, 0, "batch", "1 to 1000000"},
            {&options.batch, NULL, NULL, 1e9, "batch", "1 to 1000000"},
            {&options.min_points, NULL, NULL, 3, "min_points", "4 to 100000"},
            {&options.max_points, NULL, NULL, 19, "max_points", "20 to 100000"},
            {&options.max_points, NULL, NULL, 1e10, "max_points", "20 to 100000"},
            {NULL, &options.min_degree, NULL, 0, "min_degree", "1 to 15"},
            {NULL, &options.max_degree, NULL, 1, "max_degree", "2 to 15"},
            {NULL, &options.max_degree, NULL, 16, "max_degree", "2 to 15"},
            {NULL, NULL, &options.noise, -1, "noise", "finite and at least 0"},
            {NULL, NULL, &options.noise, INFINITY, "noise", "finite and at least 0"},
            {NULL, NULL, &options.clean, -0.1, "clean", "0 to below 1"},
            {NULL, NULL, &options.clean, 1, "clean", "0 to below 1"},
            {NULL, NULL, &options.clean, NAN, "clean", "0 to below 1"},
            {NULL, NULL, &options.rate, 0, "rate", "finite and above 0"},
            {NULL, NULL, &options.rate, NAN, "rate", "finite and above 0"},
            {NULL, NULL, &options.rate, INFINITY, "rate", "finite and above 0"},
        };
        if (fields[i].count != NULL)
            *fields[i].count = (size_t)fields[i].value;
        else if (fields[i].degree != NULL)
            *fields[i].degree = (int)fields[i].value;
        else
            *fields[i].number = fields[i].value;
        check_refused(bat_surface_train(&options, NULL, refusal), fields[i].field, fields[i].range);
    }
    bat_surface_train_options options = short_options(NULL);
    options.recipe = (bat_recipe)2;
    check_refused(bat_surface_train(&options, NULL, refusal), "recipe", "0 to 1");
    options = bat_surface_train_defaults(BAT_RECIPE_BATTEN);
    options.uninformed = true;
    check_refused(bat_surface_train(&options, NULL, refusal), "uninformed", "must be false");
}

/// An excessive learning rate ends in numbers that are not finite, which is an error.
static void what_runs_away_is_told_of(void **state)
{
    (void)state;
    bat_surface_train_options options = short_options(NULL);
    options.rate = 1e300;
    options.steps = 50;
    bat_error error;
    check_status(bat_surface_train(&options, NULL, &error), BAT_NO_CONVERGENCE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(neither_threads_nor_stops_change_a_byte, make_folders, remove_folders),
        cmocka_unit_test(both_rules_learn),
        cmocka_unit_test_setup_teardown(models_say_what_they_are, make_folders, remove_folders),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(what_runs_away_is_told_of),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Short trainings of the network for meshes: neither threads nor interruptions change a byte, the loss falls, every
// published ablation trains, and options out of range are refused. Built in single and double precision.

#include "mesh_flap_helpers.h"
#include "train_helpers.h"

#include "batten/research/mesh_train.h"
#include "research/train/mesh_network_tape.h"

static bat_mesh shapes[2];

static int make_shapes(void **state)
{
    (void)state;
    shapes[0] = ball(3);
    shapes[1] = ball(2);
    for (size_t v = 0; v < shapes[0].vertex_count; v++)
        shapes[0].positions[3 * v] *= 1.5;
    return 0;
}

static int free_shapes(void **state)
{
    (void)state;
    bat_mesh_free(&shapes[0]);
    bat_mesh_free(&shapes[1]);
    return 0;
}

static bat_mesh_train_options short_options(const char *folder)
{
    bat_mesh_train_options options = bat_mesh_train_defaults(BAT_RECIPE_PUBLISHED);
    options.run.epochs = 3;
    options.pairs = 3;
    options.resampled = 1;
    options.min_vertices = 12;
    options.max_vertices = 20;
    options.run.folder = folder;
    options.run.threads = 1;
    return options;
}

static void train(const bat_mesh_train_options *options, bat_mesh_train_report *report)
{
    bat_error error;
    if (bat_mesh_train(shapes, 2, options, report, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

static bool stop_in_the_second_epoch(void *context, double fraction)
{
    (void)context;
    return fraction < 0.5;
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    const train_folders *folders = *state;
    const char *a = folders->a, *b = folders->b, *c = folders->c;
    bat_mesh_train_report whole, resumed;
    bat_mesh_train_options options = short_options(a);
    options.batch = 2;
    train(&options, &whole);
    assert_int_equal(whole.run.epochs, 3);
    options.run.folder = b;
    options.run.threads = 3;
    train(&options, &resumed);
    assert_true(same_file(a, b, "model.safetensors"));
    options.run.folder = c;
    options.run.resume = true; // from nothing at first
    options.run.progress.report = stop_in_the_second_epoch;
    check_status(bat_mesh_train(shapes, 2, &options, &resumed, NULL), BAT_CANCELLED);
    options.run.progress.report = NULL;
    train(&options, &resumed);
    assert_true(same_file(a, c, "model.safetensors"));
    assert_true(same_file(a, c, "checkpoint.safetensors"));
    assert_memory_equal(resumed.errors, whole.errors, sizeof whole.errors);
    // Another training's checkpoint.
    options.pairs = 4;
    check_status(bat_mesh_train(shapes, 2, &options, &resumed, NULL), BAT_INVALID_ARGUMENT);
    options = short_options(c);
    options.batch = 2;
    options.run.resume = true;
    check_status(bat_mesh_train(shapes, 1, &options, &resumed, NULL), BAT_INVALID_ARGUMENT);
}

static void every_form_learns(void **state)
{
    (void)state;
    for (int form = 0; form < 7; form++)
    {
        bat_mesh_train_report early, late;
        bat_mesh_train_options options = short_options(NULL);
        options.resampled = 0;
        options.fixed_frames = form == 1;
        options.no_differences = form == 2;
        options.last_level = form == 3;
        options.chamfer = form == 4;
        options.learn_loop = form == 5;
        options.relative = form == 6;
        options.run.epochs = 1;
        train(&options, &early);
        options.run.epochs = 25;
        train(&options, &late);
        assert_int_equal(late.run.epochs, 25);
        assert_true(isfinite(late.run.loss) && late.run.loss > 0);
        assert_true(late.errors[2] < 0.7 * early.errors[2]);
    }
}

/// The form that the arrays' shapes do not determine is in the file's note, in checkpoints too.
static void models_say_of_what_form_they_are(void **state)
{
    const char *a = ((const train_folders *)*state)->a;
    for (int form = 0; form < 4; form++)
    {
        bat_mesh_train_options options = short_options(a);
        safetensors content;
        char path[200];
        options.run.epochs = 1;
        options.fixed_frames = form % 2 == 1;
        options.relative = form / 2 == 1;
        train(&options, NULL);
        check_status(safetensors_read(path_in(a, TRAIN_FILES[form / 2], path), &content, NULL), BAT_OK);
        const char *recipe = safetensors_find_note(&content, "recipe");
        assert_non_null(recipe);
        assert_int_equal(strstr(recipe, MESH_NETWORK_FIXED) != NULL, options.fixed_frames);
        assert_int_equal(strstr(recipe, MESH_NETWORK_RELATIVE) != NULL, options.relative);
        safetensors_free(&content);
    }
}

static bat_status train_with_run(const bat_train_options *run, bat_error *error)
{
    bat_mesh_train_options options = short_options(NULL);
    options.run = *run;
    return bat_mesh_train(shapes, 2, &options, NULL, error);
}

static void options_out_of_range_are_refused(void **state)
{
    (void)state;
    enum
    {
        FIELDS = 15
    };
    check_common_options(train_with_run);
    for (int i = 0; i < FIELDS; i++)
    {
        bat_mesh_train_options options = short_options(NULL);
        const struct
        {
            size_t *count;
            double *number;
            double value;
            const char *field, *range;
        } fields[FIELDS] = {
            {&options.pairs, NULL, 0, "pairs", "1 to 5000000"},
            {&options.pairs, NULL, 5000001, "pairs", "1 to 5000000"},
            {&options.resampled, NULL, 10000001, "resampled", "0 to 10000000"},
            {&options.batch, NULL, 0, "batch", "1 to 6"},
            {&options.batch, NULL, 7, "batch", "1 to 6"},
            {&options.min_vertices, NULL, 3, "min_vertices", "4 to 1000000000"},
            {&options.max_vertices, NULL, 11, "max_vertices", "12 to 1000000000"},
            {&options.max_vertices, NULL, 1000000001, "max_vertices", "12 to 1000000000"},
            {NULL, &options.min_normal, -1.5, "min_normal", "-1 to 1"},
            {NULL, &options.min_normal, 1.5, "min_normal", "-1 to 1"},
            {NULL, &options.min_quality, -0.5, "min_quality", "0 to 1"},
            {NULL, &options.min_quality, NAN, "min_quality", "0 to 1"},
            {NULL, &options.rate, 0, "rate", "finite and above 0"},
            {NULL, &options.rate, NAN, "rate", "finite and above 0"},
            {NULL, &options.rate, INFINITY, "rate", "finite and above 0"},
        };
        if (fields[i].count != NULL)
            *fields[i].count = (size_t)fields[i].value;
        else
            *fields[i].number = fields[i].value;
        check_refused(bat_mesh_train(shapes, 2, &options, NULL, refusal), fields[i].field, fields[i].range);
    }
    bat_mesh_train_options options = short_options(NULL);
    options.recipe = (bat_recipe)2;
    check_refused(bat_mesh_train(shapes, 2, &options, NULL, refusal), "recipe", "0 to 1");
    check_refused(bat_mesh_train(shapes, 0, NULL, NULL, refusal), "training needs", "1 shape");
}

/// Batten's recipe generates shapes and needs no others: it begins, where the published one is refused.
static void batten_has_shapes_of_its_own(void **state)
{
    (void)state;
    stopping stop = {0};
    bat_mesh_train_options options = bat_mesh_train_defaults(BAT_RECIPE_BATTEN);
    options.run.progress = (bat_progress){stop_at, &stop};
    check_status(bat_mesh_train(NULL, 0, &options, NULL, NULL), BAT_CANCELLED);
    options.recipe = BAT_RECIPE_PUBLISHED;
    check_refused(bat_mesh_train(NULL, 0, &options, NULL, refusal), "training needs", "1 shape");
    options.begin = WEIGHTS_FOLDER "/mesh.safetensors";
    check_refused(bat_mesh_train(NULL, 0, &options, NULL, refusal), "begin", "recipe batten");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(neither_threads_nor_stops_change_a_byte, make_folders, remove_folders),
        cmocka_unit_test(every_form_learns),
        cmocka_unit_test_setup_teardown(models_say_of_what_form_they_are, make_folders, remove_folders),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(batten_has_shapes_of_its_own),
    };
    return cmocka_run_group_tests(tests, make_shapes, free_shapes);
}

// What all trainings share, with a small regression: the files of a folder, the log and its picture, interruptions, and the
// ranges of options. Built in single and double precision.

#include "regression_helpers.h"
#include "train_helpers.h"

#include "io/common/file_text.h"
#include "learn/safetensors.h"

static bat_status no_check(const void *context, bat_error *error)
{
    (void)context;
    (void)error;
    return BAT_OK;
}

static bat_status make(void *context, bat_error *error)
{
    (void)context;
    (void)error;
    return BAT_OK;
}

static void describe(const void *context, char text[TRAIN_TEXT_SIZE])
{
    (void)context;
    (void)snprintf(text, TRAIN_TEXT_SIZE, "a regression");
}

static void configure(const void *context, learn_job *job, learn_options *options)
{
    (void)context;
    job->steps = STEPS;
    job->pieces = PIECES;
    options->threads = 2;
}

static const train_recipe BEST = {
    .columns = {METRICS, 1, VALIDATION, 2},
    .best_note = "validation_distance",
    .optimizer = {.rule = LEARN_ADAMW, .momentum = 0.9, .second = 0.99, .epsilon = 1e-8},
    .schedule = {.kind = LEARN_COSINE, .rate = 0.02, .warmup = 1},
    .plateau = {.reduce_factor = 0.5},
    .clip = 1,
    .validate_every = 2,
    .checkpoint_every = 3,
    .check = no_check,
    .make = make,
    .configure = configure,
    .describe = describe,
    .prepare_epoch = regression_prepare,
    .piece_loss = regression_piece,
    .validate = regression_validate,
};

static bat_status run_with(const bat_train_options *options, bat_recipe recipe, bat_train_report *report, bat_error *error)
{
    train_recipe last = BEST;
    last.best_note = NULL;
    const train_recipe *const recipes[TRAIN_RECIPES] = {&BEST, &last};
    regression r;
    regression_begin(&r);
    r.base.options = options;
    bat_status status = train_run(recipes, recipe, &r, report, error);
    learn_parameters_free(&r.base.parameters);
    return status;
}

static bat_status run(const bat_train_options *options, bat_error *error)
{
    return run_with(options, BAT_RECIPE_PUBLISHED, NULL, error);
}

static bat_train_options options_in(const char *folder)
{
    return (bat_train_options){.seed = 1, .epochs = EPOCHS, .folder = folder};
}

/// Two logs alike, except the last column of every line: the seconds.
static void assert_same_log(const char *folder, const char *other)
{
    file_text x, y;
    char path[200];
    check_status(file_text_read(path_in(folder, "log.csv", path), NULL, &x, NULL), BAT_OK);
    check_status(file_text_read(path_in(other, "log.csv", path), NULL, &y, NULL), BAT_OK);
    text_line p = text_line_start(&x), q = text_line_start(&y);
    size_t lines = 0;
    for (; text_line_next(&x, &p); lines++)
    {
        assert_true(text_line_next(&y, &q));
        const char *end = p.end, *other_end = q.end;
        while (end[-1] != ',')
            end--;
        while (other_end[-1] != ',')
            other_end--;
        assert_int_equal(end - p.begin, other_end - q.begin);
        assert_memory_equal(p.begin, q.begin, (size_t)(end - p.begin));
    }
    assert_false(text_line_next(&y, &q));
    assert_int_equal(lines, 1 + EPOCHS);
    file_text_free(&x);
    file_text_free(&y);
}

static void the_folder_holds_the_results(void **state)
{
    const train_folders *folders = *state;
    bat_train_options options = options_in(folders->a);
    bat_train_report report;
    size_t size;
    check_status(run_with(&options, BAT_RECIPE_PUBLISHED, &report, NULL), BAT_OK);
    assert_int_equal(report.epochs, EPOCHS);
    assert_true(report.best_epoch >= 2 && report.best > 0 && report.loss > 0 && !report.stopped);
    char *log = read_file(folders->a, "log.csv", &size);
    static const char header[] = "epoch,step,rate,loss,gradient_norm,largest,distance,size,seconds\n0,7,0.02,";
    assert_memory_equal(log, header, sizeof header - 1);
    free(log);
    char *picture = read_file(folders->a, "log.png", &size);
    assert_memory_equal(picture + 1, "PNG", 3);
    free(picture);

    char path[200], best[32];
    safetensors content;
    check_status(safetensors_read(path_in(folders->a, "model.safetensors", path), &content, NULL), BAT_OK);
    (void)snprintf(best, sizeof best, "%.6g", report.best);
    assert_string_equal(safetensors_find_note(&content, "recipe"), "a regression");
    assert_string_equal(safetensors_find_note(&content, "seed"), "1");
    assert_string_equal(safetensors_find_note(&content, "epochs"), "5");
    assert_string_equal(safetensors_find_note(&content, "validation_distance"), best);
    assert_int_equal(content.note_count, 5);
    safetensors_free(&content);
    // The last weights have no best validation.
    check_status(run_with(&options, BAT_RECIPE_BATTEN, NULL, NULL), BAT_OK);
    check_status(safetensors_read(path, &content, NULL), BAT_OK);
    assert_int_equal(content.note_count, 3);
    safetensors_free(&content);
}

static void interruptions_change_no_byte(void **state)
{
    const train_folders *folders = *state;
    bat_train_options options = options_in(folders->a);
    check_status(run(&options, NULL), BAT_OK);
    for (size_t part = 3; part < 20; part += 4)
    {
        remove_files(folders->b);
        options = options_in(folders->b);
        options.resume = true;
        bat_status status = BAT_CANCELLED;
        for (size_t runs = 0; status == BAT_CANCELLED; runs++)
        {
            stopping stop = {.steps = part};
            options.progress = (bat_progress){stop_at, &stop};
            status = run(&options, NULL);
            assert_true(runs < 100);
        }
        check_status(status, BAT_OK);
        assert_true(same_file(folders->a, folders->b, "model.safetensors"));
        assert_true(same_file(folders->a, folders->b, "checkpoint.safetensors"));
        assert_same_log(folders->a, folders->b);
    }
}

/// A crash leaves a log that is ahead of the checkpoint, with an incomplete last line.
static void a_log_ahead_of_its_checkpoint_is_truncated(void **state)
{
    const train_folders *folders = *state;
    char path[200];
    bat_train_options options = options_in(folders->a);
    check_status(run(&options, NULL), BAT_OK);
    options = options_in(folders->b);
    stopping stop = {.steps = 2 * STEPS + 1};
    options.progress = (bat_progress){stop_at, &stop};
    check_status(run(&options, NULL), BAT_CANCELLED);
    FILE *stream = fopen(path_in(folders->b, "log.csv", path), "a");
    assert_non_null(stream);
    (void)fprintf(stream, "2,21,1,1,1,1,,,1\n3,28,0.1");
    assert_int_equal(fclose(stream), 0);
    options.progress = (bat_progress){0};
    options.resume = true;
    check_status(run(&options, NULL), BAT_OK);
    assert_true(same_file(folders->a, folders->b, "model.safetensors"));
    assert_same_log(folders->a, folders->b);
}

static bool exists(const char *folder, const char *name)
{
    char path[200];
    return access(path_in(folder, name, path), R_OK) == 0;
}

static void a_resumed_training_has_its_picture(void **state)
{
    const train_folders *folders = *state;
    char path[200];
    bat_train_options options = options_in(folders->a);
    // Stopped after two epochs, before the first checkpoint that is due.
    stopping stop = {.steps = 2 * STEPS + 1};
    options.progress = (bat_progress){stop_at, &stop};
    check_status(run(&options, NULL), BAT_CANCELLED);
    assert_true(exists(folders->a, "log.png"));
    // Resumed, and stopped again before a step.
    (void)unlink(path_in(folders->a, "log.png", path));
    options.resume = true;
    stop = (stopping){0};
    check_status(run(&options, NULL), BAT_CANCELLED);
    assert_true(exists(folders->a, "log.png"));
    // Resumed when nothing is left to do.
    options.progress = (bat_progress){0};
    check_status(run(&options, NULL), BAT_OK);
    (void)unlink(path);
    check_status(run(&options, NULL), BAT_OK);
    assert_true(exists(folders->a, "log.png"));
}

static void broken_files_are_named(void **state)
{
    const train_folders *folders = *state;
    char path[200];
    bat_train_options options = options_in(folders->a);
    bat_error error;
    check_status(run(&options, NULL), BAT_OK);
    options.resume = true;
    assert_int_equal(truncate(path_in(folders->a, "log.csv", path), 20), 0);
    FILE *stream = fopen(path, "a");
    assert_non_null(stream);
    (void)fputs("\n", stream);
    (void)fclose(stream);
    check_status(run(&options, &error), BAT_BAD_FILE);
    assert_true(strstr(error.text, path) == error.text);
    assert_int_equal(truncate(path_in(folders->a, "checkpoint.safetensors", path), 1000), 0);
    check_status(run(&options, &error), BAT_BAD_FILE);
    assert_true(strstr(error.text, path) == error.text);
}

static void common_options_have_ranges(void **state)
{
    (void)state;
    check_common_options(run);
    bat_train_options options = options_in(NULL);
    check_refused(run_with(&options, (bat_recipe)2, NULL, refusal), "recipe is 2", "0 to 1");
}

static void ranges_are_told(void **state)
{
    (void)state;
    static const struct
    {
        train_range range;
        const char *text; ///< null: in range
    } cases[] = {
        {{"a", 1, 1, 2, false, false}, NULL},
        {{"a", 2, 1, 2, false, false}, NULL},
        {{"a", 3, 1, 2, false, false}, "a is 3, but must be 1 to 2"},
        {{"a", 1, 1, 2, true, false}, "a is 1, but must be above 1 to 2"},
        {{"a", 2, 1, 2, false, true}, "a is 2, but must be 1 to below 2"},
        {{"a", 1e300, 0, INFINITY, true, false}, NULL},
        {{"a", 0, 0, INFINITY, true, false}, "a is 0, but must be finite and above 0"},
        {{"a", INFINITY, 0, INFINITY, false, false}, "a is inf, but must be finite and at least 0"},
        {{"a", NAN, 0, 1, false, false}, "a is nan, but must be 0 to 1"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        bat_error error;
        bat_status status = train_check_ranges(&cases[i].range, 1, &error);
        check_status(status, cases[i].text == NULL ? BAT_OK : BAT_INVALID_ARGUMENT);
        if (cases[i].text != NULL)
            assert_string_equal(error.text, cases[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(the_folder_holds_the_results, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(interruptions_change_no_byte, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(a_log_ahead_of_its_checkpoint_is_truncated, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(a_resumed_training_has_its_picture, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(broken_files_are_named, make_folders, remove_folders),
        cmocka_unit_test(common_options_have_ranges),
        cmocka_unit_test(ranges_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

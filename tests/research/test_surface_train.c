// Short trainings of the network for clouds: neither threads nor stops change a byte, the loss falls, models say what they
// are, and what makes no sense is refused. Built in single and double precision.

#include "check.h"

#include "batten/cloud_parameterize.h"
#include "batten/research/surface_train.h"
#include "learn/safetensors.h"

#include <unistd.h>

static const char *const FILES[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};

static char root[40];
/// Folders in it.
static char a[60], b[60], c[60];

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(root, sizeof root, "/tmp/batten-surface-XXXXXX");
    if (mkdtemp(root) == NULL)
        return -1;
    (void)snprintf(a, sizeof a, "%s/a", root);
    (void)snprintf(b, sizeof b, "%s/b", root);
    (void)snprintf(c, sizeof c, "%s/c", root);
    return 0;
}

static void remove_files(const char *folder)
{
    char path[200];
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++)
    {
        (void)snprintf(path, sizeof path, "%s/%s", folder, FILES[i]);
        (void)unlink(path);
    }
    (void)rmdir(folder);
}

static int tear_down(void **state)
{
    (void)state;
    remove_files(a);
    remove_files(b);
    remove_files(c);
    return rmdir(root);
}

static bool same_file(const char *folder, const char *other, const char *name)
{
    enum
    {
        MOST = 1 << 23
    };
    char *bytes[2];
    size_t size[2];
    for (int i = 0; i < 2; i++)
    {
        char path[200];
        (void)snprintf(path, sizeof path, "%s/%s", i == 0 ? folder : other, name);
        FILE *stream = fopen(path, "rb");
        assert_non_null(stream);
        bytes[i] = malloc(MOST);
        assert_non_null(bytes[i]);
        size[i] = fread(bytes[i], 1, MOST, stream);
        (void)fclose(stream);
        assert_true(size[i] > 0 && size[i] < MOST);
    }
    bool same = size[0] == size[1] && memcmp(bytes[0], bytes[1], size[0]) == 0;
    free(bytes[0]);
    free(bytes[1]);
    return same;
}

static bat_surface_train_options short_options(const char *folder)
{
    bat_surface_train_options options = bat_surface_train_defaults();
    options.epochs = 2;
    options.steps = 3;
    options.least_points = 20;
    options.most_points = 40;
    options.most_degree = 3;
    options.noise = 0.01;
    options.folder = folder;
    options.threads = 1;
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
    (void)state;
    bat_surface_train_report whole, resumed;
    for (int adam = 0; adam < 2; adam++)
    {
        bat_surface_train_options options = short_options(a);
        options.adam = adam == 1;
        options.batch = 3;
        train(&options, &whole);
        assert_int_equal(whole.epochs, 2);
        options.folder = b;
        options.threads = 3;
        train(&options, &resumed);
        assert_true(same_file(a, b, "model.safetensors"));
        options.folder = c;
        options.resume = true; // from nothing at first
        options.progress.report = stop_in_the_second_epoch;
        check_status(bat_surface_train(&options, &resumed, NULL), BAT_CANCELLED);
        options.progress.report = NULL;
        train(&options, &resumed);
        assert_true(same_file(a, c, "model.safetensors"));
        assert_true(same_file(a, c, "checkpoint.safetensors"));
        assert_true(resumed.error == whole.error && resumed.loss == whole.loss);
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
        options.most_degree = 2;
        options.noise = 0;
        options.least_points = options.most_points = 150;
        options.adam = form > 0;
        options.rate = options.adam ? 1e-3 : 0.1;
        options.uninformed = form == 2;
        options.epochs = options.steps = 1;
        train(&options, &early);
        options.steps = 120;
        train(&options, &late);
        assert_int_equal(late.epochs, 1);
        assert_true(isfinite(late.loss) && late.loss > 0);
        assert_true(late.error < 0.85 * early.error);
    }
}

/// Of checkpoints too.
static void models_say_what_they_are(void **state)
{
    (void)state;
    for (int form = 0; form < 4; form++)
    {
        bat_surface_train_options options = short_options(a);
        bat_surface_model *model;
        safetensors content;
        char path[100];
        options.epochs = options.steps = 1;
        options.uninformed = form % 2 == 1;
        train(&options, NULL);
        (void)snprintf(path, sizeof path, "%s/%s", a, FILES[form / 2]);
        check_status(safetensors_read(path, &content, NULL), BAT_OK);
        const char *recipe = safetensors_find_note(&content, "recipe");
        assert_non_null(recipe);
        assert_int_equal(strncmp(recipe, options.uninformed ? "surface uninformed," : "surface published,", 18), 0);
        safetensors_free(&content);
        check_status(bat_surface_model_read(path, &model, NULL), BAT_OK);
        bat_surface_model_free(model);
    }
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    for (int i = 0; i < 11; i++)
    {
        bat_surface_train_options options = short_options(NULL);
        if (i == 0)
            options.epochs = 0;
        if (i == 1)
            options.steps = 0;
        if (i == 2)
            options.batch = 0;
        if (i == 3)
            options.least_points = 3;
        if (i == 4)
            options.most_points = 19;
        if (i == 5)
            options.most_points = SIZE_MAX;
        if (i == 6)
            options.least_degree = 0;
        if (i == 7)
            options.most_degree = 16;
        if (i == 8)
            options.noise = -1;
        if (i == 9)
            options.rate = NAN;
        if (i == 10)
            options.noise = INFINITY;
        bat_error error;
        check_status(bat_surface_train(&options, NULL, &error), BAT_INVALID_ARGUMENT);
    }
}

/// A rate beyond all reason ends in numbers that are none, and is told of.
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
        cmocka_unit_test(neither_threads_nor_stops_change_a_byte),
        cmocka_unit_test(both_rules_learn),
        cmocka_unit_test(models_say_what_they_are),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(what_runs_away_is_told_of),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}

// Trainings of the shipped rule with short epochs: neither threads nor stops change a byte, and the loss falls. Built in
// single and double precision.

#include "check.h"

#include "batten/curve_measure.h"
#include "curve/network/learned_network.h"
#include "learn/safetensors.h"
#include "research/train/learned_train.h"
#include "research/train/learned_validate.h"

#include <unistd.h>

static const bool DOUBLE = sizeof(real) == sizeof(double);

static const learned_epoch SHORT = {.steps = 2, .kept = 1};

static const char *const FILES[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};

static char root[40];
/// Folders in it.
static char a[60], b[60], c[60];

static int make_folders(void **state)
{
    (void)state;
    (void)snprintf(root, sizeof root, "/tmp/batten-fairing-XXXXXX");
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

static int remove_folders(void **state)
{
    (void)state;
    remove_files(a);
    remove_files(b);
    remove_files(c);
    return rmdir(root);
}

static char *read_file(const char *folder, const char *name, size_t *size)
{
    enum
    {
        MOST = 8 << 20
    };
    char path[200];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    char *bytes = malloc(MOST);
    assert_non_null(bytes);
    *size = fread(bytes, 1, MOST - 1, stream);
    bytes[*size] = 0;
    (void)fclose(stream);
    return bytes;
}

static bool same_file(const char *folder, const char *other, const char *name)
{
    size_t size, other_size;
    char *bytes = read_file(folder, name, &size), *other_bytes = read_file(other, name, &other_size);
    assert_true(size > 0);
    bool same = size == other_size && memcmp(bytes, other_bytes, size) == 0;
    free(bytes);
    free(other_bytes);
    return same;
}

/// Asked before every step; stops before step `steps`, counted from 0.
typedef struct stopping
{
    size_t steps, asked;
} stopping;

static bool stop_at(void *context, double fraction)
{
    stopping *s = context;
    assert_true(fraction >= 0 && fraction < 1);
    return s->asked++ < s->steps;
}

static void train(const char *folder, uint64_t seed, int threads, bat_learned_train_report *report)
{
    bat_learned_train_options options = bat_learned_train_defaults();
    bat_error error;
    options.folder = folder;
    options.seed = seed;
    options.threads = threads;
    options.epochs = 2;
    if (learned_train_by(&options, SHORT, report, &error) != BAT_OK)
        fail_msg("%s", error.text);
}

static void neither_threads_nor_stops_change_a_byte(void **state)
{
    (void)state;
    bat_learned_train_report whole, resumed;
    train(a, 1, 1, &whole);
    assert_int_equal(whole.epochs, 2);
    assert_true(isfinite(whole.loss));

    // In the middle of the second epoch.
    stopping stop = {.steps = 3};
    bat_learned_train_options options = bat_learned_train_defaults();
    options.epochs = 2;
    options.threads = 2;
    options.folder = b;
    options.resume = true; // from nothing at first
    options.progress = (bat_progress){stop_at, &stop};
    check_status(learned_train_by(&options, SHORT, NULL, NULL), BAT_CANCELLED);
    assert_int_equal(stop.asked, 4);
    stop = (stopping){.steps = SIZE_MAX};
    check_status(learned_train_by(&options, SHORT, &resumed, NULL), BAT_OK);
    assert_int_equal(stop.asked, 1);
    assert_true(same_file(a, b, "model.safetensors"));
    assert_true(same_file(a, b, "checkpoint.safetensors"));
    assert_int_equal(resumed.epochs, 2);
    assert_memory_equal(resumed.scores, whole.scores, sizeof whole.scores);

    // What is done stays done.
    stop = (stopping){0};
    check_status(learned_train_by(&options, SHORT, &resumed, NULL), BAT_OK);
    assert_int_equal(stop.asked, 0);
    assert_int_equal(resumed.epochs, 2);
    assert_memory_equal(resumed.scores, whole.scores, sizeof whole.scores);
    assert_true(same_file(a, b, "model.safetensors"));

    bat_error error;
    options.seed = 2;
    check_status(learned_train_by(&options, SHORT, NULL, &error), BAT_INVALID_ARGUMENT);
    options.seed = 1;
    options.epochs = 3;
    check_status(learned_train_by(&options, SHORT, NULL, &error), BAT_INVALID_ARGUMENT);
    train(c, 2, 2, NULL);
    assert_false(same_file(a, c, "model.safetensors"));
}

/// The curves that weights are checked on.
static void make_kept(size_t count, bat_tension_set *kept)
{
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        check_status(bat_tension_set_make((bat_tension_space)space, BAT_TENSION_RESAMPLED, count, 2, &kept[space], NULL),
                     BAT_OK);
}

static void free_kept(bat_tension_set *kept)
{
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        bat_tension_set_free(&kept[space]);
}

/// What the folder's model does is what the report says, and it tells what made it.
static void models_are_what_was_trained(void **state)
{
    (void)state;
    bat_learned_train_report report;
    bat_learned_score scores[BAT_TENSION_SPACE_COUNT];
    safetensors content;
    learn_parameters parameters = {0};
    bat_tension_set kept[BAT_TENSION_SPACE_COUNT];
    char path[200];
    train(a, 1, 0, &report);
    (void)snprintf(path, sizeof path, "%s/model.safetensors", a);
    check_status(safetensors_read(path, &content, NULL), BAT_OK);
    assert_string_equal(safetensors_find_note(&content, "recipe"), "batten");
    assert_string_equal(safetensors_find_note(&content, "seed"), "1");
    assert_string_equal(safetensors_find_note(&content, "epochs"), "2");
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    check_status(learn_parameters_extract(&parameters, &content, "", parameters.values, NULL), BAT_OK);
    make_kept(SHORT.kept, kept);
    for (size_t i = 0; i < BAT_FAIRING_CHECKS; i++)
    {
        check_status(learned_validate(&parameters, kept, 0.5 * (double)i, 1, scores, NULL), BAT_OK);
        for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            check_relative(scores[space].mean_nn, report.scores[i][space].mean_nn, 1e-6);
            check_relative(scores[space].bending, report.scores[i][space].bending, 1e-4);
            check_relative(scores[space].g1, report.scores[i][space].g1, 1e-4);
            assert_true(scores[space].mean_nn > 0 && scores[space].mean_nn < 0.5);
        }
    }
    free_kept(kept);
    learn_parameters_free(&parameters);
    safetensors_free(&content);
}

/// Mean over the spaces of the distances relative to those of untrained weights.
static double relative_distance(const bat_learned_score *scores, const bat_learned_score *untrained)
{
    double sum = 0;
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        sum += scores[space].mean_nn / untrained[space].mean_nn / BAT_TENSION_SPACE_COUNT;
    return sum;
}

/// Batches differ too much for their losses to fall from epoch to epoch so soon: curves kept aside tell. After thirty steps
/// one comes nearer to them at fairness 0, and where a fair curve is asked for it is fairer.
static void thirty_steps_teach_something(void **state)
{
    (void)state;
    if (DOUBLE)
        skip(); // twice as long, and no more is learned
    const learned_epoch ten = {.steps = 10, .kept = 10};
    bat_learned_train_options options = bat_learned_train_defaults();
    bat_learned_train_report report;
    bat_learned_score untrained[BAT_TENSION_SPACE_COUNT];
    bat_tension_set kept[BAT_TENSION_SPACE_COUNT];
    options.epochs = 3;
    check_status(learned_train_by(&options, ten, &report, NULL), BAT_OK);
    learn_parameters parameters = {0};
    check_status(learned_network_make(&parameters, NULL), BAT_OK);
    learned_network_start(&parameters, options.seed);
    make_kept(ten.kept, kept);
    check_status(learned_validate(&parameters, kept, 0, 0, untrained, NULL), BAT_OK);
    assert_true(relative_distance(report.scores[0], untrained) < 0.99);
    for (int space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        assert_true(report.scores[2][space].g1 < report.scores[0][space].g1 &&
                    report.scores[2][space].bending < report.scores[0][space].bending);
    free_kept(kept);
    learn_parameters_free(&parameters);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    bat_error error;
    bat_learned_train_options options = bat_learned_train_defaults();
    assert_int_equal(options.seed, 1);
    assert_int_equal(options.epochs, 300);
    assert_null(options.folder);
    options.epochs = 0;
    check_status(bat_learned_train(&options, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "training needs at least 1 epoch");
    options.epochs = 1;
    options.folder = "/dev/null/at/all";
    check_status(bat_learned_train(&options, NULL, &error), BAT_FILE_ACCESS);
    options.folder = "";
    check_status(bat_learned_train(&options, NULL, &error), BAT_FILE_ACCESS);
    // Without files, and before the first step.
    stopping stop = {0};
    options.folder = NULL;
    options.progress = (bat_progress){stop_at, &stop};
    check_status(bat_learned_train(&options, NULL, &error), BAT_CANCELLED);
    check_status(learned_train_by(&options, (learned_epoch){0, 1}, NULL, &error), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(neither_threads_nor_stops_change_a_byte, make_folders, remove_folders),
        cmocka_unit_test_setup_teardown(models_are_what_was_trained, make_folders, remove_folders),
        cmocka_unit_test(thirty_steps_teach_something),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

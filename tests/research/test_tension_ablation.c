#include "check.h"

#include "research/studies/tension_ablation.h"

#include <unistd.h>

// Tables 3 and 4 on a few curves and one epoch.

enum
{
    ROWS = 2
};
static const bat_tension_variant VARIANTS[ROWS] = {BAT_TENSION_VARIANT_NO_EMBEDDING, BAT_TENSION_VARIANT_NO_CONSISTENCY};

static int make_folder(void **state)
{
    static char folder[40];
    (void)snprintf(folder, sizeof folder, "/tmp/batten-ablation-XXXXXX");
    *state = mkdtemp(folder);
    return *state == NULL ? -1 : 0;
}

/// The files of the trainings below, and their folders.
static int remove_folder(void **state)
{
    static const char *const trainings[] = {"seed-1/no-embedding", "seed-1/no-consistency", "seed-1", "seed-2/no-embedding",
                                            "seed-2"};
    static const char *const files[] = {"model.safetensors", "checkpoint.safetensors", "log.csv", "log.png"};
    char path[200];
    for (size_t i = 0; i < sizeof trainings / sizeof *trainings; i++)
    {
        for (size_t k = 0; k < sizeof files / sizeof *files; k++)
        {
            (void)snprintf(path, sizeof path, "%s/%s/%s", (char *)*state, trainings[i], files[k]);
            (void)unlink(path);
        }
        (void)snprintf(path, sizeof path, "%s/%s", (char *)*state, trainings[i]);
        (void)rmdir(path);
    }
    return rmdir(*state);
}

/// Counts steps, and stops before step `most`.
typedef struct counting
{
    size_t asked, most;
    double last;
} counting;

static bool count_step(void *context, double fraction)
{
    counting *c = context;
    assert_true(fraction >= c->last && fraction < 1);
    c->last = fraction;
    return c->asked++ < c->most;
}

/// A few of the published curves.
static bat_tension_data few(const bat_tension_data *data)
{
    bat_tension_data part = *data;
    for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
    {
        part.train[space].count = 8;
        part.validation[space].count = 2;
    }
    return part;
}

static void finished_trainings_are_not_repeated(void **state)
{
    bat_tension_data all;
    check_status(bat_tension_data_make(&all, NULL), BAT_OK);
    bat_tension_data data = few(&all);
    bat_tension_ablation_options options = bat_tension_ablation_defaults();
    bat_tension_ablation_row whole[ROWS], again[ROWS];
    bat_error error;
    options.epochs = 1;
    check_status(tension_ablate_on(&data, VARIANTS, ROWS, &options, whole, NULL), BAT_OK);

    // Stopped in the second of two trainings of 3 steps each, gone on with, and asked for once more.
    counting steps = {.most = 4};
    options.folder = *state;
    options.progress = (bat_progress){count_step, &steps};
    check_status(tension_ablate_on(&data, VARIANTS, ROWS, &options, again, &error), BAT_CANCELLED);
    assert_int_equal(steps.asked, 5);
    steps = (counting){.most = SIZE_MAX};
    check_status(tension_ablate_on(&data, VARIANTS, ROWS, &options, again, NULL), BAT_OK);
    assert_int_equal(steps.asked, 2);
    for (int time = 0; time < 2; time++)
    {
        for (size_t i = 0; i < ROWS; i++)
        {
            assert_int_equal(again[i].report.run.epochs, 1);
            for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
            {
                check_near(again[i].scores[space].mean_nn, whole[i].scores[space].mean_nn, 0);
                check_near(again[i].scores[space].g1, whole[i].scores[space].g1, 0);
                check_near(again[i].scores[space].bending, whole[i].scores[space].bending, 0);
            }
        }
        steps = (counting){0};
        check_status(tension_ablate_on(&data, VARIANTS, ROWS, &options, again, NULL), BAT_OK);
        assert_int_equal(steps.asked, 0);
    }
    char path[100];
    (void)snprintf(path, sizeof path, "%s/seed-1/no-consistency/model.safetensors", (char *)*state);
    assert_int_equal(access(path, F_OK), 0);

    // Trainings of another length are not taken for these; those of another seed lie elsewhere.
    options.epochs = 2;
    check_status(tension_ablate_on(&data, VARIANTS, ROWS, &options, again, &error), BAT_INVALID_ARGUMENT);
    options.epochs = 1;
    options.seed = 2;
    options.progress = (bat_progress){0};
    check_status(tension_ablate_on(&data, VARIANTS, 1, &options, again, NULL), BAT_OK);
    assert_true(again[0].scores[0].mean_nn != whole[0].scores[0].mean_nn);
    bat_tension_data_free(&all);
}

static void rows_say_what_was_trained(void **state)
{
    (void)state;
    static const char *const names[BAT_TENSION_VARIANT_COUNT] = {"full",           "one-hot",    "no-embedding",
                                                                 "no-consistency", "no-bending", "no-smoothness"};
    static const size_t weights[BAT_TENSION_VARIANT_COUNT] = {140505, 139841, 139457, 140505, 140505, 140505};
    // Mean bending of the four-point scheme as printed, by accurate formulas.
    static const double four_point[BAT_TENSION_SPACE_COUNT] = {1477.52, 515.827, 76713.5};
    bat_tension_variant variants[BAT_TENSION_VARIANT_COUNT];
    bat_tension_ablation_row rows[BAT_TENSION_VARIANT_COUNT];
    bat_tension_data all;
    check_status(bat_tension_data_make(&all, NULL), BAT_OK);
    bat_tension_data data = few(&all);
    for (int i = 0; i < BAT_TENSION_VARIANT_COUNT; i++)
        variants[i] = (bat_tension_variant)i;
    bat_tension_ablation_options options = bat_tension_ablation_defaults();
    options.epochs = 1;
    check_status(tension_ablate_on(&data, variants, BAT_TENSION_VARIANT_COUNT, &options, rows, NULL), BAT_OK);
    for (size_t i = 0; i < BAT_TENSION_VARIANT_COUNT; i++)
    {
        assert_string_equal(rows[i].variant, names[i]);
        assert_int_equal(rows[i].weights, weights[i]);
        for (size_t space = 0; space < BAT_TENSION_SPACE_COUNT; space++)
        {
            assert_true(isnan(rows[i].published[space].mean_nn));
            check_relative(rows[i].scores[space].bending * four_point[space], rows[i].report.scores[0][space].bending, 1e-4);
        }
        // No two variants are the same training.
        for (size_t k = 0; k < i; k++)
            assert_true(rows[i].report.run.best != rows[k].report.run.best);
    }
    bat_tension_data_free(&all);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    bat_tension_ablation_options options = bat_tension_ablation_defaults();
    bat_tension_ablation_row rows[BAT_TENSION_TABLE4_ROWS];
    bat_error error;
    options.epochs = 0;
    check_status(bat_tension_table3(&options, rows, &error), BAT_INVALID_ARGUMENT);
    options.epochs = 1;
    options.folder = "/dev/null/at/all";
    check_status(bat_tension_table4(&options, rows, &error), BAT_FILE_ACCESS);
    counting none = {0};
    options.folder = NULL;
    options.progress = (bat_progress){count_step, &none};
    check_status(bat_tension_table4(&options, rows, &error), BAT_CANCELLED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(finished_trainings_are_not_repeated, make_folder, remove_folder),
        cmocka_unit_test(rows_say_what_was_trained),
        cmocka_unit_test(bad_options_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

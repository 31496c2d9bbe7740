// Optimizers, learning rates and the training loop. Built in single and double precision.

#include "regression_helpers.h"

#include "io/common/file_text.h"
#include "learn/blas.h"
#include "research/learn/parameters.h"

#include <unistd.h>

static const bool DOUBLE = sizeof(real) == sizeof(double);

// Optimizers: two steps of one weight from 1 with the gradients 0.5 and -1, rate and decay 0.1, computed by hand.

static void check_rule(learn_optimizer_options options, double after_one, double after_two)
{
    learn_optimizer optimizer;
    check_status(learn_optimizer_make(&options, 1, &optimizer, NULL), BAT_OK);
    real weight = 1;
    const real gradients[] = {(real)0.5, -1};
    learn_optimizer_step(&optimizer, 0.1, &gradients[0], &weight);
    check_near((double)weight, after_one, DOUBLE ? 3e-9 : 1e-6);
    learn_optimizer_step(&optimizer, 0.1, &gradients[1], &weight);
    check_near((double)weight, after_two, DOUBLE ? 3e-9 : 1e-6);
    learn_optimizer_free(&optimizer);
}

static void optimizers_step_as_computed_by_hand(void **state)
{
    (void)state;
    check_rule((learn_optimizer_options){LEARN_SGD, 0.9, 0, 0, 0.1}, 0.94, 0.9766);
    check_rule((learn_optimizer_options){LEARN_ADAM, 0.9, 0.95, 1e-8, 0.1}, 0.9, 0.925139344);
    check_rule((learn_optimizer_options){LEARN_ADAMW, 0.9, 0.95, 1e-8, 0.1}, 0.89, 0.917437394);
    bat_error error;
    learn_optimizer optimizer;
    check_status(learn_optimizer_make(&(learn_optimizer_options){LEARN_ADAM, 1, 0.9, 0, 0}, 1, &optimizer, &error),
                 BAT_INVALID_ARGUMENT);
    check_status(learn_optimizer_make(&(learn_optimizer_options){LEARN_SGD, 0, 0, 0, -1}, 1, &optimizer, &error),
                 BAT_INVALID_ARGUMENT);
}

static void long_gradients_are_clipped_and_short_ones_left(void **state)
{
    (void)state;
    real gradient[] = {3, 0, -4};
    check_near(learn_clip_norm(3, gradient, 10), 5, 1e-12);
    assert_true(gradient[0] == 3 && gradient[2] == -4);
    check_near(learn_clip_norm(3, gradient, HUGE_VAL), 5, 1e-12);
    assert_true(gradient[0] == 3);
    check_near(learn_clip_norm(3, gradient, 0.5), 5, 1e-12);
    check_near((double)gradient[0], 0.3, 1e-6);
    check_near((double)gradient[2], -0.4, 1e-6);
}

static void schedules_are_those_of_the_paper(void **state)
{
    (void)state;
    // Ugail and Howard (2026), eq. (23), and section 6.4: halved, the rate at epoch 240 is 4.93e-5.
    learn_schedule cosine = {.kind = LEARN_COSINE, .rate = 1e-3, .warmup = 5, .epochs = 300};
    check_near(learn_schedule_rate(&cosine, 0), 2e-4, 1e-15);
    check_near(learn_schedule_rate(&cosine, 4), 1e-3, 1e-15);
    check_near(learn_schedule_rate(&cosine, 5), 1e-3, 1e-15);
    check_near(0.5 * learn_schedule_rate(&cosine, 240), 4.93e-5, 5e-8);
    assert_true(learn_schedule_rate(&cosine, 299) > 0);
    assert_true(learn_schedule_rate(&cosine, 300) == 0);
    learn_schedule constant = {.kind = LEARN_CONSTANT, .rate = 0.1, .warmup = 2};
    check_near(learn_schedule_rate(&constant, 0), 0.05, 1e-15);
    check_near(learn_schedule_rate(&constant, 1000), 0.1, 1e-15);
}

static void a_plateau_reduces_the_rate_and_then_stops(void **state)
{
    (void)state;
    learn_plateau_options options = {
        .min_gain = 0.1, .reduce_patience = 2, .reduce_factor = 0.5, .min_rate = 0.2, .stop_patience = 5};
    learn_plateau plateau = learn_plateau_begin();
    assert_true(learn_plateau_update(&plateau, &options, 0, 3));
    assert_true(learn_plateau_update(&plateau, &options, 1, 2));
    // Better than the best, but not by enough to count as a gain.
    assert_true(learn_plateau_update(&plateau, &options, 2, 1.95));
    check_near(learn_plateau_rate(&plateau, &options, 1), 1, 0);
    assert_false(learn_plateau_update(&plateau, &options, 3, NAN));
    check_near(learn_plateau_rate(&plateau, &options, 1), 0.5, 0);
    assert_false(learn_plateau_update(&plateau, &options, 4, 2.5));
    assert_false(learn_plateau_update(&plateau, &options, 5, HUGE_VAL));
    check_near(learn_plateau_rate(&plateau, &options, 1), 0.25, 0);
    assert_false(learn_plateau_stops(&plateau, &options));
    assert_false(learn_plateau_update(&plateau, &options, 6, 1.95));
    assert_true(learn_plateau_stops(&plateau, &options));
    check_near(plateau.best, 1.95, 0);
    assert_int_equal(plateau.best_epoch, 2);
    // Not below the least rate, unless the schedule itself is.
    check_near(learn_plateau_rate(&plateau, &options, 0.5), 0.2, 0);
    check_near(learn_plateau_rate(&plateau, &options, 0.1), 0.1, 0);
}

// Trainings of a small regression

/// The name of a file in a folder of this test's own.
static const char *file_in(const char *folder, const char *name, char path[200])
{
    (void)snprintf(path, 200, "%s/%s", folder, name);
    return path;
}

static int make_folder(void **state)
{
    static char folder[] = "/tmp/batten-train-XXXXXX";
    *state = mkdtemp(folder);
    return *state == NULL ? -1 : 0;
}

static int remove_folder(void **state)
{
    static const char *const names[] = {"a.safetensors", "b.safetensors", "w.safetensors"};
    char path[200];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        (void)unlink(file_in(*state, names[i], path));
    return rmdir(*state);
}

static void training_learns(void **state)
{
    (void)state;
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.epochs = options.schedule.epochs = 60;
    double before[2], after[2];
    check_status(regression_validate(&r, before, NULL), BAT_OK);
    learn_report report;
    bat_error error;
    check_status(learn_train(&job, &options, &report, &error), BAT_OK);
    check_status(regression_validate(&r, after, NULL), BAT_OK);
    assert_true(after[0] < 0.1 && after[0] < 0.2 * before[0]);
    // The weights are those of the best check.
    check_near(after[0], report.best, 1e-12);
    assert_int_equal(report.epochs, 60);
    assert_int_equal(report.steps, 60 * STEPS);
    assert_true(isfinite(report.loss));
    assert_int_equal(r.asked, 60 * STEPS);
    learn_parameters_free(&r.base.parameters);
}

static void threads_change_no_byte(void **state)
{
    (void)state;
    regression one;
    regression_begin(&one);
    learn_job job = regression_job(&one);
    learn_options options = regression_options(&one);
    options.threads = 1;
    check_status(learn_train(&job, &options, NULL, NULL), BAT_OK);
    for (int threads = 2; threads <= 3; threads++)
    {
        regression more;
        regression_begin(&more);
        learn_job again = regression_job(&more);
        options = regression_options(&more);
        options.threads = threads;
        check_status(learn_train(&again, &options, NULL, NULL), BAT_OK);
        assert_same_weights(&one, &more);
        learn_parameters_free(&more.base.parameters);
    }
    // Slots change the order of sums, so roundings, and nothing else.
    regression narrow;
    regression_begin(&narrow);
    learn_job again = regression_job(&narrow);
    options = regression_options(&narrow);
    options.slots = 1;
    check_status(learn_train(&again, &options, NULL, NULL), BAT_OK);
    for (size_t k = 0; k < one.base.parameters.total; k++)
        check_near((double)narrow.base.parameters.values[k], (double)one.base.parameters.values[k], DOUBLE ? 1e-9 : 1e-3);
    learn_parameters_free(&narrow.base.parameters);
    learn_parameters_free(&one.base.parameters);
}

/// What an observer is told.
typedef struct record
{
    uint64_t begun_at, epochs, checkpoints;
    double losses[EPOCHS], largest[EPOCHS], distances[EPOCHS];
    bool fails;
} record;

static bat_status note_begin(void *context, uint64_t step, bat_error *error)
{
    (void)error;
    ((record *)context)->begun_at = step;
    return BAT_OK;
}

static bat_status note_epoch(void *context, const learn_epoch *epoch, bat_error *error)
{
    (void)error;
    record *r = context;
    assert_true(epoch->epoch < EPOCHS && epoch->step == (epoch->epoch + 1) * STEPS);
    assert_true(epoch->rate > 0 && epoch->gradient_norm > 0 && epoch->seconds >= 0);
    r->losses[epoch->epoch] = epoch->loss;
    r->largest[epoch->epoch] = epoch->metrics[0];
    r->distances[epoch->epoch] = epoch->validation[0];
    r->epochs++;
    return r->fails ? BAT_BAD_FILE : BAT_OK;
}

static bat_status note_checkpoint(void *context, bat_error *error)
{
    (void)error;
    ((record *)context)->checkpoints++;
    return BAT_OK;
}

static learn_observer observer_of(record *r)
{
    return (learn_observer){r, note_begin, note_epoch, note_checkpoint};
}

static void assert_same_file(const char *a, const char *b)
{
    file_text x, y;
    check_status(file_text_read(a, NULL, &x, NULL), BAT_OK);
    check_status(file_text_read(b, NULL, &y, NULL), BAT_OK);
    assert_int_equal(x.size, y.size);
    assert_memory_equal(x.data, y.data, x.size);
    file_text_free(&x);
    file_text_free(&y);
}

/// A run that is stopped after so many steps, again and again, by the rule.
static void run_in_parts(regression *r, learn_options options, size_t part, learn_optimizer_options rule)
{
    bat_status status = BAT_CANCELLED;
    for (size_t runs = 0; status == BAT_CANCELLED; runs++)
    {
        learn_parameters_free(&r->base.parameters);
        regression_begin(r);
        r->stop_at = part;
        learn_job job = regression_job(r);
        options.progress.context = r;
        options.optimizer = rule;
        options.resume = true;
        bat_error error;
        status = learn_train(&job, &options, NULL, &error);
        assert_true(runs < 100);
    }
    check_status(status, BAT_OK);
}

static void a_stopped_run_goes_on_to_the_same_bytes(void **state)
{
    static const learn_optimizer_options rules[] = {
        {LEARN_ADAMW, 0.9, 0.95, 1e-8, 1e-4}, {LEARN_SGD, 0.9, 0, 0, 1e-4}, {LEARN_ADAM, 0.9, 0.999, 1e-8, 0}};
    const char *folder = *state;
    char a[200], b[200];
    for (size_t k = 0; k < 3; k++)
    {
        record told = {0}, told_in_parts = {0};
        regression whole, parts = {0};
        regression_begin(&whole);
        learn_job job = regression_job(&whole);
        learn_options options = regression_options(&whole);
        options.optimizer = rules[k];
        options.checkpoint = file_in(folder, "a.safetensors", a);
        options.observer = observer_of(&told);
        bat_error error;
        check_status(learn_train(&job, &options, NULL, &error), BAT_OK);
        assert_int_equal(told.begun_at, 0);
        assert_int_equal(told.epochs, EPOCHS);
        assert_int_equal(told.checkpoints, EPOCHS);
        for (size_t part = 3; part < 20; part += 4)
        {
            options.checkpoint = file_in(folder, "b.safetensors", b);
            options.observer = observer_of(&told_in_parts);
            told_in_parts.epochs = 0;
            (void)unlink(b);
            run_in_parts(&parts, options, part, rules[k]);
            assert_same_weights(&whole, &parts);
            assert_same_file(a, b);
            assert_int_equal(told_in_parts.epochs, EPOCHS);
            assert_memory_equal(told_in_parts.losses, told.losses, sizeof told.losses);
            assert_memory_equal(told_in_parts.largest, told.largest, sizeof told.largest);
            for (size_t e = 0; e < EPOCHS; e++)
            {
                // Every second epoch is validated, and the last one.
                assert_int_equal(isnan(told.distances[e]), e % 2 == 0 && e + 1 < EPOCHS);
                assert_true(isnan(told.distances[e]) || told.distances[e] == told_in_parts.distances[e]);
            }
        }
        learn_parameters_free(&whole.base.parameters);
        learn_parameters_free(&parts.base.parameters);
    }
}

static void checkpoints_of_other_trainings_are_refused(void **state)
{
    const char *folder = *state;
    char a[200], text[300];
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.checkpoint = file_in(folder, "a.safetensors", a);
    (void)unlink(a);
    check_status(learn_train(&job, &options, NULL, NULL), BAT_OK);
    options.resume = true;
    bat_error error;
    options.name = "another";
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    (void)snprintf(text, sizeof text, "%s: the checkpoint belongs to a training with other options, 'regression'", a);
    assert_string_equal(error.text, text);
    options.name = "regression";
    options.seed = 5;
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    (void)snprintf(text, sizeof text, "%s: the checkpoint belongs to another training: state.seed is 1, not 5", a);
    assert_string_equal(error.text, text);
    options.seed = 1;
    job.metric_count = 0;
    check_status(learn_train(&job, &options, NULL, &error), BAT_BAD_FILE);
    job.metric_count = 1;
    // A broken checkpoint is named.
    assert_int_equal(truncate(a, 1000), 0);
    check_status(learn_train(&job, &options, NULL, &error), BAT_BAD_FILE);
    assert_true(strstr(error.text, a) == error.text);
    assert_int_equal(error.status, BAT_BAD_FILE);
    learn_parameters_free(&r.base.parameters);
}

static void the_threads_of_blas_are_put_back(void **state)
{
    (void)state;
    check_status(blas_load(NULL), BAT_OK);
    int before = openblas_get_num_threads();
    blas_single_begin();
    blas_single_begin();
    blas_single_end();
    assert_int_equal(openblas_get_num_threads(), 1);
    blas_single_end();
    assert_int_equal(openblas_get_num_threads(), before);
}

static void failures_are_told(void **state)
{
    (void)state;
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    bat_error error;
    r.fails = true;
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_POINT);
    r.fails = false;
    r.base.parameters.values[0] = (real)NAN;
    check_status(learn_train(&job, &options, NULL, &error), BAT_NO_CONVERGENCE);
    assert_string_equal(error.text, "the loss or its gradient is not finite at step 0");
    job.steps = 0;
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    job.steps = STEPS;
    r.base.parameters.values[0] = 0;
    record told = {.fails = true};
    options.observer = observer_of(&told);
    check_status(learn_train(&job, &options, NULL, &error), BAT_BAD_FILE);
    assert_int_equal(told.epochs, 1);
    options.observer = (learn_observer){0};
    options.checkpoint = "/nowhere/c.safetensors";
    check_status(learn_train(&job, &options, NULL, &error), BAT_FILE_ACCESS);
    assert_true(strstr(error.text, "/nowhere/c.safetensors: ") == error.text);
    learn_parameters_free(&r.base.parameters);
}

static void early_stopping_gives_the_best_weights_back(void **state)
{
    (void)state;
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.epochs = 200;
    options.validate_every = 1;
    options.schedule = (learn_schedule){.kind = LEARN_CONSTANT, .rate = 0.02};
    options.plateau = (learn_plateau_options){.stop_patience = 4, .min_gain = 1e-3};
    learn_report report;
    check_status(learn_train(&job, &options, &report, NULL), BAT_OK);
    assert_true(report.stopped && report.epochs < 200);
    double metrics[2];
    check_status(regression_validate(&r, metrics, NULL), BAT_OK);
    check_near(metrics[0], report.best, 1e-12);
    learn_parameters_free(&r.base.parameters);
}

static void weights_go_through_a_file(void **state)
{
    char path[200];
    file_in(*state, "w.safetensors", path);
    regression r;
    regression_begin(&r);
    safetensors_note note = {"what", "a regression"};
    check_status(learn_parameters_write(&r.base.parameters, path, &note, 1, NULL), BAT_OK);
    safetensors content;
    check_status(safetensors_read(path, &content, NULL), BAT_OK);
    assert_string_equal(safetensors_find_note(&content, "what"), "a regression");
    real *values = calloc(r.base.parameters.total, sizeof *values);
    check_status(learn_parameters_extract(&r.base.parameters, &content, "", values, NULL), BAT_OK);
    assert_memory_equal(values, r.base.parameters.values, r.base.parameters.total * sizeof *values);
    bat_error error;
    r.base.parameters.list[2].rows = 2;
    check_status(learn_parameters_extract(&r.base.parameters, &content, "", values, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "array 'out.weight' has the wrong shape");
    check_status(learn_parameters_extract(&r.base.parameters, &content, "x.", values, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "there is no array 'x.in.weight'");
    free(values);
    safetensors_free(&content);
    learn_parameters_free(&r.base.parameters);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(optimizers_step_as_computed_by_hand),
        cmocka_unit_test(long_gradients_are_clipped_and_short_ones_left),
        cmocka_unit_test(schedules_are_those_of_the_paper),
        cmocka_unit_test(a_plateau_reduces_the_rate_and_then_stops),
        cmocka_unit_test(training_learns),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(a_stopped_run_goes_on_to_the_same_bytes),
        cmocka_unit_test(checkpoints_of_other_trainings_are_refused),
        cmocka_unit_test(the_threads_of_blas_are_put_back),
        cmocka_unit_test(failures_are_told),
        cmocka_unit_test(early_stopping_gives_the_best_weights_back),
        cmocka_unit_test(weights_go_through_a_file),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

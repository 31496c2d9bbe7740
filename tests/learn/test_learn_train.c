#include "check.h"

#include "io/common/file_text.h"
#include "learn/blas.h"
#include "learn/operations.h"
#include "research/train/train.h"

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
    learn_watch_options options = {
        .least_gain = 0.1, .reduce_patience = 2, .reduce_factor = 0.5, .least_rate = 0.2, .stop_patience = 5};
    learn_watch watch = learn_watch_begin();
    assert_true(learn_watch_see(&watch, &options, 0, 3));
    assert_true(learn_watch_see(&watch, &options, 1, 2));
    // Better than the best, but not by enough to count as a gain.
    assert_true(learn_watch_see(&watch, &options, 2, 1.95));
    check_near(learn_watch_rate(&watch, &options, 1), 1, 0);
    assert_false(learn_watch_see(&watch, &options, 3, NAN));
    check_near(learn_watch_rate(&watch, &options, 1), 0.5, 0);
    assert_false(learn_watch_see(&watch, &options, 4, 2.5));
    assert_false(learn_watch_see(&watch, &options, 5, HUGE_VAL));
    check_near(learn_watch_rate(&watch, &options, 1), 0.25, 0);
    assert_false(learn_watch_stops(&watch, &options));
    assert_false(learn_watch_see(&watch, &options, 6, 1.95));
    assert_true(learn_watch_stops(&watch, &options));
    check_near(watch.best, 1.95, 0);
    assert_int_equal(watch.best_epoch, 2);
    // Not below the least rate, unless the schedule itself is.
    check_near(learn_watch_rate(&watch, &options, 0.5), 0.2, 0);
    check_near(learn_watch_rate(&watch, &options, 0.1), 0.1, 0);
}

// A small regression: y = sin(3 x) by a network of one hidden layer with dropout, on points that are drawn anew for every
// piece.

enum
{
    POINTS = 16,
    HIDDEN = 24,
    STEPS = 7,
    PIECES = 6,
    EPOCHS = 5
};

typedef struct regression
{
    learn_parameters parameters;
    real offset;    ///< drawn for each epoch
    size_t stop_at; ///< the step that is not begun any more; 0: none
    size_t asked;   ///< by progress
    bool fails;
} regression;

static const char *const FIGURES[] = {"largest"};
static const char *const CHECKS[] = {"distance", "size"};

static void regression_begin(regression *r)
{
    *r = (regression){0};
    bat_random random = bat_random_seed(3);
    (void)learn_parameters_add(&r->parameters, HIDDEN, 1, "in.weight");
    (void)learn_parameters_add(&r->parameters, 0, HIDDEN, "in.bias");
    (void)learn_parameters_add(&r->parameters, 1, HIDDEN, "out.weight");
    (void)learn_parameters_add(&r->parameters, 0, 1, "out.bias");
    check_status(learn_parameters_allocate(&r->parameters, NULL), BAT_OK);
    learn_parameter_fill_normal(&r->parameters, 0, 2, &random);
    learn_parameter_fill_normal(&r->parameters, 1, 1, &random);
    learn_parameter_fill_normal(&r->parameters, 2, 0.3, &random);
}

static learn_array *regression_model(learn_tape *tape, learn_array *x)
{
    x = learn_linear(tape, x, learn_parameter_array(tape, 0), learn_parameter_array(tape, 1));
    x = learn_dropout(tape, learn_gelu(tape, x), 0.02);
    return learn_linear(tape, x, learn_parameter_array(tape, 2), learn_parameter_array(tape, 3));
}

static bat_status regression_epoch(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    (void)epoch;
    (void)error;
    ((regression *)context)->offset = (real)(0.01 * bat_random_uniform(random));
    return BAT_OK;
}

static bat_status regression_piece(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss, double *figures,
                                   bat_error *error)
{
    const regression *r = context;
    if (r->fails && piece->step == 2 && piece->index == 4)
        return error != NULL ? (error->status = BAT_INVALID_POINT) : BAT_INVALID_POINT;
    // The last piece of every third step is missing.
    if (piece->step % 3 == 2 && piece->index == PIECES - 1)
        return BAT_OK;
    learn_array *x = learn_array_make(tape, POINTS, 1, false), *y = learn_array_make(tape, POINTS, 1, false);
    if (tape->status != BAT_OK)
        return BAT_OK;
    for (size_t i = 0; i < POINTS; i++)
    {
        double at = 2 * bat_random_uniform(&piece->random) - 1;
        x->value[i] = (real)at + r->offset;
        y->value[i] = (real)sin(3 * at);
        figures[0] = fmax(figures[0], fabs(at));
    }
    *loss = learn_scale(tape, learn_mean_squared_error(tape, regression_model(tape, x), y), (real)(1.0 / PIECES));
    return BAT_OK;
}

static bat_status regression_check(void *context, uint64_t epoch, double *figures, bat_error *error)
{
    (void)epoch;
    const regression *r = context;
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, &r->parameters, NULL);
    learn_array *x = learn_array_make(&tape, 101, 1, false);
    for (size_t i = 0; i < x->rows; i++)
        x->value[i] = (real)((double)i / 50 - 1);
    const learn_array *y = regression_model(&tape, x);
    figures[0] = 0;
    for (size_t i = 0; i < x->rows; i++)
        figures[0] += fabs((double)y->value[i] - sin(3 * (double)x->value[i])) / 101;
    figures[1] = (double)r->parameters.total;
    bat_status status = learn_tape_status(&tape, error);
    learn_tape_free(&tape);
    return status;
}

static bool regression_asked(void *context, double fraction)
{
    regression *r = context;
    assert_true(fraction >= 0 && fraction < 1);
    r->asked++;
    return r->stop_at == 0 || r->asked <= r->stop_at;
}

static learn_job regression_job(regression *r)
{
    return (learn_job){.context = r,
                       .parameters = &r->parameters,
                       .steps = STEPS,
                       .pieces = PIECES,
                       .figures = FIGURES,
                       .figure_count = 1,
                       .checks = CHECKS,
                       .check_count = 2,
                       .epoch = regression_epoch,
                       .piece = regression_piece,
                       .check = regression_check};
}

static learn_options regression_options(regression *r)
{
    learn_options options = learn_options_defaults();
    options.epochs = EPOCHS;
    options.schedule = (learn_schedule){.kind = LEARN_COSINE, .rate = 0.02, .warmup = 1, .epochs = EPOCHS};
    options.watch = (learn_watch_options){.reduce_patience = 2, .reduce_factor = 0.5, .least_rate = 1e-6};
    options.clip = 0.5;
    options.check_every = 2;
    options.name = "regression";
    options.threads = 2;
    options.progress = (bat_progress){regression_asked, r};
    return options;
}

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
    static const char *const names[] = {"a.safetensors", "b.safetensors", "a.csv", "b.csv", "a.svg", "w.safetensors"};
    char path[200];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        (void)unlink(file_in(*state, names[i], path));
    return rmdir(*state);
}

static void assert_same_weights(const regression *a, const regression *b)
{
    assert_memory_equal(a->parameters.values, b->parameters.values, a->parameters.total * sizeof(real));
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
    check_status(regression_check(&r, 0, before, NULL), BAT_OK);
    learn_report report;
    bat_error error;
    check_status(learn_train(&job, &options, &report, &error), BAT_OK);
    check_status(regression_check(&r, 0, after, NULL), BAT_OK);
    assert_true(after[0] < 0.1 && after[0] < 0.2 * before[0]);
    // The weights are those of the best check.
    check_near(after[0], report.best, 1e-12);
    assert_int_equal(report.epochs, 60);
    assert_int_equal(report.steps, 60 * STEPS);
    assert_true(isfinite(report.loss));
    assert_int_equal(r.asked, 60 * STEPS);
    learn_parameters_free(&r.parameters);
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
        learn_parameters_free(&more.parameters);
    }
    // Slots change the order of sums, so roundings, and nothing else.
    regression narrow;
    regression_begin(&narrow);
    learn_job again = regression_job(&narrow);
    options = regression_options(&narrow);
    options.slots = 1;
    check_status(learn_train(&again, &options, NULL, NULL), BAT_OK);
    for (size_t k = 0; k < one.parameters.total; k++)
        check_near((double)narrow.parameters.values[k], (double)one.parameters.values[k], DOUBLE ? 1e-9 : 1e-3);
    learn_parameters_free(&narrow.parameters);
    learn_parameters_free(&one.parameters);
}

/// Two files alike, but for the last column of every line: the seconds.
static void assert_same_log(const char *a, const char *b)
{
    file_text x, y;
    check_status(file_text_read(a, &x, NULL), BAT_OK);
    check_status(file_text_read(b, &y, NULL), BAT_OK);
    text_line p = text_line_start(&x), q = text_line_start(&y);
    size_t lines = 0;
    while (text_line_next(&x, &p))
    {
        assert_true(text_line_next(&y, &q));
        const char *end = p.end, *other = q.end;
        while (end[-1] != ',')
            end--;
        while (other[-1] != ',')
            other--;
        assert_int_equal(end - p.begin, other - q.begin);
        assert_memory_equal(p.begin, q.begin, (size_t)(end - p.begin));
        lines++;
    }
    assert_false(text_line_next(&y, &q));
    assert_int_equal(lines, 1 + EPOCHS);
    file_text_free(&x);
    file_text_free(&y);
}

static void assert_same_file(const char *a, const char *b)
{
    file_text x, y;
    check_status(file_text_read(a, &x, NULL), BAT_OK);
    check_status(file_text_read(b, &y, NULL), BAT_OK);
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
        learn_parameters_free(&r->parameters);
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
    char a[200], b[200], a_log[200], b_log[200], chart[200];
    for (size_t k = 0; k < 3; k++)
    {
        regression whole, parts = {0};
        regression_begin(&whole);
        learn_job job = regression_job(&whole);
        learn_options options = regression_options(&whole);
        options.optimizer = rules[k];
        options.checkpoint = file_in(folder, "a.safetensors", a);
        options.log = file_in(folder, "a.csv", a_log);
        options.chart = file_in(folder, "a.svg", chart);
        bat_error error;
        check_status(learn_train(&job, &options, NULL, &error), BAT_OK);
        assert_int_equal(access(chart, R_OK), 0);
        for (size_t part = 3; part < 20; part += 4)
        {
            options.checkpoint = file_in(folder, "b.safetensors", b);
            options.log = file_in(folder, "b.csv", b_log);
            options.chart = NULL;
            (void)unlink(b);
            run_in_parts(&parts, options, part, rules[k]);
            assert_same_weights(&whole, &parts);
            assert_same_file(a, b);
            assert_same_log(a_log, b_log);
        }
        learn_parameters_free(&whole.parameters);
        learn_parameters_free(&parts.parameters);
    }
}

/// What a crash leaves: a log that is ahead of the checkpoint, and its last line half written.
static void a_log_ahead_of_its_checkpoint_is_shortened(void **state)
{
    const char *folder = *state;
    char a[200], b[200], a_log[200], b_log[200];
    regression whole, crashed;
    regression_begin(&whole);
    learn_job job = regression_job(&whole);
    learn_options options = regression_options(&whole);
    options.checkpoint = file_in(folder, "a.safetensors", a);
    options.log = file_in(folder, "a.csv", a_log);
    check_status(learn_train(&job, &options, NULL, NULL), BAT_OK);

    regression_begin(&crashed);
    crashed.stop_at = 2 * STEPS + 1;
    job = regression_job(&crashed);
    options.progress.context = &crashed;
    options.checkpoint = file_in(folder, "b.safetensors", b);
    options.log = file_in(folder, "b.csv", b_log);
    (void)unlink(b);
    bat_error error;
    check_status(learn_train(&job, &options, NULL, &error), BAT_CANCELLED);
    FILE *stream = fopen(b_log, "a");
    assert_non_null(stream);
    (void)fprintf(stream, "2,21,1,1,1,1,,,1\n3,28,0.1");
    assert_int_equal(fclose(stream), 0);
    crashed.stop_at = 0;
    options.resume = true;
    check_status(learn_train(&job, &options, NULL, &error), BAT_OK);
    assert_same_weights(&whole, &crashed);
    assert_same_log(a_log, b_log);
    learn_parameters_free(&whole.parameters);
    learn_parameters_free(&crashed.parameters);
}

static void checkpoints_of_other_trainings_are_refused(void **state)
{
    const char *folder = *state;
    char a[200], log[200];
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.checkpoint = file_in(folder, "a.safetensors", a);
    options.log = file_in(folder, "a.csv", log);
    (void)unlink(a);
    check_status(learn_train(&job, &options, NULL, NULL), BAT_OK);
    options.resume = true;
    bat_error error;
    options.name = "another";
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "the checkpoint is of another recipe, 'regression'");
    options.name = "regression";
    options.seed = 5;
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "the checkpoint is of another training: state.seed is 1, not 5");
    options.seed = 1;
    job.figure_count = 0;
    check_status(learn_train(&job, &options, NULL, &error), BAT_BAD_FILE);
    job.figure_count = 1;
    (void)truncate(a, 1000);
    check_status(learn_train(&job, &options, NULL, &error), BAT_BAD_FILE);
    learn_parameters_free(&r.parameters);
}

static void the_threads_of_blas_are_put_back(void **state)
{
    (void)state;
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
    r.parameters.values[0] = (real)NAN;
    check_status(learn_train(&job, &options, NULL, &error), BAT_NO_CONVERGENCE);
    assert_string_equal(error.text, "the loss or its gradient is not finite at step 0");
    job.steps = 0;
    check_status(learn_train(&job, &options, NULL, &error), BAT_INVALID_ARGUMENT);
    job.steps = STEPS;
    options.log = "/nowhere/log.csv";
    check_status(learn_train(&job, &options, NULL, &error), BAT_FILE_ACCESS);
    learn_parameters_free(&r.parameters);
}

static void early_stopping_gives_the_best_weights_back(void **state)
{
    (void)state;
    regression r;
    regression_begin(&r);
    learn_job job = regression_job(&r);
    learn_options options = regression_options(&r);
    options.epochs = 200;
    options.check_every = 1;
    options.schedule = (learn_schedule){.kind = LEARN_CONSTANT, .rate = 0.02};
    options.watch = (learn_watch_options){.stop_patience = 4, .least_gain = 1e-3};
    learn_report report;
    check_status(learn_train(&job, &options, &report, NULL), BAT_OK);
    assert_true(report.stopped && report.epochs < 200);
    double figures[2];
    check_status(regression_check(&r, 0, figures, NULL), BAT_OK);
    check_near(figures[0], report.best, 1e-12);
    learn_parameters_free(&r.parameters);
}

static void weights_go_through_a_file(void **state)
{
    char path[200];
    file_in(*state, "w.safetensors", path);
    regression r;
    regression_begin(&r);
    safetensors_note note = {"what", "a regression"};
    check_status(learn_parameters_write(&r.parameters, path, &note, 1, NULL), BAT_OK);
    safetensors content;
    check_status(safetensors_read(path, &content, NULL), BAT_OK);
    assert_string_equal(safetensors_find_note(&content, "what"), "a regression");
    real *values = calloc(r.parameters.total, sizeof *values);
    check_status(learn_parameters_extract(&r.parameters, &content, "", values, NULL), BAT_OK);
    assert_memory_equal(values, r.parameters.values, r.parameters.total * sizeof *values);
    bat_error error;
    r.parameters.list[2].rows = 2;
    check_status(learn_parameters_extract(&r.parameters, &content, "", values, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "array 'out.weight' has the wrong shape");
    check_status(learn_parameters_extract(&r.parameters, &content, "x.", values, &error), BAT_BAD_FILE);
    assert_string_equal(error.text, "there is no array 'x.in.weight'");
    free(values);
    safetensors_free(&content);
    learn_parameters_free(&r.parameters);
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
        cmocka_unit_test(a_log_ahead_of_its_checkpoint_is_shortened),
        cmocka_unit_test(checkpoints_of_other_trainings_are_refused),
        cmocka_unit_test(the_threads_of_blas_are_put_back),
        cmocka_unit_test(failures_are_told),
        cmocka_unit_test(early_stopping_gives_the_best_weights_back),
        cmocka_unit_test(weights_go_through_a_file),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

#ifndef TESTS_SUPPORT_REGRESSION_HELPERS_H
#define TESTS_SUPPORT_REGRESSION_HELPERS_H

#include "check.h"

#include "research/learn/operations.h"
#include "research/learn/parameters.h"
#include "research/train/run.h"

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
    train_context base;
    real offset;    ///< drawn for each epoch
    size_t stop_at; ///< the step that is not begun any more; 0: none
    size_t asked;   ///< by progress
    bool fails;
} regression;

static const char *const METRICS[] = {"largest"};
static const char *const VALIDATION[] = {"distance", "size"};

static inline void regression_begin(regression *r)
{
    *r = (regression){0};
    bat_random random = bat_random_seed(3);
    (void)learn_parameters_add(&r->base.parameters, HIDDEN, 1, "in.weight");
    (void)learn_parameters_add(&r->base.parameters, 0, HIDDEN, "in.bias");
    (void)learn_parameters_add(&r->base.parameters, 1, HIDDEN, "out.weight");
    (void)learn_parameters_add(&r->base.parameters, 0, 1, "out.bias");
    check_status(learn_parameters_allocate(&r->base.parameters, NULL), BAT_OK);
    learn_parameter_fill_normal(&r->base.parameters, 0, 2, &random);
    learn_parameter_fill_normal(&r->base.parameters, 1, 1, &random);
    learn_parameter_fill_normal(&r->base.parameters, 2, 0.3, &random);
}

static inline learn_array *regression_model(learn_tape *tape, learn_array *x)
{
    x = learn_linear(tape, x, learn_parameter_array(tape, 0), learn_parameter_array(tape, 1));
    x = learn_dropout(tape, learn_gelu(tape, x), 0.02);
    return learn_linear(tape, x, learn_parameter_array(tape, 2), learn_parameter_array(tape, 3));
}

static inline bat_status regression_prepare(void *context, uint64_t epoch, bat_random *random, bat_error *error)
{
    (void)epoch;
    (void)error;
    ((regression *)context)->offset = (real)(0.01 * bat_random_uniform(random));
    return BAT_OK;
}

static inline bat_status regression_piece(void *context, learn_piece *piece, learn_tape *tape, learn_array **loss,
                                          double *metrics, bat_error *error)
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
        metrics[0] = fmax(metrics[0], fabs(at));
    }
    *loss = learn_scale(tape, learn_mean_squared_error(tape, regression_model(tape, x), y), (real)(1.0 / PIECES));
    return BAT_OK;
}

static inline bat_status regression_validate(void *context, double *metrics, bat_error *error)
{
    const regression *r = context;
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, &r->base.parameters, NULL);
    learn_array *x = learn_array_make(&tape, 101, 1, false);
    for (size_t i = 0; i < x->rows; i++)
        x->value[i] = (real)((double)i / 50 - 1);
    const learn_array *y = regression_model(&tape, x);
    metrics[0] = 0;
    for (size_t i = 0; i < x->rows; i++)
        metrics[0] += fabs((double)y->value[i] - sin(3 * (double)x->value[i])) / 101;
    metrics[1] = (double)r->base.parameters.total;
    bat_status status = learn_tape_status(&tape, error);
    learn_tape_free(&tape);
    return status;
}

static inline bool regression_asked(void *context, double fraction)
{
    regression *r = context;
    assert_true(fraction >= 0 && fraction < 1);
    r->asked++;
    return r->stop_at == 0 || r->asked <= r->stop_at;
}

static inline learn_job regression_job(regression *r)
{
    return (learn_job){.context = r,
                       .parameters = &r->base.parameters,
                       .steps = STEPS,
                       .pieces = PIECES,
                       .metric_count = 1,
                       .validation_count = 2,
                       .prepare_epoch = regression_prepare,
                       .piece_loss = regression_piece,
                       .validate = regression_validate};
}

static inline learn_options regression_options(regression *r)
{
    learn_options options = learn_options_defaults();
    options.epochs = EPOCHS;
    options.schedule = (learn_schedule){.kind = LEARN_COSINE, .rate = 0.02, .warmup = 1, .epochs = EPOCHS};
    options.plateau = (learn_plateau_options){.reduce_patience = 2, .reduce_factor = 0.5, .min_rate = 1e-6};
    options.clip = 0.5;
    options.validate_every = 2;
    options.name = "regression";
    options.threads = 2;
    options.progress = (bat_progress){regression_asked, r};
    return options;
}

static inline void assert_same_weights(const regression *a, const regression *b)
{
    assert_memory_equal(a->base.parameters.values, b->base.parameters.values, a->base.parameters.total * sizeof(real));
}

#endif

#include "research/learn/optimizer.h"

#include "base/error.h"
#include "base/memory.h"
#include "research/learn/functions.h"

#include <stdlib.h>

static const double PI = 3.14159265358979323846;

static real *make_zeros(size_t count)
{
    real *zeros = memory_array(count, sizeof *zeros);
    if (zeros != NULL)
        memset(zeros, 0, count * sizeof *zeros);
    return zeros;
}

bat_status learn_optimizer_make(const learn_optimizer_options *options, size_t count, learn_optimizer *optimizer,
                                bat_error *error)
{
    bool adam = options->rule != LEARN_SGD;
    if (!(options->momentum >= 0 && options->momentum < 1) || (adam && !(options->second >= 0 && options->second < 1)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "an optimizer's momentum and second moment must be at least 0 and below 1");
    if (!(options->decay >= 0) || (adam && !(options->epsilon >= 0)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "an optimizer's epsilon and decay cannot be negative");
    *optimizer = (learn_optimizer){.options = *options, .count = count};
    optimizer->mean = make_zeros(count);
    optimizer->squares = adam ? make_zeros(count) : NULL;
    if (optimizer->mean != NULL && (!adam || optimizer->squares != NULL))
        return BAT_OK;
    learn_optimizer_free(optimizer);
    return error_memory(error, 2 * count * sizeof(real));
}

void learn_optimizer_free(learn_optimizer *optimizer)
{
    free(optimizer->mean);
    free(optimizer->squares);
    *optimizer = (learn_optimizer){0};
}

LANES_CLONES
static void sgd_step(size_t count, real rate, real momentum, real decay, const real *restrict gradient,
                     real *restrict direction, real *restrict values)
{
    for (size_t i = 0; i < count; i++)
    {
        direction[i] = momentum * direction[i] + (gradient[i] + decay * values[i]);
        values[i] -= rate * direction[i];
    }
}

/// Numbers of a step of Adam that all weights share.
typedef struct adam_numbers
{
    real first, second, epsilon;
    real keep;         ///< the factor of the weight itself, by AdamW's decay
    real coupled;      ///< Adam's decay
    real rate;         ///< over the correction of the mean
    real square_scale; ///< one over the root of the correction of the squares
} adam_numbers;

LANES_CLONES
static void adam_step(size_t count, const adam_numbers *numbers, const real *restrict gradient, real *restrict mean,
                      real *restrict squares, real *restrict values)
{
    adam_numbers n = *numbers;
    for (size_t i = 0; i < count; i++)
    {
        real g = gradient[i] + n.coupled * values[i];
        real m = n.first * mean[i] + (1 - n.first) * g;
        real s = n.second * squares[i] + (1 - n.second) * g * g;
        mean[i] = m;
        squares[i] = s;
        values[i] = n.keep * values[i] - n.rate * m / (real_sqrt(s) * n.square_scale + n.epsilon);
    }
}

void learn_optimizer_step(learn_optimizer *optimizer, double rate, const real *gradient, real *values)
{
    learn_optimizer_options o = optimizer->options;
    optimizer->steps++;
    if (o.rule == LEARN_SGD)
    {
        sgd_step(optimizer->count, (real)rate, (real)o.momentum, (real)o.decay, gradient, optimizer->mean, values);
        return;
    }
    double steps = (double)optimizer->steps;
    bool decoupled = o.rule == LEARN_ADAMW;
    adam_numbers numbers = {
        .first = (real)o.momentum,
        .second = (real)o.second,
        .epsilon = (real)o.epsilon,
        .keep = decoupled ? (real)(1 - rate * o.decay) : 1,
        .coupled = decoupled ? 0 : (real)o.decay,
        .rate = (real)(rate / (1 - pow(o.momentum, steps))),
        .square_scale = (real)(1 / sqrt(1 - pow(o.second, steps))),
    };
    adam_step(optimizer->count, &numbers, gradient, optimizer->mean, optimizer->squares, values);
}

LANES_CLONES
static double sum_of_squares(size_t count, const real *x)
{
    double squares = 0;
#pragma omp simd reduction(+ : squares)
    for (size_t i = 0; i < count; i++)
        squares += (double)x[i] * (double)x[i];
    return squares;
}

double learn_clip_norm(size_t count, real *gradient, double limit)
{
    double norm = sqrt(sum_of_squares(count, gradient));
    // PyTorch adds the 1e-6.
    double factor = limit / (norm + 1e-6);
    if (factor < 1)
        for (size_t i = 0; i < count; i++)
            gradient[i] *= (real)factor;
    return norm;
}

// Learning rates

double learn_schedule_rate(const learn_schedule *schedule, uint64_t epoch)
{
    if (epoch < schedule->warmup)
        return schedule->rate * (double)(epoch + 1) / (double)schedule->warmup;
    if (schedule->kind == LEARN_CONSTANT)
        return schedule->rate;
    if (epoch >= schedule->epochs)
        return 0;
    double share = (double)(epoch - schedule->warmup) / (double)(schedule->epochs - schedule->warmup);
    return schedule->rate * 0.5 * (1 + cos(PI * share));
}

learn_plateau learn_plateau_begin(void)
{
    return (learn_plateau){.best = HUGE_VAL, .reference = HUGE_VAL, .scale = 1};
}

bool learn_plateau_update(learn_plateau *plateau, const learn_plateau_options *options, uint64_t epoch, double value)
{
    bool gain = isfinite(value) && value < plateau->reference && value <= plateau->reference - options->min_gain;
    plateau->checks_since_gain = gain ? 0 : plateau->checks_since_gain + 1;
    plateau->checks_since_change = gain ? 0 : plateau->checks_since_change + 1;
    if (gain)
        plateau->reference = value;
    if (options->reduce_patience > 0 && plateau->checks_since_change >= options->reduce_patience)
    {
        plateau->scale *= options->reduce_factor;
        plateau->checks_since_change = 0;
    }
    if (!isfinite(value) || value >= plateau->best)
        return false;
    plateau->best = value;
    plateau->best_epoch = epoch;
    return true;
}

double learn_plateau_rate(const learn_plateau *plateau, const learn_plateau_options *options, double scheduled)
{
    double rate = plateau->scale * scheduled;
    return rate >= options->min_rate ? rate : fmin(scheduled, options->min_rate);
}

bool learn_plateau_stops(const learn_plateau *plateau, const learn_plateau_options *options)
{
    return options->stop_patience > 0 && plateau->checks_since_gain >= options->stop_patience;
}

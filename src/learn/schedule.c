#include "learn/schedule.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

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

learn_watch learn_watch_begin(void)
{
    return (learn_watch){.best = HUGE_VAL, .reference = HUGE_VAL, .scale = 1};
}

bool learn_watch_see(learn_watch *watch, const learn_watch_options *options, uint64_t epoch, double figure)
{
    bool gain = isfinite(figure) && figure < watch->reference && figure <= watch->reference - options->least_gain;
    watch->checks_since_gain = gain ? 0 : watch->checks_since_gain + 1;
    watch->checks_since_change = gain ? 0 : watch->checks_since_change + 1;
    if (gain)
        watch->reference = figure;
    if (options->reduce_patience > 0 && watch->checks_since_change >= options->reduce_patience)
    {
        watch->scale *= options->reduce_factor;
        watch->checks_since_change = 0;
    }
    if (!isfinite(figure) || figure >= watch->best)
        return false;
    watch->best = figure;
    watch->best_epoch = epoch;
    return true;
}

double learn_watch_rate(const learn_watch *watch, const learn_watch_options *options, double scheduled)
{
    double rate = watch->scale * scheduled;
    return rate >= options->least_rate ? rate : fmin(scheduled, options->least_rate);
}

bool learn_watch_stops(const learn_watch *watch, const learn_watch_options *options)
{
    return options->stop_patience > 0 && watch->checks_since_gain >= options->stop_patience;
}

#include "batten/motion_hermite.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/number_digits.h"
#include "motion/hermite_average.h"

#include <math.h>
#include <string.h>

/// The step of the differences that give velocities, as a share of the interval: the error of the formula, some units of its
/// fourth power over 30, and rounding over the step, 1e-16 / step, are then about the same.
static const double DIFFERENCE_STEP = 1.0 / 256;
/// The last sample of a rate may be this share of a step late.
static const double RATE_TOLERANCE = 1e-9;

/// One interval between two points, with the cubic's inner control vectors: velocities times a third of its duration.
typedef struct interval
{
    const bat_space *space;
    const double *p0, *v0, *p1, *v1;
    double u0[BAT_SPACE_MAX_DIM], u1[BAT_SPACE_MAX_DIM];
    double begin, length;
} interval;

/// The interval and share of a time on a curve.
static double time_of(const bat_hermite_curve *curve, size_t index)
{
    if (index < curve->count)
        return curve->times != NULL ? curve->times[index] : (double)index;
    return curve->times != NULL ? curve->times[curve->count - 1] + curve->closing_time : (double)curve->count;
}

static size_t interval_count(const bat_hermite_curve *curve)
{
    return curve->closed ? curve->count : curve->count - 1;
}

/// The time within the first period of a closed curve.
static double wrapped(const bat_hermite_curve *curve, double time)
{
    double begin = time_of(curve, 0), period = time_of(curve, curve->count) - begin;
    double since = fmod(time - begin, period);
    return begin + (since < 0 ? since + period : since);
}

/// The interval that contains a time: the later one at a given point, but the last one at the end.
static size_t find_interval(const bat_hermite_curve *curve, double time)
{
    size_t low = 0, high = interval_count(curve);
    while (high - low > 1)
    {
        size_t middle = low + (high - low) / 2;
        if (time_of(curve, middle) <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void open_interval(const bat_hermite_curve *curve, size_t index, interval *span)
{
    const bat_space *space = curve->space;
    size_t next = index + 1 == curve->count ? 0 : index + 1;
    *span = (interval){
        .space = space,
        .p0 = curve->points + index * space->point_dim,
        .v0 = curve->tangents + index * space->tangent_dim,
        .p1 = curve->points + next * space->point_dim,
        .v1 = curve->tangents + next * space->tangent_dim,
        .begin = time_of(curve, index),
    };
    span->length = time_of(curve, index + 1) - span->begin;
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        span->u0[i] = span->length / 3 * span->v0[i];
        span->u1[i] = span->length / 3 * span->v1[i];
    }
}

/// Whether the geodesic from p with velocity u is the shortest to its end: else the cubic would not have this velocity.
/// Lengths in a product may be greater than its injectivity radius.
static bool is_within(const bat_space *space, const double *p, const double *u)
{
    double end[BAT_SPACE_MAX_DIM], log[BAT_SPACE_MAX_DIM], half = space->injectivity / 2;
    if (space->inner(space, p, u, u) < space->injectivity * space->injectivity)
        return true;
    if (space->exp(space, p, u, end) != BAT_OK || space->log(space, p, end, log) != BAT_OK)
        return false;
    for (size_t i = 0; i < space->tangent_dim; i++)
        log[i] -= u[i];
    return space->inner(space, p, log, log) < half * half;
}

static bat_status check_interval(const interval *span, size_t index, bat_error *error)
{
    const bat_space *space = span->space;
    char digits[NUMBER_DIGITS_SIZE];
    bool first = is_within(space, span->p0, span->u0);
    if (first && is_within(space, span->p1, span->u1))
        return BAT_OK;
    return error_set(error, BAT_CUT_LOCUS, index, 0,
                     "there is no point at time %zu: a third of the interval from %s on at the velocity of its %s leads "
                     "past the cut locus; add keys, or make a spline",
                     index, number_digits(span->begin, digits), first ? "end" : "beginning");
}

/// The cubic at a share of its interval.
static bat_status point_at(const interval *span, double share, double *point)
{
    double before[BAT_SPACE_MAX_DIM], after[BAT_SPACE_MAX_DIM];
    bat_status status =
        hermite_cubic_ends(span->space, span->p0, span->u0, span->p1, span->u1, share, HERMITE_LEGS_WITHIN, before, after);
    return status == BAT_OK ? bat_space_geodesic(span->space, before, after, share, point) : status;
}

/// (8 (f(d) - f(-d)) - (f(2 d) - f(-2 d))) / 12 d of the logarithms f at the point.
static bat_status velocity_at(const interval *span, double share, const double *point, double *velocity)
{
    static const double steps[4] = {-2, -1, 1, 2}, weights[4] = {1, -8, 8, -1};
    const bat_space *space = span->space;
    double near[BAT_SPACE_MAX_DIM], log[BAT_SPACE_MAX_DIM], scale = 1 / (12 * DIFFERENCE_STEP * span->length);
    memset(velocity, 0, space->tangent_dim * sizeof *velocity);
    for (int k = 0; k < 4; k++)
    {
        bat_status status = point_at(span, share + steps[k] * DIFFERENCE_STEP, near);
        if (status == BAT_OK)
            status = space->log(space, point, near, log);
        if (status != BAT_OK)
            return status;
        for (size_t i = 0; i < space->tangent_dim; i++)
            velocity[i] += scale * weights[k] * log[i];
    }
    return BAT_OK;
}

/// The given points and velocities are returned bit for bit.
static bat_status sample_interval(const interval *span, double time, double *point, double *velocity)
{
    size_t point_size = span->space->point_dim * sizeof *point, tangent_size = span->space->tangent_dim * sizeof *point;
    double share = (time - span->begin) / span->length;
    if (share == 0 || share == 1)
    {
        memcpy(point, share == 0 ? span->p0 : span->p1, point_size);
        if (velocity != NULL)
            memcpy(velocity, share == 0 ? span->v0 : span->v1, tangent_size);
        return BAT_OK;
    }
    bat_status status = point_at(span, share, point);
    return status == BAT_OK && velocity != NULL ? velocity_at(span, share, point, velocity) : status;
}

static bat_status check_sample_time(const bat_hermite_curve *curve, double time, size_t index, bat_error *error)
{
    double begin = time_of(curve, 0), end = time_of(curve, curve->count - 1);
    if (!isfinite(time) || (!curve->closed && !(time >= begin && time <= end)))
    {
        char digits[3][NUMBER_DIGITS_SIZE];
        return error_set(error, BAT_INVALID_ARGUMENT, index, 0, "time %zu, %s, is not within those of the curve, %s to %s",
                         index, number_digits(time, digits[0]), number_digits(begin, digits[1]),
                         number_digits(end, digits[2]));
    }
    return BAT_OK;
}

bat_status bat_hermite_sample(const bat_hermite_curve *curve, const double *times, size_t count, double *points,
                              double *velocities, bat_error *error)
{
    const bat_space *space = curve->space;
    bat_status status = hermite_check(curve, (hermite_check_parts){0}, 1, error);
    if (status == BAT_OK)
        status = hermite_check_velocities(curve, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        status = check_sample_time(curve, times[i], i, error);
        if (status != BAT_OK)
            break;
        double time = curve->closed ? wrapped(curve, times[i]) : times[i];
        interval span;
        open_interval(curve, find_interval(curve, time), &span);
        status = check_interval(&span, i, error);
        if (status != BAT_OK)
            break;
        status = sample_interval(&span, time, points + i * space->point_dim,
                                 velocities != NULL ? velocities + i * space->tangent_dim : NULL);
        char digits[NUMBER_DIGITS_SIZE];
        if (status != BAT_OK)
            (void)error_set(error, status, i, 0, "there is no point at time %zu, %s (%s)", i,
                            number_digits(times[i], digits), bat_status_name(status));
    }
    return status;
}

static bat_status count_samples(const bat_hermite_curve *curve, double rate, size_t *count, bat_error *error)
{
    double duration = time_of(curve, interval_count(curve)) - time_of(curve, 0), steps = duration * rate;
    if (!(rate > 0 && isfinite(rate)))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the rate must be positive, not %g", rate);
    if (!(steps < (double)BAT_MAX_POINTS))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%.15g samples are too many; a lower rate makes fewer",
                         steps);
    *count = curve->closed ? (size_t)ceil(steps - RATE_TOLERANCE) : (size_t)floor(steps + RATE_TOLERANCE) + 1;
    *count = *count == 0 ? 1 : *count;
    return BAT_OK;
}

bat_status bat_hermite_sample_rate(const bat_hermite_curve *curve, double rate, bat_hermite_curve *sampled, bat_error *error)
{
    const bat_space *space = curve->space;
    bat_hermite_curve result = {.space = space, .closed = curve->closed, .kind = BAT_HERMITE_TANGENTS_VELOCITIES};
    bat_status status = hermite_check(curve, (hermite_check_parts){0}, 1, error);
    if (status == BAT_OK)
        status = hermite_check_velocities(curve, error);
    if (status == BAT_OK)
        status = count_samples(curve, rate, &result.count, error);
    if (status != BAT_OK)
        return status;
    result.points = memory_array(result.count, space->point_dim * sizeof *result.points);
    result.tangents = memory_array(result.count, space->tangent_dim * sizeof *result.tangents);
    result.times = memory_array(result.count, sizeof *result.times);
    if (result.points == NULL || result.tangents == NULL || result.times == NULL)
        status = error_set(error, BAT_NO_MEMORY, BAT_NO_INDEX, 0, "out of memory for %zu points", result.count);
    double begin = time_of(curve, 0), end = time_of(curve, interval_count(curve));
    for (size_t i = 0; i < result.count && status == BAT_OK; i++)
        result.times[i] = fmin(begin + (double)i / rate, end);
    if (status == BAT_OK)
        status = bat_hermite_sample(curve, result.times, result.count, result.points, result.tangents, error);
    if (status != BAT_OK)
    {
        bat_hermite_free(&result);
        return status;
    }
    result.closing_time = curve->closed ? end - result.times[result.count - 1] : 0;
    *sampled = result;
    return BAT_OK;
}

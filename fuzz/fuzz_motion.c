#include "byte_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum
{
    MAX_KEYS = 16,
    SAMPLES = 5
};

/// Keyframes with times that mostly increase.
static bat_hermite_curve take_keys(byte_reader *reader, const bat_space *space)
{
    bat_hermite_curve keys = {.space = space, .count = take_below(reader, MAX_KEYS + 1)};
    unsigned flags = take_byte(reader);
    keys.closed = (flags & 1) != 0;
    keys.points = take_points(reader, space, keys.count);
    keys.tangents = take_coordinates(reader, keys.count * space->tangent_dim);
    keys.kind = (bat_hermite_tangents)take_choice(reader, 4);
    keys.closing_time = take_option(reader, 0, 4);
    if ((flags & 2) == 0)
        return keys;
    keys.times = take_coordinates(reader, keys.count);
    for (size_t i = 1; i < keys.count && (flags & 12) != 0; i++)
        keys.times[i] = keys.times[i - 1] + fabs(keys.times[i]);
    return keys;
}

static bat_motion_spline_options take_options(byte_reader *reader)
{
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.threads = 1;
    options.ends = (bat_motion_ends)take_choice(reader, 4);
    options.shape = (bat_motion_shape)take_choice(reader, 4);
    options.extrapolate = take_flag(reader);
    if (take_byte(reader) < 128)
        return options;
    options.sigma = take_flag(reader) ? BAT_MOTION_SIGMA_AUTO : take_option(reader, 0, 2);
    options.angle_sigma = take_option(reader, 0, 1);
    options.outliers = (bat_motion_outliers)take_choice(reader, 3);
    if (take_flag(reader))
        options.max_speed = take_option(reader, 0, 2);
    if (take_flag(reader))
        options.max_acceleration = take_option(reader, 0, 2);
    return options;
}

/// Sample a spline within its times and at any.
static void sample(const bat_motion_spline *spline, byte_reader *reader)
{
    bat_motion_keys keys = bat_motion_spline_keys(spline);
    const bat_space *space = keys.space;
    double times[SAMPLES], *values = calloc(SAMPLES, (space->point_dim + 3 * space->tangent_dim) * sizeof *values);
    PROMISE(values != NULL);
    double *velocities = values + SAMPLES * space->point_dim, *rest = velocities + SAMPLES * space->tangent_dim;
    for (size_t i = 0; i < SAMPLES; i++)
    {
        double share = (double)take_byte(reader) / 255;
        times[i] = share > 0.99 ? take_coordinate(reader) : keys.begin + share * (keys.end - keys.begin);
    }
    if (bat_motion_spline_sample(spline, times, SAMPLES, values, velocities, rest, NULL) == BAT_OK)
    {
        promise_points(space, values, SAMPLES);
        PROMISE(bat_motion_spline_at(spline, times[0], rest, NULL, NULL, NULL) == BAT_OK);
    }
    (void)bat_motion_spline_uncertainty(spline, times, SAMPLES, rest, NULL);
    free(values);
}

static void refine(const bat_hermite_curve *keys, byte_reader *reader)
{
    bat_hermite_refine_options options = bat_hermite_refine_defaults();
    options.order = take_below(reader, 12);
    options.levels = take_below(reader, 5);
    options.threads = 1;
    bat_hermite_curve fine = {0};
    if (bat_hermite_refine(keys, &options, &fine, NULL) == BAT_OK)
        promise_points(keys->space, fine.points, fine.count);
    bat_hermite_free(&fine);
}

/// Splines and Hermite schemes give points of their space, or a failure.
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    byte_reader reader = {data, size};
    bat_space space = take_space(&reader);
    bat_motion_spline_options options = take_options(&reader);
    bat_hermite_curve keys = take_keys(&reader, &space);
    bat_motion_spline *spline = NULL;
    unsigned what = take_byte(&reader);
    if ((what & 1) != 0 && keys.count > 0 && bat_hermite_estimate_tangents(&keys, (what & 2) != 0 ? 4 : 2, NULL) == BAT_OK)
        promise_finite(keys.tangents, keys.count * space.tangent_dim);
    if ((what & 4) != 0)
        (void)bat_hermite_normalize(&keys, NULL);
    bat_error error = {0};
    if (bat_motion_spline_make(&keys, &options, &spline, &error) == BAT_OK)
        sample(spline, &reader);
    PROMISE(error.status != BAT_NO_MEMORY);
    bat_motion_spline_free(spline);
    refine(&keys, &reader);
    bat_hermite_free(&keys);
    return 0;
}

// Gyroscopes: rotations of noisy keys fused with rates of a bias and noise, against the motion that they come from.

#include "check.h"

#include "batten/motion_spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    KEYS = 61,
    RATES = 6001,
    AT = 2000
};

static const double BIAS[3] = {0.03, -0.07, 0.12}, SPAN = 60;

/// The rotation vector of a motion that shakes between the keys, and its angular velocity in the body's frame.
static void truth_at(double t, double *quaternion, double *rate)
{
    const bat_space rotation = bat_rotation();
    double ends[2][4], log[3], step = 1e-5;
    for (int side = 0; side < 2; side++)
    {
        double s = t + (side == 0 ? -step : step);
        const double v[] = {0.8 * sin(0.5 * s) + 0.1 * sin(9 * s), 0.6 * cos(0.7 * s) + 0.1 * sin(11 * s + 1),
                            0.9 * sin(0.3 * s + 1) + 0.08 * cos(8 * s)};
        check_status(bat_rotation_from_vector(v, ends[side], NULL), BAT_OK);
    }
    check_status(bat_space_geodesic(&rotation, ends[0], ends[1], 0.5, quaternion), BAT_OK);
    check_status(rotation.log(&rotation, ends[0], ends[1], log), BAT_OK);
    for (int c = 0; c < 3; c++)
        rate[c] = log[c] / (2 * step);
}

typedef struct recording
{
    double times[KEYS], poses[7 * KEYS], rotations[4 * KEYS], rate_times[RATES], rates[3 * RATES];
    bat_motion_gyro gyro;
} recording;

static recording *record(double noise, double rate_noise, uint64_t seed)
{
    const bat_space rotation = bat_rotation();
    recording *made = calloc(1, sizeof *made);
    bat_random random = bat_random_seed(seed);
    double rate[3], error[3];
    assert_non_null(made);
    for (size_t i = 0; i < KEYS; i++)
    {
        double quaternion[4];
        made->times[i] = SPAN * (double)i / (KEYS - 1) + (i % 2 == 1 ? 0.2 : 0);
        truth_at(made->times[i], quaternion, rate);
        for (int c = 0; c < 3; c++)
        {
            error[c] = noise / sqrt(3) * bat_random_normal(&random);
            made->poses[7 * i + (size_t)c] = sin(made->times[i] + c) + 0.01 * bat_random_normal(&random);
        }
        check_status(rotation.exp(&rotation, quaternion, error, made->rotations + 4 * i), BAT_OK);
        memcpy(made->poses + 7 * i + 3, made->rotations + 4 * i, 4 * sizeof(double));
    }
    for (size_t i = 0; i < RATES; i++)
    {
        double quaternion[4];
        made->rate_times[i] = -0.005 + 1.0003 * SPAN * (double)i / (RATES - 1);
        truth_at(made->rate_times[i], quaternion, made->rates + 3 * i);
        for (size_t c = 0; c < 3; c++)
            made->rates[3 * i + c] += BIAS[c] + rate_noise * bat_random_normal(&random);
    }
    made->gyro = (bat_motion_gyro){made->rate_times, made->rates, RATES};
    return made;
}

/// The root mean square error of rotations, and how much of them lies in the intervals of 95 %.
static double error_of(const bat_motion_spline *spline, size_t at, double *coverage)
{
    const bat_space rotation = bat_rotation();
    double squares = 0, inside = 0;
    for (size_t i = 0; i < AT; i++)
    {
        double time = SPAN * ((double)i + 0.5) / AT, truth[4], rate[3], point[7], deviations[6], log[3];
        truth_at(time, truth, rate);
        check_status(bat_motion_spline_at(spline, time, point, NULL, NULL, NULL), BAT_OK);
        check_status(bat_motion_spline_uncertainty(spline, &time, 1, deviations, NULL), BAT_OK);
        check_status(rotation.log(&rotation, point + at, truth, log), BAT_OK);
        for (size_t c = 0; c < 3; c++)
        {
            squares += log[c] * log[c] / AT;
            inside += fabs(log[c]) <= 1.96 * deviations[at + c] ? 1.0 / (3 * AT) : 0;
        }
    }
    *coverage = inside;
    return sqrt(squares);
}

static void rates_and_keys_tell_more_than_either(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation(), rigid;
    check_status(bat_rigid(1, &rigid, NULL), BAT_OK);
    double covered = 0;
    for (uint64_t seed = 1; seed <= 8; seed++)
    {
        recording *given = record(0.05, 0.02, seed);
        bat_hermite_curve keys = {.space = &rotation, .points = given->rotations, .times = given->times, .count = KEYS};
        bat_motion_spline_options options = bat_motion_spline_defaults();
        bat_motion_spline *spline = NULL, *alone = NULL;
        bat_error error;
        options.sigma = seed % 2 == 0 ? BAT_MOTION_SIGMA_AUTO : 0.05;
        check_status(bat_motion_spline_make(&keys, &options, &alone, &error), BAT_OK);
        options.gyro = &given->gyro;
        if (bat_motion_spline_make(&keys, &options, &spline, &error) != BAT_OK)
            fail_msg("%s", error.text);
        double coverage, with = error_of(spline, 0, &coverage), without = error_of(alone, 0, &(double){0});
        bat_motion_keys made = bat_motion_spline_keys(spline);
        covered += coverage / 8;
        if (!(with < 0.2 * without) || !(with < 0.025))
            fail_msg("seed %zu: errors %g with rates, %g without", (size_t)seed, with, without);
        for (int c = 0; c < 3; c++)
        {
            check_near(made.gyro.bias[c], BIAS[c], 4.5 * made.gyro.bias_sigma[c]);
            assert_true(made.gyro.bias_sigma[c] < 2e-3);
        }
        check_near(made.gyro.sigma, 0.05, seed % 2 == 0 ? 0.015 : 1e-12);
        assert_true(made.gyro.walk > 0.0015 && made.gyro.walk < 0.006); // 0.002
        bat_motion_spline_free(spline);
        // Poses have the same rotations, and translations through their keys.
        keys = (bat_hermite_curve){.space = &rigid, .points = given->poses, .times = given->times, .count = KEYS};
        options.angle_sigma = options.sigma;
        options.sigma = 0;
        check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_OK);
        check_near(error_of(spline, 3, &(double){0}), with, 1e-9);
        double pose[7];
        check_status(bat_motion_spline_at(spline, given->times[7], pose, NULL, NULL, NULL), BAT_OK);
        check_near(pose[1], given->poses[50], 1e-12);
        bat_motion_spline_free(spline);
        bat_motion_spline_free(alone);
        free(given);
    }
    if (!(covered > 0.91 && covered < 0.985))
        fail_msg("coverage %g", covered);
}

static void exact_rates_leave_no_error(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    recording *given = record(0, 0, 1);
    bat_hermite_curve keys = {.space = &rotation, .points = given->rotations, .times = given->times, .count = KEYS};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.gyro = &given->gyro;
    bat_motion_spline *spline = NULL;
    check_status(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_OK);
    assert_true(error_of(spline, 0, &(double){0}) < 2e-4);
    bat_motion_spline_free(spline);
    free(given);
}

static void bad_rates_are_refused(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation(), plane = bat_euclidean(2);
    recording *given = record(0.05, 0.02, 1);
    bat_hermite_curve keys = {.space = &rotation, .points = given->rotations, .times = given->times, .count = KEYS};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_motion_spline *spline = NULL;
    bat_error error;
    options.gyro = &given->gyro;
    given->gyro.count = RATES / 2;
    check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "do not cover"));
    given->gyro.count = RATES;
    given->rates[30] = NAN;
    check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 10);
    given->rates[30] = 0;
    keys.count = 5;
    check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_UNSUPPORTED);
    keys = (bat_hermite_curve){.space = &plane, .points = given->rotations, .times = given->times, .count = KEYS};
    check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    free(given);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_and_keys_tell_more_than_either),
        cmocka_unit_test(exact_rates_leave_no_error),
        cmocka_unit_test(bad_rates_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

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
    made->gyro = (bat_motion_gyro){.times = made->rate_times, .rates = made->rates, .count = RATES};
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

/// Rates with two axes exchanged, with other signs or in degrees contradict the turns of the keys.
static void contradictions_are_refused(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    for (int kind = 0; kind < 3; kind++)
    {
        recording *given = record(0.01, 0.02, 1);
        bat_hermite_curve keys = {.space = &rotation, .points = given->rotations, .times = given->times, .count = KEYS};
        bat_motion_spline_options options = bat_motion_spline_defaults();
        bat_motion_spline *spline = NULL;
        bat_error error;
        for (double *r = given->rates; r < given->rates + 3 * RATES; r += 3)
        {
            const double x = r[0];
            r[0] = kind == 0 ? r[1] : kind == 1 ? -x : 57.3 * x;
            r[1] = kind == 0 ? x : kind == 1 ? -r[1] : 57.3 * r[1];
            r[2] *= kind == 0 ? 1 : kind == 1 ? -1 : 57.3;
        }
        options.gyro = &given->gyro;
        check_status(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_NO_CONVERGENCE);
        assert_non_null(strstr(error.text, "contradict"));
        free(given);
    }
}

static void place_at_time(double t, double *place, double *acceleration)
{
    for (int c = 0; c < 3; c++)
    {
        double w = 1.1 + 0.3 * c;
        place[c] = sin(w * t + c) + 0.3 * sin(2.7 * t - c);
        if (acceleration != NULL)
            acceleration[c] = -w * w * sin(w * t + c) - 0.3 * 2.7 * 2.7 * sin(2.7 * t - c);
    }
}

/// The noise of the keys' translations.
typedef struct noise_of_places
{
    double size, sigma; ///< of each number; what the spline is told
    uint64_t seed;
} noise_of_places;

/// The error of the translations of a spline through every `step`th key with a gyroscope.
/// @param noise   null: none
/// @param covered receives the share of the numbers within the intervals of 95 %
static double error_of_places(const recording *given, const bat_space *rigid, size_t step, const noise_of_places *noise,
                              double *covered, bat_motion_force_report *report)
{
    double times[KEYS], poses[7 * KEYS], point[7], place[3], deviations[6], squares = 0;
    bat_random random = bat_random_seed(noise != NULL ? noise->seed : 0);
    *covered = 0;
    bat_hermite_curve keys = {.space = rigid, .points = poses, .times = times};
    for (size_t i = 0; i < KEYS; i += step, keys.count++)
    {
        times[keys.count] = given->times[i];
        memcpy(poses + 7 * keys.count, given->poses + 7 * i, 7 * sizeof *poses);
        place_at_time(given->times[i], poses + 7 * keys.count, NULL);
        for (size_t c = 0; c < 3; c++)
            poses[7 * keys.count + c] += (noise != NULL ? noise->size : 0) * bat_random_normal(&random);
    }
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_motion_spline *spline = NULL;
    bat_error error;
    options.gyro = &given->gyro;
    options.sigma = noise != NULL ? noise->sigma : 0;
    if (bat_motion_spline_make(&keys, &options, &spline, &error) != BAT_OK)
        fail_msg("%s", error.text);
    *report = bat_motion_spline_keys(spline).force;
    for (size_t i = 0; i < AT; i++)
    {
        double time = SPAN * ((double)i + 0.5) / AT;
        check_status(bat_motion_spline_at(spline, time, point, NULL, NULL, NULL), BAT_OK);
        check_status(bat_motion_spline_uncertainty(spline, &time, 1, deviations, NULL), BAT_OK);
        place_at_time(time, place, NULL);
        for (int c = 0; c < 3; c++)
        {
            squares += (point[c] - place[c]) * (point[c] - place[c]) / AT;
            *covered += fabs(point[c] - place[c]) <= 1.96 * deviations[c] ? 1.0 / (3 * AT) : 0;
        }
    }
    bat_motion_spline_free(spline);
    return sqrt(squares);
}

// An accelerometer tells the way between keys, its bias and gravity; in another unit it tells nothing, and the report says
// so.
static void forces_tell_the_way_between_keys(void **state)
{
    (void)state;
    static const double GRAVITY[3] = {0.3, -0.2, -9.8}, OFF[3] = {0.2, -0.15, 0.1};
    bat_space rigid;
    check_status(bat_rigid(1, &rigid, NULL), BAT_OK);
    recording *given = record(0, 0.002, 3);
    double *forces = calloc(RATES, 3 * sizeof *forces);
    bat_random random = bat_random_seed(5);
    assert_non_null(forces);
    for (size_t i = 0; i < RATES; i++)
    {
        double quaternion[4], matrix[9], rate[3], place[3], pull[3];
        truth_at(given->rate_times[i], quaternion, rate);
        place_at_time(given->rate_times[i], place, pull);
        bat_rotation_to_matrix(quaternion, matrix);
        for (size_t c = 0; c < 3; c++)
        {
            forces[3 * i + c] = OFF[c] + 0.05 * bat_random_normal(&random);
            for (size_t r = 0; r < 3; r++)
                forces[3 * i + c] += matrix[3 * r + c] * (pull[r] - GRAVITY[r]);
        }
    }
    bat_motion_force_report report;
    double covered;
    double without = error_of_places(given, &rigid, 2, NULL, &covered, &report);
    assert_true(report.noise == 0 && !report.used);
    given->gyro.forces = forces;
    double with = error_of_places(given, &rigid, 2, NULL, &covered, &report);
    print_message("errors %.3g, %.3g with forces, which explain %.4f\n", without, with, report.explained);
    assert_true(report.used && report.explained > 0.95 && with < 0.05 * without);
    for (size_t c = 0; c < 3; c++)
    {
        assert_true(fabs(report.bias[c] - OFF[c]) < 4 * report.bias_sigma[c]);
        assert_true(fabs(report.gravity[c] - GRAVITY[c]) < 0.05);
    }
    enum
    {
        SEEDS = 8
    };
    for (int told = 0; told < 2; told++)
    {
        double error = 0, all = 0, sigma = told ? 0.03 * sqrt(3) : BAT_MOTION_SIGMA_AUTO;
        for (uint64_t seed = 0; seed < SEEDS; seed++, all += covered / SEEDS)
            error += error_of_places(given, &rigid, 1, &(noise_of_places){0.03, sigma, seed}, &covered, &report) / SEEDS;
        print_message("noise .03, %s: error %.3g, %.3f within 95 %%\n", told ? "told" : "found", error, all);
        assert_true(report.used && error < 0.025 && all > 0.9 && all < 0.98);
    }
    for (size_t i = 0; i < (size_t)3 * RATES; i++)
        forces[i] /= 9.81;
    double again = error_of_places(given, &rigid, 2, NULL, &covered, &report);
    assert_true(!report.used && report.explained < 0.5 && again == without);
    forces[7] = NAN;
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_motion_spline *spline = NULL;
    options.gyro = &given->gyro;
    bat_hermite_curve keys = {.space = &rigid, .points = given->poses, .times = given->times, .count = KEYS};
    check_status(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_INVALID_ARGUMENT);
    free(forces);
    free(given);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_and_keys_tell_more_than_either),
        cmocka_unit_test(exact_rates_leave_no_error),
        cmocka_unit_test(bad_rates_are_refused),
        cmocka_unit_test(contradictions_are_refused),
        cmocka_unit_test(forces_tell_the_way_between_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

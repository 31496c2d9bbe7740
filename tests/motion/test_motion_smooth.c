// Smoothed motions: what stays, how much noise goes, outliers, and what is refused.

#include "check.h"

#include "batten/motion.h"
#include "batten/space.h"
#include "motion/spline_system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    KEYS = 150
};

/// Keys of a rigid motion with noise, and the truth.
typedef struct noisy_motion
{
    bat_space space;
    double truth[7 * KEYS], points[7 * KEYS], times[KEYS];
} noisy_motion;

static double next_uniform(uint64_t *state)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return (double)(*state >> 11) / 9007199254740992.0;
}

/// A normal variate by twelve uniform ones.
static double next_normal(uint64_t *state)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += next_uniform(state);
    return sum;
}

/// `straight`: constant velocity.
static noisy_motion make_motion(double noise, double angle_noise, bool straight)
{
    noisy_motion m = {0};
    assert_int_equal(bat_rigid(1, &m.space, NULL), BAT_OK);
    const double rate[3] = {0.3, -0.2, 0.5}, identity[7] = {0, 0, 0, 1, 0, 0, 0};
    uint64_t state = 7;
    for (size_t i = 0; i < KEYS; i++)
    {
        double t = 0.05 * ((double)i + (i % 3 == 1 ? 0.3 : 0)), vector[6], error[6];
        m.times[i] = t;
        for (int k = 0; k < 3; k++)
        {
            vector[k] = straight ? rate[k] * t : sin(t + k) + 0.2 * cos(2 * t);
            vector[3 + k] = straight ? rate[k] * t : 0.6 * sin(0.8 * t + 2 * k);
            error[k] = noise / sqrt(3) * next_normal(&state);
            error[3 + k] = angle_noise / sqrt(3) * next_normal(&state);
        }
        assert_int_equal(m.space.exp(&m.space, identity, vector, m.truth + 7 * i), BAT_OK);
        assert_int_equal(m.space.exp(&m.space, m.truth + 7 * i, error, m.points + 7 * i), BAT_OK);
    }
    return m;
}

static bat_hermite_curve keys_of(noisy_motion *m)
{
    return (bat_hermite_curve){.space = &m->space, .points = m->points, .times = m->times, .count = KEYS};
}

static bat_motion_spline *must_make(noisy_motion *m, const bat_motion_spline_options *options)
{
    bat_hermite_curve keys = keys_of(m);
    bat_motion_spline *spline;
    bat_error error = {0};
    if (bat_motion_spline_make(&keys, options, &spline, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return spline;
}

static bat_motion_spline_options smoothing(double sigma, double angle_sigma, bat_motion_outliers outliers)
{
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.sigma = sigma;
    options.angle_sigma = angle_sigma;
    options.outliers = outliers;
    return options;
}

/// Root mean square distances of the keys' times from points: translation and rotation.
static void distances(const noisy_motion *m, const bat_motion_spline *spline, const double *points, double rms[2])
{
    bat_space rotation = bat_rotation();
    rms[0] = rms[1] = 0;
    for (size_t i = 0; i < KEYS; i++)
    {
        double at[7];
        assert_int_equal(bat_motion_spline_at(spline, m->times[i], at, NULL, NULL, NULL), BAT_OK);
        for (int k = 0; k < 3; k++)
            rms[0] += (at[k] - points[7 * i + (size_t)k]) * (at[k] - points[7 * i + (size_t)k]) / KEYS;
        double turn = rotation.distance(&rotation, at + 3, points + 7 * i + 3);
        rms[1] += turn * turn / KEYS;
    }
    rms[0] = sqrt(rms[0]);
    rms[1] = sqrt(rms[1]);
}

/// With a noise that is known, or found, it falls to less than half, and the stated deviations are right.
static void noise_falls(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0.02, 0.01, false);
    for (int found = 0; found < 2; found++)
    {
        const double automatic = BAT_MOTION_SIGMA_AUTO;
        bat_motion_spline_options options =
            smoothing(found ? automatic : 0.02, found ? automatic : 0.01, BAT_MOTION_OUTLIERS_NONE);
        bat_motion_spline *spline = must_make(&m, &options);
        bat_motion_keys keys = bat_motion_spline_keys(spline);
        double rms[2], stated[2] = {0};
        distances(&m, spline, m.truth, rms);
        assert_true(rms[0] < 0.5 * 0.02);
        assert_true(rms[1] < 0.5 * 0.01);
        assert_true(fabs(keys.sigma / 0.02 - 1) < (found ? 0.1 : 1e-15));
        assert_true(fabs(keys.angle_sigma / 0.01 - 1) < (found ? 0.1 : 1e-15));
        for (size_t i = 0; i < 6 * KEYS; i++)
            stated[i % 6 / 3] += keys.uncertainties[i] * keys.uncertainties[i] / KEYS;
        // A noise that is found is uncertain itself.
        assert_true(fabs(sqrt(stated[0]) / rms[0] - (found ? 1.3 : 1)) < 0.3);
        assert_true(fabs(sqrt(stated[1]) / rms[1] - (found ? 1.3 : 1)) < 0.3);
        bat_motion_spline_free(spline);
    }
}

/// Few keys a wave tell little of their noise. The stated deviations hold all the same.
static void unknown_noise_is_covered(void **state)
{
    enum
    {
        FEW = 30,
        CURVES = 60
    };
    (void)state;
    bat_space line = bat_euclidean(1);
    bat_random random = bat_random_seed(5);
    size_t covered = 0;
    for (int curve = 0; curve < CURVES; curve++)
    {
        double times[FEW], truth[FEW], points[FEW];
        const double phase = bat_random_uniform(&random), wave = 8 + 12 * bat_random_uniform(&random);
        for (size_t i = 0; i < FEW; i++)
        {
            times[i] = (double)i;
            truth[i] = sin(6.283 * ((double)i / wave + phase)) + 0.5 * cos(6.283 * (double)i / (2.3 * wave));
            points[i] = truth[i] + 0.03 * bat_random_normal(&random);
        }
        bat_hermite_curve keys = {.space = &line, .points = points, .times = times, .count = FEW};
        bat_motion_spline_options options = smoothing(BAT_MOTION_SIGMA_AUTO, 0, BAT_MOTION_OUTLIERS_NONE);
        bat_motion_spline *spline;
        double made[FEW], deviations[FEW];
        check_status(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_OK);
        check_status(bat_motion_spline_sample(spline, times, FEW, made, NULL, NULL, NULL), BAT_OK);
        check_status(bat_motion_spline_uncertainty(spline, times, FEW, deviations, NULL), BAT_OK);
        for (size_t i = 0; i < FEW; i++)
            covered += fabs(made[i] - truth[i]) < 1.96 * deviations[i];
        bat_motion_spline_free(spline);
    }
    print_message("covered %.3f\n", (double)covered / (FEW * CURVES));
    assert_in_range(covered, 0.85 * FEW * CURVES, 0.99 * FEW * CURVES);
}

/// Straight motions have weights at the end of the range. The noise falls as a line's, to about 1 / sqrt(keys) of it.
static void straight_motions_have_deviations(void **state)
{
    enum
    {
        MANY = 200
    };
    (void)state;
    bat_space plane = bat_euclidean(2);
    for (uint64_t seed = 0; seed < 12; seed++)
    {
        double times[MANY], points[2 * MANY], deviations[2 * MANY];
        bat_random random = bat_random_seed(seed);
        for (size_t i = 0; i < MANY; i++)
        {
            times[i] = (double)i;
            points[2 * i] = 0.1 * (double)i + 0.1 * bat_random_normal(&random);
            points[2 * i + 1] = 0.02 * (double)i + 0.1 * bat_random_normal(&random);
        }
        bat_hermite_curve keys = {.space = &plane, .points = points, .times = times, .count = MANY};
        bat_motion_spline_options options =
            smoothing(BAT_MOTION_SIGMA_AUTO, 0, seed % 2 == 0 ? BAT_MOTION_OUTLIERS_NONE : BAT_MOTION_OUTLIERS_HUBER);
        bat_motion_spline *spline;
        check_status(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_OK);
        check_status(bat_motion_spline_uncertainty(spline, times, MANY, deviations, NULL), BAT_OK);
        for (size_t i = 0; i < 2 * MANY; i++)
            assert_true(deviations[i] > 0.003 && deviations[i] < 0.09);
        bat_motion_spline_free(spline);
    }
}

static void sigma_0_interpolates(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0.02, 0.01, false);
    bat_motion_spline_options options = smoothing(0, 0, BAT_MOTION_OUTLIERS_NONE), half = smoothing(0.02, 0, 0);
    bat_motion_spline *plain = must_make(&m, NULL), *none = must_make(&m, &options), *moved = must_make(&m, &half);
    for (int i = 0; i < 100; i++)
    {
        double p[7], q[7], r[7], t = 0.07 * i;
        assert_int_equal(bat_motion_spline_at(plain, t, p, NULL, NULL, NULL), BAT_OK);
        assert_int_equal(bat_motion_spline_at(none, t, q, NULL, NULL, NULL), BAT_OK);
        assert_int_equal(bat_motion_spline_at(moved, t, r, NULL, NULL, NULL), BAT_OK);
        assert_memory_equal(p, q, sizeof p);
        assert_memory_equal(p + 3, r + 3, 4 * sizeof *p);
        assert_true(p[0] != r[0]);
    }
    bat_motion_spline_free(plain);
    bat_motion_spline_free(none);
    bat_motion_spline_free(moved);
}

/// Few keys, and those without noise, stay where they are where the noise is to be found.
static void exact_keys_stay(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0, 0, false);
    const double automatic = BAT_MOTION_SIGMA_AUTO;
    bat_motion_spline_options options = smoothing(automatic, automatic, BAT_MOTION_OUTLIERS_NONE);
    bat_motion_spline *spline = must_make(&m, &options), *few;
    double rms[2], at[7];
    distances(&m, spline, m.truth, rms);
    assert_true(rms[0] < 1e-5 && rms[1] < 1e-5);
    bat_hermite_curve keys = keys_of(&m);
    keys.count = 11;
    assert_int_equal(bat_motion_spline_make(&keys, &options, &few, NULL), BAT_OK);
    assert_true(bat_motion_spline_keys(few).sigma == 0);
    assert_int_equal(bat_motion_spline_at(few, m.times[5], at, NULL, NULL, NULL), BAT_OK);
    assert_memory_equal(at, m.points + 35, 3 * sizeof *at);
    bat_motion_spline_free(spline);
    bat_motion_spline_free(few);
}

static void constant_velocity_stays(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0, 0, true);
    bat_motion_spline_options options = smoothing(0.1, 0.1, BAT_MOTION_OUTLIERS_NONE);
    bat_motion_spline *spline = must_make(&m, &options);
    double rms[2];
    distances(&m, spline, m.truth, rms);
    assert_true(rms[0] < 1e-9 && rms[1] < 1e-9);
    bat_motion_spline_free(spline);
}

static void outliers_are_ignored(void **state)
{
    (void)state;
    noisy_motion clean = make_motion(0.02, 0.01, false), m = clean;
    for (size_t i = 5; i < KEYS; i += 15)
    {
        double error[6] = {2, -1, 0.5, 0.8, 0.3, -0.5};
        assert_int_equal(m.space.exp(&m.space, clean.points + 7 * i, error, m.points + 7 * i), BAT_OK);
    }
    double kept[2], huber[2], tukey[2], found[2];
    const bat_motion_outliers rules[] = {BAT_MOTION_OUTLIERS_NONE, BAT_MOTION_OUTLIERS_HUBER, BAT_MOTION_OUTLIERS_TUKEY,
                                         BAT_MOTION_OUTLIERS_TUKEY};
    double *results[] = {kept, huber, tukey, found};
    for (int i = 0; i < 4; i++)
    {
        const double automatic = BAT_MOTION_SIGMA_AUTO;
        bat_motion_spline_options options = smoothing(i < 3 ? 0.02 : automatic, i < 3 ? 0.01 : automatic, rules[i]);
        bat_motion_spline *spline = must_make(&m, &options);
        distances(&m, spline, m.truth, results[i]);
        const double *deviations = bat_motion_spline_keys(spline).deviations;
        for (size_t k = 0; k < KEYS && rules[i] == BAT_MOTION_OUTLIERS_TUKEY; k++)
            assert_true((deviations[k] > motion_outliers_threshold(rules[i])) == (k % 15 == 5));
        bat_motion_spline_free(spline);
    }
    print_message("%g %g  %g %g  %g %g\n", kept[0], kept[1], huber[0], huber[1], tukey[0], tukey[1]);
    assert_true(kept[0] > 0.1 && kept[1] > 0.05);
    assert_true(huber[0] < 0.2 * kept[0] && huber[1] < 0.2 * kept[1]);
    assert_true(tukey[0] < 0.6 * 0.02 && tukey[1] < 0.6 * 0.01);
    assert_true(found[0] < 0.6 * 0.02 && found[1] < 0.6 * 0.01);
}

/// Another fixed frame moves the motion with it.
static void left_multiplication_commutes(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0.02, 0.01, false), turned = m;
    const double g[4] = {0.5, -0.5, 0.5, 0.5};
    for (size_t i = 0; i < KEYS; i++)
    {
        const double *q = m.points + 7 * i + 3;
        double *r = turned.points + 7 * i + 3;
        r[0] = g[0] * q[0] - g[1] * q[1] - g[2] * q[2] - g[3] * q[3];
        r[1] = g[0] * q[1] + g[1] * q[0] + g[2] * q[3] - g[3] * q[2];
        r[2] = g[0] * q[2] - g[1] * q[3] + g[2] * q[0] + g[3] * q[1];
        r[3] = g[0] * q[3] + g[1] * q[2] - g[2] * q[1] + g[3] * q[0];
    }
    bat_motion_spline_options options = smoothing(0, 0.01, BAT_MOTION_OUTLIERS_HUBER);
    bat_motion_spline *a = must_make(&m, &options), *b = must_make(&turned, &options);
    for (int i = 0; i < 70; i++)
    {
        double p[7], q[7], v[6], w[6], t = 0.1 * i, same = 0;
        assert_int_equal(bat_motion_spline_at(a, t, p, v, NULL, NULL), BAT_OK);
        assert_int_equal(bat_motion_spline_at(b, t, q, w, NULL, NULL), BAT_OK);
        double r[4] = {
            g[0] * p[3] - g[1] * p[4] - g[2] * p[5] - g[3] * p[6], g[0] * p[4] + g[1] * p[3] + g[2] * p[6] - g[3] * p[5],
            g[0] * p[5] - g[1] * p[6] + g[2] * p[3] + g[3] * p[4], g[0] * p[6] + g[1] * p[5] - g[2] * p[4] + g[3] * p[3]};
        for (int k = 0; k < 4; k++)
            same += r[k] * q[3 + k];
        assert_true(fabs(fabs(same) - 1) < 1e-12);
        for (int k = 3; k < 6; k++)
            assert_true(fabs(v[k] - w[k]) < 1e-7);
    }
    bat_motion_spline_free(a);
    bat_motion_spline_free(b);
}

/// Reinsch's spline minimizes the sum of squares plus the weighted penalty: no other weight or shift is nearer at equal
/// penalty. Here its condition: residuals are orthogonal to lines.
static void residuals_are_orthogonal_to_lines(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0.02, 0.01, false);
    bat_motion_spline_options options = smoothing(0.02, 0, BAT_MOTION_OUTLIERS_NONE);
    bat_motion_spline *spline = must_make(&m, &options);
    double sum = 0, moment = 0, at[7], a[6];
    for (size_t i = 0; i < KEYS; i++)
    {
        assert_int_equal(bat_motion_spline_at(spline, m.times[i], at, NULL, NULL, NULL), BAT_OK);
        sum += at[0] - m.points[7 * i];
        moment += m.times[i] * (at[0] - m.points[7 * i]);
    }
    assert_true(fabs(sum) < 1e-9 && fabs(moment) < 1e-9);
    assert_int_equal(bat_motion_spline_at(spline, m.times[0], at, NULL, a, NULL), BAT_OK);
    assert_true(fabs(a[0]) < 1e-9); // natural ends
    bat_motion_spline_free(spline);
}

static void others_are_refused(void **state)
{
    (void)state;
    noisy_motion m = make_motion(0.02, 0.01, false);
    bat_hermite_curve keys = keys_of(&m);
    bat_motion_spline *spline = NULL;
    bat_error error;
    bat_motion_spline_options options = smoothing(0.1, 0, BAT_MOTION_OUTLIERS_NONE);
    double tangents[6 * KEYS] = {0};
    keys.tangents = tangents;
    assert_int_equal(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_UNSUPPORTED);
    keys.tangents = NULL;
    keys.closed = true;
    keys.closing_time = 1;
    assert_int_equal(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_UNSUPPORTED);
    bat_space sphere = bat_sphere(2);
    double points[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    bat_hermite_curve round = {.space = &sphere, .points = points, .count = 3};
    assert_int_equal(bat_motion_spline_make(&round, &options, &spline, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "sphere"));
    options = smoothing(0, 0.1, BAT_MOTION_OUTLIERS_NONE);
    assert_int_equal(bat_motion_spline_make(&round, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    options = smoothing(0, 0, BAT_MOTION_OUTLIERS_HUBER);
    assert_int_equal(bat_options_check(&bat_motion_spline_fields, &options, &error), BAT_INVALID_ARGUMENT);
    options = smoothing(-0.5, 0, BAT_MOTION_OUTLIERS_NONE);
    assert_int_equal(bat_options_check(&bat_motion_spline_fields, &options, &error), BAT_INVALID_ARGUMENT);
    assert_null(spline);
}

/// Between keys at random times a smoothed motion is about the smooth spline: the rule for gaps, of exact keys, spoils it.
static void gaps_of_random_times_stay_smooth(void **state)
{
    (void)state;
    double errors[2] = {0};
    for (uint64_t seed = 1; seed <= 8; seed++)
    {
        bat_space line = bat_euclidean(1);
        double points[KEYS], times[KEYS] = {0};
        uint64_t random = seed;
        for (size_t i = 0; i < KEYS; i++)
        {
            times[i] = i > 0 ? times[i - 1] - 0.3 * log(1 - next_uniform(&random)) : 0;
            points[i] = sin(times[i]) + 0.01 * next_normal(&random);
        }
        bat_hermite_curve keys = {.space = &line, .points = points, .times = times, .count = KEYS};
        for (int smooth = 0; smooth < 2; smooth++)
        {
            bat_motion_spline_options options = smoothing(0.01, 0, BAT_MOTION_OUTLIERS_NONE);
            options.shape = smooth ? BAT_MOTION_SHAPE_SMOOTH : options.shape;
            bat_motion_spline *spline;
            assert_int_equal(bat_motion_spline_make(&keys, &options, &spline, NULL), BAT_OK);
            for (size_t i = 0; i < 1000; i++)
            {
                double time = times[KEYS - 1] * (double)i / 1000, at;
                assert_int_equal(bat_motion_spline_at(spline, time, &at, NULL, NULL, NULL), BAT_OK);
                errors[smooth] += pow(at - sin(time), 2) / 8000;
            }
            bat_motion_spline_free(spline);
        }
    }
    if (!(errors[0] <= 1.05 * errors[1]) || !(sqrt(errors[0]) < 0.02))
        fail_msg("errors %g, %g", sqrt(errors[0]), sqrt(errors[1]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_falls),
        cmocka_unit_test(unknown_noise_is_covered),
        cmocka_unit_test(straight_motions_have_deviations),
        cmocka_unit_test(sigma_0_interpolates),
        cmocka_unit_test(constant_velocity_stays),
        cmocka_unit_test(gaps_of_random_times_stay_smooth),
        cmocka_unit_test(exact_keys_stay),
        cmocka_unit_test(outliers_are_ignored),
        cmocka_unit_test(left_multiplication_commutes),
        cmocka_unit_test(residuals_are_orthogonal_to_lines),
        cmocka_unit_test(others_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

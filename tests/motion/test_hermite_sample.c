// Curves through keyframes at uneven times, and tangents estimated from points.

#include "hermite_helpers.h"

/// Parameters from 0.3 on, around a whole period or over half of one, with long and short gaps in turn.
static void uneven_parameters(size_t count, bool closed, double *parameters)
{
    double edges = (double)(closed ? count : count - 1), mean = (closed ? 2 * PI : PI) / edges;
    for (size_t i = 0; i < count; i++)
        parameters[i] = 0.3 + mean * ((double)i + (i % 2 == 1 ? 0.4 : 0));
}

static bat_hermite_curve uneven_samples(const study_curve *curve, size_t count, bool closed)
{
    double parameters[1024];
    bat_hermite_curve samples;
    uneven_parameters(count, closed, parameters);
    check_status(study_curve_sample(curve, parameters, count, closed, &samples, NULL), BAT_OK);
    return samples;
}

/// The largest distances of 7 samples an interval from the curve at their times, and of their velocities from its own.
static void sampling_errors(const study_curve *curve, size_t count, bool closed, double *points, double *velocities)
{
    const bat_space *space = curve->space;
    bat_hermite_curve keys = uneven_samples(curve, count, closed);
    *points = *velocities = 0;
    for (size_t i = 0; i + 1 < count; i++)
        for (int k = 1; k < 8; k++)
        {
            double time = keys.times[i] + (keys.times[i + 1] - keys.times[i]) * k / 8.0, p[DIM], v[DIM], at[DIM], moved[DIM],
                   goal[DIM];
            check_status(bat_hermite_sample(&keys, &time, 1, p, v, NULL), BAT_OK);
            check_status(study_curve_point(curve, time, at), BAT_OK);
            check_status(study_curve_velocity(curve, time, at, goal), BAT_OK);
            check_status(space->transport(space, p, at, v, moved), BAT_OK);
            *points = fmax(*points, space->distance(space, p, at));
            *velocities = fmax(*velocities, gap(space, at, moved, goal));
        }
    bat_hermite_free(&keys);
}

static void samples_are_of_fourth_order(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 2 * SPACES; trial++)
    {
        bool closed = trial >= SPACES;
        study_curve curve = smooth_curve(&spaces[trial % SPACES], trial);
        double points[2], velocities[2];
        sampling_errors(&curve, closed ? 64 : 49, closed, &points[0], &velocities[0]);
        sampling_errors(&curve, closed ? 128 : 97, closed, &points[1], &velocities[1]);
        if (log2(points[0] / points[1]) < 3.9 || log2(velocities[0] / velocities[1]) < 2.9)
            fail_msg("%s: points off by %g and %g, velocities by %g and %g", curve.space->name, points[0], points[1],
                     velocities[0], velocities[1]);
        study_curve_free(&curve);
    }
}

/// Keyframes come back bit for bit at their times; from both sides of one the velocity is the given one.
static void keyframes_are_met_with_their_velocities(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 2 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        study_curve curve = smooth_curve(space, trial);
        bat_hermite_curve keys = uneven_samples(&curve, 8, trial >= SPACES);
        double p[DIM], v[DIM], way[DIM];
        for (size_t i = 0; i < keys.count; i++)
        {
            const double *key = keys.points + i * space->point_dim, *velocity = keys.tangents + i * space->tangent_dim;
            check_status(bat_hermite_sample(&keys, keys.times + i, 1, p, v, NULL), BAT_OK);
            assert_memory_equal(p, key, space->point_dim * sizeof *p);
            assert_memory_equal(v, velocity, space->tangent_dim * sizeof *p);
            const double step = 1e-6;
            for (double side = -step; side < 2 * step; side += 2 * step)
            {
                double time = keys.times[i] + side;
                if (!keys.closed && (i == 0 || i + 1 == keys.count))
                    continue;
                check_status(bat_hermite_sample(&keys, &time, 1, p, v, NULL), BAT_OK);
                check_status(space->log(space, key, p, way), BAT_OK);
                for (size_t c = 0; c < space->tangent_dim; c++)
                    way[c] /= side;
                check_near(gap(space, key, way, velocity), 0, 1e-5);
                double there[DIM];
                check_status(space->transport(space, key, p, velocity, there), BAT_OK);
                check_near(gap(space, p, v, there), 0, 1e-5);
            }
        }
        bat_hermite_free(&keys);
        study_curve_free(&curve);
    }
}

/// In R^n it is the cubic Hermite interpolant.
static void euclidean_samples_reproduce_cubics(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    double times[4] = {-1, 0.5, 0.75, 3}, points[4], slopes[4];
    for (int i = 0; i < 4; i++)
    {
        double t = times[i];
        points[i] = 1 + t * (2 - t * (0.5 - 0.3 * t));
        slopes[i] = 2 - t * (1 - 0.9 * t);
    }
    bat_hermite_curve keys = {.space = &line, .points = points, .tangents = slopes, .times = times, .count = 4};
    bat_hermite_curve fine;
    check_status(bat_hermite_sample_rate(&keys, 16, &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, 65);
    for (size_t i = 0; i < fine.count; i++)
    {
        double t = fine.times[i];
        check_near(t, -1 + (double)i / 16, 0);
        check_near(fine.points[i], 1 + t * (2 - t * (0.5 - 0.3 * t)), 2e-14);
        check_near(fine.tangents[i], 2 - t * (1 - 0.9 * t), 1e-11);
    }
    bat_hermite_free(&fine);
}

static void closed_curves_go_around(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    study_curve curve = smooth_curve(&rotation, 2);
    bat_hermite_curve keys = uneven_samples(&curve, 10, true), fine;
    double p[DIM], q[DIM], time = 1.234;
    check_status(bat_hermite_sample(&keys, &time, 1, p, NULL, NULL), BAT_OK);
    time += 4 * PI;
    check_status(bat_hermite_sample(&keys, &time, 1, q, NULL, NULL), BAT_OK);
    check_near(rotation.distance(&rotation, p, q), 0, 1e-13);
    time -= 10 * PI;
    check_status(bat_hermite_sample(&keys, &time, 1, q, NULL, NULL), BAT_OK);
    check_near(rotation.distance(&rotation, p, q), 0, 1e-13);
    // a whole number of samples a period: the last is one step before the first
    check_status(bat_hermite_sample_rate(&keys, 100 / (2 * PI), &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, 100);
    check_near(fine.closing_time, 2 * PI / 100, 1e-12);
    check_status(bat_hermite_check(&fine, NULL), BAT_OK);
    bat_hermite_free(&fine);
    bat_hermite_free(&keys);
    study_curve_free(&curve);
}

static void rest_is_allowed(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    double points[12] = {1, 0, 0, 0, 1, 0, 0, 0, 0.8, 0.6, 0, 0}, tangents[9] = {0}, times[3] = {0, 1, 4};
    bat_hermite_curve keys = {.space = &rotation, .points = points, .tangents = tangents, .times = times, .count = 3}, fine;
    check_status(bat_hermite_sample_rate(&keys, 2, &fine, NULL), BAT_OK);
    assert_int_equal(fine.count, 9);
    check_near(rotation.distance(&rotation, fine.points + 4, points), 0, 0);
    check_near(fine.tangents[3], 0, 1e-12);
    assert_true(rotation.distance(&rotation, fine.points + 4 * 6, points) > 0.5);
    bat_hermite_free(&fine);
}

static void bad_times_are_named(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[6] = {0, 0, 1, 0, 2, 1}, tangents[6] = {1, 0, 1, 0, 1, 1}, times[3] = {0, 1, 3}, p[6];
    bat_hermite_curve keys = {.space = &plane, .points = points, .tangents = tangents, .times = times, .count = 3}, fine;
    bat_error error;
    double wanted[3] = {0.5, 3.1, NAN};
    check_status(bat_hermite_sample(&keys, wanted, 3, p, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    wanted[1] = 3;
    check_status(bat_hermite_sample(&keys, wanted, 3, p, NULL, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 2);
    check_status(bat_hermite_sample_rate(&keys, 0, &fine, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_hermite_sample_rate(&keys, 1e30, &fine, &error), BAT_TOO_LARGE);
    times[2] = 1;
    check_status(bat_hermite_sample_rate(&keys, 1, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    times[2] = 3;
    keys.closed = true;
    check_status(bat_hermite_sample_rate(&keys, 1, &fine, &error), BAT_INVALID_ARGUMENT);
}

/// The largest error of estimated tangents: velocities with times, else directions.
static double estimate_error(const study_curve *curve, size_t count, bool closed, bool with_times, size_t order)
{
    const bat_space *space = curve->space;
    bat_hermite_curve truth = uneven_samples(curve, count, closed), found = uneven_samples(curve, count, closed);
    if (!with_times)
    {
        free(found.times);
        found.times = NULL;
        check_status(bat_hermite_normalize(&truth, NULL), BAT_OK);
    }
    memset(found.tangents, 0xff, count * space->tangent_dim * sizeof(double));
    check_status(bat_hermite_estimate_tangents(&found, order, NULL), BAT_OK);
    double largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmax(largest, gap(space, truth.points + i * space->point_dim, truth.tangents + i * space->tangent_dim,
                                    found.tangents + i * space->tangent_dim));
    bat_hermite_free(&truth);
    bat_hermite_free(&found);
    return largest;
}

static void estimates_are_of_their_order(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    for (size_t trial = 0; trial < 8 * SPACES; trial++)
    {
        study_curve curve = smooth_curve(&spaces[trial % SPACES], trial);
        size_t kind = trial / SPACES, order = kind % 2 == 0 ? 2 : 4;
        bool closed = kind / 2 % 2 == 0, with_times = kind / 4 == 0;
        double error = estimate_error(&curve, closed ? 256 : 257, closed, with_times, order);
        double half = estimate_error(&curve, closed ? 512 : 513, closed, with_times, order);
        if (log2(error / half) < 0.95 * (double)order)
            fail_msg("%s, %s, %s, order %zu: errors %g and %g, observed %.2f", curve.space->name, closed ? "closed" : "open",
                     with_times ? "times" : "no times", order, error, half, log2(error / half));
        study_curve_free(&curve);
    }
}

static void short_curves_have_tangents(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[8] = {0, 0, 2, 0, 2, 2, 0, 2}, tangents[8];
    bat_hermite_curve two = {.space = &plane, .points = points, .tangents = tangents, .count = 2};
    check_status(bat_hermite_estimate_tangents(&two, 4, NULL), BAT_OK);
    check_near(tangents[0], 1, 1e-15);
    check_near(tangents[2], 1, 1e-15);
    bat_hermite_curve square = {.space = &plane, .points = points, .tangents = tangents, .count = 4, .closed = true};
    check_status(bat_hermite_estimate_tangents(&square, 4, NULL), BAT_OK);
    for (int i = 0; i < 4; i++) // parallel to the diagonal
    {
        const double *before = points + 2 * ((i + 3) % 4), *after = points + 2 * ((i + 1) % 4);
        for (int c = 0; c < 2; c++)
            check_near(tangents[2 * i + c], (after[c] - before[c]) / sqrt(8), 1e-15);
    }
}

static void impossible_estimates_are_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    double points[10] = {0, 0, 1, 0, 0, 0, 2, 5, 2, 5}, tangents[15];
    bat_hermite_curve curve = {.space = &plane, .points = points, .tangents = tangents, .count = 3};
    bat_error error;
    check_status(bat_hermite_estimate_tangents(&curve, 3, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_hermite_estimate_tangents(&curve, 2, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1); // turns back on itself
    curve.count = 5;
    check_status(bat_hermite_estimate_tangents(&curve, 4, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 4); // repeats its neighbour
    double around[9] = {1, 0, 0, 0, 1, 0, 0, -1, 0};
    curve = (bat_hermite_curve){.space = &sphere, .points = around, .tangents = tangents, .count = 3};
    check_status(bat_hermite_estimate_tangents(&curve, 2, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_are_of_fourth_order),
        cmocka_unit_test(keyframes_are_met_with_their_velocities),
        cmocka_unit_test(euclidean_samples_reproduce_cubics),
        cmocka_unit_test(closed_curves_go_around),
        cmocka_unit_test(rest_is_allowed),
        cmocka_unit_test(bad_times_are_named),
        cmocka_unit_test(estimates_are_of_their_order),
        cmocka_unit_test(short_curves_have_tangents),
        cmocka_unit_test(impossible_estimates_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

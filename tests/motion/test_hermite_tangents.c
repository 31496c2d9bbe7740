// Tangents estimated from points, with and without uneven times.

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
        cmocka_unit_test(estimates_are_of_their_order),
        cmocka_unit_test(short_curves_have_tangents),
        cmocka_unit_test(impossible_estimates_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

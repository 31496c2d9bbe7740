// Fits of Bézier patches and the loss: exact surfaces leave nothing, moves and scales do what they must, derivatives are
// those of differences, and degenerate clouds do no harm. Built in single and double precision.

#include "check.h"

#include "research/train/bezier_fit.h"
#include "research/train/surface_sample.h"

static const bool DOUBLE = sizeof(real) == sizeof(double);

static surface_sample draw(size_t points, int degree, double noise, uint64_t seed)
{
    surface_sample_range range = {
        .min_points = points, .max_points = points, .min_degree = degree, .max_degree = degree, .noise = noise};
    bat_random random = bat_random_seed(seed);
    surface_sample sample;
    check_status(surface_sample_draw(&range, &random, &sample, NULL), BAT_OK);
    return sample;
}

static double *numbers(size_t count)
{
    double *made = calloc(count, sizeof *made);
    assert_non_null(made);
    return made;
}

static void fit(const double *points, const double *parameters, size_t count, bezier_fit *made)
{
    check_status(bezier_fit_make(points, parameters, count, made, NULL), BAT_OK);
}

// Drawing

static void samples_lie_in_the_unit_box(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++)
    {
        surface_sample sample = draw(40 + 10 * seed, 1 + (int)(seed % 4), 0.02, seed);
        double low[3] = {1, 1, 1}, high[3] = {0}, longest = 0;
        for (size_t i = 0; i < 3 * sample.cloud.count; i++)
        {
            low[i % 3] = fmin(low[i % 3], sample.cloud.points[i]);
            high[i % 3] = fmax(high[i % 3], sample.cloud.points[i]);
        }
        for (size_t a = 0; a < 3; a++)
        {
            assert_true(low[a] == 0);
            longest = fmax(longest, high[a]);
        }
        check_near(longest, 1, 1e-15);
        check_status(bat_cloud_check(&sample.cloud, NULL), BAT_OK);
        assert_int_equal(sample.cloud.count - sample.cloud.boundary_count, 40 + 10 * seed);
        surface_sample_free(&sample);
    }
}

static void sizes_degrees_and_noise_fill_their_ranges(void **state)
{
    (void)state;
    surface_sample_range range = {.min_points = 50, .max_points = 200, .min_degree = 2, .max_degree = 5, .noise = 0.05};
    bat_random random = bat_random_seed(3);
    size_t degrees[6] = {0}, small = 0;
    double noisiest = 0;
    for (size_t k = 0; k < 200; k++)
    {
        surface_sample sample;
        double left;
        check_status(surface_sample_draw(&range, &random, &sample, NULL), BAT_OK);
        size_t interior = sample.cloud.count - sample.cloud.boundary_count;
        assert_in_range(interior, 50, 200);
        assert_in_range(sample.degree, 2, 5);
        degrees[sample.degree]++;
        small += interior < 100;
        check_status(surface_sample_floor(&sample, &left, NULL), BAT_OK);
        noisiest = fmax(noisiest, left);
        surface_sample_free(&sample);
    }
    for (int degree = 2; degree <= 5; degree++)
        assert_in_range(degrees[degree], 30, 70);
    assert_in_range(small, 75, 125); // evenly in the logarithm
    assert_true(noisiest > 2e-4 && noisiest < 3e-3);
}

// Fits

static void true_parameters_leave_nothing(void **state)
{
    (void)state;
    for (int degree = 1; degree <= 8; degree++)
    {
        surface_sample sample = draw(300, degree, 0, (uint64_t)degree);
        double left;
        check_status(surface_sample_floor(&sample, &left, NULL), BAT_OK);
        check_near(left, 0, 1e-24);
        surface_sample_free(&sample);
    }
}

/// The patch of a fit moves and turns with the points, and knows no better than any other patch.
static void fits_are_least_and_move_with_the_points(void **state)
{
    (void)state;
    surface_sample sample = draw(60, 2, 0.05, 9);
    size_t count = sample.cloud.count;
    bezier_fit made = {.patch.degree = 2, .residual = numbers(3 * count)},
               moved = {.patch.degree = 2, .residual = numbers(3 * count)};
    double *points = numbers(3 * count);
    fit(sample.cloud.points, sample.parameters, count, &made);
    for (size_t i = 0; i < 3 * count; i++)
        points[i] = 3 * sample.cloud.points[(i + 1) % 3 == 0 ? i - 2 : i + 1] + 0.7;
    fit(points, sample.parameters, count, &moved);
    check_relative(moved.error, 9 * made.error, 1e-12);
    // What is left is perpendicular to all that control points can do: the derivatives of the error by them vanish.
    for (int p = 0; p < 9; p++)
    {
        double kept = made.patch.control[p][0], errors[2] = {0};
        for (int side = 0; side < 2; side++)
        {
            made.patch.control[p][0] = kept + (side == 0 ? -1e-4 : 1e-4);
            for (size_t k = 0; k < count; k++)
            {
                double point[3];
                bezier_surface_at(&made.patch, sample.parameters + 2 * k, point);
                errors[side] += pow(point[0] - sample.cloud.points[3 * k], 2);
            }
        }
        made.patch.control[p][0] = kept;
        check_near(errors[1], errors[0], 1e-13);
    }
    free(points);
    free(made.residual);
    free(moved.residual);
    surface_sample_free(&sample);
}

static void the_gradient_is_that_of_differences(void **state)
{
    (void)state;
    for (int degree = 1; degree <= 5; degree++)
    {
        surface_sample sample = draw(80, degree, 0.05, 40 + (uint64_t)degree);
        size_t count = sample.cloud.count;
        bezier_fit made = {.patch.degree = degree, .residual = numbers(3 * count)};
        double *gradient = numbers(2 * count);
        const double step = 1e-5;
        fit(sample.cloud.points, sample.parameters, count, &made);
        bezier_fit_gradient(&made, sample.parameters, count, gradient);
        for (size_t i = 0; i < 2 * count; i += 7)
        {
            double kept = sample.parameters[i], errors[2];
            for (int side = 0; side < 2; side++)
            {
                sample.parameters[i] = kept + (side == 0 ? -step : step);
                fit(sample.cloud.points, sample.parameters, count, &made);
                errors[side] = made.error;
            }
            sample.parameters[i] = kept;
            check_near(gradient[i], (errors[1] - errors[0]) / (2 * step), 1e-9);
        }
        free(gradient);
        free(made.residual);
        surface_sample_free(&sample);
    }
}

/// The same on a tape, which weighs it.
static void the_loss_is_the_error_of_the_fit(void **state)
{
    (void)state;
    surface_sample sample = draw(120, 3, 0.02, 4);
    size_t interior = sample.cloud.count - sample.cloud.boundary_count, bound = sample.cloud.boundary_count;
    double *parameters = numbers(2 * sample.cloud.count), *gradient = numbers(2 * sample.cloud.count);
    bezier_fit made = {.patch.degree = 3, .residual = numbers(3 * sample.cloud.count)};
    learn_tape tape = learn_tape_make();
    learn_tape_begin(&tape, NULL, NULL);
    learn_array *said = learn_array_make(&tape, interior, 2, true);
    memcpy(parameters, sample.parameters, 2 * sample.cloud.count * sizeof *parameters);
    for (size_t i = 0; i < 2 * interior; i++)
    {
        said->value[i] = (real)(0.9 * sample.parameters[2 * bound + i]);
        parameters[2 * bound + i] = (double)said->value[i];
    }
    learn_array *loss = surface_sample_residual(&tape, &sample, said);
    learn_tape_backward(&tape, loss, (real)0.5);
    check_status(learn_tape_status(&tape, NULL), BAT_OK);
    fit(sample.cloud.points, parameters, sample.cloud.count, &made);
    bezier_fit_gradient(&made, parameters, sample.cloud.count, gradient);
    check_relative((double)*loss->value, made.error, DOUBLE ? 1e-14 : 1e-6);
    for (size_t i = 0; i < 2 * interior; i++)
        check_near((double)said->gradient[i], 0.5 * gradient[2 * bound + i], DOUBLE ? 1e-16 : 1e-9);
    learn_tape_free(&tape);
    free(parameters);
    free(gradient);
    free(made.residual);
    surface_sample_free(&sample);
}

// What does not determine a patch

static void too_few_or_coinciding_parameters_do_no_harm(void **state)
{
    (void)state;
    surface_sample sample = draw(40, 2, 0, 1);
    bezier_fit made = {.patch.degree = 5, .residual = numbers(3 * sample.cloud.count)};
    double *gradient = numbers(2 * sample.cloud.count);
    // Four points under 36 control points: all are met.
    fit(sample.cloud.points, sample.parameters, 4, &made);
    check_near(made.error, 0, 1e-24);
    // All in one place: their middle is the best.
    for (size_t i = 0; i < 2 * sample.cloud.count; i++)
        sample.parameters[i] = 0.5;
    fit(sample.cloud.points, sample.parameters, sample.cloud.count, &made);
    bezier_fit_gradient(&made, sample.parameters, sample.cloud.count, gradient);
    double middle[3] = {0}, squares = 0;
    for (size_t i = 0; i < 3 * sample.cloud.count; i++)
        middle[i % 3] += sample.cloud.points[i] / (double)sample.cloud.count;
    for (size_t i = 0; i < 3 * sample.cloud.count; i++)
    {
        squares += pow(sample.cloud.points[i] - middle[i % 3], 2) / (3 * (double)sample.cloud.count);
        assert_true(isfinite(gradient[i / 3]));
    }
    check_relative(made.error, squares, 1e-12);
    sample.parameters[7] = NAN;
    check_status(bezier_fit_make(sample.cloud.points, sample.parameters, sample.cloud.count, &made, NULL),
                 BAT_NO_CONVERGENCE);
    free(gradient);
    free(made.residual);
    surface_sample_free(&sample);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_lie_in_the_unit_box),
        cmocka_unit_test(sizes_degrees_and_noise_fill_their_ranges),
        cmocka_unit_test(true_parameters_leave_nothing),
        cmocka_unit_test(fits_are_least_and_move_with_the_points),
        cmocka_unit_test(the_gradient_is_that_of_differences),
        cmocka_unit_test(the_loss_is_the_error_of_the_fit),
        cmocka_unit_test(too_few_or_coinciding_parameters_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

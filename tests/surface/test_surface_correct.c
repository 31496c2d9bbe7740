// Parameter correction: feet of points, how fast they are found, and what may not move.

#include "surface/fit/points.h"
#include "surface_fit_helpers.h"

#include "spline_fit.h"

/// A surface of bidegree (3, 3) close to a shape.
static bat_spline_surface surface_of(surface_shape shape)
{
    bat_hierarchical_space *space = refined_space(3, 3, true);
    surface_sample sample = sample_make(shape, 3000, 40, 0, 21);
    bat_spline_surface surface = {
        .space = space, .control = calloc(3 * bat_hierarchical_space_functions(space), sizeof(double)), .dimension = 3};
    double lambda = 0;
    assert_non_null(surface.control);
    check_status(spline_fit(space, &sample.data, NULL, &lambda, surface.control, NULL), BAT_OK);
    sample_free(&sample);
    return surface;
}

/// The distances of points from where their parameters say.
static double *distances_of(const bat_spline_surface *surface, const bat_surface_fit_data *data)
{
    double *values = calloc(3 * data->count, sizeof *values), *distances = calloc(data->count, sizeof *distances);
    assert_true(values != NULL && distances != NULL);
    check_status(bat_spline_surface_evaluate(surface, data->parameters, data->count, 0, values, NULL), BAT_OK);
    for (size_t i = 0; i < data->count; i++)
    {
        double square = 0;
        for (size_t k = 0; k < 3; k++)
            square += (values[3 * i + k] - data->points[3 * i + k]) * (values[3 * i + k] - data->points[3 * i + k]);
        distances[i] = sqrt(square);
    }
    free(values);
    return distances;
}

static void no_distance_rises_and_feet_are_feet(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_hills);
    surface_sample sample = sample_make(shape_hills, 4000, 100, 0.03, 22);
    double *before = distances_of(&surface, &sample.data);
    size_t moved, feet = 0, inside = 0;
    check_status(spline_correct(&surface, &sample.data, &moved, NULL), BAT_OK);
    assert_true(moved > 3800);
    double *after = distances_of(&surface, &sample.data);
    double *values = calloc(9 * sample.data.count, sizeof *values);
    assert_non_null(values);
    check_status(bat_spline_surface_evaluate(&surface, sample.data.parameters, sample.data.count, 1, values, NULL), BAT_OK);
    for (size_t i = 0; i < sample.data.count; i++)
    {
        const double *at = sample.data.parameters + 2 * i, *value = values + 9 * i;
        assert_true(after[i] <= before[i] * (1 + 1e-12) + 1e-15);
        assert_true(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1);
        if (i < sample.data.boundary_count || at[0] == 0 || at[0] == 1 || at[1] == 0 || at[1] == 1)
            continue;
        double along[2] = {0, 0};
        for (size_t k = 0; k < 3; k++)
            for (size_t d = 0; d < 2; d++)
                along[d] += (value[k] - sample.points[3 * i + k]) * value[3 + 3 * d + k];
        inside++;
        feet += fabs(along[0]) < 1e-8 && fabs(along[1]) < 1e-8;
    }
    // A point may come to rest where no step makes the distance smaller though the residual is not upright: in a valley's
    // saddle.
    assert_true(feet > inside - inside / 100);
    free(before);
    free(after);
    free(values);
    sample_free(&sample);
    bat_spline_surface_free(&surface);
}

static void newton_converges_quadratically(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_hills);
    // A point above the foot S(u*), off it along the normal.
    double foot[2] = {0.37, 0.71}, values[9], point[3], start[2] = {0.372, 0.709};
    check_status(bat_spline_surface_evaluate(&surface, foot, 1, 1, values, NULL), BAT_OK);
    const double *du = values + 3, *dv = values + 6;
    double normal[3] = {du[1] * dv[2] - du[2] * dv[1], du[2] * dv[0] - du[0] * dv[2], du[0] * dv[1] - du[1] * dv[0]};
    for (size_t k = 0; k < 3; k++)
        point[k] = values[k] + 0.05 * normal[k];
    bat_surface_fit_data data = {.points = point, .parameters = start, .count = 1, .dimension = 3};
    fit_points points;
    fit_nets nets;
    check_status(fit_points_make(NULL, &data, NULL, false, &points, NULL), BAT_OK);
    check_status(fit_nets_make(surface.space, surface.control, 3, 1, &nets, NULL), BAT_OK);
    fit_points_locate(&points, surface.space, 1);
    double error = hypot(start[0] - foot[0], start[1] - foot[1]);
    for (int k = 0; k < 4; k++)
    {
        size_t moved;
        check_status(fit_correct(&nets, &points, (fit_correction){.steps = 1}, 1, &moved, NULL), BAT_OK);
        double next = hypot(points.parameter[0] - foot[0], points.parameter[1] - foot[1]);
        assert_true(next <= 50 * error * error + 2e-8);
        error = next;
    }
    // The distance says no more of the foot than the root of the unit roundoff, and a step has to make it smaller.
    assert_true(error < 2e-8);
    fit_points_free(&points);
    fit_nets_free(&nets);
    bat_spline_surface_free(&surface);
}

static void boundary_parameters_stay_on_their_sides(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_hills);
    surface_sample sample = sample_make(shape_hills, 1000, 200, 0.02, 23);
    size_t side = sample.data.boundary_count / 4, moved, slid = 0;
    double *before = calloc(2000, sizeof *before);
    assert_true(before != NULL);
    memcpy(before, sample.data.parameters, 2000 * sizeof *before);
    sample.data.slides = false;
    check_status(spline_correct(&surface, &sample.data, &moved, NULL), BAT_OK);
    assert_true(moved > 0);
    assert_memory_equal(before, sample.data.parameters, 2 * sample.data.boundary_count * sizeof *before);
    sample.data.slides = true;
    check_status(spline_correct(&surface, &sample.data, &moved, NULL), BAT_OK);
    for (size_t i = 0; i < sample.data.boundary_count; i++)
    {
        size_t which = i / side, across = which % 2 == 0 ? 1 : 0;
        const double *at = sample.data.parameters + 2 * i;
        assert_true(at[across] == before[2 * i + across]);
        if (i % side == 0)
            assert_true(at[1 - across] == before[2 * i + 1 - across]);
        slid += at[1 - across] != before[2 * i + 1 - across];
    }
    assert_true(slid > sample.data.boundary_count / 2);
    free(before);
    sample_free(&sample);
    bat_spline_surface_free(&surface);
}

static void feet_stay_in_the_square(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_biquadratic);
    // Far outside beyond the side u = 1, beside v = 0.4.
    double foot[2] = {1, 0.4}, values[9], point[3], at[2] = {0.9, 0.45};
    check_status(bat_spline_surface_evaluate(&surface, foot, 1, 1, values, NULL), BAT_OK);
    double squared = 0, along = 0;
    for (size_t k = 0; k < 3; k++)
    {
        along += values[3 + k] * values[6 + k];
        squared += values[6 + k] * values[6 + k];
    }
    for (size_t k = 0; k < 3; k++)
        point[k] = values[k] + 0.2 * (values[3 + k] - along / squared * values[6 + k]);
    bat_surface_fit_data data = {.points = point, .parameters = at, .count = 1, .dimension = 3};
    check_status(spline_correct(&surface, &data, NULL, NULL), BAT_OK);
    assert_true(at[0] == 1);
    check_near(at[1], 0.4, 1e-7);
    bat_spline_surface_free(&surface);
}

static void lost_points_are_found_again(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_hills);
    surface_sample sample = sample_make(shape_hills, 2000, 0, 0, 24);
    for (size_t i = 0; i < 20; i++)
    {
        sample.data.parameters[2 * i] = 0;
        sample.data.parameters[2 * i + 1] = 0;
    }
    fit_points points;
    fit_nets nets;
    size_t moved;
    check_status(fit_points_make(NULL, &sample.data, NULL, false, &points, NULL), BAT_OK);
    check_status(fit_nets_make(surface.space, surface.control, 3, 1, &nets, NULL), BAT_OK);
    fit_points_locate(&points, surface.space, 1);
    check_status(fit_nets_measure(&nets, &points, 1, NULL), BAT_OK);
    check_status(fit_correct_wrong_feet(&nets, &points, fit_correction_full(), 1, &moved, NULL), BAT_OK);
    assert_int_equal(moved, 20);
    double largest[2] = {0, 0};
    for (size_t row = 0; row < points.count; row++)
    {
        double *of = &largest[points.number[row] < 20 ? 1 : 0];
        *of = fmax(*of, points.distance[row]);
    }
    assert_true(largest[1] <= largest[0]);
    fit_points_free(&points);
    fit_nets_free(&nets);
    sample_free(&sample);
    bat_spline_surface_free(&surface);
}

static void dimensions_must_agree(void **state)
{
    (void)state;
    bat_spline_surface surface = surface_of(shape_biquadratic);
    double point[2] = {0, 0}, at[2] = {0.5, 0.5};
    bat_surface_fit_data data = {.points = point, .parameters = at, .count = 1, .dimension = 2};
    check_status(spline_correct(&surface, &data, NULL, NULL), BAT_INVALID_ARGUMENT);
    bat_spline_surface_free(&surface);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_distance_rises_and_feet_are_feet),
        cmocka_unit_test(newton_converges_quadratically),
        cmocka_unit_test(boundary_parameters_stay_on_their_sides),
        cmocka_unit_test(feet_stay_in_the_square),
        cmocka_unit_test(lost_points_are_found_again),
        cmocka_unit_test(dimensions_must_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

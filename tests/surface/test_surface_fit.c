// One penalized least-squares fit: what it reproduces, the thin-plate energy, agreement with dense algebra, gaps.

#include "surface/spline/hierarchical_space.h"
#include "surface_fit_helpers.h"

#include "linalg/dense.h"
#include "spline_fit.h"

static bat_spline_surface fit(bat_hierarchical_space *space, const bat_surface_fit_data *data, const double *weights,
                              double *lambda)
{
    bat_spline_surface surface = {
        .space = space, .control = calloc(3 * bat_hierarchical_space_functions(space), sizeof(double)), .dimension = 3};
    bat_error error;
    assert_non_null(surface.control);
    if (spline_fit(space, data, weights, lambda, surface.control, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return surface;
}

static void polynomials_are_reproduced(void **state)
{
    (void)state;
    for (int k = 0; k < 6; k++)
    {
        bat_hierarchical_space *space = refined_space(2 + k % 3, 2 + k / 2 % 2, k % 2 == 0);
        surface_sample sample = sample_make(shape_biquadratic, 3000, 40, 0, 7);
        double lambda = 0;
        bat_spline_surface surface = fit(space, &sample.data, NULL, &lambda);
        assert_true(lambda == 0);
        check_near(largest_distance(&surface, &sample.data, sample.points), 0, 1e-12);
        bat_spline_surface_free(&surface);
        sample_free(&sample);
    }
}

static void splines_of_the_space_are_reproduced(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(3, 2, true);
    size_t functions = bat_hierarchical_space_functions(space);
    double *control = calloc(3 * functions, sizeof *control), lambda = 0;
    assert_non_null(control);
    bat_random random = bat_random_seed(3);
    for (size_t k = 0; k < 3 * functions; k++)
        control[k] = bat_random_uniform(&random);
    surface_sample sample = sample_make(shape_biquadratic, 4000, 80, 0, 8);
    bat_spline_surface given = {.space = space, .control = control, .dimension = 3};
    check_status(bat_spline_surface_evaluate(&given, sample.data.parameters, sample.data.count, 0, sample.points, NULL),
                 BAT_OK);
    bat_spline_surface surface = fit(space, &sample.data, NULL, &lambda);
    for (size_t k = 0; k < 3 * functions; k++)
        check_near(surface.control[k], control[k], 1e-12);
    free(control);
    bat_spline_surface_free(&surface);
    sample_free(&sample);
}

static void shape_energetic(double u, double v, double *point)
{
    point[0] = u * u * v * v * v;
    point[1] = 1 - u + 2 * v;
    point[2] = u * v;
}

/// The thin-plate energy of one coordinate.
static double energy_of(const fit_system *system, const double *control, size_t coordinate)
{
    size_t functions = system->functions;
    double *column = calloc(functions, sizeof *column), *product = calloc(functions, sizeof *product), energy = 0;
    assert_non_null(column);
    assert_non_null(product);
    for (size_t f = 0; f < functions; f++)
        column[f] = control[3 * f + coordinate];
    fit_system_multiply(system, system->plate, 1, column, product);
    for (size_t f = 0; f < functions; f++)
        energy += column[f] * product[f];
    free(column);
    free(product);
    return energy;
}

static void energy_is_that_of_the_formula(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 3, true);
    surface_sample sample = sample_make(shape_energetic, 3000, 40, 0, 5);
    double lambda = 0;
    bat_spline_surface surface = fit(space, &sample.data, NULL, &lambda);
    fit_system system;
    check_status(fit_system_make(space, NULL, 3, false, 1, &system, NULL), BAT_OK);
    // f = u^2 v^3: integrals of f_uu^2 = 4 v^6, f_uv^2 = 36 u^2 v^4 and f_vv^2 = 36 u^4 v^2.
    check_near(energy_of(&system, surface.control, 0), 4.0 / 7 + 36.0 / 15 + 36.0 / 15, 1e-10);
    check_near(energy_of(&system, surface.control, 1), 0, 1e-10);
    check_near(energy_of(&system, surface.control, 2), 1, 1e-10);
    fit_system_free(&system);
    bat_spline_surface_free(&surface);
    sample_free(&sample);
}

/// Rows of the least-squares problem that eq. (5) is: sqrt(w) B_j(u_i), then sqrt(2 lambda) times a root of the thin-plate
/// matrix.
static double *dense_rows(const bat_hierarchical_space *space, const bat_surface_fit_data *data, const double *weights,
                          double lambda)
{
    size_t functions = bat_hierarchical_space_functions(space), rows = data->count + functions;
    double *matrix = calloc(rows * functions, sizeof *matrix), *plate = calloc(functions * functions, sizeof *plate);
    double *values = calloc(hierarchical_space_max_active(space), sizeof *values), *eigen = calloc(functions, sizeof *eigen);
    assert_true(matrix != NULL && plate != NULL && values != NULL && eigen != NULL);
    for (size_t i = 0; i < data->count; i++)
    {
        double u = data->parameters[2 * i], v = data->parameters[2 * i + 1];
        const uint32_t *active;
        size_t cell = bat_hierarchical_space_locate(space, u, v),
               count = bat_hierarchical_space_active(space, cell, &active);
        bat_hierarchical_space_basis(space, cell, u, v, 0, values);
        for (size_t k = 0; k < count; k++)
            matrix[i * functions + active[k]] = sqrt(weights[i]) * values[k];
    }
    fit_system system;
    check_status(fit_system_make(space, NULL, 3, false, 1, &system, NULL), BAT_OK);
    for (size_t j = 0; j < functions; j++)
        for (int at = system.pattern.first[j]; at < system.pattern.first[j + 1]; at++)
            plate[j * functions + (size_t)system.pattern.row[at]] = system.plate[at];
    fit_system_free(&system);
    check_status(decompose_symmetric(functions, plate, eigen, NULL), BAT_OK);
    for (size_t e = 0; e < functions; e++)
        for (size_t j = 0; j < functions; j++)
            matrix[(data->count + e) * functions + j] = sqrt(2 * lambda * fmax(eigen[e], 0)) * plate[j * functions + e];
    free(plate);
    free(values);
    free(eigen);
    return matrix;
}

/// Solve for three columns in the sense of least squares.
/// @param right rows x 3; receives the solution in its first rows
static void solve_dense(size_t rows, size_t columns, const double *matrix, double *right)
{
    double *copy = malloc(rows * columns * sizeof *copy), *side = malloc(rows * sizeof *side);
    assert_true(copy != NULL && side != NULL);
    for (size_t d = 0; d < 3; d++)
    {
        memcpy(copy, matrix, rows * columns * sizeof *copy);
        for (size_t i = 0; i < rows; i++)
            side[i] = right[3 * i + d];
        check_status(decompose_least_squares(rows, columns, copy, side, NULL), BAT_OK);
        for (size_t i = 0; i < columns; i++)
            right[3 * i + d] = side[i];
    }
    free(copy);
    free(side);
}

static void normal_equations_agree_with_dense_least_squares(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++)
    {
        bat_hierarchical_space *space = refined_space(2 + k % 2, 3, k < 2);
        size_t functions = bat_hierarchical_space_functions(space), count = 900, rows = count + functions;
        surface_sample sample = sample_make(shape_hills, count, 40, 0.01, 9);
        double *weights = calloc(count, sizeof *weights), *right = calloc(3 * rows, sizeof *right);
        assert_true(weights != NULL && right != NULL);
        double lambda = k == 0 ? 0 : 0.01 * k;
        for (size_t i = 0; i < count; i++)
            weights[i] = i % 7 == 0 ? 0 : 0.5 + (double)(i % 3);
        for (size_t i = 0; i < 3 * count; i++)
            right[i] = sqrt(weights[i / 3]) * sample.points[i];
        double *matrix = dense_rows(space, &sample.data, weights, lambda);
        solve_dense(rows, functions, matrix, right);
        bat_spline_surface surface = fit(space, &sample.data, weights, &lambda);
        for (size_t i = 0; i < 3 * functions; i++)
            check_near(surface.control[i], right[i], 1e-10);
        free(weights);
        free(right);
        free(matrix);
        bat_spline_surface_free(&surface);
        sample_free(&sample);
    }
}

static void heavy_smoothing_gives_the_regression_plane(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 2, true);
    surface_sample sample = sample_make(shape_hills, 500, 0, 0, 11);
    double rows[500 * 3], right[500 * 3], lambda = 1e7;
    for (size_t i = 0; i < 500; i++)
    {
        rows[3 * i] = 1;
        rows[3 * i + 1] = sample.data.parameters[2 * i];
        rows[3 * i + 2] = sample.data.parameters[2 * i + 1];
    }
    memcpy(right, sample.points, sizeof right);
    solve_dense(500, 3, rows, right);
    bat_spline_surface surface = fit(space, &sample.data, NULL, &lambda);
    double corner[2] = {1, 1}, value[3];
    check_status(bat_spline_surface_evaluate(&surface, corner, 1, 0, value, NULL), BAT_OK);
    for (size_t k = 0; k < 3; k++)
        check_near(value[k], right[k] + right[3 + k] + right[6 + k], 1e-4);
    bat_spline_surface_free(&surface);
    sample_free(&sample);
}

/// Beyond some weight nothing of the points is left in the matrix.
static void excessive_smoothing_is_refused(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 2, true);
    surface_sample sample = sample_make(shape_hills, 500, 0, 0, 11);
    const double excessive[] = {1e16, 1e100, 1e308};
    double *control = calloc(3 * bat_hierarchical_space_functions(space), sizeof *control);
    for (size_t i = 0; i < 3; i++)
    {
        bat_error error;
        double lambda = excessive[i];
        check_status(spline_fit(space, &sample.data, NULL, &lambda, control, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "weight of smoothing"));
        assert_non_null(strstr(error.text, "out of range"));
        assert_true(lambda == excessive[i]);
    }
    free(control);
    sample_free(&sample);
    bat_hierarchical_space_free(space);
}

static void gaps_take_the_least_smoothing(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 2, true);
    surface_sample sample = sample_make(shape_biquadratic, 2000, 0, 0, 12);
    size_t kept = 0;
    for (size_t i = 0; i < sample.data.count; i++)
    {
        const double *at = sample.data.parameters + 2 * i;
        if (at[0] < 0.5 && at[1] < 0.6)
            continue;
        memmove(sample.data.parameters + 2 * kept, at, 2 * sizeof *at);
        memmove(sample.points + 3 * kept, sample.points + 3 * i, 3 * sizeof(double));
        kept++;
    }
    sample.data.count = kept;
    double lambda = 0, inside[2] = {0.2, 0.2}, value[3];
    bat_spline_surface surface = fit(space, &sample.data, NULL, &lambda);
    assert_true(lambda > 0 && lambda < 1e-6);
    check_near(largest_distance(&surface, &sample.data, sample.points), 0, 1e-7);
    // Over the gap it goes on smoothly.
    check_status(bat_spline_surface_evaluate(&surface, inside, 1, 0, value, NULL), BAT_OK);
    for (size_t k = 0; k < 3; k++)
        assert_true(fabs(value[k]) < 3);
    bat_spline_surface_free(&surface);
    sample_free(&sample);
}

static void far_too_few_points_are_refused(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 2, true);
    double points[3] = {1, 2, 3}, parameters[2] = {0.5, 0.5}, lambda = 0;
    double *control = calloc(3 * bat_hierarchical_space_functions(space), sizeof *control);
    bat_surface_fit_data data = {.points = points, .parameters = parameters, .count = 1, .dimension = 3};
    check_status(spline_fit(space, &data, NULL, &lambda, control, NULL), BAT_NO_CONVERGENCE);
    assert_true(lambda == 0);
    free(control);
    bat_hierarchical_space_free(space);
}

static void wrong_data_is_refused(void **state)
{
    (void)state;
    bat_hierarchical_space *space = refined_space(2, 2, true);
    surface_sample sample = sample_make(shape_hills, 200, 40, 0, 1);
    double lambda = 0, *control = calloc(3 * bat_hierarchical_space_functions(space), sizeof *control);
    bat_error error;
    assert_non_null(control);
    sample.data.parameters[2 * 150] = 1.01;
    check_status(spline_fit(space, &sample.data, NULL, &lambda, control, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 150);
    sample.points[3 * 120 + 1] = NAN;
    check_status(spline_fit(space, &sample.data, NULL, &lambda, control, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 120);
    sample.data.parameters[2 * 11] = 0.25;
    sample.data.parameters[2 * 11 + 1] = 0.25;
    check_status(spline_fit(space, &sample.data, NULL, &lambda, control, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 11);
    sample.data.count = 0;
    check_status(spline_fit(space, &sample.data, NULL, &lambda, control, NULL), BAT_INVALID_ARGUMENT);
    free(control);
    sample_free(&sample);
    bat_hierarchical_space_free(space);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polynomials_are_reproduced),
        cmocka_unit_test(splines_of_the_space_are_reproduced),
        cmocka_unit_test(energy_is_that_of_the_formula),
        cmocka_unit_test(normal_equations_agree_with_dense_least_squares),
        cmocka_unit_test(heavy_smoothing_gives_the_regression_plane),
        cmocka_unit_test(excessive_smoothing_is_refused),
        cmocka_unit_test(gaps_take_the_least_smoothing),
        cmocka_unit_test(far_too_few_points_are_refused),
        cmocka_unit_test(wrong_data_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

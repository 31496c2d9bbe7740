#include "hierarchical_helpers.h"
#include "surface/spline/tensor_surface.h"
#include "tensor_helpers.h"

#include "surface/spline/hierarchical_space.h"

static bat_spline_surface random_surface(bat_random *random, const bat_hierarchical_options *options, uint32_t levels)
{
    bat_spline_surface surface = {.space = random_space(random, options, levels), .dimension = 1 + below(random, 3)};
    size_t size = bat_hierarchical_space_functions(surface.space) * surface.dimension;
    surface.control = malloc(size * sizeof(double));
    assert_non_null(surface.control);
    for (size_t i = 0; i < size; i++)
        surface.control[i] = uniform(random, -1, 1);
    return surface;
}

static void random_parameters(bat_random *random, double *parameters, size_t count)
{
    for (size_t i = 0; i < 2 * count; i++)
        parameters[i] = below(random, 10) == 0 ? (double)below(random, 17) / 16 : bat_random_uniform(random);
}

/// A surface is the sum of its control points times the functions, at points in any order, and all orders of derivatives
/// agree.
static void test_evaluate(void **state)
{
    (void)state;
    enum
    {
        POINTS = 700
    };
    bat_random random = bat_random_seed(1);
    double *parameters = malloc(2 * POINTS * sizeof *parameters), *values = malloc(POINTS * 18 * sizeof *values);
    assert_true(parameters != NULL && values != NULL);
    for (int trial = 0; trial < 30; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        options.truncated = trial % 3 > 0;
        bat_spline_surface s = random_surface(&random, &options, 4);
        double *basis = malloc(6 * hierarchical_space_max_active(s.space) * sizeof *basis);
        assert_non_null(basis);
        random_parameters(&random, parameters, POINTS);
        for (int derivatives = 0; derivatives <= 2; derivatives++)
        {
            size_t orders = derivatives == 0 ? 1 : derivatives == 1 ? 3 : 6;
            assert_int_equal(bat_spline_surface_evaluate(&s, parameters, POINTS, derivatives, values, NULL), BAT_OK);
            for (size_t i = 0; i < POINTS; i++)
            {
                const uint32_t *active;
                size_t cell = bat_hierarchical_space_locate(s.space, parameters[2 * i], parameters[2 * i + 1]);
                size_t count = bat_hierarchical_space_active(s.space, cell, &active);
                bat_hierarchical_space_basis(s.space, cell, parameters[2 * i], parameters[2 * i + 1], derivatives, basis);
                for (size_t k = 0; k < orders * s.dimension; k++)
                {
                    double sum = 0, size = 1;
                    for (size_t a = 0; a < count; a++)
                    {
                        double term =
                            basis[k / s.dimension * count + a] * s.control[active[a] * s.dimension + k % s.dimension];
                        sum += term;
                        size += fabs(term);
                    }
                    check_near(values[i * orders * s.dimension + k], sum, 1e-14 * size);
                }
            }
        }
        free(basis);
        bat_spline_surface_free(&s);
    }
    free(parameters);
    free(values);
}

static void test_bad_parameters(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    bat_hierarchical_options options = bat_hierarchical_defaults();
    bat_spline_surface s = random_surface(&random, &options, 2);
    const double bad[][2] = {{-1e-9, 0.5}, {0.5, 1 + 1e-9}, {NAN, 0.5}, {0.5, INFINITY}};
    double parameters[6] = {0, 0, 1, 1}, values[18];
    bat_error error;
    for (size_t i = 0; i < 4; i++)
    {
        memcpy(parameters + 4, bad[i], sizeof bad[i]);
        assert_int_equal(bat_spline_surface_evaluate(&s, parameters, 3, 0, values, &error), BAT_INVALID_POINT);
        assert_int_equal(error.index, 2);
    }
    assert_int_equal(bat_spline_surface_evaluate(&s, parameters, 1, 3, values, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_spline_surface_evaluate(&s, parameters, 1, -1, values, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(bat_spline_surface_evaluate(&s, NULL, 0, 0, NULL, NULL), BAT_OK);
    bat_spline_surface_free(&s);
}

/// Coefficients of (x - u)^p by the functions of a direction of level 0: Marsden's identity.
static void marsden(const bat_hierarchical_options *options, int d, double x, double *coefficients)
{
    bat_knot_vector knots;
    assert_int_equal(knot_vector_uniform(options->degree[d], options->spans[d], &knots, NULL), BAT_OK);
    for (size_t i = 0; i < knot_vector_functions(&knots); i++)
    {
        coefficients[i] = 1;
        for (size_t k = 1; k <= (size_t)options->degree[d]; k++)
            coefficients[i] *= x - knots.knots[i + k];
    }
    knot_vector_free(&knots);
}

/// The k-th derivative of (x - t)^p by t.
static double power_derivative(double x, double t, int p, int k)
{
    double factor = 1;
    for (int i = 0; i < k; i++)
        factor *= -(p - i);
    return k > p ? 0 : factor * pow(x - t, p - k);
}

/// The polynomial (x - u)^p (y - v)^q stays itself through refinement, with both its derivatives.
static void test_polynomials(void **state)
{
    (void)state;
    static const int ORDERS[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 60; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        options.truncated = trial % 3 > 0;
        bat_hierarchical_space *begin = make_space(&options);
        bat_spline_surface s = {.space = random_space(&random, &options, 4), .dimension = 1};
        double across[16], along[16], coarse[16 * 16], x = uniform(&random, -1, 2), y = uniform(&random, -1, 2);
        size_t columns = options.spans[0] + (size_t)options.degree[0];
        marsden(&options, 0, x, across);
        marsden(&options, 1, y, along);
        for (size_t f = 0; f < bat_hierarchical_space_functions(begin); f++)
            coarse[f] = across[f % columns] * along[f / columns];
        s.control = malloc(bat_hierarchical_space_functions(s.space) * sizeof *s.control);
        assert_non_null(s.control);
        assert_int_equal(hierarchical_space_prolong(begin, s.space, coarse, 1, s.control, NULL), BAT_OK);
        for (int k = 0; k < 40; k++)
        {
            double parameter[2], values[6];
            random_parameters(&random, parameter, 1);
            assert_int_equal(bat_spline_surface_evaluate(&s, parameter, 1, 2, values, NULL), BAT_OK);
            size_t cell = bat_hierarchical_space_locate(s.space, parameter[0], parameter[1]);
            uint32_t level = bat_hierarchical_space_cell(s.space, cell).level;
            for (size_t o = 0; o < 6; o++)
            {
                double expected = power_derivative(x, parameter[0], options.degree[0], ORDERS[o][0]) *
                                  power_derivative(y, parameter[1], options.degree[1], ORDERS[o][1]);
                // What differences of control points lose, in units of the cells' size.
                double scale = pow(2, options.degree[0] + options.degree[1]);
                for (int d = 0; d < 2; d++)
                    scale *= pow(2. * options.degree[d] * (double)(options.spans[d] << level), ORDERS[o][d]);
                check_near(values[o], expected, 1e-14 * scale);
            }
        }
        bat_hierarchical_space_free(begin);
        bat_spline_surface_free(&s);
    }
}

/// Derivatives are the slopes of positions, by differences of fourth order within a cell.
static void test_finite_differences(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (int trial = 0; trial < 40; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 4);
        bat_spline_surface s = random_surface(&random, &options, 3);
        bat_spline_box cell = bat_hierarchical_space_cell(s.space, below(&random, bat_hierarchical_space_cells(s.space)));
        double parameter[2], step[2], values[18], stencil[2 * 8], at[8 * 9];
        for (int d = 0; d < 2; d++)
        {
            double spans = (double)(options.spans[d] << cell.level);
            parameter[d] = (cell.low[d] + uniform(&random, 0.2, 0.8)) / spans;
            step[d] = 1e-3 / spans;
        }
        for (size_t k = 0; k < 8; k++)
        {
            const double offsets[] = {-2, -1, 1, 2};
            stencil[2 * k] = parameter[0] + (k < 4 ? offsets[k] * step[0] : 0);
            stencil[2 * k + 1] = parameter[1] + (k < 4 ? 0 : offsets[k - 4] * step[1]);
        }
        size_t n = s.dimension;
        assert_int_equal(bat_spline_surface_evaluate(&s, parameter, 1, 2, values, NULL), BAT_OK);
        assert_int_equal(bat_spline_surface_evaluate(&s, stencil, 8, 1, at, NULL), BAT_OK);
        // Derivative `to` of order one more than `from`, by u (points 0 to 3) or v (4 to 7).
        const size_t pairs[5][3] = {{0, 1, 0}, {0, 2, 4}, {1, 3, 0}, {1, 4, 4}, {2, 5, 4}};
        for (size_t k = 0; k < 5; k++)
            for (size_t c = 0; c < n; c++)
            {
                const double *f = at + pairs[k][2] * 3 * n + pairs[k][0] * n + c;
                double h = step[pairs[k][2] / 4], slope = (f[0] - 8 * f[3 * n] + 8 * f[6 * n] - f[9 * n]) / (12 * h);
                double scale = 1e-3 / h;
                check_near(slope, values[pairs[k][1] * n + c], 1e-9 * scale * (pairs[k][0] == 0 ? 1 : 100 * scale));
            }
        bat_spline_surface_free(&s);
    }
}

static void check_same_surface(bat_random *random, const bat_spline_surface *a, const bat_spline_surface *b)
{
    enum
    {
        POINTS = 60
    };
    double parameters[2 * POINTS], here[3 * POINTS], there[3 * POINTS];
    random_parameters(random, parameters, POINTS);
    assert_int_equal(bat_spline_surface_evaluate(a, parameters, POINTS, 0, here, NULL), BAT_OK);
    assert_int_equal(bat_spline_surface_evaluate(b, parameters, POINTS, 0, there, NULL), BAT_OK);
    for (size_t i = 0; i < POINTS * a->dimension; i++)
        check_near(here[i], there[i], 1e-13);
}

/// Spaces are nested: a surface stays the same when its space is refined, any number of times. In the truncated basis
/// functions that stay keep their coefficients to the bit.
static void test_prolong(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 80; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        options.truncated = trial % 3 > 0;
        options.admissible = trial % 2 == 0 ? 0 : 2;
        bat_spline_surface s = random_surface(&random, &options, 3), fine = {.dimension = s.dimension};
        assert_int_equal(hierarchical_space_copy(s.space, &fine.space, NULL), BAT_OK);
        bat_spline_box boxes[3];
        size_t count = random_boxes(&random, &options, 4, boxes, 3);
        refine_space(fine.space, boxes, count);
        fine.control = malloc(bat_hierarchical_space_functions(fine.space) * s.dimension * sizeof *fine.control);
        assert_non_null(fine.control);
        assert_int_equal(hierarchical_space_prolong(s.space, fine.space, s.control, s.dimension, fine.control, NULL),
                         BAT_OK);
        check_same_surface(&random, &s, &fine);
        for (size_t f = 0; f < bat_hierarchical_space_functions(s.space) && options.truncated; f++)
        {
            size_t kept = hierarchical_space_find(fine.space, hierarchical_space_function(s.space, f));
            for (size_t d = 0; d < s.dimension && kept != BAT_NO_INDEX; d++)
                check_near(fine.control[kept * s.dimension + d], s.control[f * s.dimension + d], 0);
        }
        if (bat_hierarchical_space_cells(fine.space) > bat_hierarchical_space_cells(s.space))
            assert_int_equal(hierarchical_space_prolong(fine.space, s.space, fine.control, s.dimension, s.control, NULL),
                             BAT_INVALID_ARGUMENT);
        bat_spline_surface_free(&s);
        bat_spline_surface_free(&fine);
    }
}

static void test_prolong_refuses(void **state)
{
    (void)state;
    bat_hierarchical_options options = bat_hierarchical_defaults(), other = options;
    bat_hierarchical_space *space = make_space(&options), *stranger;
    double numbers[64] = {0}, out[64];
    for (int k = 0; k < 3; k++)
    {
        other = options;
        if (k == 0)
            other.degree[1] = 3;
        else if (k == 1)
            other.spans[0] = 2;
        else
            other.truncated = false;
        stranger = make_space(&other);
        assert_int_equal(hierarchical_space_prolong(space, stranger, numbers, 1, out, NULL), BAT_INVALID_ARGUMENT);
        bat_hierarchical_space_free(stranger);
    }
    bat_hierarchical_space_free(space);
}

/// The pieces cover the square once, are clamped at their ends and say the surface.
static void test_patches(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    for (int trial = 0; trial < 60; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        options.truncated = trial % 3 > 0;
        bat_spline_surface s = random_surface(&random, &options, 4);
        tensor_surface *patches;
        size_t count;
        double covered = 0;
        assert_int_equal(spline_surface_patches(&s, &patches, &count, NULL), BAT_OK);
        assert_true(count <= bat_hierarchical_space_cells(s.space));
        for (size_t i = 0; i < count; i++)
        {
            double low[2], high[2], area = 1;
            check_tensor_surface(&patches[i]);
            for (int d = 0; d < 2; d++)
            {
                const bat_knot_vector *knots = &patches[i].knots[d];
                assert_int_equal(knots->degree, options.degree[d]);
                low[d] = knots->knots[0];
                high[d] = knots->knots[knots->count - 1];
                area *= high[d] - low[d];
                check_near(knots->knots[knots->degree], low[d], 0);
                check_near(knots->knots[knot_vector_functions(knots)], high[d], 0);
            }
            covered += area;
            for (int k = 0; k < 20; k++)
            {
                double parameter[2], here[3], there[3];
                for (int d = 0; d < 2; d++)
                    parameter[d] = k < 4 ? (k >> d & 1 ? high[d] : low[d]) : uniform(&random, low[d], high[d]);
                tensor_surface_at(&patches[i], parameter, here);
                assert_int_equal(bat_spline_surface_evaluate(&s, parameter, 1, 0, there, NULL), BAT_OK);
                for (size_t d = 0; d < s.dimension; d++)
                    check_near(here[d], there[d], 1e-13);
            }
            tensor_surface_free(&patches[i]);
        }
        check_near(covered, 1, 1e-13);
        free(patches);
        bat_spline_surface_free(&s);
    }
}

/// Sums over a cell in its local functions, taken to the basis by its extraction, are the sums in the basis.
static void test_extraction(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(8);
    for (int trial = 0; trial < 40; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 4);
        options.truncated = trial % 3 > 0;
        bat_hierarchical_space *space = random_space(&random, &options, 4);
        size_t index = below(&random, bat_hierarchical_space_cells(space)), locals = hierarchical_locals(space);
        const hierarchical_cell *cell = &space->cells[index];
        size_t count = cell->active;
        double *sums = calloc(locals * locals, sizeof *sums), *matrix = malloc(count * count * sizeof *matrix);
        double *expected = calloc(count * count, sizeof *expected), *scratch = malloc(count * locals * sizeof *scratch);
        double *values = malloc(locals * sizeof *values), *basis = malloc(count * sizeof *basis);
        assert_true(sums && matrix && expected && scratch && values && basis);
        for (int k = 0; k < 20; k++)
        {
            double u = (cell->column + bat_random_uniform(&random)) / (double)(options.spans[0] << cell->level);
            double v = (cell->row + bat_random_uniform(&random)) / (double)(options.spans[1] << cell->level);
            hierarchical_local_values(space, cell, u, v, 0, values);
            bat_hierarchical_space_basis(space, index, u, v, 0, basis);
            for (size_t a = 0; a < locals * locals; a++)
                sums[a] += values[a / locals] * values[a % locals];
            for (size_t a = 0; a < count * count; a++)
                expected[a] += basis[a / count] * basis[a % count];
        }
        hierarchical_extract_matrix(space, cell, sums, scratch, matrix);
        for (size_t a = 0; a < count * count; a++)
            check_near(matrix[a], expected[a], 1e-13);
        free(sums);
        free(matrix);
        free(expected);
        free(scratch);
        free(values);
        free(basis);
        bat_hierarchical_space_free(space);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_evaluate),    cmocka_unit_test(test_bad_parameters),
        cmocka_unit_test(test_polynomials), cmocka_unit_test(test_finite_differences),
        cmocka_unit_test(test_prolong),     cmocka_unit_test(test_prolong_refuses),
        cmocka_unit_test(test_patches),     cmocka_unit_test(test_extraction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "hierarchical_helpers.h"
#include "surface/spline/tensor_surface.h"

#include "linalg/dense.h"
#include "research/analysis/eigen.h"
#include "surface/spline/hierarchical_space.h"

enum
{
    LEVELS = 4
};

/// A parameter anywhere, or on the border of cells, or at an end.
static double random_parameter(bat_random *random)
{
    size_t choice = below(random, 10);
    return choice == 0   ? (double)below(random, 17) / 16
           : choice == 1 ? (double)below(random, 2)
                         : bat_random_uniform(random);
}

/// A parameter within a cell.
static void random_within(bat_random *random, const bat_hierarchical_space *space, size_t cell, double *parameter)
{
    bat_hierarchical_options options = bat_hierarchical_space_options(space);
    bat_spline_box box = bat_hierarchical_space_cell(space, cell);
    for (int d = 0; d < 2; d++)
        parameter[d] = (box.low[d] + bat_random_uniform(random)) / (double)(options.spans[d] << box.level);
}

/// The truncated basis adds up to one with derivatives that add up to nothing, and is nowhere negative.
static void test_partition_of_unity(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    for (int trial = 0; trial < 100; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        bat_hierarchical_space *space = random_space(&random, &options, 5);
        double *values = malloc(6 * hierarchical_space_max_active(space) * sizeof *values);
        assert_non_null(values);
        for (int k = 0; k < 100; k++)
        {
            double u = random_parameter(&random), v = random_parameter(&random);
            size_t cell = bat_hierarchical_space_locate(space, u, v);
            const uint32_t *active;
            size_t count = bat_hierarchical_space_active(space, cell, &active);
            bat_hierarchical_space_basis(space, cell, u, v, 2, values);
            for (size_t order = 0; order < 6; order++)
            {
                double sum = 0, size = 0;
                for (size_t a = 0; a < count; a++)
                {
                    sum += values[order * count + a];
                    size += fabs(values[order * count + a]);
                    assert_true(order > 0 || values[a] >= 0);
                    assert_true(a == 0 || active[a] > active[a - 1]);
                }
                check_near(sum, order == 0, 1e-13 * fmax(size, 1));
            }
        }
        free(values);
        bat_hierarchical_space_free(space);
    }
}

/// A deep hierarchy, high degrees.
static void test_deep_partition_of_unity(void **state)
{
    (void)state;
    static const int DEGREES[][2] = {{2, 2}, {5, 2}, {1, 15}, {9, 4}};
    bat_random random = bat_random_seed(2);
    for (int trial = 0; trial < 4; trial++)
    {
        bat_hierarchical_options options = bat_hierarchical_defaults();
        options.degree[0] = DEGREES[trial][0];
        options.degree[1] = DEGREES[trial][1];
        options.spans[0] = 3;
        options.admissible = trial % 2 == 0 ? 2 : 0;
        bat_hierarchical_space *space = make_space(&options);
        double at[2] = {0.7, 0.3};
        bat_spline_box box = {.level = trial < 2 ? 18 : 7};
        for (int d = 0; d < 2; d++)
            box.high[d] = 1 + (box.low[d] = (uint32_t)(at[d] * (double)(options.spans[d] << box.level)));
        refine_space(space, &box, 1);
        double *values = malloc(hierarchical_space_max_active(space) * sizeof *values);
        assert_non_null(values);
        for (size_t cell = 0; cell < bat_hierarchical_space_cells(space); cell++)
        {
            double parameter[2], sum = 0;
            const uint32_t *active;
            random_within(&random, space, cell, parameter);
            bat_hierarchical_space_basis(space, cell, parameter[0], parameter[1], 0, values);
            for (size_t a = 0; a < bat_hierarchical_space_active(space, cell, &active); a++)
            {
                assert_true(values[a] >= 0);
                sum += values[a];
            }
            check_near(sum, 1, 1e-13);
        }
        free(values);
        bat_hierarchical_space_free(space);
    }
}

/// All B-splines of a level and direction at a parameter, by the knot vector.
static void level_values(const bat_hierarchical_options *options, uint32_t level, int d, double t, double *values)
{
    bat_knot_vector knots;
    double alive[BAT_SPLINE_MAX_DEGREE + 1];
    size_t p = (size_t)options->degree[d];
    assert_int_equal(knot_vector_uniform(options->degree[d], options->spans[d] << level, &knots, NULL), BAT_OK);
    memset(values, 0, knot_vector_functions(&knots) * sizeof *values);
    size_t span = knot_vector_span(&knots, t);
    knot_vector_basis(&knots, span, t, 0, alive);
    memcpy(values + span - p, alive, (p + 1) * sizeof *values);
    knot_vector_free(&knots);
}

/// The values at a parameter of all functions of a space, zeros included.
static void all_values(const bat_hierarchical_space *space, const double *parameter, double *values)
{
    size_t cell = bat_hierarchical_space_locate(space, parameter[0], parameter[1]);
    double *alive = malloc(hierarchical_space_max_active(space) * sizeof *alive);
    const uint32_t *active;
    size_t count = bat_hierarchical_space_active(space, cell, &active);
    assert_non_null(alive);
    memset(values, 0, bat_hierarchical_space_functions(space) * sizeof *values);
    bat_hierarchical_space_basis(space, cell, parameter[0], parameter[1], 0, alive);
    for (size_t a = 0; a < count; a++)
        values[active[a]] = alive[a];
    free(alive);
}

/// The plain basis is the selected B-splines themselves, and what is not active vanishes.
static void test_plain_basis(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 50; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5);
        options.truncated = false;
        bat_hierarchical_space *space = random_space(&random, &options, LEVELS);
        size_t count = bat_hierarchical_space_functions(space);
        double *values = malloc(count * sizeof *values), across[LEVELS][64], along[LEVELS][64];
        assert_non_null(values);
        for (int k = 0; k < 30; k++)
        {
            double parameter[2] = {random_parameter(&random), random_parameter(&random)};
            for (uint32_t level = 0; level < LEVELS; level++)
            {
                level_values(&options, level, 0, parameter[0], across[level]);
                level_values(&options, level, 1, parameter[1], along[level]);
            }
            all_values(space, parameter, values);
            for (size_t f = 0; f < count; f++)
            {
                bat_spline_function function = hierarchical_space_function(space, f);
                check_near(values[f], across[function.level][function.i] * along[function.level][function.j], 1e-13);
            }
        }
        free(values);
        bat_hierarchical_space_free(space);
    }
}

/// The two-scale relation of a level and direction from blossoms: fine functions x coarse functions.
static double *relation_make(const bat_hierarchical_options *options, uint32_t level, int d)
{
    bat_knot_vector coarse, fine;
    size_t p = (size_t)options->degree[d], spans = options->spans[d] << level;
    assert_int_equal(knot_vector_uniform(options->degree[d], spans, &coarse, NULL), BAT_OK);
    assert_int_equal(knot_vector_uniform(options->degree[d], 2 * spans, &fine, NULL), BAT_OK);
    size_t functions = spans + p;
    double *relation = calloc((2 * spans + p) * functions, sizeof *relation);
    double *single = calloc(functions * functions, sizeof *single);
    assert_true(relation != NULL && single != NULL);
    for (size_t k = 0; k < functions; k++)
        single[k * functions + k] = 1;
    const tensor_surface all = {{coarse, {(double[]){0, 1}, 2, 0}}, single, functions};
    tensor_surface_convert(&all, 0, &fine, relation);
    free(single);
    knot_vector_free(&coarse);
    knot_vector_free(&fine);
    return relation;
}

/// What the truncated basis is by definition: functions in those of their level, taken up level by level, the coefficients
/// of the ones with support in the next region set to zero.
typedef struct truncated_reference
{
    bat_hierarchical_options options;
    const bat_hierarchical_space *space;
    refined_map map;
    uint32_t top;
    double *relation[LEVELS][2];
} truncated_reference;

static size_t level_size(const truncated_reference *r, uint32_t level, int d)
{
    return (r->options.spans[d] << level) + (size_t)r->options.degree[d];
}

/// The coefficients of a function by the finest level. The result is the caller's.
static double *reference_function(const truncated_reference *r, bat_spline_function function)
{
    size_t rows = level_size(r, function.level, 1), columns = level_size(r, function.level, 0);
    double *coefficients = calloc(rows * columns, sizeof *coefficients);
    assert_non_null(coefficients);
    coefficients[function.j * columns + function.i] = 1;
    for (uint32_t level = function.level; level < r->top; level++)
    {
        size_t fine_rows = level_size(r, level + 1, 1), fine_columns = level_size(r, level + 1, 0);
        double *fine = calloc(fine_rows * fine_columns, sizeof *fine);
        assert_non_null(fine);
        for (size_t j = 0; j < rows; j++)
            for (size_t i = 0; i < columns; i++)
                for (size_t y = 0; y < fine_rows && coefficients[j * columns + i] != 0; y++)
                    for (size_t x = 0; x < fine_columns && r->relation[level][1][y * rows + j] != 0; x++)
                        fine[y * fine_columns + x] += coefficients[j * columns + i] * r->relation[level][1][y * rows + j] *
                                                      r->relation[level][0][x * columns + i];
        for (uint32_t y = 0; y < fine_rows; y++)
            for (uint32_t x = 0; x < fine_columns; x++)
                if (map_supports(&r->map, r->options.degree, (bat_spline_function){level + 1, x, y}, false))
                    fine[y * fine_columns + x] = 0;
        free(coefficients);
        coefficients = fine;
        rows = fine_rows;
        columns = fine_columns;
    }
    return coefficients;
}

static void check_truncated(bat_random *random, const truncated_reference *r)
{
    enum
    {
        POINTS = 25
    };
    size_t count = bat_hierarchical_space_functions(r->space), columns = level_size(r, r->top, 0);
    double parameters[POINTS][2], across[POINTS][64], along[POINTS][64], *values = malloc(POINTS * count * sizeof *values);
    assert_non_null(values);
    for (size_t k = 0; k < POINTS; k++)
    {
        for (int d = 0; d < 2; d++)
        {
            parameters[k][d] = random_parameter(random);
            level_values(&r->options, r->top, d, parameters[k][d], d == 0 ? across[k] : along[k]);
        }
        all_values(r->space, parameters[k], values + k * count);
    }
    for (size_t f = 0; f < count; f++)
    {
        double *coefficients = reference_function(r, hierarchical_space_function(r->space, f));
        for (size_t k = 0; k < POINTS; k++)
        {
            double sum = 0;
            for (size_t j = 0; j < level_size(r, r->top, 1); j++)
                for (size_t i = 0; i < columns && along[k][j] != 0; i++)
                    sum += coefficients[j * columns + i] * across[k][i] * along[k][j];
            check_near(values[k * count + f], sum, 1e-13);
        }
        free(coefficients);
    }
    free(values);
}

static void test_truncated_basis(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (int trial = 0; trial < 24; trial++)
    {
        truncated_reference r = {.options = random_options(&random, 4), .top = 3};
        for (int d = 0; d < 2; d++)
            r.options.spans[d] = 1 + below(&random, 3);
        bat_hierarchical_space *space = make_space(&r.options);
        bat_spline_box boxes[4];
        size_t count = random_boxes(&random, &r.options, r.top + 1, boxes, 4);
        refine_space(space, boxes, count);
        r.space = space;
        r.map = map_make(&r.options);
        for (size_t i = 0; i < count; i++)
            map_refine(&r.map, &boxes[i]);
        for (uint32_t level = 0; level < r.top; level++)
            for (int d = 0; d < 2; d++)
                r.relation[level][d] = relation_make(&r.options, level, d);
        check_truncated(&random, &r);
        for (uint32_t level = 0; level < r.top; level++)
            for (int d = 0; d < 2; d++)
                free(r.relation[level][d]);
        map_free(&r.map);
        bat_hierarchical_space_free(space);
    }
}

/// The values of all functions at as many points in every cell as it has local functions: a matrix in columns of functions.
/// @return the number of rows
static size_t collocate(bat_random *random, const bat_hierarchical_space *space, const bat_hierarchical_space *other,
                        double **matrix, double **other_matrix)
{
    size_t count = bat_hierarchical_space_functions(space), cells = bat_hierarchical_space_cells(space);
    size_t locals = hierarchical_locals(space), rows = cells * locals;
    double *values = malloc(count * sizeof *values);
    *matrix = malloc(rows * count * sizeof **matrix);
    *other_matrix = malloc(rows * count * sizeof **other_matrix);
    assert_true(values != NULL && *matrix != NULL && *other_matrix != NULL);
    for (size_t r = 0; r < rows; r++)
    {
        double parameter[2];
        random_within(random, space, r / locals, parameter);
        all_values(space, parameter, values);
        for (size_t f = 0; f < count; f++)
            (*matrix)[f * rows + r] = values[f];
        all_values(other, parameter, values);
        for (size_t f = 0; f < count; f++)
            (*other_matrix)[f * rows + r] = values[f];
    }
    free(values);
    return rows;
}

/// The columns of `basis` are independent, and have no residuals in the span of `other`: both by the triangle R of an
/// orthogonal decomposition of all columns, in which the residuals stand below the first `count` rows.
static void check_bases(size_t rows, size_t count, const double *basis, const double *other)
{
    size_t columns = 2 * count;
    double *both[2], *side = calloc(rows, sizeof *side), *singular = calloc(count, sizeof *singular);
    double *triangle = calloc(2 * count * count, sizeof *triangle), *adjoint = calloc(2 * count * count, sizeof *adjoint);
    assert_true(side != NULL && singular != NULL && triangle != NULL && adjoint != NULL && rows >= columns);
    for (size_t order = 0; order < 2; order++)
    {
        both[order] = malloc(rows * columns * sizeof **both);
        assert_non_null(both[order]);
        for (size_t r = 0; r < rows; r++)
            for (size_t f = 0; f < columns; f++)
            {
                const double *from = (f < count) == (order == 0) ? basis : other;
                both[order][r * columns + f] = from[f % count * rows + r];
            }
        // The residuals may vanish altogether.
        (void)decompose_least_squares(rows, columns, both[order], side, NULL);
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = i; j < count; j++)
            triangle[2 * (i * count + j)] = both[0][i * columns + j];
    check_status(decompose_singular(count, triangle, singular, adjoint, NULL), BAT_OK);
    assert_true(singular[count - 1] > 1e-8 * singular[0]);
    for (size_t r = count; r < rows; r++)
        for (size_t f = count; f < columns; f++)
            check_near(both[1][r * columns + f], 0, 1e-13 * singular[0]);
    free(both[0]);
    free(both[1]);
    free(side);
    free(singular);
    free(triangle);
    free(adjoint);
}

/// The functions are linearly independent, and both bases have the same span: the plain one solves for the truncated one
/// without residuals.
static void test_independence_and_span(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 12; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 3);
        for (int d = 0; d < 2; d++)
            options.spans[d] = 1 + below(&random, 3);
        options.admissible = trial % 2 == 0 ? 0 : 2;
        bat_hierarchical_space *space = make_space(&options), *plain;
        bat_spline_box box = random_box(&random, &options, 1);
        refine_space(space, &box, 1);
        box = (bat_spline_box){2, {2, 2}, {3, 3}};
        refine_space(space, &box, 1);
        bat_spline_box *boxes;
        size_t box_count, count = bat_hierarchical_space_functions(space);
        assert_int_equal(hierarchical_space_regions(space, &boxes, &box_count, NULL), BAT_OK);
        options.truncated = false;
        options.admissible = 0;
        plain = make_space(&options);
        for (size_t b = 0; b < box_count; b++)
        {
            boxes[b].level--;
            for (int d = 0; d < 2; d++)
            {
                boxes[b].low[d] /= 2;
                boxes[b].high[d] /= 2;
            }
        }
        refine_space(plain, boxes, box_count);
        free(boxes);
        assert_int_equal(bat_hierarchical_space_functions(plain), count);
        double *matrix, *plain_matrix;
        size_t rows = collocate(&random, space, plain, &matrix, &plain_matrix);
        check_bases(rows, count, matrix, plain_matrix);
        free(matrix);
        free(plain_matrix);
        bat_hierarchical_space_free(space);
        bat_hierarchical_space_free(plain);
    }
}

/// The whole square refined is the tensor-product space of the finer grid, whichever way it came about.
static void test_whole_square(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    for (int trial = 0; trial < 40; trial++)
    {
        bat_hierarchical_options options = random_options(&random, 5), fine = options;
        options.truncated = fine.truncated = trial % 4 > 0;
        bat_hierarchical_space *space = random_space(&random, &options, 2), *tensor;
        for (uint32_t level = 0; level < 2; level++)
        {
            bat_spline_box all = {level, {0, 0}, {(uint32_t)options.spans[0] << level, (uint32_t)options.spans[1] << level}};
            refine_space(space, &all, 1);
        }
        fine.spans[0] *= 4;
        fine.spans[1] *= 4;
        tensor = make_space(&fine);
        size_t count = bat_hierarchical_space_functions(tensor), cells = bat_hierarchical_space_cells(tensor);
        assert_int_equal(bat_hierarchical_space_functions(space), count);
        assert_int_equal(bat_hierarchical_space_cells(space), cells);
        assert_int_equal(count, (fine.spans[0] + (size_t)fine.degree[0]) * (fine.spans[1] + (size_t)fine.degree[1]));
        double *here = malloc(count * sizeof *here), *there = malloc(count * sizeof *there);
        assert_true(here != NULL && there != NULL);
        for (int k = 0; k < 50; k++)
        {
            double parameter[2] = {random_parameter(&random), random_parameter(&random)}, across[64], along[64];
            all_values(space, parameter, here);
            all_values(tensor, parameter, there);
            level_values(&fine, 0, 0, parameter[0], across);
            level_values(&fine, 0, 1, parameter[1], along);
            assert_memory_equal(here, there, count * sizeof *here);
            for (size_t f = 0; f < count; f++)
            {
                bat_spline_function function = hierarchical_space_function(tensor, f);
                check_near(here[f], across[function.i] * along[function.j], 1e-13);
            }
        }
        free(here);
        free(there);
        bat_hierarchical_space_free(space);
        bat_hierarchical_space_free(tensor);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_partition_of_unity),    cmocka_unit_test(test_deep_partition_of_unity),
        cmocka_unit_test(test_plain_basis),           cmocka_unit_test(test_truncated_basis),
        cmocka_unit_test(test_independence_and_span), cmocka_unit_test(test_whole_square),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

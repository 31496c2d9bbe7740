#include "check.h"

#include "batten/spline.h"
#include "surface/spline/tensor_surface.h"

#include "surface/spline/hierarchical_space.h"
#include "tensor_helpers.h"

#include <float.h>

static double uniform(bat_random *random, double low, double high)
{
    return low + (high - low) * bat_random_uniform(random);
}

static size_t below(bat_random *random, size_t count)
{
    return (size_t)(bat_random_bits(random) % count);
}

/// A knot vector with knots of any multiplicity, clamped or with knots outside its domain.
static bat_knot_vector random_knots(bat_random *random, int degree, bool continuous)
{
    size_t p = (size_t)degree, spans = 1 + below(random, 5), count = 0;
    double *knots = malloc((2 * (p + 1) + spans * (p + 1)) * sizeof *knots), at = uniform(random, -1, 1);
    assert_non_null(knots);
    bool clamped = below(random, 2) == 0;
    for (size_t i = 0; i <= p; i++)
        knots[count++] = clamped || i == 0 ? at : (at += uniform(random, 0.1, 1) * (double)below(random, 2));
    if (!clamped && count > 1 && knots[0] == at && p > 0)
        knots[0] -= 0.5;
    for (size_t s = 1; s < spans; s++)
    {
        at += uniform(random, 0.2, 1);
        size_t multiplicity = 1 + below(random, continuous ? (p > 1 ? p : 1) : p + 1);
        for (size_t m = 0; m < multiplicity; m++)
            knots[count++] = at;
    }
    at += uniform(random, 0.2, 1);
    for (size_t i = 0; i <= p; i++)
        knots[count++] = clamped || i == 0 ? at : (at += uniform(random, 0.1, 1));
    return (bat_knot_vector){knots, count, degree};
}

static double domain_begin(const bat_knot_vector *knots)
{
    return knots->knots[knots->degree];
}

static double domain_end(const bat_knot_vector *knots)
{
    return knots->knots[knot_vector_functions(knots)];
}

/// A parameter of the domain: anywhere, or at a knot, or at an end.
static double random_parameter(bat_random *random, const bat_knot_vector *knots)
{
    double t = uniform(random, domain_begin(knots), domain_end(knots));
    if (below(random, 8) == 0)
        t = fmin(fmax(knots->knots[below(random, knots->count)], domain_begin(knots)), domain_end(knots));
    return t;
}

/// The definition by Cox and de Boor, over the span that counts as holding t.
static double reference_basis(const bat_knot_vector *knots, size_t i, int degree, size_t span, double t)
{
    const double *k = knots->knots;
    if (degree == 0)
        return i == span ? 1 : 0;
    double left = k[i + (size_t)degree] - k[i], right = k[i + (size_t)degree + 1] - k[i + 1], value = 0;
    if (left > 0)
        value += (t - k[i]) / left * reference_basis(knots, i, degree - 1, span, t);
    if (right > 0)
        value += (k[i + (size_t)degree + 1] - t) / right * reference_basis(knots, i + 1, degree - 1, span, t);
    return value;
}

static void test_basis(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    for (int trial = 0; trial < 400; trial++)
    {
        int degree = trial % 9;
        bat_knot_vector knots = random_knots(&random, degree, false);
        assert_int_equal(knot_vector_check(&knots, NULL), BAT_OK);
        double t = random_parameter(&random, &knots), values[9], sum = 0;
        size_t span = knot_vector_span(&knots, t);
        assert_true(knots.knots[span] < knots.knots[span + 1] && knots.knots[span] <= t);
        assert_true(t < knots.knots[span + 1] || (t == domain_end(&knots) && knots.knots[span + 1] == t));
        knot_vector_basis(&knots, span, t, 0, values);
        for (int a = 0; a <= degree; a++)
        {
            assert_true(values[a] >= 0);
            check_near(values[a], reference_basis(&knots, span - (size_t)(degree - a), degree, span, t), 1e-13);
            sum += values[a];
        }
        check_near(sum, 1, 1e-13);
        knot_vector_free(&knots);
    }
}

/// Marsden's identity, (x - t)^p = sum_i prod_k (x - knots[i + k]) B_i(t), and its derivatives by t.
static void test_derivatives(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    for (int trial = 0; trial < 300; trial++)
    {
        int degree = trial % 7;
        size_t p = (size_t)degree;
        bat_knot_vector knots = random_knots(&random, degree, false);
        double t = random_parameter(&random, &knots), x = uniform(&random, -1, 3), values[8 * 7], factor = 1;
        size_t span = knot_vector_span(&knots, t);
        knot_vector_basis(&knots, span, t, 7, values);
        for (size_t order = 0; order <= 7; order++)
        {
            double sum = 0, size = 0;
            for (size_t a = 0; a <= p; a++)
            {
                double coefficient = 1;
                for (size_t k = 1; k <= p; k++)
                    coefficient *= x - knots.knots[span - p + a + k];
                sum += coefficient * values[order * (p + 1) + a];
                size += fabs(coefficient * values[order * (p + 1) + a]);
            }
            double expected = order > p ? 0 : factor * pow(x - t, (double)(p - order));
            check_near(sum, expected, 1e-13 * (1 + size));
            factor *= -(double)(p - order);
        }
        knot_vector_free(&knots);
    }
}

static void check_refused(double *numbers, size_t count, int degree, size_t index)
{
    bat_knot_vector knots = {numbers, count, degree};
    bat_error error;
    assert_int_equal(knot_vector_check(&knots, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, index);
}

static void test_knot_vectors(void **state)
{
    (void)state;
    check_refused((double[]){0, 0, 1, 1}, 4, -1, BAT_NO_INDEX);
    check_refused((double[]){0, 0, 1, 1}, 4, BAT_SPLINE_MAX_DEGREE + 1, BAT_NO_INDEX);
    check_refused((double[]){0, 0, 1}, 3, 1, BAT_NO_INDEX);
    check_refused((double[]){0, 0, NAN, 1, 1}, 5, 1, 2);
    check_refused((double[]){0, 0, 1, 0.5, 1}, 5, 1, 3);
    check_refused((double[]){0, 0, 0, 1, 1}, 5, 1, 2);
    check_refused((double[]){0, 1, 1, 2}, 4, 1, 1);
    bat_knot_vector knots;
    assert_int_equal(knot_vector_uniform(3, 0, &knots, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(knot_vector_uniform(16, 1, &knots, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(knot_vector_uniform(1, SIZE_MAX / 4, &knots, NULL), BAT_TOO_LARGE);
    assert_int_equal(knot_vector_uniform(2, 3, &knots, NULL), BAT_OK);
    const double expected[] = {0, 0, 0, 1. / 3, 2. / 3, 1, 1, 1};
    assert_int_equal(knots.count, 8);
    assert_memory_equal(knots.knots, expected, sizeof expected);
    assert_int_equal(knot_vector_functions(&knots), 5);
    knot_vector_free(&knots);
    assert_null(knots.knots);
}

static tensor_surface random_surface(bat_random *random, int p, int q, bool continuous)
{
    tensor_surface surface = {.knots = {random_knots(random, p, continuous), random_knots(random, q, continuous)},
                              .dimension = 1 + below(random, 3)};
    size_t size = knot_vector_functions(&surface.knots[0]) * knot_vector_functions(&surface.knots[1]);
    surface.control = malloc(size * surface.dimension * sizeof(double));
    assert_non_null(surface.control);
    for (size_t i = 0; i < size * surface.dimension; i++)
        surface.control[i] = uniform(random, -1, 1);
    check_tensor_surface(&surface);
    return surface;
}

/// Two surfaces are the same where both are: positions to `tolerance`. Jumps are avoided.
static void check_same(bat_random *random, const tensor_surface *a, const tensor_surface *b, double tolerance)
{
    for (int k = 0; k < 50; k++)
    {
        double parameter[2], here[3], there[3];
        for (int d = 0; d < 2; d++)
            parameter[d] = uniform(random, fmax(domain_begin(&a->knots[d]), domain_begin(&b->knots[d])),
                                   fmin(domain_end(&a->knots[d]), domain_end(&b->knots[d])));
        tensor_surface_at(a, parameter, here);
        tensor_surface_at(b, parameter, there);
        for (size_t d = 0; d < a->dimension; d++)
            check_near(here[d], there[d], tolerance);
    }
}

static void test_restrict(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(9);
    for (int trial = 0; trial < 200; trial++)
    {
        bat_random same = random;
        tensor_surface s = random_surface(&random, 1 + trial % 5, 1 + trial / 5 % 5, true);
        tensor_surface before = random_surface(&same, 1 + trial % 5, 1 + trial / 5 % 5, true);
        for (int d = 0; d < 2; d++)
        {
            double a = random_parameter(&random, &s.knots[d]), b = random_parameter(&random, &s.knots[d]);
            double low = fmin(a, b), high = fmax(a, b);
            if (high - low < 1e-3)
                continue;
            assert_int_equal(tensor_surface_restrict(&s, d, low, high, NULL), BAT_OK);
            for (int k = 0; k <= s.knots[d].degree; k++)
            {
                check_near(s.knots[d].knots[k], low, 0);
                check_near(s.knots[d].knots[s.knots[d].count - 1 - (size_t)k], high, 0);
            }
        }
        check_tensor_surface(&s);
        check_same(&random, &s, &before, 1e-13);
        tensor_surface_free(&s);
        tensor_surface_free(&before);
    }
}

/// The functions of a cell are those of the whole knot vector.
static void test_uniform_values(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(10);
    for (int trial = 0; trial < 2000; trial++)
    {
        int degree = 1 + trial % BAT_SPLINE_MAX_DEGREE;
        size_t cells = 1 + below(&random, 40), count = (size_t)degree + 1;
        bat_knot_vector knots;
        assert_int_equal(knot_vector_uniform(degree, cells, &knots, NULL), BAT_OK);
        double t = bat_random_uniform(&random), expected[3 * 16], values[3 * 16], power = 1;
        size_t span = knot_vector_span(&knots, t), cell = span - (size_t)degree;
        knot_vector_basis(&knots, span, t, 2, expected);
        uniform_basis_values(degree, cells, cell, t * (double)cells - (double)cell, 2, values);
        for (size_t k = 0; k < 3; k++, power *= (double)cells)
            for (size_t a = 0; a < count; a++)
                check_near(values[k * count + a] * power, expected[k * count + a],
                           1e-13 * power * pow(degree, 2. * (double)k));
        knot_vector_free(&knots);
    }
}

/// A coarse function is the sum of its children, which count nonnegative shares that add up to one over all coarse
/// functions.
static void test_two_scale(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(11);
    for (int degree = 1; degree <= BAT_SPLINE_MAX_DEGREE; degree++)
    {
        uniform_basis basis;
        assert_int_equal(uniform_basis_make(degree, &basis, NULL), BAT_OK);
        size_t p = (size_t)degree;
        for (size_t cells = 1; cells < 3 * p; cells++)
        {
            size_t cell = below(&random, cells), half = below(&random, 2), count = p + 1;
            uniform_refinement block = uniform_basis_refinement(&basis, cells, cell, half);
            double s = bat_random_uniform(&random), coarse[16], fine[16];
            uniform_basis_values(degree, cells, cell, ((double)half + s) / 2, 0, coarse);
            uniform_basis_values(degree, 2 * cells, 2 * cell + half, s, 0, fine);
            for (size_t a = 0; a < count; a++)
            {
                double sum = 0;
                for (size_t b = 0; b < count; b++)
                {
                    double share = block.rows[a * block.stride + b];
                    assert_true(share >= 0);
                    sum += share * fine[b];
                    check_near(share, uniform_basis_two_scale(&basis, cells, cell + a, 2 * cell + half + b), 0);
                }
                check_near(sum, coarse[a], 1e-14);
            }
            for (size_t b = 0; b < count; b++)
            {
                double sum = 0;
                for (size_t a = 0; a < count; a++)
                    sum += block.rows[a * block.stride + b];
                check_near(sum, 1, 4 * DBL_EPSILON);
            }
        }
        uniform_basis_free(&basis);
    }
    // Far from the ends the shares are binomial numbers over 2^p.
    uniform_basis cubic;
    assert_int_equal(uniform_basis_make(3, &cubic, NULL), BAT_OK);
    const double shares[] = {0, 1, 4, 6, 4, 1, 0};
    for (size_t k = 0; k < 7; k++)
        check_near(uniform_basis_two_scale(&cubic, 100, 50, 96 + k), shares[k] / 8, 0);
    uniform_basis_free(&cubic);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_basis),    cmocka_unit_test(test_derivatives),    cmocka_unit_test(test_knot_vectors),
        cmocka_unit_test(test_restrict), cmocka_unit_test(test_uniform_values), cmocka_unit_test(test_two_scale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

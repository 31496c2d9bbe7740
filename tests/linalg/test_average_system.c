// Systems of averages: solutions that are known.

#include "check.h"

#include "linalg/sparse.h"

/// A chain between 0 and 1 with weights one half: the solution is linear.
static void chains_are_linear(void **state)
{
    (void)state;
    const size_t counts[] = {1, 2, 47, 48, 49, 50, 1000, 20000};
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++)
    {
        size_t count = counts[n], at = 0;
        sparse_rows weights;
        double *constant = calloc(2 * count, sizeof *constant), *x = calloc(2 * count, sizeof *x);
        assert_true(constant != NULL && x != NULL);
        check_status(sparse_rows_make(count, count, 2 * count - 2, &weights, NULL), BAT_OK);
        for (size_t i = 0; i < count; i++)
        {
            weights.starts[i] = at;
            for (int side = -1; side <= 1; side += 2)
                if (side > 0 ? i + 1 < count : i > 0)
                {
                    weights.columns[at] = (uint32_t)(side > 0 ? i + 1 : i - 1);
                    weights.values[at++] = 0.5;
                }
        }
        constant[2 * count - 2] += 0.5;
        constant[1] += 0.5;
        check_status(average_solve(&weights, constant, x, NULL), BAT_OK);
        // The inverse has entries up to count / 2.
        double tolerance = 1e-15 * (double)(count + 10) * (double)(count + 10);
        for (size_t i = 0; i < count; i++)
        {
            check_near(x[2 * i], (double)(i + 1) / (double)(count + 1), tolerance);
            check_near(x[2 * i + 1], 1 - (double)(i + 1) / (double)(count + 1), tolerance);
        }
        sparse_rows_free(&weights);
        free(constant);
        free(x);
    }
}

/// Random averages of few others with weights over many orders of size, among them pairs that see each other almost alone.
static sparse_rows random_weights(size_t count, uint64_t seed)
{
    enum
    {
        ENTRIES = 6
    };
    bat_random random = bat_random_seed(seed);
    sparse_rows weights;
    check_status(sparse_rows_make(count, count, ENTRIES * count, &weights, NULL), BAT_OK);
    for (size_t i = 0; i < count; i++)
    {
        double sum = 0;
        weights.starts[i] = ENTRIES * i;
        for (size_t e = 0; e < ENTRIES; e++)
        {
            // The partner, then points at growing distances.
            size_t place = e == 0 ? i ^ 1 : (i + 2 + e * e * (1 + (size_t)(bat_random_uniform(&random) * 7))) % count;
            weights.columns[ENTRIES * i + e] = (uint32_t)place;
            weights.values[ENTRIES * i + e] = e == 0 ? 20 : exp(-6 * bat_random_uniform(&random));
            for (size_t f = 0; f < e; f++)
                if (weights.columns[ENTRIES * i + f] == place)
                    weights.values[ENTRIES * i + e] = 0;
            if (place == i)
                weights.values[ENTRIES * i + e] = 0;
            sum += weights.values[ENTRIES * i + e];
        }
        // One row in fifty is given a share.
        for (size_t e = 0; e < ENTRIES; e++)
            weights.values[ENTRIES * i + e] *= (i % 50 == 7 ? 0.5 : 1) / sum;
    }
    return weights;
}

/// Random systems: each equation holds, and averages stay within the range of what is given.
static void equations_hold(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++)
    {
        size_t count = 40 + 400 * seed;
        sparse_rows weights = random_weights(count, seed);
        double *constant = calloc(2 * count, sizeof *constant), *x = calloc(2 * count, sizeof *x);
        assert_true(constant != NULL && x != NULL);
        for (size_t i = 7; i < count; i += 50)
        {
            constant[2 * i] = 0.5 * (double)(i % 3) / 2;
            constant[2 * i + 1] = 0.5;
        }
        check_status(average_solve(&weights, constant, x, NULL), BAT_OK);
        for (size_t i = 0; i < count; i++)
        {
            double sum = constant[2 * i];
            for (size_t e = weights.starts[i]; e < weights.starts[i + 1]; e++)
                sum += weights.values[e] * x[2 * (size_t)weights.columns[e]];
            check_near(x[2 * i], sum, 1e-12);
            assert_true(x[2 * i] >= -1e-12 && x[2 * i] <= 1 + 1e-12);
            // Where all that is given is 1, so is everything.
            check_near(x[2 * i + 1], 1, 1e-11);
        }
        sparse_rows_free(&weights);
        free(constant);
        free(x);
    }
}

/// Two unknowns that are each other's only neighbour have no solution.
static void singular_systems_are_told(void **state)
{
    (void)state;
    sparse_rows weights;
    check_status(sparse_rows_make(2, 2, 2, &weights, NULL), BAT_OK);
    weights.starts[1] = 1;
    weights.columns[0] = 1;
    weights.columns[1] = 0;
    weights.values[0] = weights.values[1] = 1;
    const double constant[4] = {0};
    double x[4];
    bat_error error;
    check_status(average_solve(&weights, constant, x, &error), BAT_NO_CONVERGENCE);
    assert_non_null(strstr(error.text, "singular"));
    sparse_rows_free(&weights);
}

/// A transpose against a dense one.
static void transposes_are_dense_ones(void **state)
{
    (void)state;
    enum
    {
        SIDE = 30
    };
    sparse_rows a = random_weights(SIDE, 3), transposed;
    double dense[SIDE][SIDE] = {{0}}, turned[SIDE][SIDE] = {{0}};
    check_status(sparse_rows_transpose(&a, &transposed, NULL), BAT_OK);
    for (size_t i = 0; i < SIDE; i++)
    {
        for (size_t e = a.starts[i]; e < a.starts[i + 1]; e++)
            dense[i][a.columns[e]] += a.values[e];
        for (size_t e = transposed.starts[i]; e < transposed.starts[i + 1]; e++)
            turned[i][transposed.columns[e]] += transposed.values[e];
    }
    for (size_t i = 0; i < SIDE; i++)
        for (size_t j = 0; j < SIDE; j++)
            check_near(turned[j][i], dense[i][j], 0);
    sparse_rows_free(&a);
    sparse_rows_free(&transposed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chains_are_linear),
        cmocka_unit_test(equations_hold),
        cmocka_unit_test(singular_systems_are_told),
        cmocka_unit_test(transposes_are_dense_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

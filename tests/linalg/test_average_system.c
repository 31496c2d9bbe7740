// Systems of averages: solutions that are known, and ways to solve that agree.

#include "check.h"

#include "linalg/sparse.h"

static bat_status solve_iteratively(const sparse_rows *weights, const double *constant, double *x, bat_error *error)
{
    return average_solve_iterative(weights, constant, 0, x, error);
}

/// The ways to solve: the iterative one and the direct one.
static bat_status (*const ways[])(const sparse_rows *, const double *, double *, bat_error *) = {
    solve_iteratively,
    average_solve_direct,
};
static const size_t way_count = sizeof ways / sizeof *ways;

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
        for (size_t way = 0; way < way_count; way++)
        {
            check_status(ways[way](&weights, constant, x, NULL), BAT_OK);
            // The inverse has entries up to count / 2.
            double tolerance = 1e-15 * (double)(count + 10) * (double)(count + 10);
            for (size_t i = 0; i < count; i++)
            {
                check_near(x[2 * i], (double)(i + 1) / (double)(count + 1), tolerance);
                check_near(x[2 * i + 1], 1 - (double)(i + 1) / (double)(count + 1), tolerance);
            }
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

static void all_ways_agree(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 6; seed++)
    {
        size_t count = 40 + 400 * seed;
        sparse_rows weights = random_weights(count, seed);
        double *constant = calloc(2 * count, sizeof *constant), *a = calloc(2 * count, sizeof *a),
               *b = calloc(2 * count, sizeof *b);
        assert_true(constant != NULL && a != NULL && b != NULL);
        for (size_t i = 7; i < count; i += 50)
        {
            constant[2 * i] = 0.5 * (double)(i % 3) / 2;
            constant[2 * i + 1] = 0.5;
        }
        check_status(ways[0](&weights, constant, a, NULL), BAT_OK);
        for (size_t way = 0; way < way_count; way++)
        {
            check_status(ways[way](&weights, constant, b, NULL), BAT_OK);
            for (size_t i = 0; i < count; i++)
            {
                check_near(a[2 * i], b[2 * i], 1e-11);
                assert_true(b[2 * i] >= -1e-12 && b[2 * i] <= 1 + 1e-12);
                // Where all that is given is 1, so is everything.
                check_near(b[2 * i + 1], 1, 1e-11);
            }
        }
        sparse_rows_free(&weights);
        free(constant);
        free(a);
        free(b);
    }
}

/// Enough unknowns for several blocks of rows: any number of threads gives the same bytes.
static void threads_change_no_byte(void **state)
{
    (void)state;
    size_t count = 60000;
    sparse_rows weights = random_weights(count, 8);
    double *constant = calloc(2 * count, sizeof *constant), *one = calloc(2 * count, sizeof *one),
           *other = calloc(2 * count, sizeof *other);
    assert_true(constant != NULL && one != NULL && other != NULL);
    for (size_t i = 7; i < count; i += 50)
    {
        constant[2 * i] = (double)(i % 3) / 4;
        constant[2 * i + 1] = 0.5;
    }
    check_status(average_solve_iterative(&weights, constant, 1, one, NULL), BAT_OK);
    for (size_t i = 0; i < count; i++)
        check_near(one[2 * i + 1], 1, 1e-11);
    for (int threads = 2; threads <= 3; threads++)
    {
        check_status(average_solve_iterative(&weights, constant, threads, other, NULL), BAT_OK);
        assert_memory_equal(one, other, 2 * count * sizeof *one);
    }
    sparse_rows_free(&weights);
    free(constant);
    free(one);
    free(other);
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
    for (size_t way = 0; way < way_count; way++)
    {
        check_status(ways[way](&weights, constant, x, &error), BAT_NO_CONVERGENCE);
        assert_non_null(strstr(error.text, "singular"));
    }
    sparse_rows_free(&weights);
}

/// Products and transposes against dense ones.
static void sparse_products_are_dense_ones(void **state)
{
    (void)state;
    enum
    {
        SIDE = 30
    };
    sparse_rows a = random_weights(SIDE, 3), b = random_weights(SIDE, 4), product, transposed;
    double dense_a[SIDE][SIDE] = {{0}}, dense_b[SIDE][SIDE] = {{0}}, found[SIDE][SIDE] = {{0}}, turned[SIDE][SIDE] = {{0}};
    check_status(sparse_rows_multiply(&a, &b, true, &product, NULL), BAT_OK);
    check_status(sparse_rows_transpose(&a, &transposed, NULL), BAT_OK);
    for (size_t i = 0; i < SIDE; i++)
    {
        for (size_t e = a.starts[i]; e < a.starts[i + 1]; e++)
            dense_a[i][a.columns[e]] += a.values[e];
        for (size_t e = b.starts[i]; e < b.starts[i + 1]; e++)
            dense_b[i][b.columns[e]] += b.values[e];
        for (size_t e = product.starts[i]; e < product.starts[i + 1]; e++)
        {
            assert_true(found[i][product.columns[e]] == 0);
            found[i][product.columns[e]] = product.values[e];
            assert_true(product.columns[e] != i || e == product.starts[i]);
        }
        for (size_t e = transposed.starts[i]; e < transposed.starts[i + 1]; e++)
            turned[i][transposed.columns[e]] += transposed.values[e];
    }
    for (size_t i = 0; i < SIDE; i++)
        for (size_t j = 0; j < SIDE; j++)
        {
            double sum = 0;
            for (size_t k = 0; k < SIDE; k++)
                sum += dense_a[i][k] * dense_b[k][j];
            check_near(found[i][j], sum, 1e-15);
            check_near(turned[j][i], dense_a[i][j], 0);
        }
    sparse_rows_free(&a);
    sparse_rows_free(&b);
    sparse_rows_free(&product);
    sparse_rows_free(&transposed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chains_are_linear),
        cmocka_unit_test(all_ways_agree),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(singular_systems_are_told),
        cmocka_unit_test(sparse_products_are_dense_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// The multifrontal method: its tree of fronts against symbolic elimination of dense matrices, and solutions that are known.

#include "check.h"

#include "batten/base.h"
#include "linalg/blas.h"
#include "linalg/multifrontal.h"

/// The least pivot of a factorization.
static double factor(multifrontal *solver, const double *lower, const double *upper)
{
    double pivot = -1;
    assert_int_equal(multifrontal_factor(solver, lower, upper, &pivot, NULL), BAT_OK);
    return pivot;
}

/// A pattern with random values on both sides of the diagonal.
typedef struct test_system
{
    symmetric_pattern pattern;
    int *first, *row;
    double *lower, *upper;
} test_system;

/// Graphs whose fronts differ: from many small ones to a single large one.
typedef enum graph
{
    GRAPH_DIAGONAL, ///< no entries off the diagonal
    GRAPH_CHAIN,
    GRAPH_HUB,    ///< the first unknown meets all others
    GRAPH_PARTS,  ///< chains of seven
    GRAPH_RANDOM, ///< each unknown meets four others
    GRAPH_GRID,   ///< each unknown meets those up to two steps away in a square grid
    GRAPH_DENSE,
    GRAPHS
} graph;

static bool meet(graph kind, size_t count, size_t i, size_t j)
{
    size_t side = (size_t)ceil(sqrt((double)count)), far = i - j, down = i / side - j / side;
    size_t across = i % side > j % side ? i % side - j % side : j % side - i % side;
    switch (kind)
    {
    case GRAPH_CHAIN:
        return far == 1;
    case GRAPH_HUB:
        return j == 0;
    case GRAPH_PARTS:
        return far == 1 && i % 7 != 0;
    case GRAPH_RANDOM:
        return (i * 7919 + j * 104729 + i * j * 31) % count < 4;
    case GRAPH_GRID:
        return down <= 2 && across <= 2;
    case GRAPH_DENSE:
        return true;
    default:
        return false;
    }
}

/// Row sums of moduli below the diagonal entries, signs as in an M-matrix.
static test_system make_system(graph kind, size_t count, bool symmetric, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    size_t entries = 0;
    for (size_t j = 0; j < count; j++)
        for (size_t i = j; i < count; i++)
            entries += i == j || meet(kind, count, i, j);
    test_system made = {.first = calloc(count + 1, sizeof(int)),
                        .row = calloc(entries, sizeof(int)),
                        .lower = calloc(entries, sizeof(double)),
                        .upper = calloc(entries, sizeof(double))};
    assert_true(made.first != NULL && made.row != NULL && made.lower != NULL && made.upper != NULL);
    made.pattern = (symmetric_pattern){count, made.first, made.row};
    int at = 0;
    for (size_t j = 0; j < count; j++)
    {
        made.first[j] = at;
        for (size_t i = j; i < count; i++)
            if (i == j || meet(kind, count, i, j))
            {
                made.row[at] = (int)i;
                made.lower[at] = -bat_random_uniform(&random);
                made.upper[at] = symmetric ? made.lower[at] : -bat_random_uniform(&random);
                at++;
            }
    }
    made.first[count] = at;
    for (size_t j = 0; j < count; j++)
        made.lower[made.first[j]] = made.upper[made.first[j]] = 0.01;
    for (size_t j = 0; j < count; j++)
        for (int k = made.first[j] + 1; k < made.first[j + 1]; k++)
        {
            made.lower[made.first[made.row[k]]] -= made.lower[k];
            made.lower[made.first[j]] -= made.upper[k];
        }
    for (size_t j = 0; j < count; j++)
        made.upper[made.first[j]] = made.lower[made.first[j]];
    return made;
}

static void free_system(test_system *made)
{
    free(made->first);
    free(made->row);
    free(made->lower);
    free(made->upper);
}

/// product = A x
static void multiply(const test_system *made, size_t columns, const double *x, double *product)
{
    memset(product, 0, made->pattern.count * columns * sizeof *product);
    for (size_t j = 0; j < made->pattern.count; j++)
        for (int k = made->first[j]; k < made->first[j + 1]; k++)
        {
            size_t i = (size_t)made->row[k];
            for (size_t c = 0; c < columns; c++)
            {
                product[i * columns + c] += made->lower[k] * x[j * columns + c];
                if (i != j)
                    product[j * columns + c] += made->upper[k] * x[i * columns + c];
            }
        }
}

/// The largest |A x - b| for random b and the x that is found.
static double residual_of(const test_system *made, const multifrontal *solver, size_t columns)
{
    size_t numbers = made->pattern.count * columns;
    bat_random random = bat_random_seed(numbers);
    double *b = calloc(numbers, sizeof *b), *x = calloc(numbers, sizeof *x), *product = calloc(numbers, sizeof *product);
    assert_true(b != NULL && x != NULL && product != NULL);
    for (size_t k = 0; k < numbers; k++)
        b[k] = x[k] = bat_random_normal(&random);
    check_status(multifrontal_solve(solver, columns, x, NULL), BAT_OK);
    multiply(made, columns, x, product);
    double largest = 0;
    for (size_t k = 0; k < numbers; k++)
        largest = fmax(largest, fabs(product[k] - b[k]));
    free(b);
    free(x);
    free(product);
    return largest;
}

static const size_t COUNTS[] = {1, 2, 3, 6, 20, 121, 400};

static void solutions_solve(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof COUNTS / sizeof *COUNTS; n++)
        for (int kind = 0; kind < GRAPHS; kind++)
            for (int symmetric = 0; symmetric < 2; symmetric++)
            {
                test_system made = make_system((graph)kind, COUNTS[n], symmetric, 5 + (uint64_t)kind);
                multifrontal *solver = NULL;
                check_status(multifrontal_make(&made.pattern, symmetric, &solver, NULL), BAT_OK);
                double pivot = factor(solver, made.lower, symmetric ? NULL : made.upper);
                assert_true(pivot > 0 && pivot <= 1);
                for (size_t columns = 1; columns <= 5; columns += 2)
                    check_near(residual_of(&made, solver, columns), 0, 1e-11);
                multifrontal_free(solver);
                free_system(&made);
            }
}

/// Fronts of more pivots and rows than are worked on at a time.
static void large_fronts_solve(void **state)
{
    (void)state;
    for (int symmetric = 0; symmetric < 2; symmetric++)
    {
        test_system made = make_system(GRAPH_GRID, 4900, symmetric, 9);
        multifrontal *solver = NULL;
        check_status(multifrontal_make(&made.pattern, symmetric, &solver, NULL), BAT_OK);
        assert_true(factor(solver, made.lower, symmetric ? NULL : made.upper) > 0);
        check_near(residual_of(&made, solver, 3), 0, 1e-10);
        multifrontal_free(solver);
        free_system(&made);
    }
}

/// Which entries the factor of a dense matrix in this order has: by columns, `count` x `count`.
static bool *eliminate_pattern(const symmetric_pattern *pattern, const front_tree *tree)
{
    size_t count = pattern->count;
    bool *filled = calloc(count * count, sizeof *filled);
    size_t *place = calloc(count, sizeof *place);
    assert_true(filled != NULL && place != NULL);
    for (size_t k = 0; k < count; k++)
        place[tree->order[k]] = k;
    for (size_t j = 0; j < count; j++)
        for (int k = pattern->first[j]; k < pattern->first[j + 1]; k++)
        {
            size_t a = place[j], b = place[pattern->row[k]];
            filled[a < b ? a * count + b : b * count + a] = true;
        }
    for (size_t k = 0; k < count; k++)
        for (size_t j = k + 1; j < count; j++)
            for (size_t i = j; i < count && filled[k * count + j]; i++)
                filled[j * count + i] |= filled[k * count + i];
    free(place);
    return filled;
}

/// The rows of a front are those of its columns in the factor, some zeros among them.
static void check_front(const front_tree *tree, const bool *filled, size_t f, size_t *zeros)
{
    size_t count = tree->count, begin = (size_t)tree->pivot_first[f], end = (size_t)tree->pivot_first[f + 1];
    bool *has = calloc(count, sizeof *has);
    assert_non_null(has);
    for (size_t k = begin; k < end; k++)
        has[k] = true;
    for (size_t k = tree->row_first[f]; k < tree->row_first[f + 1]; k++)
    {
        assert_true((size_t)tree->rows[k] >= end);
        assert_true(k == tree->row_first[f] || tree->rows[k] > tree->rows[k - 1]);
        has[tree->rows[k]] = true;
    }
    for (size_t k = begin; k < end; k++)
        for (size_t i = k; i < count; i++)
        {
            assert_true(has[i] || !filled[k * count + i]);
            *zeros += has[i] && !filled[k * count + i];
        }
    // No row without an entry in the last column.
    for (size_t k = tree->row_first[f]; k < tree->row_first[f + 1]; k++)
        assert_true(filled[(end - 1) * count + (size_t)tree->rows[k]]);
    free(has);
}

static void fronts_hold_the_factor(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof COUNTS / sizeof *COUNTS; n++)
        for (int kind = 0; kind < GRAPHS; kind++)
        {
            test_system made = make_system((graph)kind, COUNTS[n], true, 1);
            front_tree tree;
            check_status(front_tree_make(&made.pattern, &tree, NULL), BAT_OK);
            bool *filled = eliminate_pattern(&made.pattern, &tree);
            size_t zeros = 0, entries = 0;
            for (size_t k = 0; k < COUNTS[n] * COUNTS[n]; k++)
                entries += filled[k];
            for (size_t f = 0; f < tree.fronts; f++)
                check_front(&tree, filled, f, &zeros);
            assert_int_equal(tree.pivot_first[tree.fronts], COUNTS[n]);
            // The largest share of zeros that a front of more than four pivots is merged for; smaller ones have at most six.
            assert_true(zeros <= 4 * entries + 6 * COUNTS[n]);
            if (kind == GRAPH_DENSE)
                assert_int_equal(tree.fronts, 1);
            if (kind == GRAPH_DIAGONAL)
                assert_int_equal(tree.fronts, COUNTS[n]);
            // The hub comes last: there is no fill.
            if (kind == GRAPH_HUB || kind == GRAPH_CHAIN)
                assert_int_equal(entries, 2 * COUNTS[n] - 1);
            free(filled);
            front_tree_free(&tree);
            free_system(&made);
        }
}

static void pivots_tell_singular_matrices(void **state)
{
    (void)state;
    int first[] = {0, 2, 3}, row[] = {0, 1, 1};
    const symmetric_pattern pattern = {2, first, row};
    const double regular[] = {4, 1.2, 0.4}, singular[] = {4, 2, 1}, indefinite[] = {4, 3, 1}, negative[] = {-1, 0, 1};
    const double wrong[] = {4, NAN, 1}, infinite[] = {INFINITY, 0, 1};
    multifrontal *solver = NULL;
    check_status(multifrontal_make(&pattern, true, &solver, NULL), BAT_OK);
    check_near(factor(solver, regular, NULL), 1 - 1.2 * 1.2 / (4 * 0.4), 1e-15);
    assert_true(factor(solver, singular, NULL) < 1e-15);
    assert_true(factor(solver, indefinite, NULL) == 0);
    assert_true(factor(solver, negative, NULL) == 0);
    assert_true(factor(solver, wrong, NULL) == 0);
    assert_true(factor(solver, infinite, NULL) == 0);
    check_near(factor(solver, regular, NULL), 0.1, 1e-15);
    multifrontal_free(solver);

    // Rows that sum up to 0.
    test_system made = make_system(GRAPH_GRID, 400, true, 3);
    for (size_t j = 0; j < 400; j++)
        made.lower[made.first[j]] -= 0.01;
    check_status(multifrontal_make(&made.pattern, true, &solver, NULL), BAT_OK);
    assert_true(factor(solver, made.lower, NULL) < 1e-13);
    multifrontal_free(solver);
    free_system(&made);
}

/// Solve after each of some factorizations with a number of threads of BLAS.
static void solve_often(const test_system *made, const test_system *other, int threads, double *x)
{
    size_t count = made->pattern.count;
    multifrontal *solver = NULL;
    openblas_set_num_threads(threads);
    check_status(multifrontal_make(&made->pattern, false, &solver, NULL), BAT_OK);
    for (int k = 0; k < threads; k++)
    {
        assert_true(factor(solver, other->lower, other->upper) > 0);
        assert_true(factor(solver, made->lower, made->upper) > 0);
    }
    for (size_t i = 0; i < count; i++)
        x[i] = 1 + (double)(i % 5);
    check_status(multifrontal_solve(solver, 1, x, NULL), BAT_OK);
    multifrontal_free(solver);
}

static void threads_and_earlier_matrices_change_no_byte(void **state)
{
    (void)state;
    test_system made = make_system(GRAPH_GRID, 4900, false, 2), other = make_system(GRAPH_GRID, 4900, false, 4);
    double *one = calloc(4900, sizeof *one), *more = calloc(4900, sizeof *more);
    assert_int_equal(blas_load(NULL), BAT_OK);
    int before = openblas_get_num_threads();
    assert_true(one != NULL && more != NULL);
    solve_often(&made, &other, 1, one);
    for (int threads = 2; threads <= 3; threads++)
    {
        solve_often(&made, &other, threads, more);
        assert_memory_equal(one, more, 4900 * sizeof *one);
        assert_int_equal(openblas_get_num_threads(), threads);
    }
    openblas_set_num_threads(before);
    free(one);
    free(more);
    free_system(&made);
    free_system(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solutions_solve),
        cmocka_unit_test(large_fronts_solve),
        cmocka_unit_test(fronts_hold_the_factor),
        cmocka_unit_test(pivots_tell_singular_matrices),
        cmocka_unit_test(threads_and_earlier_matrices_change_no_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

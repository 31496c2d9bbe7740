#include "check.h"

#include "curve/measure/metric_tree.h"
#include "search/nearest.h"

static double *random_rows(bat_random *random, size_t count, size_t size)
{
    double *rows = malloc((count * size + 1) * sizeof *rows);
    for (size_t i = 0; i < count * size; i++)
        rows[i] = bat_random_normal(random);
    return rows;
}

/// Whole numbers in 0 … 3, so that most distances tie.
static double *lattice_rows(bat_random *random, size_t count, size_t size)
{
    double *rows = malloc((count * size + 1) * sizeof *rows);
    for (size_t i = 0; i < count * size; i++)
        rows[i] = (double)(bat_random_bits(random) % 4);
    return rows;
}

static double squared(const double *p, const double *q, size_t dim)
{
    double sum = 0;
    for (size_t i = 0; i < dim; i++)
        sum += (p[i] - q[i]) * (p[i] - q[i]);
    return sum;
}

/// The definition: the first of the least products of squared distance and weight, and its root.
static nearest_hit search_all(const double *rows, const double *weights, size_t count, size_t dim, const double *point)
{
    nearest_hit best = {BAT_NO_INDEX, INFINITY};
    for (size_t i = 0; i < count; i++)
    {
        double distance = squared(rows + i * dim, point, dim) * (weights == NULL ? 1 : weights[i]);
        if (distance < best.distance)
            best = (nearest_hit){i, distance};
    }
    best.distance = sqrt(best.distance);
    return best;
}

static void agree_with_search_of_all(const double *rows, const double *weights, size_t count, size_t dim,
                                     const double *points, size_t point_count)
{
    nearest_tree tree;
    check_status(nearest_build(NEAREST_POINTS, rows, weights, count, dim, &tree, NULL), BAT_OK);
    for (size_t i = 0; i < point_count; i++)
    {
        nearest_hit found = nearest_find(&tree, points + i * dim);
        nearest_hit expected = search_all(rows, weights, count, dim, points + i * dim);
        assert_int_equal(found.item, expected.item);
        assert_true(found.distance == expected.distance);
    }
    nearest_free(&tree);
}

static void finds_the_nearest_in_any_dimension(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    const size_t dims[] = {1, 2, 3, 4, 7, 40, 1024}, counts[] = {1, 2, 8, 9, 17, 100, 1000};
    for (size_t d = 0; d < sizeof dims / sizeof *dims; d++)
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++)
        {
            size_t dim = dims[d], count = dim > 40 ? 30 : counts[c];
            double *rows = random_rows(&random, count, dim), *points = random_rows(&random, 60, dim);
            agree_with_search_of_all(rows, NULL, count, dim, points, 60);
            agree_with_search_of_all(rows, NULL, count, dim, rows, count); // itself, at distance 0
            free(rows);
            free(points);
        }
}

static void takes_the_first_of_several_nearest(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    for (size_t dim = 1; dim <= 5; dim++)
    {
        double *rows = lattice_rows(&random, 700, dim), *points = lattice_rows(&random, 300, dim);
        for (size_t i = 0; i < 150 * dim; i++)
            points[i] += 0.5;
        agree_with_search_of_all(rows, NULL, 700, dim, points, 300);
        free(rows);
        free(points);
    }
}

static void weights_scale_the_squared_distance(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    double *rows = random_rows(&random, 500, 2), *points = random_rows(&random, 300, 2), weights[500];
    for (size_t i = 0; i < 500; i++)
        weights[i] = exp(3 * bat_random_normal(&random));
    agree_with_search_of_all(rows, weights, 500, 2, points, 300);
    free(rows);
    free(points);
}

static void equal_points_cost_no_more_than_others(void **state)
{
    (void)state;
    enum
    {
        COUNT = 200000
    };
    double *rows = calloc(2 * COUNT, sizeof *rows), point[2] = {1, 1};
    nearest_tree tree;
    check_status(nearest_build(NEAREST_POINTS, rows, NULL, COUNT, 2, &tree, NULL), BAT_OK);
    for (size_t i = 0; i < COUNT; i++) // would take hours if each query looked at each point
        assert_int_equal(nearest_find(&tree, point).item, 0);
    nearest_free(&tree);
    free(rows);
}

static void points_on_a_line_and_far_away(void **state)
{
    (void)state;
    double rows[300 * 3] = {0}, points[] = {1e300, 0, 0, -1e300, 1, 1, 149.4, 1e-300, 0, 149.6, 0, 0};
    for (size_t i = 0; i < 300; i++)
        rows[3 * i] = (double)i;
    nearest_tree tree;
    check_status(nearest_build(NEAREST_POINTS, rows, NULL, 300, 3, &tree, NULL), BAT_OK);
    assert_int_equal(nearest_find(&tree, points).item, 0); // all are as far, to rounding
    check_relative(nearest_find(&tree, points).distance, 1e300, 0);
    assert_int_equal(nearest_find(&tree, points + 3).item, 0);
    assert_int_equal(nearest_find(&tree, points + 6).item, 149);
    assert_int_equal(nearest_find(&tree, points + 9).item, 150);
    nearest_free(&tree);
}

static void an_empty_tree_finds_nothing(void **state)
{
    (void)state;
    double point[3] = {0};
    nearest_tree tree;
    check_status(nearest_build(NEAREST_POINTS, NULL, NULL, 0, 3, &tree, NULL), BAT_OK);
    assert_true(nearest_find(&tree, point).item == BAT_NO_INDEX);
    nearest_free(&tree);
    bat_space space = bat_euclidean(3);
    metric_tree metric;
    check_status(metric_tree_build(&space, NULL, 0, &metric, NULL), BAT_OK);
    assert_true(metric_tree_find(&metric, point).item == BAT_NO_INDEX);
    metric_tree_free(&metric);
}

/// The least distance over a fine sampling of a segment, from above.
static double sampled_distance(const double *ends, size_t dim, const double *point)
{
    double least = INFINITY, sample[8];
    for (int step = 0; step <= 2000; step++)
    {
        for (size_t i = 0; i < dim; i++)
            sample[i] = ends[i] + (ends[dim + i] - ends[i]) * step / 2000;
        least = fmin(least, squared(sample, point, dim));
    }
    return least;
}

static void finds_the_nearest_segment(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (size_t dim = 1; dim <= 4; dim++)
    {
        double *ends = random_rows(&random, 60, 2 * dim), *points = random_rows(&random, 40, dim);
        memcpy(ends + dim, ends, dim * sizeof *ends); // one without length
        nearest_tree tree;
        check_status(nearest_build(NEAREST_SEGMENTS, ends, NULL, 60, dim, &tree, NULL), BAT_OK);
        for (size_t i = 0; i < 40; i++)
        {
            nearest_hit found = nearest_find(&tree, points + i * dim);
            double least = INFINITY;
            for (size_t s = 0; s < 60; s++)
                least = fmin(least, sampled_distance(ends + 2 * s * dim, dim, points + i * dim));
            assert_true(found.distance <= sqrt(least) + 1e-14);
            check_near(found.distance, sqrt(least), 5e-3);
            check_near(sqrt(sampled_distance(ends + 2 * found.item * dim, dim, points + i * dim)), found.distance, 5e-3);
        }
        nearest_free(&tree);
        free(ends);
        free(points);
    }
}

/// Powers of two change no digit, neither of the distance nor of the choice, as far as the coordinates do not underflow.
static void no_scale_changes_a_digit(void **state)
{
    (void)state;
    const int exponents[] = {1018, 700, 300, -300, -700, -950};
    bat_random random = bat_random_seed(7);
    for (size_t dim = 1; dim <= 4; dim++)
        for (size_t kind = NEAREST_POINTS; kind <= NEAREST_SEGMENTS; kind++)
            for (size_t e = 0; e < sizeof exponents / sizeof *exponents; e++)
            {
                double scaled[100 * 8], *rows = random_rows(&random, 100, 8), *points = random_rows(&random, 50, dim);
                for (size_t i = 0; i < 100 * 8; i++)
                    scaled[i] = ldexp(rows[i], exponents[e]);
                nearest_tree plain, tree;
                check_status(nearest_build((nearest_kind)kind, rows, NULL, 100, dim, &plain, NULL), BAT_OK);
                check_status(nearest_build((nearest_kind)kind, scaled, NULL, 100, dim, &tree, NULL), BAT_OK);
                for (size_t i = 0; i < 50; i++)
                {
                    nearest_hit expected = nearest_find(&plain, points + i * dim);
                    for (size_t axis = 0; axis < dim; axis++)
                        points[i * dim + axis] = ldexp(points[i * dim + axis], exponents[e]);
                    nearest_hit found = nearest_find(&tree, points + i * dim);
                    assert_int_equal(found.item, expected.item);
                    assert_true(found.distance == ldexp(expected.distance, exponents[e]));
                }
                nearest_free(&plain);
                nearest_free(&tree);
                free(rows);
                free(points);
            }
}

/// Coordinates of very different sizes in one tree.
static void far_points_do_not_hide_near_ones(void **state)
{
    (void)state;
    double rows[] = {8e307, 0, 3e-300, 0, 1, 0, 2e-300, 0, -8e307, -8e307}, point[] = {1e-300, 0};
    nearest_tree tree;
    check_status(nearest_build(NEAREST_POINTS, rows, NULL, 5, 2, &tree, NULL), BAT_OK);
    nearest_hit found = nearest_find(&tree, point);
    assert_int_equal(found.item, 3);
    check_relative(found.distance, 1e-300, 1e-15);
    point[0] = -8e307;
    check_relative(nearest_find(&tree, point).distance, 8e307, 1e-15);
    nearest_free(&tree);
    // A long edge passes 1e-200 below the point, a short one lies 1e-190 above it, one of no length on its left.
    double edges[] = {-1e200, -1e-200, 1e200, -1e-200, 0, 1e-190, 1e-195, 1e-190, -1e-199, 0, -1e-199, 0};
    double origin[] = {0, 0}, above[] = {0, 1e-190}, beyond[] = {3e200, 4e200};
    check_status(nearest_build(NEAREST_SEGMENTS, edges, NULL, 3, 2, &tree, NULL), BAT_OK);
    found = nearest_find(&tree, origin);
    assert_int_equal(found.item, 0);
    check_relative(found.distance, 1e-200, 1e-15);
    assert_int_equal(nearest_find(&tree, above).item, 1);
    check_relative(nearest_find(&tree, beyond).distance, 1e200 * sqrt(20), 1e-15);
    nearest_free(&tree);
}

static void metric_tree_agrees_on_every_space(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(3), bat_sphere(2), bat_sphere(5), bat_disk()};
    bat_random random = bat_random_seed(5);
    for (size_t s = 0; s < 4; s++)
    {
        const bat_space *space = &spaces[s];
        double rows[400 * 6], point[6];
        for (size_t i = 0; i < 400; i++)
            space->random_point(space, &random, rows + i * space->point_dim);
        memcpy(rows + 7 * space->point_dim, rows, space->point_dim * sizeof *rows);
        metric_tree tree;
        check_status(metric_tree_build(space, rows, 400, &tree, NULL), BAT_OK);
        for (size_t i = 0; i < 300; i++)
        {
            space->random_point(space, &random, point);
            nearest_hit found = metric_tree_find(&tree, point);
            double least = INFINITY;
            for (size_t k = 0; k < 400; k++)
                least = fmin(least, space->distance(space, point, rows + k * space->point_dim));
            check_near(found.distance, least, 1e-14);
            assert_true(space->distance(space, point, rows + found.item * space->point_dim) == found.distance);
        }
        metric_tree_free(&tree);
    }
}

static void selection_puts_each_place_right(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(6);
    for (size_t count = 1; count <= 40; count++)
        for (size_t nth = 0; nth < count; nth++)
        {
            keyed entries[40];
            for (size_t i = 0; i < count; i++)
                entries[i] = (keyed){(double)(bat_random_bits(&random) % 7), i};
            select_nth(entries, count, nth);
            for (size_t i = 0; i < count; i++)
            {
                keyed low = i < nth ? entries[i] : entries[nth], high = i < nth ? entries[nth] : entries[i];
                assert_true(low.key < high.key || (low.key == high.key && low.item <= high.item));
            }
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_nearest_in_any_dimension), cmocka_unit_test(takes_the_first_of_several_nearest),
        cmocka_unit_test(weights_scale_the_squared_distance), cmocka_unit_test(equal_points_cost_no_more_than_others),
        cmocka_unit_test(points_on_a_line_and_far_away),      cmocka_unit_test(an_empty_tree_finds_nothing),
        cmocka_unit_test(finds_the_nearest_segment),          cmocka_unit_test(no_scale_changes_a_digit),
        cmocka_unit_test(far_points_do_not_hide_near_ones),   cmocka_unit_test(metric_tree_agrees_on_every_space),
        cmocka_unit_test(selection_puts_each_place_right),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

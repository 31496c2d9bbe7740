// Neighbours in space: every answer is what searching all points gives.
#include "check.h"

#include "search/nearest.h"

static double *random_points(uint64_t seed, size_t count)
{
    bat_random random = bat_random_seed(seed);
    double *points = malloc((3 * count + 1) * sizeof *points);
    for (size_t i = 0; i < 3 * count; i++)
        points[i] = bat_random_normal(&random);
    return points;
}

/// Whole numbers in 0 … 4, so that most distances tie and many points coincide.
static double *lattice_points(uint64_t seed, size_t count)
{
    bat_random random = bat_random_seed(seed);
    double *points = malloc((3 * count + 1) * sizeof *points);
    for (size_t i = 0; i < 3 * count; i++)
        points[i] = (double)(bat_random_bits(&random) % 5);
    return points;
}

/// Few points far apart and many close together.
static double *uneven_points(uint64_t seed, size_t count)
{
    double *points = random_points(seed, count);
    for (size_t i = 0; i < count; i++)
        for (size_t axis = 0; axis < 3; axis++)
            points[3 * i + axis] *= i % 10 == 0 ? 1000 : 1e-3;
    return points;
}

static int compare_neighbours(const void *a, const void *b)
{
    const neighbour *p = a, *q = b;
    if (p->squared != q->squared)
        return p->squared < q->squared ? -1 : 1;
    return (p->item > q->item) - (p->item < q->item);
}

/// The definition: all points in order of their distance.
static neighbour *sort_all(const double *points, size_t count, const double place[3])
{
    neighbour *all = malloc((count + 1) * sizeof *all);
    for (size_t i = 0; i < count; i++)
    {
        double dx = points[3 * i] - place[0], dy = points[3 * i + 1] - place[1], dz = points[3 * i + 2] - place[2];
        all[i] = (neighbour){dx * dx + dy * dy + dz * dz, (uint32_t)i};
    }
    qsort(all, count, sizeof *all, compare_neighbours);
    return all;
}

static void assert_list(const neighbour_list *list, const neighbour *expected, size_t count)
{
    assert_int_equal(list->count, count);
    for (size_t i = 0; i < count; i++)
    {
        assert_int_equal(list->entries[i].item, expected[i].item);
        assert_true(list->entries[i].squared == expected[i].squared);
    }
}

static void agree_at(const nearest_tree *tree, const double *points, const double place[3], neighbour_list *list)
{
    size_t count = tree->count;
    neighbour *all = sort_all(points, count, place);
    for (size_t wanted = 0; wanted <= count + 1; wanted = 2 * wanted + 1)
    {
        size_t found = wanted < count ? wanted : count;
        check_status(neighbours_nearest(tree, place, wanted, list, NULL), BAT_OK);
        assert_list(list, all, found);
        double radius = found > 0 ? sqrt(all[found - 1].squared) : 0;
        size_t within = 0;
        while (within < count && all[within].squared <= radius * radius)
            within++;
        check_status(neighbours_within(tree, place, radius, list, NULL), BAT_OK);
        assert_list(list, all, within);
    }
    free(all);
}

static void agree_with_search_of_all(double *points, size_t count)
{
    nearest_tree tree;
    neighbour_list list = {0};
    check_status(neighbours_build(points, count, &tree, NULL), BAT_OK);
    size_t step = count / 20 + 1;
    for (size_t i = 0; i < count; i += step)
        agree_at(&tree, points, points + 3 * i, &list);
    const double places[][3] = {{0, 0, 0}, {0.5, 0.5, 0.5}, {-100, 3, 1e6}, {2, 2.5, 1}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++)
        agree_at(&tree, points, places[i], &list);
    neighbour_list_free(&list);
    nearest_free(&tree);
    free(points);
}

static void test_lists_are_those_of_a_search_of_all(void **state)
{
    (void)state;
    static const size_t counts[] = {0, 1, 2, 15, 16, 17, 33, 100, 1000};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    {
        agree_with_search_of_all(random_points(i, counts[i]), counts[i]);
        agree_with_search_of_all(lattice_points(i, counts[i]), counts[i]);
        agree_with_search_of_all(uneven_points(i, counts[i]), counts[i]);
    }
}

static void test_equal_points_are_all_found(void **state)
{
    (void)state;
    enum
    {
        COUNT = 500
    };
    double points[3 * COUNT];
    for (size_t i = 0; i < 3 * (size_t)COUNT; i++)
        points[i] = 0.1;
    nearest_tree tree;
    neighbour_list list = {0};
    check_status(neighbours_build(points, COUNT, &tree, NULL), BAT_OK);
    check_status(neighbours_within(&tree, points, 0, &list, NULL), BAT_OK);
    assert_int_equal(list.count, COUNT);
    check_status(neighbours_nearest(&tree, points, 7, &list, NULL), BAT_OK);
    for (uint32_t i = 0; i < 7; i++)
        assert_int_equal(list.entries[i].item, i);
    neighbour_list_free(&list);
    nearest_free(&tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_are_those_of_a_search_of_all),
        cmocka_unit_test(test_equal_points_are_all_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

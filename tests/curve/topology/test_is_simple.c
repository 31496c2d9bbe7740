// Whether curves are simple: known cases, and the tree of boxes against all pairs of edges.

#include "check.h"

#include "batten/curve_measure.h"
#include "curve/topology/edge_tree.h"

static const double PI = 3.14159265358979323846;

static bool is_simple(const bat_curve *curve)
{
    bool simple;
    bat_error error;
    if (bat_curve_is_simple(curve, &simple, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return simple;
}

static bool is_simple_plane(const double *points, size_t count, bool closed)
{
    bat_space plane = bat_euclidean(2);
    double *copy = malloc(2 * count * sizeof *copy);
    memcpy(copy, points, 2 * count * sizeof *copy);
    bool simple = is_simple(&(bat_curve){.space = &plane, .points = copy, .count = count, .closed = closed});
    free(copy);
    return simple;
}

static void known_curves(void **state)
{
    (void)state;
    const struct
    {
        const char *what;
        size_t count;
        double points[16];
        bool closed, simple;
    } cases[] = {
        {"a point", 1, {1, 2}, false, true},
        {"a point as a ring", 1, {1, 2}, true, true},
        {"an edge", 2, {0, 0, 1, 1}, false, true},
        {"a ring there and back", 2, {0, 0, 1, 1}, true, false},
        {"a triangle", 3, {0, 0, 1, 0, 0, 1}, true, true},
        {"a flat triangle", 3, {0, 0, 1, 0, 2, 0}, true, false},
        {"a straight line", 3, {0, 0, 1, 0, 2, 0}, false, true},
        {"a line that folds back", 3, {0, 0, 2, 0, 1, 0}, false, false},
        {"a square", 4, {0, 0, 1, 0, 1, 1, 0, 1}, true, true},
        {"a bow tie", 4, {0, 0, 1, 1, 1, 0, 0, 1}, true, false},
        {"a figure eight that touches itself", 6, {0, 0, 1, 1, 2, 0, 2, 2, 1, 1, 0, 2}, true, false},
        {"a vertex on an edge", 5, {0, 0, 4, 0, 4, 2, 2, 0, 0, 2}, true, false},
        {"an edge along an edge", 6, {0, 0, 4, 0, 4, 2, 3, 0, 1, 0, 0, 2}, true, false},
        {"an open ring", 4, {0, 0, 1, 0, 0, 1, 0, 0}, false, true},
        {"an open line to an inner vertex", 4, {0, 0, 1, 0, 0, 1, 1, 0}, false, false},
        {"an open line that ends on its first edge", 4, {0, 0, 2, 0, 1, 1, 1, 0}, false, false},
        {"a repeated point", 5, {0, 0, 1, 0, 1, 0, 1, 1, 0, 1}, true, true},
        {"a repeated point at the seam", 5, {0, 0, 1, 0, 1, 1, 0, 1, 0, 0}, true, true},
        {"a fold behind a repeated point", 4, {0, 0, 2, 0, 2, 0, 1, 0}, false, false},
        {"points that are all one", 4, {1, 1, 1, 1, 1, 1, 1, 1}, true, true},
        {"there and back with repeated points", 4, {0, 0, 0, 0, 1, 0, 1, 0}, true, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        if (is_simple_plane(cases[i].points, cases[i].count, cases[i].closed) != cases[i].simple)
            fail_msg("%s", cases[i].what);
        double extreme[16];
        for (int k = 0; k < 16; k++)
            extreme[k] = cases[i].points[k] * 1e300; // neither overflow
        assert_int_equal(is_simple_plane(extreme, cases[i].count, cases[i].closed), cases[i].simple);
        for (int k = 0; k < 16; k++)
            extreme[k] = cases[i].points[k] * 4e-310; // nor underflow
        assert_int_equal(is_simple_plane(extreme, cases[i].count, cases[i].closed), cases[i].simple);
    }
}

static void sphere_point(double longitude, double latitude, double *point)
{
    point[0] = cos(latitude * PI / 180) * cos(longitude * PI / 180);
    point[1] = cos(latitude * PI / 180) * sin(longitude * PI / 180);
    point[2] = sin(latitude * PI / 180);
}

static bool is_simple_sphere(const double (*degrees)[2], size_t count, bool closed)
{
    bat_space sphere = bat_sphere(2);
    double points[3 * 16];
    for (size_t i = 0; i < count; i++)
        sphere_point(degrees[i][0], degrees[i][1], points + 3 * i);
    return is_simple(&(bat_curve){.space = &sphere, .points = points, .count = count, .closed = closed});
}

static void known_curves_of_the_sphere(void **state)
{
    (void)state;
    const double dateline[][2] = {{170, -10}, {-170, -10}, {-170, 10}, {170, 10}};
    const double bow_tie[][2] = {{170, -10}, {-170, 10}, {-170, -10}, {170, 10}};
    const double pole[][2] = {{0, 80}, {90, 80}, {180, 80}, {-90, 80}};
    const double equator[][2] = {{0, 0}, {120, 0}, {-120, 0}};
    const double twice[][2] = {{0, 0}, {120, 0}, {-120, 0}, {30, 0}};
    const double long_arcs[][2] = {{0, 0}, {179, 0}, {179, 50}, {90, 80}};
    const double antipodal_paths[][2] = {{-20, 0}, {20, 0}, {90, 60}, {160, -20}, {-160, 20}};
    assert_true(is_simple_sphere(dateline, 4, true));
    assert_false(is_simple_sphere(bow_tie, 4, true));
    assert_true(is_simple_sphere(pole, 4, true));
    assert_true(is_simple_sphere(equator, 3, true));
    assert_false(is_simple_sphere(twice, 4, false));
    assert_true(is_simple_sphere(long_arcs, 4, true));
    assert_true(is_simple_sphere(antipodal_paths, 5, false));
}

static void faults_are_told(void **state)
{
    (void)state;
    bat_space space = bat_euclidean(3), sphere = bat_sphere(2);
    double points[] = {1, 0, 0, -1, 0, 0, 0, 1, 0};
    bat_curve curve = {.space = &space, .points = points, .count = 3};
    bool simple = true;
    bat_error error;
    check_status(bat_curve_is_simple(&curve, &simple, &error), BAT_UNSUPPORTED);
    curve.space = &sphere;
    check_status(bat_curve_is_simple(&curve, &simple, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
    curve.count = 0;
    check_status(bat_curve_is_simple(&curve, &simple, &error), BAT_INVALID_ARGUMENT);
    points[4] = NAN;
    curve.count = 3;
    check_status(bat_curves_are_simple(&curve, 1, NULL, &simple, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 0);
}

// Against all pairs

/// The pairs of edges that meet, as a sum that does not depend on their order.
typedef struct pair_sum
{
    size_t count, sum;
} pair_sum;

static bool add_pair(void *context, edge_place first, edge_place second)
{
    pair_sum *pairs = context;
    assert_true(first.curve < second.curve || (first.curve == second.curve && first.edge < second.edge));
    pairs->count++;
    pairs->sum += (first.curve * 1000003 + first.edge) * 7919 + (second.curve * 1000003 + second.edge) * 104729;
    return true;
}

static const double *vertex(const bat_curve *curve, size_t i)
{
    return curve->points + i % curve->count * curve->space->point_dim;
}

/// Every pair by the predicates alone. The points of a curve are all different.
static pair_sum all_pairs(surface_kind kind, const bat_curve *curves, size_t count, edge_pairs rule)
{
    pair_sum pairs = {0, 0};
    for (size_t c = 0; c < count; c++)
        for (size_t d = c; d < count && (d == c || rule == EDGE_PAIRS_ALL); d++)
        {
            const bat_curve *p = &curves[c], *q = &curves[d];
            size_t p_edges = p->count - !p->closed, q_edges = q->count - !q->closed;
            for (size_t i = 0; i < p_edges; i++)
                for (size_t j = c == d ? i + 1 : 0; j < q_edges; j++)
                {
                    bool follows = c == d && j == i + 1, around = c == d && p->closed && i == 0 && j == q_edges - 1;
                    bool meet = follows  ? predicate_folds_back(kind, vertex(p, i), vertex(p, j), vertex(p, j + 1))
                                : around ? predicate_folds_back(kind, vertex(p, j), vertex(p, 0), vertex(p, 1))
                                         : predicate_edges_meet(kind, vertex(p, i), vertex(p, i + 1), vertex(q, j),
                                                                vertex(q, j + 1));
                    if (meet)
                        (void)add_pair(&pairs, (edge_place){c, i}, (edge_place){d, j});
                }
        }
    return pairs;
}

/// A curve of many or few crossings: a random walk with inertia.
static void random_walk(bat_random *random, const bat_space *space, double roughness, bat_curve *curve)
{
    surface_kind kind;
    assert_true(surface_of_space(space, &kind));
    size_t count = 3 + bat_random_bits(random) % 150;
    *curve = (bat_curve){.space = space, .count = count, .closed = bat_random_bits(random) % 2 == 0};
    curve->points = malloc(count * space->point_dim * sizeof *curve->points);
    double angle = 6 * bat_random_uniform(random), x = 0.3 * bat_random_normal(random), y = 0.3 * bat_random_normal(random);
    bool grid = kind == SURFACE_PLANE && bat_random_bits(random) % 2 == 0;
    for (size_t i = 0; i < count; i++)
    {
        angle += roughness * bat_random_normal(random);
        double step = 0.02 * exp(bat_random_normal(random));
        x += step * cos(angle);
        y += step * sin(angle);
        double *point = curve->points + i * space->point_dim;
        if (kind == SURFACE_SPHERE)
        {
            double v[3] = {cos(5 * x), y, sin(5 * x)};
            (void)space->project(space, v, point);
            continue;
        }
        double shrink = kind == SURFACE_DISK ? 1 / sqrt(1 + x * x + y * y) : 1;
        // On a grid edges touch often. The last digits keep points apart.
        point[0] = grid ? rint(20 * x) / 20 + 1e-9 * (double)(i % 2) : shrink * x;
        point[1] = grid ? rint(20 * y) / 20 + (double)i * 1e-12 : shrink * y;
    }
}

static void the_tree_finds_all_pairs(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_random random = bat_random_seed(5);
    size_t simple = 0, found = 0;
    for (int trial = 0; trial < 600; trial++)
    {
        const bat_space *space = &spaces[trial % 3];
        surface_kind kind;
        assert_true(surface_of_space(space, &kind));
        bat_curve curves[3];
        for (int c = 0; c < 3; c++)
            random_walk(&random, space, 0.02 * (double)(1 + trial % 40), &curves[c]);
        edge_tree tree;
        assert_int_equal(edge_tree_make(curves, 3, 0, 1 + trial % 2, &tree, NULL), BAT_OK);
        const edge_pairs rules[] = {EDGE_PAIRS_SAME_CURVE, EDGE_PAIRS_ALL};
        for (int r = 0; r < 2; r++)
        {
            pair_sum by_tree = {0, 0}, by_hand = all_pairs(kind, curves, 3, rules[r]);
            assert_true(edge_tree_search(&tree, rules[r], false, add_pair, &by_tree));
            assert_int_equal(by_tree.count, by_hand.count);
            assert_int_equal(by_tree.sum, by_hand.sum);
            found += by_hand.count;
        }
        edge_tree_free(&tree);
        for (int c = 0; c < 3; c++)
        {
            bool expected = all_pairs(kind, &curves[c], 1, EDGE_PAIRS_SAME_CURVE).count == 0;
            assert_int_equal(is_simple(&curves[c]), expected);
            simple += expected;
            free(curves[c].points);
        }
    }
    assert_in_range(simple, 100, 1700);
    assert_true(found > 10000);
}

/// After some points moved, only pairs with a moved edge are found, and all of them.
static void moved_edges_are_found_again(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(6);
    for (int trial = 0; trial < 200; trial++)
    {
        bat_curve curve;
        random_walk(&random, &plane, 0.1, &curve);
        if (!is_simple(&curve))
        {
            free(curve.points);
            continue;
        }
        edge_tree tree;
        assert_int_equal(edge_tree_make(&curve, 1, 0, 1, &tree, NULL), BAT_OK);
        size_t moved = 1 + bat_random_bits(&random) % (curve.count - 2);
        curve.points[2 * moved] += 0.3 * bat_random_normal(&random);
        if (trial % 4 == 0)
            curve.points[2 * moved] *= 1e-200; // out of the range of the predicates
        edge_tree_mark(&tree, 0, moved - 1, moved + 1);
        assert_int_equal(edge_tree_update(&tree, NULL), BAT_OK);
        pair_sum by_tree = {0, 0}, by_hand = all_pairs(SURFACE_PLANE, &curve, 1, EDGE_PAIRS_SAME_CURVE);
        (void)edge_tree_search(&tree, EDGE_PAIRS_SAME_CURVE, true, add_pair, &by_tree);
        assert_int_equal(by_tree.count, by_hand.count);
        assert_int_equal(by_tree.sum, by_hand.sum);
        edge_tree_settle(&tree);
        pair_sum none = {0, 0};
        (void)edge_tree_search(&tree, EDGE_PAIRS_SAME_CURVE, true, add_pair, &none);
        assert_int_equal(none.count, 0);
        edge_tree_free(&tree);
        free(curve.points);
    }
}

/// Long thin spirals and combs: simple until one point is moved across its neighbour arm.
static void thin_curves(void **state)
{
    (void)state;
    enum
    {
        COUNT = 4096
    };
    double *points = malloc(2 * COUNT * sizeof *points);
    for (size_t i = 0; i < COUNT; i++)
    {
        double t = 2 * PI * (double)i / 128, r = 1 + 1e-9 * t;
        points[2 * i] = r * cos(t);
        points[2 * i + 1] = r * sin(t);
    }
    assert_true(is_simple_plane(points, COUNT, false));
    points[2 * 2000] *= 1 + 1e-8;
    points[2 * 2000 + 1] *= 1 + 1e-8;
    assert_false(is_simple_plane(points, COUNT, false));
    for (size_t i = 0; i < COUNT; i++)
    {
        points[2 * i] = (double)(i / 2) * 1e-12;
        points[2 * i + 1] = (double)((i + 1) / 2 % 2);
    }
    assert_true(is_simple_plane(points, COUNT, false));
    points[2 * 1000] += 1e-12;
    assert_false(is_simple_plane(points, COUNT, false));
    free(points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_curves),
        cmocka_unit_test(known_curves_of_the_sphere),
        cmocka_unit_test(faults_are_told),
        cmocka_unit_test(the_tree_finds_all_pairs),
        cmocka_unit_test(moved_edges_are_found_again),
        cmocka_unit_test(thin_curves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

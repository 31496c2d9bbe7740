// Refinement that keeps simple curves simple.

#include "refine_helpers.h"

#include "batten/curve_measure.h"
#include "curve/topology/draw_back.h"

static bool is_simple(const bat_curve *curve)
{
    bool simple;
    bat_error error;
    if (bat_curve_is_simple(curve, &simple, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return simple;
}

/// Put a point of the unit disk into a space: onto a cap of the sphere by central projection, into Poincaré's disk from
/// Klein's. Straight edges stay straight.
static void place(const bat_space *space, double x, double y, double *point)
{
    if (space->point_dim == 3)
    {
        double v[3] = {2 * x, 2 * y, 1};
        (void)space->project(space, v, point);
        return;
    }
    double scale = strcmp(space->name, "disk") == 0 ? 1 / (1 + sqrt(1 - x * x - y * y)) : 1;
    point[0] = scale * x;
    point[1] = scale * y;
}

/// A star of random radii at uneven angles, which is simple in every space.
static bat_curve star(bat_random *random, const bat_space *space, size_t count, bool closed)
{
    bat_curve curve = {.space = space, .count = count, .closed = closed};
    curve.points = malloc(count * space->point_dim * sizeof *curve.points);
    double step = 2 * PI / (double)count;
    for (size_t i = 0; i < count; i++)
    {
        double angle = step * ((double)i + 0.9 * bat_random_uniform(random));
        double radius = 0.95 * exp(-3 * bat_random_uniform(random));
        place(space, radius * cos(angle), radius * sin(angle), curve.points + i * space->point_dim);
    }
    return curve;
}

static bool rows_equal(const bat_curve *a, const bat_curve *b, size_t i)
{
    size_t dim = a->space->point_dim;
    return memcmp(a->points + i * dim, b->points + i * dim, dim * sizeof(double)) == 0;
}

/// The number of edges of the polygon whose new points differ; all or none of an edge's points are moved, but for those that
/// lie on the edge.
static size_t edges_moved(const bat_curve *coarse, const bat_curve *kept, const bat_curve *free)
{
    size_t edges = coarse->count - !coarse->closed, parts = (kept->count - !kept->closed) / edges, moved = 0;
    assert_int_equal(kept->count, free->count);
    for (size_t e = 0; e < edges; e++)
    {
        bool differs = false;
        for (size_t i = e * parts + 1; i < (e + 1) * parts; i++)
            differs |= !rows_equal(kept, free, i);
        moved += differs;
    }
    return moved;
}

static void check_kept(const bat_curve *coarse, const char *name, bat_curve_simple simple, bat_curve_refine_report *sum)
{
    bat_curve_refine_report report;
    bat_curve_refine_options how = options(name, 4);
    how.simple = BAT_CURVE_SIMPLE_NEVER;
    bat_curve free = refined(coarse, &how);
    how.simple = simple;
    how.report = &report;
    bat_curve kept = refined(coarse, &how);
    bool was_simple = is_simple(&free);
    assert_true(is_simple(&kept));
    assert_int_equal(report.checked, 1);
    assert_int_equal(report.given_crossing, 0);
    assert_int_equal(report.crossing, !was_simple);
    assert_int_equal(report.crossings > 0, !was_simple);
    assert_int_equal(report.left_crossing, 0);
    assert_true(report.straight <= report.drawn_back);
    assert_int_equal(edges_moved(coarse, &kept, &free), report.drawn_back);
    size_t dim = coarse->space->point_dim;
    for (size_t i = 0; i < coarse->count; i++)
        assert_memory_equal(kept.points + 16 * i * dim, coarse->points + i * dim, dim * sizeof(double));
    sum->crossing += report.crossing;
    sum->drawn_back += report.drawn_back;
    sum->straight += report.straight;
    sum->checked += coarse->count;
    bat_curve_free(&free);
    bat_curve_free(&kept);
}

static void stars_stay_simple(void **state)
{
    (void)state;
    const struct
    {
        const char *space;
        const char *schemes[4];
    } cases[] = {{"plane", {"four-point", "six-point", "learned:fairness=0", "angle-4"}},
                 {"sphere", {"log-exp-6", "learned", "angle-6", "log-exp-4"}},
                 {"disk", {"learned", "angle-4", "log-exp-4", "angle-6"}}};
    bat_random random = bat_random_seed(1);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
    {
        bat_space space;
        assert_int_equal(bat_space_by_name(cases[c].space, 0, &space, NULL), BAT_OK);
        for (int s = 0; s < 4; s++)
        {
            bat_curve_refine_report sum = {0};
            for (int trial = 0; trial < 40; trial++)
            {
                bat_curve coarse = star(&random, &space, 5 + bat_random_bits(&random) % 40, trial % 2 == 0);
                check_kept(&coarse, cases[c].schemes[s], BAT_CURVE_SIMPLE_ALWAYS, &sum);
                bat_curve_free(&coarse);
            }
            assert_true(sum.crossing > 0 && sum.drawn_back > 0);
            assert_true(sum.drawn_back < sum.checked); // most edges stay
        }
    }
}

/// Two arms of a spiral, side by side, as a ring. The outer arm has its points where the inner one has none.
static void thin_spirals_stay_simple(void **state)
{
    (void)state;
    enum
    {
        COUNT = 60
    };
    bat_space plane = bat_euclidean(2);
    double points[4 * COUNT];
    bat_curve_refine_report sum = {0};
    for (int turns = 1; turns < 5; turns++)
    {
        for (size_t i = 0; i < COUNT; i++)
        {
            double t = (double)i / COUNT, angle = 2 * PI * turns * t;
            double inner = 1 + 2 * t * turns, wobble = i % 3 == 0 ? 0.9 : -0.6;
            points[2 * i] = inner * cos(angle);
            points[2 * i + 1] = inner * sin(angle);
            double outer = inner + 1 + wobble;
            points[2 * (2 * COUNT - 1 - i)] = outer * cos(angle);
            points[2 * (2 * COUNT - 1 - i) + 1] = outer * sin(angle);
        }
        bat_curve ring = {.space = &plane, .points = points, .count = 2 * COUNT, .closed = true};
        assert_true(is_simple(&ring));
        check_kept(&ring, "six-point:w=0.05", BAT_CURVE_SIMPLE_RINGS, &sum);
        check_kept(&ring, "four-point:w=0.2", BAT_CURVE_SIMPLE_RINGS, &sum);
        check_kept(&ring, "learned", BAT_CURVE_SIMPLE_RINGS, &sum);
    }
    assert_true(sum.crossing > 2);
}

/// A coast by midpoint displacement, of which every other point is left out at random; one attempt.
static void coast(bat_random *random, const bat_space *space, size_t levels, bat_curve *curve)
{
    size_t count = (size_t)4 << levels;
    double *flat = malloc(2 * count * sizeof *flat);
    for (size_t i = 0; i < 4; i++)
    {
        flat[2 * i * (count / 4)] = 0.6 * cos(PI * (double)i / 2);
        flat[2 * i * (count / 4) + 1] = 0.6 * sin(PI * (double)i / 2);
    }
    for (size_t step = count / 4; step > 1; step /= 2)
        for (size_t i = 0; i < count; i += step)
        {
            const double *p = flat + 2 * i, *q = flat + 2 * ((i + step) % count);
            double shift = 0.2 * bat_random_normal(random), *middle = flat + 2 * (i + step / 2);
            middle[0] = 0.5 * (p[0] + q[0]) - shift * (q[1] - p[1]);
            middle[1] = 0.5 * (p[1] + q[1]) + shift * (q[0] - p[0]);
        }
    *curve = (bat_curve){.space = space, .closed = true};
    curve->points = malloc(count * space->point_dim * sizeof *curve->points);
    for (size_t i = 0; i < count; i++)
        if (i < 3 || bat_random_bits(random) % 2 == 0)
            place(space, 0.5 * flat[2 * i], 0.5 * flat[2 * i + 1], curve->points + space->point_dim * curve->count++);
    free(flat);
}

static void coasts_stay_simple(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const char *const schemes[] = {"four-point", "log-exp-6", "log-exp-6"};
    bat_random random = bat_random_seed(3);
    for (int s = 0; s < 3; s++)
    {
        bat_curve_refine_report sum = {0};
        for (int trial = 0; trial < 100; trial++)
        {
            bat_curve curve;
            coast(&random, &spaces[s], 4 + (size_t)trial % 4, &curve);
            if (is_simple(&curve))
                check_kept(&curve, schemes[s], BAT_CURVE_SIMPLE_RINGS, &sum);
            bat_curve_free(&curve);
        }
        assert_true(sum.crossing > 2);
        assert_true(sum.drawn_back * 5 < sum.checked); // local
    }
}

/// The same ring reversed or mirrored gives the same refined ring, reversed or mirrored.
static void reversal_and_mirror(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const char *const schemes[] = {"four-point", "angle-6", "learned"};
    bat_random random = bat_random_seed(4);
    size_t drawn = 0;
    for (int trial = 0; trial < 60; trial++)
    {
        const bat_space *space = &spaces[trial % 3];
        size_t dim = space->point_dim;
        bat_curve coarse = star(&random, space, 30, true), other = coarse;
        other.points = malloc(coarse.count * dim * sizeof *other.points);
        for (size_t i = 0; i < coarse.count; i++)
            for (size_t c = 0; c < dim; c++)
                other.points[i * dim + c] =
                    coarse.points[(coarse.count - 1 - i) * dim + c] * (trial % 2 == 0 && c == 0 ? -1 : 1);
        bat_curve_refine_report reports[2];
        bat_curve_refine_options how = options(schemes[trial % 3], 3);
        how.report = &reports[0];
        bat_curve fine = refined(&coarse, &how);
        how.report = &reports[1];
        bat_curve other_fine = refined(&other, &how);
        assert_int_equal(reports[0].drawn_back, reports[1].drawn_back);
        assert_int_equal(reports[0].straight, reports[1].straight);
        drawn += reports[0].drawn_back;
        for (size_t i = 0; i < fine.count; i++)
            for (size_t c = 0; c < dim; c++)
            {
                size_t from = (2 * fine.count - 8 - i) % fine.count;
                check_near(other_fine.points[i * dim + c], fine.points[from * dim + c] * (trial % 2 == 0 && c == 0 ? -1 : 1),
                           1e-6);
            }
        bat_curve_free(&coarse);
        bat_curve_free(&other);
        bat_curve_free(&fine);
        bat_curve_free(&other_fine);
    }
    assert_true(drawn > 50);
}

static void sets_do_not_depend_on_threads(void **state)
{
    (void)state;
    enum
    {
        COUNT = 50
    };
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(5);
    bat_curve coarse[COUNT], fine[COUNT], again[COUNT];
    for (int i = 0; i < COUNT; i++)
        coarse[i] = star(&random, &plane, 20, i % 3 != 0);
    bat_curve_refine_report report = {0}, other = {0};
    bat_curve_refine_options how = options("angle-4", 5);
    how.threads = 1;
    how.report = &report;
    assert_int_equal(bat_curves_refine(coarse, COUNT, &how, fine, NULL), BAT_OK);
    assert_int_equal(report.checked, COUNT - (COUNT + 2) / 3); // closed ones alone
    assert_true(report.crossing > 3 && report.crossings >= report.crossing);
    for (int threads = 2; threads < 30; threads += 9)
    {
        how.threads = threads;
        how.report = &other;
        assert_int_equal(bat_curves_refine(coarse, COUNT, &how, again, NULL), BAT_OK);
        assert_memory_equal(&report, &other, sizeof report);
        for (int i = 0; i < COUNT; i++)
        {
            assert_memory_equal(fine[i].points, again[i].points, 2 * fine[i].count * sizeof(double));
            bat_curve_free(&again[i]);
        }
    }
    // One call for each curve gives the same, and so does the caller's array.
    how.report = NULL;
    for (int i = 0; i < COUNT; i++)
    {
        bat_curve one = refined(&coarse[i], &how);
        assert_memory_equal(fine[i].points, one.points, 2 * one.count * sizeof(double));
        double *points = malloc(2 * one.count * sizeof *points);
        assert_int_equal(bat_curve_refine_into(&coarse[i], &how, points, NULL, one.count, NULL), BAT_OK);
        assert_memory_equal(points, one.points, 2 * one.count * sizeof(double));
        free(points);
        bat_curve_free(&one);
        bat_curve_free(&fine[i]);
        bat_curve_free(&coarse[i]);
    }
}

/// Edges with their own numbers of new points.
static void uneven_edges_are_drawn_back(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double corners[] = {0, 0, 8, 0, 8, 1, 0, 1};
    double points[] = {0, 0, 2, 1.5, 4, 2, 6, 1.5, 8, 0, 8, 1, 4, 1.25, 0, 1, -0.25, 0.5};
    const size_t starts[] = {0, 4, 5, 7, 9};
    bat_curve coarse = {.space = &plane, .points = corners, .count = 4, .closed = true};
    bat_curve fine = {.space = &plane, .points = points, .count = 9, .closed = true};
    drawn_curve drawn = {.coarse = &coarse, .starts = starts};
    draw_back_counts counts;
    assert_true(contains_points(&coarse, &fine, starts));
    assert_false(contains_points(&coarse, &fine, NULL));
    assert_false(is_simple(&fine));
    assert_int_equal(
        draw_back(&drawn, &fine, 1, &(draw_rules){.pairs = EDGE_PAIRS_SAME_CURVE}, (bat_progress){0}, &counts, NULL),
        BAT_OK);
    assert_true(is_simple(&fine));
    assert_int_equal(counts.crossings, 2);
    assert_int_equal(counts.edges, 2);
    assert_int_equal(counts.straight, 0);
    const double expected[] = {0, 0, 2, 0.75, 4, 1, 6, 0.75, 8, 0, 8, 1, 4, 1.125, 0, 1, -0.25, 0.5};
    assert_memory_equal(points, expected, sizeof expected);
}

/// Several curves that must not meet each other.
static void neighbours_are_drawn_apart(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double lines[2][4] = {{0, 0, 4, 0}, {0, 1, 4, 1}}, bulges[2][6] = {{0, 0, 2, 2, 4, 0}, {0, 1, 2, 1.5, 4, 1}};
    bat_curve coarse[2], fine[2];
    drawn_curve drawn[2];
    for (int c = 0; c < 2; c++)
    {
        coarse[c] = (bat_curve){.space = &plane, .points = lines[c], .count = 2};
        fine[c] = (bat_curve){.space = &plane, .points = bulges[c], .count = 3};
        drawn[c] = (drawn_curve){.coarse = &coarse[c]};
    }
    draw_back_counts counts;
    assert_int_equal(
        draw_back(drawn, fine, 2, &(draw_rules){.pairs = EDGE_PAIRS_SAME_CURVE}, (bat_progress){0}, &counts, NULL), BAT_OK);
    assert_int_equal(counts.crossings, 0);
    assert_int_equal(draw_back(drawn, fine, 2, &(draw_rules){.pairs = EDGE_PAIRS_ALL}, (bat_progress){0}, &counts, NULL),
                     BAT_OK);
    assert_int_equal(counts.crossings, 2);
    assert_int_equal(counts.edges, 2);
    assert_true(bulges[0][3] == 1 && bulges[1][3] == 1.25);
}

static void choices_and_refusals(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), solid = bat_euclidean(3);
    bat_error error;
    bat_curve fine = {0};
    bat_curve_refine_report report;
    bat_curve_refine_options how = options("four-point", 3);
    how.report = &report;

    // A bow tie stays one, or is refused.
    double tie[] = {0, 0, 1, 1, 1, 0, 0, 1};
    bat_curve bow_tie = {.space = &plane, .points = tie, .count = 4, .closed = true};
    fine = refined(&bow_tie, &how);
    assert_true(report.checked == 1 && report.given_crossing == 1 && report.crossing == 0);
    bat_curve_free(&fine);
    how.strict = true;
    assert_int_equal(bat_curves_refine(&bow_tie, 1, &how, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 0);
    how.strict = false;

    // Other spaces: nothing by default, unsupported when it is asked for.
    double space_points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    bat_curve triangle = {.space = &solid, .points = space_points, .count = 3, .closed = true};
    fine = refined(&triangle, &how);
    assert_int_equal(report.checked, 0);
    bat_curve_free(&fine);
    how.simple = BAT_CURVE_SIMPLE_ALWAYS;
    report.checked = 17;
    check_status(bat_curve_refine(&triangle, &how, &fine, &error), BAT_UNSUPPORTED);
    assert_int_equal(report.checked, 17);

    // A scheme that leaves the given points: counted, or refused.
    bat_random random = bat_random_seed(6);
    size_t left = 0;
    for (int trial = 0; trial < 200; trial++)
    {
        bat_curve coarse = star(&random, &plane, 6, true);
        how = options("mask:-1/2,3/2,3/2,-1/2", 2); // overshoots
        how.report = &report;
        fine = refined(&coarse, &how);
        assert_int_equal(report.left_crossing, !is_simple(&fine));
        assert_int_equal(report.drawn_back, 0);
        left += report.left_crossing;
        how.simple = BAT_CURVE_SIMPLE_ALWAYS;
        bat_curve must = {0};
        check_status(bat_curve_refine(&coarse, &how, &must, &error), report.left_crossing > 0 ? BAT_UNSUPPORTED : BAT_OK);
        bat_curve_free(&must);
        bat_curve_free(&fine);
        bat_curve_free(&coarse);
    }
    assert_in_range(left, 5, 200);
}

/// A sliver thinner than the rounding of its points: refined right, or told to cross itself; refused where it must not.
static void slivers_are_right_or_told(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(7);
    size_t refused = 0, done = 0;
    for (int trial = 0; trial < 400; trial++)
    {
        double x = bat_random_uniform(&random), y = bat_random_uniform(&random),
               share = 0.2 + 0.6 * bat_random_uniform(&random);
        double points[] = {0, 0, x, y, share * x, share * y};
        for (int k = 0; k < trial % 8; k++)
            points[5] = nextafter(points[5], 2);
        bat_curve sliver = {.space = &plane, .points = points, .count = 3, .closed = true}, fine = {0};
        bat_curve_refine_options how = options("four-point", 5);
        bat_curve_refine_report report;
        bat_error error;
        how.report = &report;
        if (!is_simple(&sliver))
            continue;
        bat_status status = bat_curve_refine(&sliver, &how, &fine, &error);
        check_status(status, BAT_OK);
        bool simple = is_simple(&fine);
        assert_int_equal(report.left_crossing, !simple);
        bat_curve_free(&fine);
        how.simple = BAT_CURVE_SIMPLE_ALWAYS;
        status = bat_curve_refine(&sliver, &how, &fine, &error);
        assert_true(simple ? status == BAT_OK : status == BAT_INVALID_POINT && error.index < 3);
        refused += status != BAT_OK;
        done += status == BAT_OK;
        if (status == BAT_OK)
            bat_curve_free(&fine);
    }
    assert_true(refused > 0 && done > 0);
}

static bool stop(void *context, double fraction)
{
    (void)context;
    return fraction < 0.85;
}

static void drawing_back_can_be_cancelled(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(8);
    bat_curve coarse = star(&random, &plane, 60, true), fine = {0};
    bat_curve_refine_options how = options("six-point:w=0.1", 5);
    how.progress = (bat_progress){stop, NULL};
    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_CANCELLED);
    assert_null(fine.points);
    bat_curve_free(&coarse);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stars_stay_simple),
        cmocka_unit_test(thin_spirals_stay_simple),
        cmocka_unit_test(coasts_stay_simple),
        cmocka_unit_test(reversal_and_mirror),
        cmocka_unit_test(sets_do_not_depend_on_threads),
        cmocka_unit_test(uneven_edges_are_drawn_back),
        cmocka_unit_test(neighbours_are_drawn_apart),
        cmocka_unit_test(choices_and_refusals),
        cmocka_unit_test(slivers_are_right_or_told),
        cmocka_unit_test(drawing_back_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

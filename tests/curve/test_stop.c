// Stops: pieces that are short enough and near enough to the limit, with as few levels as that takes.

#include "refine_helpers.h"

#include "batten/curve_measure.h"
#include "curve/pieces.h"

enum
{
    COUNT = 24,
    DEEP = 12
};

/// A closed curve with edges of very different lengths.
static void make_ring(const bat_space *space, double *points)
{
    double origin[3] = {0, 0, 1}, flat[3];
    for (int i = 0; i < COUNT; i++)
    {
        double t = 2 * PI * (i + 3 * sin(2 * PI * i / COUNT)) / COUNT, r = 0.5 + 0.2 * cos(3 * t);
        flat[0] = r * cos(t);
        flat[1] = r * sin(t);
        flat[2] = 0;
        double *p = points + (size_t)i * space->point_dim;
        if (space->point_dim == 2)
            memcpy(p, flat, 2 * sizeof *p);
        else
            check_status(space->exp(space, origin, flat, p), BAT_OK);
    }
}

static size_t levels_between(size_t begin, size_t end)
{
    size_t levels = 0;
    while (((size_t)1 << levels) < end - begin)
        levels++;
    assert_int_equal((size_t)1 << levels, end - begin);
    return levels;
}

/// The distance of a point from the geodesic between two, by search along it.
static double distance_to_edge(const bat_space *space, const double *p, const double *q, const double *x)
{
    double low = 0, high = 1, at[3];
    for (int i = 0; i < 60; i++)
    {
        double a = low + (high - low) / 3, b = high - (high - low) / 3;
        check_status(bat_space_geodesic(space, p, q, a, at), BAT_OK);
        double d = space->distance(space, at, x);
        check_status(bat_space_geodesic(space, p, q, b, at), BAT_OK);
        if (d < space->distance(space, at, x))
            high = b;
        else
            low = a;
    }
    check_status(bat_space_geodesic(space, p, q, (low + high) / 2, at), BAT_OK);
    return space->distance(space, at, x);
}

static const char *const NAMES[] = {
    "angle-4", "angle-6", "log-exp-4", "four-point", "six-point", "lane-riesenfeld:order=3", "log-exp-4:parameters=chordal"};
enum
{
    NAME_COUNT = sizeof NAMES / sizeof *NAMES
};

static bool exists(const bat_space *space, size_t name)
{
    return name < 3 || name == 6 || strcmp(space->name, "plane") == 0 || strcmp(space->name, "euclidean") == 0;
}

/// Every point of an edge with k levels is the point that k levels everywhere give, and k is the smallest that is enough.
static void each_edge_gets_its_own_levels(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t k = 0; k < 3; k++)
        for (size_t s = 0; s < NAME_COUNT; s++)
            for (int closed = 0; closed < 2; closed++)
            {
                const bat_space *space = &spaces[k];
                if (!exists(space, s))
                    continue;
                size_t dim = space->point_dim;
                double points[3 * COUNT];
                make_ring(space, points);
                bat_curve ring = {.space = space, .points = points, .count = COUNT, .closed = closed};
                bat_curve_refine_options how = options(NAMES[s], 0);
                how.snap = s == 5;
                how.max_edge = 0.013;
                bat_curve fine, whole[8];
                size_t *starts, count, edges = closed ? COUNT : COUNT - 1;
                check_status(pieces_refine(&ring, &how, NULL, NULL, &fine, &starts, NULL), BAT_OK);
                check_status(bat_curve_refined_count(&ring, &how, &count, NULL), BAT_OK);
                assert_int_equal(count, fine.count);
                how.max_edge = 0;
                size_t least = 8, most = 0;
                for (how.levels = 0; how.levels < 8; how.levels++)
                    whole[how.levels] = refined(&ring, &how);
                for (size_t e = 0; e < edges; e++)
                {
                    size_t levels = levels_between(starts[e], starts[e + 1]);
                    assert_true(levels < 8);
                    least = levels < least ? levels : least;
                    most = levels > most ? levels : most;
                    const bat_curve *same = &whole[levels];
                    double longest = 0, longest_before = 0;
                    for (size_t i = 0; i <= (size_t)1 << levels; i++)
                    {
                        const double *p = fine.points + (starts[e] + i) % fine.count * dim;
                        for (size_t c = 0; c < dim; c++)
                            check_near(p[c], same->points[((e << levels) + i) % same->count * dim + c], 1e-14);
                        if (i < (size_t)1 << levels)
                            longest = fmax(longest,
                                           space->distance(space, p, fine.points + (starts[e] + i + 1) % fine.count * dim));
                    }
                    assert_true(longest <= 0.013 * (1 + 1e-12));
                    if (levels == 0)
                        continue;
                    const bat_curve *before = &whole[levels - 1];
                    for (size_t i = e << (levels - 1); i < (e + 1) << (levels - 1); i++)
                        longest_before =
                            fmax(longest_before, space->distance(space, before->points + i * dim,
                                                                 before->points + (i + 1) % before->count * dim));
                    assert_true(longest_before > 0.013);
                }
                assert_true(least + 1 < most);
                for (size_t i = 0; i < 8; i++)
                    bat_curve_free(&whole[i]);
                free(starts);
                bat_curve_free(&fine);
            }
}

/// The points of level 12 lie within the tolerance of the pieces, and the tolerance is not undercut by much: with one level
/// less they do not.
static void the_tolerance_holds_at_level_12(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    const double tolerances[] = {1e-2, 1e-3, 1e-4, 1e-5};
    for (size_t k = 0; k < 3; k++)
        for (size_t s = 0; s < NAME_COUNT; s++)
        {
            const bat_space *space = &spaces[k];
            if (!exists(space, s))
                continue;
            size_t dim = space->point_dim, wasted = 0, edges = 0;
            double points[3 * COUNT];
            make_ring(space, points);
            bat_curve ring = {.space = space, .points = points, .count = COUNT, .closed = true};
            bat_curve_refine_options how = options(NAMES[s], DEEP);
            how.snap = s == 5;
            bat_curve limit = refined(&ring, &how);
            for (size_t t = 0; t < 4; t++)
            {
                how.tolerance = tolerances[t];
                bat_curve fine;
                size_t *starts;
                check_status(pieces_refine(&ring, &how, NULL, NULL, &fine, &starts, NULL), BAT_OK);
                for (size_t e = 0; e < COUNT; e++)
                {
                    size_t levels = levels_between(starts[e], starts[e + 1]), stride = (size_t)1 << (DEEP - levels);
                    double largest = 0, before = 0;
                    for (size_t i = 0; i < (size_t)1 << DEEP; i += 29)
                    {
                        const double *x = limit.points + ((e << DEEP) + i) * dim;
                        const double *p = fine.points + (starts[e] + i / stride) * dim;
                        const double *q = fine.points + (starts[e] + i / stride + 1) % fine.count * dim;
                        largest = fmax(largest, distance_to_edge(space, p, q, x));
                        size_t j = i / (2 * stride) * 2 * stride;
                        if (levels > 0)
                            before =
                                fmax(before,
                                     distance_to_edge(space, limit.points + ((e << DEEP) + j) * dim,
                                                      limit.points + ((e << DEEP) + j + 2 * stride) % limit.count * dim, x));
                    }
                    assert_true(largest <= tolerances[t]);
                    wasted += levels > 0 && before <= tolerances[t];
                    edges++;
                }
                free(starts);
                bat_curve_free(&fine);
            }
            assert_true(wasted * 5 <= edges);
            bat_curve_free(&limit);
        }
}

/// The learned scheme on polygons of any sampling: the estimate holds for nearly all edges.
static void the_estimate_is_safe_for_the_default_scheme(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(17);
    size_t edges = 0, missed = 0;
    double worst = 0;
    for (int curve = 0; curve < 20; curve++)
    {
        double points[2 * COUNT];
        for (size_t i = 0; i < COUNT; i++)
        {
            double noise[2], t = 2 * PI * (double)i / COUNT;
            plane.random_point(&plane, &random, noise);
            points[2 * i] = cos(t) + 0.02 * curve * 0.2 * noise[0];
            points[2 * i + 1] = sin(t) + 0.02 * curve * 0.2 * noise[1];
        }
        bat_curve ring = {.space = &plane, .points = points, .count = COUNT, .closed = true};
        bat_curve_refine_options how = options("learned", DEEP);
        bat_curve limit = refined(&ring, &how), fine;
        size_t *starts;
        how.tolerance = 1e-4;
        check_status(pieces_refine(&ring, &how, NULL, NULL, &fine, &starts, NULL), BAT_OK);
        for (size_t e = 0; e < COUNT; e++)
        {
            size_t levels = levels_between(starts[e], starts[e + 1]), stride = (size_t)1 << (DEEP - levels);
            double largest = 0;
            for (size_t i = 0; i < (size_t)1 << DEEP; i += 11)
                largest = fmax(largest, distance_to_edge(&plane, fine.points + 2 * (starts[e] + i / stride),
                                                         fine.points + 2 * ((starts[e] + i / stride + 1) % fine.count),
                                                         limit.points + 2 * ((e << DEEP) + i)));
            edges++;
            missed += largest > how.tolerance;
            worst = fmax(worst, largest / how.tolerance);
        }
        free(starts);
        bat_curve_free(&fine);
        bat_curve_free(&limit);
    }
    print_message("%zu of %zu edges are farther than the tolerance, at most %.3f of it\n", missed, edges, worst);
    assert_true(missed * 100 <= edges);
    assert_true(worst < 1.5);
}

/// A change elsewhere does not change the levels of an edge out of its reach, and reversal reverses.
static void neighbours_do_not_matter(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT], changed[2 * COUNT], backwards[2 * COUNT];
    make_ring(&plane, points);
    memcpy(changed, points, sizeof points);
    changed[0] *= 3;
    for (size_t i = 0; i < COUNT; i++)
        memcpy(backwards + 2 * i, points + 2 * ((COUNT - i) % COUNT), 2 * sizeof *points);
    bat_curve a = {.space = &plane, .points = points, .count = COUNT, .closed = true}, b = a, c = a;
    b.points = changed;
    c.points = backwards;
    bat_curve_refine_options how = options("angle-4", 0);
    how.tolerance = 2e-4;
    how.max_edge = 0.1;
    bat_curve fine[3];
    size_t *starts[3];
    check_status(pieces_refine(&a, &how, NULL, NULL, &fine[0], &starts[0], NULL), BAT_OK);
    check_status(pieces_refine(&b, &how, NULL, NULL, &fine[1], &starts[1], NULL), BAT_OK);
    check_status(pieces_refine(&c, &how, NULL, NULL, &fine[2], &starts[2], NULL), BAT_OK);
    for (size_t e = 0; e < COUNT; e++)
    {
        size_t levels = levels_between(starts[0][e], starts[0][e + 1]);
        if (e > 4 && e < COUNT - 5)
            assert_int_equal(levels, levels_between(starts[1][e], starts[1][e + 1]));
        size_t reversed = COUNT - 1 - e;
        assert_int_equal(levels, levels_between(starts[2][reversed], starts[2][reversed + 1]));
    }
    assert_int_equal(fine[0].count, fine[2].count);
    for (size_t i = 0; i < fine[0].count; i++)
        for (size_t k = 0; k < 2; k++)
            check_near(fine[0].points[2 * i + k], fine[2].points[2 * ((fine[0].count - i) % fine[0].count) + k], 1e-14);
    for (int i = 0; i < 3; i++)
    {
        free(starts[i]);
        bat_curve_free(&fine[i]);
    }
}

/// One huge edge among small ones, in windows and by threads: the same bytes; and corners beside stops.
static void threads_and_windows_make_no_difference(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 100, 1, 100.01, 2, 100, 3, 50, 10, 0, 3, -0.01, 1.5}, channels[] = {1, 2, 3, 4, 5, 6, 7};
    unsigned char flags[7] = {0, 0, 0, 0, 0, 1, 0};
    bat_curve curve = {.space = &plane, .points = points, .count = 7, .closed = true};
    curve.channels = channels;
    curve.channel_count = 1;
    for (int cut = 0; cut < 2; cut++)
    {
        curve.corners = cut ? flags : NULL;
        bat_curve_refine_report report;
        bat_curve_refine_options how = options(cut ? "four-point:parameters=centripetal" : "learned", 0);
        how.max_edge = 0.005;
        how.tolerance = 1e-3;
        how.report = &report;
        how.threads = 1;
        bat_curve one = refined(&curve, &how);
        how.threads = 4;
        bat_curve four = refined(&curve, &how);
        assert_int_equal(one.count, four.count);
        assert_memory_equal(one.points, four.points, 2 * one.count * sizeof(double));
        assert_memory_equal(one.channels, four.channels, one.count * sizeof(double));
        assert_int_equal(report.corners, cut);
        assert_true(report.max_levels >= 14 && report.min_levels < report.max_levels);
        double longest = 0;
        for (size_t i = 0; i < one.count; i++)
            longest = fmax(longest, plane.distance(&plane, one.points + 2 * i, one.points + 2 * ((i + 1) % one.count)));
        assert_true(longest <= 0.005 * (1 + 1e-12));
        // Channels stand beside their points: each given point has its own.
        for (size_t v = 0; v < 7; v++)
        {
            bool found = false;
            for (size_t i = 0; i < one.count; i++)
                found = found || (memcmp(one.points + 2 * i, points + 2 * v, 2 * sizeof *points) == 0 &&
                                  one.channels[i] == channels[v]);
            assert_true(found);
        }
        bat_curve_free(&one);
        bat_curve_free(&four);
    }
}

static void check_refused(const bat_curve *curve, const bat_curve_refine_options *how, bat_status status, const char *text)
{
    bat_curve fine = {0};
    bat_error error = {.text = ""};
    size_t count = 17;
    check_status(bat_curve_refine(curve, how, &fine, &error), status);
    assert_null(fine.points);
    if (strstr(error.text, text) == NULL)
        fail_msg("'%s' does not have '%s'", error.text, text);
    check_status(bat_curve_refined_count(curve, how, &count, NULL), status);
    assert_int_equal(count, 17);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    make_ring(&plane, points);
    points[2 * 5] *= 4;
    points[2 * 5 + 1] *= 4;
    bat_curve ring = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    const struct
    {
        const char *scheme, *text;
    } refused[] = {{"lane-riesenfeld:order=3", "snap"},
                   {"chaikin", "order=3"},
                   {"geodesic:order=3", "log-exp-4"},
                   {"angle:adaptive=1", "levels"},
                   {"cubic", "spline"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
    {
        bat_curve_refine_options how = options(refused[i].scheme, 3);
        how.tolerance = 0.01;
        check_refused(&ring, &how, BAT_UNSUPPORTED, refused[i].text);
    }
    bat_curve_refine_options how = options("four-point", 3);
    how.max_edge = 0.01;
    how.ends = BAT_CURVE_END_RULE_FREE;
    check_refused(&ring, &how, BAT_UNSUPPORTED, "free ends");
    // The first edge that needs more than the most levels is the one before the far point.
    how = options("four-point", 3);
    how.max_edge = 0.05;
    how.max_levels = 3;
    check_refused(&ring, &how, BAT_TOO_LARGE, "the edge after point 4 needs more than the 3 levels");
    how.max_edge = 0;
    how.tolerance = 1e-4;
    how.max_levels = 1;
    check_refused(&ring, &how, BAT_TOO_LARGE, "needs more than the 1 levels");
    how.max_levels = 20;
    how.max_edge = 0.05;
    how.max_points = 3 * COUNT / 2;
    check_refused(&ring, &how, BAT_TOO_LARGE, "more than 36 points");
    // A cap that is just enough.
    how = options("four-point", 0);
    how.max_edge = 0.05;
    how.max_levels = 7;
    bat_curve_refine_report report;
    how.report = &report;
    bat_curve fine = refined(&ring, &how);
    assert_true(report.max_levels <= 7);
    how.max_levels = report.max_levels;
    bat_curve again = refined(&ring, &how);
    assert_int_equal(fine.count, again.count);
    how.max_levels--;
    check_refused(&ring, &how, BAT_TOO_LARGE, "point 4");
    bat_curve_free(&fine);
    bat_curve_free(&again);
}

/// A ring with a neck that crosses itself when refined is drawn back edge by edge, with levels of its own on each; its
/// corner stays.
static void rings_stay_simple(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 3, 1.4, 3.5, 1.4, 6, 0, 6, 3, 3.5, 1.6, 3, 1.6, 0, 3};
    unsigned char flags[8] = {1};
    bat_curve ring = {.space = &plane, .points = points, .count = 8, .closed = true};
    for (int cut = 0; cut < 2; cut++)
    {
        ring.corners = cut ? flags : NULL;
        bat_curve_refine_report report;
        bat_curve_refine_options how = options("four-point", 0);
        how.max_edge = 0.3;
        how.report = &report;
        how.simple = BAT_CURVE_SIMPLE_NEVER;
        bat_curve crossing = refined(&ring, &how);
        how.simple = BAT_CURVE_SIMPLE_RINGS;
        bat_curve fine = refined(&ring, &how);
        bool simple[2];
        check_status(bat_curve_is_simple(&crossing, &simple[0], NULL), BAT_OK);
        check_status(bat_curve_is_simple(&fine, &simple[1], NULL), BAT_OK);
        assert_true(!simple[0] && simple[1]);
        assert_true(report.crossing == 1 && report.drawn_back > 0 && report.corners == (size_t)cut);
        assert_true(report.min_levels < report.max_levels);
        assert_int_equal(fine.count, crossing.count);
        double *into = calloc(fine.count, 2 * sizeof *into);
        check_status(bat_curve_refine_into(&ring, &how, into, NULL, fine.count, NULL), BAT_OK);
        assert_memory_equal(into, fine.points, 2 * fine.count * sizeof *into);
        free(into);
        bat_curve_free(&crossing);
        bat_curve_free(&fine);
    }
}

/// A curve that is as it should be stays as it is.
static void nothing_needed_is_nothing_done(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 0, 2, 0, 3, 0};
    bat_curve line = {.space = &plane, .points = points, .count = 4};
    bat_curve_refine_options how = options("learned", 5);
    how.tolerance = 1e-12;
    bat_curve fine = refined(&line, &how);
    assert_int_equal(fine.count, 4);
    assert_memory_equal(fine.points, points, sizeof points);
    bat_curve_free(&fine);
    how.max_edge = 1; // the edges are not longer
    fine = refined(&line, &how);
    assert_int_equal(fine.count, 4);
    bat_curve_free(&fine);
    how.max_edge = 0.999;
    fine = refined(&line, &how);
    assert_int_equal(fine.count, 7);
    bat_curve_free(&fine);
}

static void a_relative_tolerance_is_in_median_edges(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 0, 3, 1, 3, 4, 0, 3}; // edges of 1, sqrt(5), 3, sqrt(10), 3
    bat_curve ring = {.space = &plane, .points = points, .count = 5, .closed = true};
    bat_curve_refine_options how = options("log-exp-4", 5);
    bat_curve_refine_report report;
    how.report = &report;
    how.tolerance = 0.02 * 3;
    bat_curve fine = refined(&ring, &how);
    assert_int_equal(report.stopped, 1);
    how.tolerance = 0;
    how.relative_tolerance = 0.02;
    bat_curve same = refined(&ring, &how);
    assert_int_equal(same.count, fine.count);
    assert_memory_equal(same.points, fine.points, 2 * fine.count * sizeof *fine.points);
    assert_int_equal(report.stopped, 1);
    bat_curve_free(&same);
    bat_curve_free(&fine);
    // A scheme that cannot be stopped goes by its levels.
    how.scheme = options("chaikin", 5).scheme;
    fine = refined(&ring, &how);
    assert_int_equal(fine.count, 5 * 32);
    assert_int_equal(report.stopped, 0);
    bat_curve_free(&fine);
}

static void straight_edges_are_counted(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 0, 2, 0, 3, 0, 4, 1, 5, 3};
    bat_curve line = {.space = &plane, .points = points, .count = 6};
    bat_curve_refine_options how = options("angle-6:turns=1", 3);
    bat_curve fine = refined(&line, &how);
    assert_int_equal(bat_curve_straight_edges(&line, &fine), 3);
    bat_curve_free(&fine);
    how.corner_angle = 0.1;
    fine = refined(&line, &how);
    assert_int_equal(bat_curve_straight_edges(&line, &fine), 5);
    bat_curve_free(&fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_edge_gets_its_own_levels),
        cmocka_unit_test(the_tolerance_holds_at_level_12),
        cmocka_unit_test(the_estimate_is_safe_for_the_default_scheme),
        cmocka_unit_test(neighbours_do_not_matter),
        cmocka_unit_test(threads_and_windows_make_no_difference),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(rings_stay_simple),
        cmocka_unit_test(nothing_needed_is_nothing_done),
        cmocka_unit_test(a_relative_tolerance_is_in_median_edges),
        cmocka_unit_test(straight_edges_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

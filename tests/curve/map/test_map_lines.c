// Lines of a map: those that meet end to end go on, and edges along parallels and meridians stay on them.

#include "refine_helpers.h"

#include "batten/curve_map.h"
#include "space/degrees.h"

/// Of the learned scheme, whose network is of single precision, when a line is reversed.
static const double ROUNDING = 1e-6;

enum
{
    POINTS = 13,
    PIECES = 4
};

/// A wavy line on the plane.
static void line_point(size_t i, double *p)
{
    p[0] = (double)i + 0.2 * cos(3.0 * (double)i);
    p[1] = sin(0.9 * (double)i) + 0.3 * cos(2.0 * (double)i);
}

/// Pieces of a line from point to point of `cuts`; piece k is reversed where bit k of `reversed` is set. A ring goes on
/// from its last point to its first.
static bat_curve_set pieces_of(const bat_space *space, const double *points, const size_t *cuts, size_t count,
                               unsigned reversed, size_t ring)
{
    bat_curve *curves = calloc(count, sizeof *curves);
    for (size_t k = 0; k < count; k++)
    {
        size_t n = cuts[k + 1] - cuts[k] + 1, dim = space->point_dim;
        curves[k] = (bat_curve){.space = space, .count = n, .points = malloc(n * dim * sizeof(double))};
        for (size_t i = 0; i < n; i++)
        {
            size_t from = cuts[k] + (reversed >> k & 1 ? n - 1 - i : i);
            memcpy(curves[k].points + i * dim, points + (ring > 0 ? from % ring : from) * dim, dim * sizeof(double));
        }
    }
    bat_curve_set set;
    assert_int_equal(bat_curve_set_take(curves, count, &set, NULL), BAT_OK);
    return set;
}

static bat_curve_map_refine_options line_options(const char *scheme, bat_curve_map_refine_report *report)
{
    bat_curve_map_refine_options options = bat_curve_map_refine_defaults();
    assert_int_equal(bat_curve_scheme_by_name(scheme, &options.refine.scheme, NULL), BAT_OK);
    options.refine.levels = 3;
    options.topology = BAT_CURVE_MAP_TOPOLOGY_ALWAYS;
    options.report = report;
    return options;
}

/// Whether refined pieces are the parts of a refined line.
static void check_pieces(const bat_curve_set *pieces, const bat_curve *whole, const size_t *cuts, unsigned reversed,
                         size_t levels)
{
    for (size_t k = 0; k < pieces->count; k++)
    {
        const bat_curve *piece = &pieces->curves[k];
        size_t first = cuts[k] << levels, edges = (cuts[k + 1] - cuts[k]) << levels, dim = whole->space->point_dim;
        assert_int_equal(piece->count, edges + 1);
        assert_false(piece->closed);
        for (size_t i = 0; i <= edges; i++)
        {
            size_t at = reversed >> k & 1 ? edges - i : i;
            for (size_t c = 0; c < dim; c++)
                assert_true(fabs(piece->points[at * dim + c] - whole->points[(first + i) % whole->count * dim + c]) <
                            ROUNDING);
        }
    }
}

static void test_lines_that_meet_are_one(void **state)
{
    (void)state;
    static const size_t CUTS[PIECES + 1] = {0, 1, 5, 8, POINTS - 1};
    static const char *const NAMES[] = {"four-point", "angle-6", "learned"};
    bat_space plane = bat_euclidean(2);
    double points[2 * POINTS];
    for (size_t i = 0; i < POINTS; i++)
        line_point(i, points + 2 * i);
    for (unsigned reversed = 0; reversed < 1 << PIECES; reversed++)
        for (size_t n = 0; n < 3; n++)
        {
            bat_curve_map_refine_report report;
            bat_curve_map_refine_options how = line_options(NAMES[n], &report);
            bat_curve_set coarse = pieces_of(&plane, points, CUTS, PIECES, reversed, 0), fine, ended;
            bat_curve line = {.space = &plane, .points = points, .count = POINTS}, whole;
            assert_int_equal(bat_curve_refine(&line, &how.refine, &whole, NULL), BAT_OK);
            assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, NULL), BAT_OK);
            assert_int_equal(report.joints, PIECES - 1);
            check_pieces(&fine, &whole, CUTS, reversed, 3);
            how.join = BAT_CURVE_MAP_JOIN_NO;
            assert_int_equal(bat_curve_map_refine(&coarse, &how, &ended, NULL), BAT_OK);
            assert_int_equal(report.joints, 0);
            assert_true(ended.curves[0].points[2] != fine.curves[0].points[2] ||
                        ended.curves[0].points[3] != fine.curves[0].points[3]);
            bat_curve_free(&whole);
            bat_curve_set_free(&fine);
            bat_curve_set_free(&ended);
            bat_curve_set_free(&coarse);
        }
}

/// With stops a joint turns by at most 3 degrees or a fifth of the given turn, however coarse the tolerance is.
static void test_joints_are_smooth(void **state)
{
    (void)state;
    static const size_t CUTS[PIECES + 1] = {0, 2, 5, 8, POINTS - 1};
    static const char *const NAMES[] = {"four-point", "learned"};
    bat_space plane = bat_euclidean(2);
    double points[2 * POINTS];
    for (size_t i = 0; i < POINTS; i++)
        line_point(i, points + 2 * i);
    for (size_t n = 0; n < 2; n++)
    {
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = line_options(NAMES[n], &report);
        bat_curve_set coarse = pieces_of(&plane, points, CUTS, PIECES, 0, 0), fine;
        for (size_t k = 0; k < PIECES; k++)
        {
            bat_curve *piece = (bat_curve *)&coarse.curves[k];
            piece->channel_count = 1;
            piece->channels = malloc(piece->count * sizeof(double));
            for (size_t i = 0; i < piece->count; i++)
                piece->channels[i] = (double)(CUTS[k] + i);
        }
        how.refine.tolerance = 0.4;
        assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, NULL), BAT_OK);
        for (size_t k = 1; k < PIECES; k++)
        {
            const double *joint = points + 2 * CUTS[k], *after = fine.curves[k].points + 2;
            const double *before = fine.curves[k - 1].points + 2 * (fine.curves[k - 1].count - 2);
            double given = fabs(plane.exterior_angle(&plane, joint - 2, joint, joint + 2));
            double turn = fabs(plane.exterior_angle(&plane, before, joint, after));
            assert_true(given > 0.06); // or nothing is tested
            assert_true(turn <= fmax(0.0523598776, 0.2 * given));
            const double *channels = fine.curves[k].channels;
            for (size_t i = 0; i < fine.curves[k].count; i++)
                assert_true(channels[i] > (double)CUTS[k] - 0.5 && (i == 0 || channels[i] > channels[i - 1]));
        }
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);
    }
}

// Pieces of a ring, and one line whose ends meet.
static void test_pieces_of_a_ring_close(void **state)
{
    (void)state;
    enum
    {
        RING = 9
    };
    static const size_t CUTS[2][4] = {{0, 2, 6, RING}, {0, RING}};
    bat_space plane = bat_euclidean(2);
    double points[2 * RING];
    for (size_t i = 0; i < RING; i++)
    {
        double angle = 6.2831853 * (double)i / RING, radius = 1 + 0.1 * cos(5.0 * (double)i);
        points[2 * i] = radius * cos(angle);
        points[2 * i + 1] = radius * sin(angle);
    }
    for (size_t n = 0; n < 2; n++)
    {
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = line_options("four-point", &report);
        size_t count = n == 0 ? 3 : 1;
        unsigned reversed = n == 0 ? 2 : 0;
        bat_curve_set coarse = pieces_of(&plane, points, CUTS[n], count, reversed, RING), fine;
        bat_curve ring = {.space = &plane, .points = points, .count = RING, .closed = true}, whole;
        assert_int_equal(bat_curve_refine(&ring, &how.refine, &whole, NULL), BAT_OK);
        assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, NULL), BAT_OK);
        assert_int_equal(report.joints, count);
        check_pieces(&fine, &whole, CUTS[n], reversed, 3);
        bat_curve_free(&whole);
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);
    }
}

// A third line, a corner and other values at the joint end the lines there.
static void test_lines_end_where_they_must(void **state)
{
    (void)state;
    static const double LINE[] = {0, 0, 1, 0.3, 2, 0, 3, 0.4, 4, 0, 2, 0, 2.2, -1, 2, -2};
    static const size_t CUTS[] = {0, 2, 4};
    bat_space plane = bat_euclidean(2);
    for (int why = 0; why < 4; why++)
    {
        bat_curve_map_refine_report report;
        bat_curve_map_refine_options how = line_options("four-point", &report);
        bat_curve_set coarse = pieces_of(&plane, LINE, CUTS, 2, 0, 0), fine;
        if (why == 1)
        {
            bat_curve third = {.space = coarse.space, .count = 3, .points = malloc(6 * sizeof(double))};
            memcpy(third.points, LINE + 10, 6 * sizeof(double));
            coarse.curves = realloc(coarse.curves, 3 * sizeof *coarse.curves);
            coarse.curves[coarse.count++] = third;
        }
        if (why == 2)
        {
            coarse.curves[0].corners = calloc(3, 1);
            coarse.curves[0].corners[2] = 1;
        }
        for (size_t c = 0; c < 2 && why == 3; c++)
        {
            coarse.curves[c].channel_count = 1;
            coarse.curves[c].channels = calloc(3, sizeof(double));
            coarse.curves[c].channels[0] = 7.0 * (double)c;
        }
        assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, NULL), BAT_OK);
        assert_int_equal(report.joints, why == 0);
        bat_curve_set_free(&fine);
        bat_curve_set_free(&coarse);
    }
}

/// A line of the sphere through points in degrees.
static bat_curve_set line_in_degrees(const bat_space *sphere, const double *degrees, size_t count)
{
    bat_curve *curves = calloc(1, sizeof *curves);
    curves[0] = (bat_curve){.space = sphere, .count = count, .points = malloc(3 * count * sizeof(double))};
    for (size_t i = 0; i < count; i++)
        degrees_to_point(degrees[2 * i], degrees[2 * i + 1], curves[0].points + 3 * i);
    bat_curve_set set;
    assert_int_equal(bat_curve_set_take(curves, 1, &set, NULL), BAT_OK);
    return set;
}

static double latitude_of(const bat_curve *curve, size_t i)
{
    const double *p = curve->points + 3 * i;
    return atan2(p[2], hypot(p[0], p[1])) * 57.295779513082321;
}

static void test_edges_along_parallels_stay_on_them(void **state)
{
    (void)state;
    // The second run crosses the antimeridian; the third is short, and its coordinates are coarse.
    static const double LINES[][10] = {{-126, 47.31, -123, 49, -109, 49, -95, 49, -93, 46.7},
                                       {176, -10.3, 178, -12, -175, -12, -170, -12, -168, -15.21},
                                       {10, 50.3, 11.5, 51.1, 13, 51.1, 14.1, 50.2, 15.3, 50.7}};
    bat_space sphere = bat_sphere(2);
    for (size_t n = 0; n < 3; n++)
        for (int edges = 0; edges < 3; edges++)
        {
            bat_curve_map_refine_options how = line_options("log-exp-4", NULL);
            how.edges = (bat_curve_map_edges)edges;
            bat_curve_set coarse = line_in_degrees(&sphere, LINES[n], 5), fine;
            assert_int_equal(bat_curve_map_refine(&coarse, &how, &fine, NULL), BAT_OK);
            double off = 0, latitude = LINES[n][3];
            for (size_t i = 8; i <= (n < 2 ? 24 : 16); i++)
                off = fmax(off, fabs(latitude_of(&fine.curves[0], i) - latitude));
            bool straight = edges == BAT_CURVE_MAP_EDGES_STRAIGHT || (n < 2 && edges == BAT_CURVE_MAP_EDGES_AUTO);
            assert_true(straight ? off < 1e-12 : off > 1e-3);
            bat_curve_set_free(&fine);
            bat_curve_set_free(&coarse);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines_that_meet_are_one),
        cmocka_unit_test(test_joints_are_smooth),
        cmocka_unit_test(test_pieces_of_a_ring_close),
        cmocka_unit_test(test_lines_end_where_they_must),
        cmocka_unit_test(test_edges_along_parallels_stay_on_them),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

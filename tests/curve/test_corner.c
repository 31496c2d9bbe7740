// Corners: what stays where it is, which edges stay straight, and what makes no difference.

#include "refine_helpers.h"

#include "curve/pieces.h"

static bat_curve_refine_options with_corners(const char *name, size_t levels, double degrees)
{
    bat_curve_refine_options how = options(name, levels);
    how.corner_angle = degrees * PI / 180;
    return how;
}

/// The row of a curve that equals a point to the last bit, or BAT_NO_INDEX.
static size_t row_of(const bat_curve *curve, const double *point)
{
    size_t dim = curve->space->point_dim;
    for (size_t i = 0; i < curve->count; i++)
        if (memcmp(curve->points + i * dim, point, dim * sizeof *point) == 0)
            return i;
    return BAT_NO_INDEX;
}

/// A rounded letter: a square with one side replaced by points of an arc, whose ends are corners.
enum
{
    LETTER = 9
};
static void make_letter(double *points)
{
    const double square[] = {1, -1, -1, -1, -1, 1, 1, 1};
    memcpy(points, square, sizeof square);
    for (int i = 1; i <= 5; i++)
    {
        double t = PI / 4 - i * PI / 12;
        points[6 + 2 * i] = sqrt(2) * cos(t);
        points[7 + 2 * i] = sqrt(2) * sin(t);
    }
}

static const char *const SCHEMES[] = {"learned",
                                      "four-point:parameters=centripetal",
                                      "catmull-rom",
                                      "cubic",
                                      "angle-4",
                                      "angle-6:adaptive=1",
                                      "four-point",
                                      "log-exp-4",
                                      "geodesic:order=2",
                                      "chaikin",
                                      "lane-riesenfeld:order=3"};
enum
{
    SCHEME_COUNT = sizeof SCHEMES / sizeof *SCHEMES
};

static void a_polygon_of_corners_stays(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * 5] = {0, 0, 4, 0, 4, 3, 1, 3.5, 0, 2};
    for (int closed = 0; closed < 2; closed++)
        for (size_t s = 0; s < SCHEME_COUNT; s++)
        {
            bat_curve curve = {.space = &plane, .points = points, .count = 5, .closed = closed};
            bat_curve_refine_options how = with_corners(SCHEMES[s], 3, 10);
            bat_curve fine = refined(&curve, &how);
            size_t edges = closed ? 5 : 4;
            assert_int_equal(fine.count, 8 * edges + !closed);
            for (size_t i = 0; i < fine.count; i++)
            {
                const double *p = points + i / 8 * 2, *q = points + (i / 8 + 1) % 5 * 2;
                double t = (double)(i % 8) / 8;
                check_near(fine.points[2 * i], t == 0 ? p[0] : p[0] + t * (q[0] - p[0]), 1e-15);
                check_near(fine.points[2 * i + 1], t == 0 ? p[1] : p[1] + t * (q[1] - p[1]), 1e-15);
                bool inner = closed || (i > 0 && i + 1 < fine.count);
                assert_int_equal(fine.corners[i], i % 8 == 0 && inner);
            }
            bat_curve_free(&fine);
        }
}

/// Each piece is refined as an open curve of its own.
static void pieces_are_open_curves(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * LETTER], arc[2 * 6], channels[LETTER], arc_channels[7];
    make_letter(points);
    for (int i = 0; i < LETTER; i++)
        channels[i] = sin(i);
    memcpy(arc, points + 6, sizeof arc);
    memcpy(arc_channels, channels + 3, 6 * sizeof *channels);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        double around[2 * 7];
        memcpy(around, arc, sizeof arc);
        memcpy(around + 12, points, 2 * sizeof *points);
        arc_channels[6] = channels[0];
        bat_curve letter = {.space = &plane, .points = points, .count = LETTER, .closed = true};
        bat_curve open = {.space = &plane, .points = around, .count = 7};
        letter.channels = channels;
        open.channels = arc_channels;
        letter.channel_count = open.channel_count = 1;
        bat_curve_refine_options how = with_corners(SCHEMES[s], 4, 30);
        // The two upper and the two lower vertices are corners.
        bat_curve fine = refined(&letter, &how), piece = refined(&open, &how);
        size_t count, first = row_of(&fine, points + 6);
        check_status(bat_curve_refined_count(&letter, &how, &count, NULL), BAT_OK);
        assert_int_equal(count, fine.count);
        assert_int_equal(first, 3 * 16);
        assert_int_equal(fine.count, first + piece.count - 1);
        for (size_t i = 0; i + 1 < piece.count; i++)
        {
            check_near(fine.points[2 * (first + i)], piece.points[2 * i], 1e-15);
            check_near(fine.points[2 * (first + i) + 1], piece.points[2 * i + 1], 1e-15);
            check_near(fine.channels[first + i], piece.channels[i], 1e-15);
        }
        check_near(fine.channels[8], (channels[0] + channels[1]) / 2, 1e-15);
        size_t corners = 0;
        for (size_t i = 0; i < fine.count; i++)
            corners += fine.corners[i];
        assert_int_equal(corners, 4);
        double *rows = calloc(fine.count, 3 * sizeof *rows);
        check_status(bat_curve_refine_into(&letter, &how, rows, rows + 2 * fine.count, fine.count, NULL), BAT_OK);
        assert_memory_equal(rows, fine.points, 2 * fine.count * sizeof *rows);
        assert_memory_equal(rows + 2 * fine.count, fine.channels, fine.count * sizeof *rows);
        check_status(bat_curve_refine_into(&letter, &how, rows, NULL, fine.count - 1, NULL), BAT_TOO_LARGE);
        free(rows);
        bat_curve_free(&fine);
        bat_curve_free(&piece);
    }
}

/// A flag does what an angle does; without any, nothing changes.
static void flags_cut_as_angles_do(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * LETTER];
    make_letter(points);
    unsigned char flags[LETTER] = {1, 1, 1, 1}, none[LETTER] = {0};
    bat_curve letter = {.space = &plane, .points = points, .count = LETTER, .closed = true};
    bat_curve_refine_options by_angle = with_corners("learned", 4, 30), plain = options("learned", 4);
    bat_curve a = refined(&letter, &by_angle), whole = refined(&letter, &plain);
    letter.corners = flags;
    bat_curve b = refined(&letter, &plain);
    letter.corners = none;
    bat_curve unflagged = refined(&letter, &plain);
    assert_int_equal(a.count, b.count);
    assert_memory_equal(a.points, b.points, 2 * a.count * sizeof(double));
    assert_memory_equal(a.corners, b.corners, a.count);
    assert_int_equal(whole.count, unflagged.count);
    assert_memory_equal(whole.points, unflagged.points, 2 * whole.count * sizeof(double));
    assert_null(whole.corners);
    for (size_t i = 0; i < unflagged.count; i++)
        assert_int_equal(unflagged.corners[i], 0);
    bat_curve_free(&a);
    bat_curve_free(&b);
    bat_curve_free(&whole);
    bat_curve_free(&unflagged);
}

/// A curve with one corner is cut there only: the last point of the open curve is the first again.
static void one_corner_opens_a_ring(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[3 * 8], around[3 * 9];
    for (int i = 0; i < 8; i++)
    {
        double t = 2 * PI * i / 8, v[3] = {cos(t), sin(t), 0.3 * sin(2 * t) + (i == 3 ? 1 : 0)};
        check_status(sphere.project(&sphere, v, points + 3 * i), BAT_OK);
    }
    for (int i = 0; i < 9; i++)
        memcpy(around + 3 * i, points + 3 * ((i + 3) % 8), 3 * sizeof *points);
    unsigned char flags[8] = {0, 0, 0, 1};
    bat_curve ring = {.space = &sphere, .points = points, .count = 8, .closed = true, .corners = flags};
    bat_curve open = {.space = &sphere, .points = around, .count = 9};
    bat_curve_refine_options how = options("learned", 3);
    size_t *starts;
    bat_curve piece = refined(&open, &how), fine;
    check_status(pieces_refine(&ring, &how, NULL, NULL, &fine, &starts, NULL), BAT_OK);
    assert_int_equal(fine.count, 64);
    for (size_t i = 0; i < 64; i++)
        assert_memory_equal(fine.points + 3 * ((i + 24) % 64), piece.points + 3 * i, 3 * sizeof(double));
    for (size_t i = 0; i <= 8; i++)
        assert_int_equal(starts[i], 8 * i);
    for (size_t i = 0; i < 64; i++)
        assert_int_equal(fine.corners[i], i == 24);
    free(starts);
    bat_curve_free(&fine);
    bat_curve_free(&piece);
}

/// Rotations have no signed angles, but angles.
static void corners_exist_in_every_space(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_rotation(), bat_euclidean(3), bat_positive_definite(2), bat_hyperbolic(3), bat_disk()};
    for (size_t k = 0; k < sizeof spaces / sizeof *spaces; k++)
    {
        const bat_space *space = &spaces[k];
        bat_random random = bat_random_seed(11);
        double points[5 * 4] = {0}, tangent[6] = {0.3, 0.1}, turned[6] = {0.1, -0.3};
        size_t dim = space->point_dim;
        // Two geodesics of two even edges, at a right angle.
        double corner[4];
        space->random_point(space, &random, corner);
        double scale_u = sqrt(space->inner(space, corner, tangent, tangent));
        double along = space->inner(space, corner, tangent, turned) / (scale_u * scale_u);
        for (int c = 0; c < 2; c++)
            turned[c] -= along * tangent[c];
        double scale_v = sqrt(space->inner(space, corner, turned, turned));
        for (int i = 0; i < 5; i++)
        {
            double step[6];
            for (size_t c = 0; c < 6; c++)
                step[c] = i < 2 ? 0.2 * (2 - i) * tangent[c] / scale_u : 0.2 * (i - 2) * turned[c] / scale_v;
            check_status(space->exp(space, corner, step, points + (size_t)i * dim), BAT_OK);
        }
        bat_curve curve = {.space = space, .points = points, .count = 5};
        for (int below = 0; below < 2; below++)
        {
            bat_curve_refine_options how = with_corners("log-exp-4", 3, below ? 89 : 91);
            bat_curve fine = refined(&curve, &how);
            size_t corners = 0;
            for (size_t i = 0; i < fine.count; i++)
                corners += fine.corners[i];
            assert_int_equal(corners, below);
            assert_int_equal(fine.corners[16], below);
            // Both pieces lie on geodesics: so do their refined points.
            double length = 0;
            for (size_t i = 0; i + 1 < fine.count; i++)
                length += space->distance(space, fine.points + i * dim, fine.points + (i + 1) * dim);
            if (below)
                check_near(length, 0.8, 1e-12);
            else
                assert_true(length > 0.8 + 1e-6);
            bat_curve_free(&fine);
        }
    }
}

/// Reversal, mirror images and another first vertex.
static void corners_commute_with_symmetries(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * LETTER], backwards[2 * LETTER], mirrored[2 * LETTER], turned[2 * LETTER];
    make_letter(points);
    for (size_t s = 0; s < SCHEME_COUNT; s++)
        for (size_t start = 1; start < LETTER; start++)
        {
            for (size_t i = 0; i < LETTER; i++)
                for (size_t c = 0; c < 2; c++)
                {
                    backwards[2 * i + c] = points[2 * ((LETTER - i) % LETTER) + c];
                    mirrored[2 * i + c] = c == 0 ? -points[2 * i] : points[2 * i + 1];
                    turned[2 * i + c] = points[2 * ((i + start) % LETTER) + c];
                }
            bat_curve a = {.space = &plane, .points = points, .count = LETTER, .closed = true}, b = a, c = a, d = a;
            b.points = backwards;
            c.points = mirrored;
            d.points = turned;
            bat_curve_refine_options how = with_corners(SCHEMES[s], 3, 30);
            bat_curve fine = refined(&a, &how), back = refined(&b, &how), other = refined(&c, &how),
                      moved = refined(&d, &how);
            size_t n = fine.count;
            assert_true(back.count == n && other.count == n && moved.count == n);
            size_t shift = row_of(&fine, turned);
            if (shift == BAT_NO_INDEX) // a vertex that its scheme moves
                for (shift = 0; shift < n && memcmp(fine.points + 2 * shift, moved.points, 2 * sizeof(double)) != 0;)
                    shift++;
            assert_true(shift < n);
            for (size_t i = 0; i < n; i++)
            {
                const double *p = fine.points + 2 * i, *q = fine.points + 2 * ((i + shift) % n);
                for (size_t k = 0; k < 2; k++)
                {
                    check_near(back.points[2 * ((n - i) % n) + k], p[k], s == 0 ? 3e-8 : 1e-13); // single precision
                    check_near(other.points[2 * i + k], k == 0 ? -p[0] : p[1], s == 0 ? 3e-8 : 1e-15);
                    check_near(moved.points[2 * i + k], q[k], 1e-15);
                }
                assert_int_equal(back.corners[(n - i) % n], fine.corners[i]);
                assert_int_equal(moved.corners[i], fine.corners[(i + shift) % n]);
            }
            bat_curve_free(&fine);
            bat_curve_free(&back);
            bat_curve_free(&other);
            bat_curve_free(&moved);
        }
}

/// Meridian and parallel: a border that comes out as it went in.
static void a_meridian_stays_one(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[4 * 3];
    const double degrees[4][2] = {{20, 10}, {20, 40}, {60, 40}, {60, 10}};
    for (int i = 0; i < 4; i++)
    {
        double lon = degrees[i][0] * PI / 180, lat = degrees[i][1] * PI / 180;
        double v[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
        memcpy(points + 3 * i, v, sizeof v);
    }
    bat_curve border = {.space = &sphere, .points = points, .count = 4, .closed = true};
    bat_curve_refine_options how = with_corners("learned", 4, 30);
    bat_curve fine = refined(&border, &how);
    for (size_t i = 0; i <= 16; i++)
    {
        const double *p = fine.points + 3 * i;
        check_near(atan2(p[1], p[0]), PI / 9, 1e-15);
        check_near(asin(p[2]), (10 + 30 * (double)i / 16) * PI / 180, 1e-14);
    }
    bat_curve_free(&fine);
}

/// A run of uneven points on a line between corners stays on the line.
static void straight_runs_stay_straight(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 0.7, 0, 1, 0, 3, 0, 3.5, 0, 6, 0, 6, 2, 5, 3, 3, 3.5, 1, 3, 0, 2};
    for (size_t s = 0; s < SCHEME_COUNT; s++)
    {
        bat_curve building = {.space = &plane, .points = points, .count = 11, .closed = true};
        bat_curve_refine_options how = with_corners(SCHEMES[s], 4, 60);
        bat_curve fine = refined(&building, &how);
        size_t end = row_of(&fine, points + 10);
        assert_true(end >= 5 * 16 && end < fine.count);
        for (size_t i = 0; i <= end; i++)
            check_near(fine.points[2 * i + 1], 0, 1e-14);
        bat_curve_free(&fine);
    }
}

/// Many pieces or few curves with many: the same bytes for any number of threads.
static void threads_make_no_difference(void **state)
{
    (void)state;
    enum
    {
        POINTS = 500,
        CURVES = 20
    };
    bat_space plane = bat_euclidean(2);
    static double points[2 * POINTS], channels[POINTS];
    static unsigned char flags[POINTS];
    bat_random random = bat_random_seed(5);
    for (size_t i = 0; i < POINTS; i++)
    {
        double noise[2];
        plane.random_point(&plane, &random, noise);
        points[2 * i] = cos(2 * PI * (double)i / POINTS) + 0.002 * noise[0];
        points[2 * i + 1] = sin(2 * PI * (double)i / POINTS) + 0.002 * noise[1];
        channels[i] = noise[0];
        flags[i] = i % 7 == 3;
    }
    bat_curve curves[CURVES], fine[4][CURVES];
    for (size_t i = 0; i < CURVES; i++)
        curves[i] = (bat_curve){.space = &plane,
                                .points = points,
                                .channels = channels,
                                .channel_count = 1,
                                .count = POINTS - i,
                                .closed = i % 2 == 0,
                                .corners = flags};
    bat_curve_refine_report reports[4];
    for (int k = 0; k < 4; k++)
    {
        bat_curve_refine_options how = options("angle-4", 3);
        how.threads = k % 2 == 0 ? 1 : 3;
        how.report = &reports[k];
        how.max_edge = k < 2 ? 0 : 0.003;
        check_status(bat_curves_refine(curves, CURVES, &how, fine[k], NULL), BAT_OK);
        if (k % 2 == 0)
            continue;
        for (size_t i = 0; i < CURVES; i++)
        {
            assert_int_equal(fine[k][i].count, fine[k - 1][i].count);
            assert_memory_equal(fine[k][i].points, fine[k - 1][i].points, 2 * fine[k][i].count * sizeof(double));
            assert_memory_equal(fine[k][i].channels, fine[k - 1][i].channels, fine[k][i].count * sizeof(double));
        }
        assert_memory_equal(&reports[k], &reports[k - 1], sizeof reports[k]);
        bat_curve alone;
        check_status(bat_curve_refine(&curves[0], &how, &alone, NULL), BAT_OK);
        assert_memory_equal(alone.points, fine[k][0].points, 2 * alone.count * sizeof(double));
        bat_curve_free(&alone);
    }
    size_t corners = 0;
    for (size_t i = 0; i < CURVES; i++)
        for (size_t j = 0; j < fine[0][i].count; j++)
            corners += fine[0][i].corners[j];
    assert_int_equal(reports[0].corners, corners);
    assert_int_equal(reports[0].min_levels, 3);
    assert_int_equal(reports[0].max_levels, 3);
    assert_true(reports[2].min_levels < reports[2].max_levels);
    for (int k = 0; k < 4; k++)
        for (size_t i = 0; i < CURVES; i++)
            bat_curve_free(&fine[k][i]);
}

static void what_cannot_be_is_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * LETTER];
    make_letter(points);
    bat_curve letter = {.space = &plane, .points = points, .count = LETTER, .closed = true};
    bat_curve_refine_options how = with_corners("four-point", 3, 30);
    bat_curve fine = {0};
    bat_error error;
    how.ends = BAT_CURVE_END_RULE_FREE;
    check_status(bat_curve_refine(&letter, &how, &fine, &error), BAT_UNSUPPORTED);
    assert_non_null(strstr(error.text, "free ends"));
    how.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
    check_status(bat_curve_refine(&letter, &how, &fine, &error), BAT_OK);
    bat_curve_free(&fine);
    how = with_corners("chaikin", 3, 30);
    how.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
    check_status(bat_curve_refine(&letter, &how, &fine, &error), BAT_UNSUPPORTED);
    how = with_corners("mask:1/4,3/4,3/4,1/4,0.1,-0.1", 3, 30);
    check_status(bat_curve_refine(&letter, &how, &fine, &error), BAT_UNSUPPORTED);
    // A failure in a piece names the vertex of the whole curve: a rule without an angle there.
    how = with_corners("four-point", 3, 30);
    how.max_points = 10;
    check_status(bat_curve_refine(&letter, &how, &fine, &error), BAT_TOO_LARGE);
    assert_null(fine.points);
}

/// An angle rule that fails over edges that are longer than its limit.
static void short_edges(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                        void *scratch)
{
    (void)scratch;
    for (size_t i = 0; i < view->count; i++)
        angles[i] = view->lengths[i] > *(const double *)rule->parameters ? NAN : 0.1;
}

static void failures_name_the_vertex_of_the_whole(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 0, 1, 1, 1, 1, 5, 2, 5, 2, 0}, limit = 3;
    unsigned char flags[6] = {0, 1};
    bat_curve_angle_rule rule = {.name = "short", .reach = 1, .parameters = &limit, .angles = short_edges};
    bat_curve curve = {.space = &plane, .points = points, .count = 6, .closed = true, .corners = flags};
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_angle_rule(&rule);
    bat_curve fine;
    bat_error error;
    for (int stop = 0; stop < 2; stop++)
    {
        how.tolerance = stop * 0.01;
        check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_POINT);
        assert_int_equal(error.index, 2);
        assert_non_null(strstr(error.text, "point 2 "));
    }
}

/// How many corners are found in a polygon of the plane.
static size_t corners_found(double *points, size_t count, bool closed, const char *scheme)
{
    bat_space plane = bat_euclidean(2);
    bat_curve curve = {.space = &plane, .points = points, .count = count, .closed = closed};
    bat_curve_refine_options how = options(scheme, 2);
    bat_curve_refine_report report;
    how.find_corners = true;
    how.report = &report;
    bat_curve fine = refined(&curve, &how);
    bat_curve_free(&fine);
    return report.corners;
}

/// Turn points of the plane by an angle about the origin.
static void turn_points(double *points, size_t count, double angle)
{
    for (size_t i = 0; i < count; i++)
    {
        double x = points[2 * i], y = points[2 * i + 1];
        points[2 * i] = cos(angle) * x - sin(angle) * y;
        points[2 * i + 1] = sin(angle) * x + cos(angle) * y;
    }
}

static void right_angles_are_found(void **state)
{
    (void)state;
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1}, ell[] = {0, 0, 3, 0, 3, 1, 1, 1, 1, 2, 0, 2};
    // A short edge cuts off one corner, and a point lies within a side.
    double cut[] = {0, 0, 1, 0, 3, 0, 4, 0, 4, 2, 3.8, 2.2, 0, 2.2};
    for (int i = 0; i < 3; i++)
    {
        assert_int_equal(corners_found(square, 4, true, "learned"), 4);
        assert_int_equal(corners_found(ell, 6, true, "learned"), 6);
        assert_int_equal(corners_found(cut, 7, true, "learned"), 5);
        assert_int_equal(corners_found(square, 4, false, "learned"), 2);
        turn_points(square, 4, 0.7);
        turn_points(ell, 6, 0.7);
        turn_points(cut, 7, 0.7);
    }
}

static void round_curves_have_no_corners(void **state)
{
    (void)state;
    double points[2 * 40];
    for (size_t count = 5; count <= 40; count++)
    {
        for (size_t i = 0; i < count; i++)
        {
            double t = 2 * PI * (double)i / (double)count;
            points[2 * i] = 3 * cos(t);
            points[2 * i + 1] = 2 * sin(t);
        }
        assert_int_equal(corners_found(points, count, true, "learned"), 0);
        for (size_t i = 0; i < count; i++)
            points[2 * i] *= 20;
        if (count % 2 == 0 || count > 17) // a short side at the end of few points is one
            assert_int_equal(corners_found(points, count, true, "learned"), 0);
        // A slow wave: all edges have nearly one direction.
        for (size_t i = 0; i < count; i++)
        {
            points[2 * i] = (double)i;
            points[2 * i + 1] = 0.05 * sin(0.7 * (double)i);
        }
        assert_int_equal(corners_found(points, count, false, "learned"), 0);
    }
}

/// Rings of three or four vertices tell no curve.
static void lots_keep_their_corners(void **state)
{
    (void)state;
    double kite[] = {0, 0, 2, -1, 3, 1, 0, 2}, triangle[] = {0, 0, 2, 0, 0, 1}, bow[] = {0, 0, 3, 2, 3, 0, 0, 1};
    assert_int_equal(corners_found(kite, 4, true, "learned"), 4);
    assert_int_equal(corners_found(triangle, 3, true, "learned"), 3);
    assert_int_equal(corners_found(kite, 4, false, "learned"), 0);
    assert_int_equal(corners_found(bow, 4, true, "learned"), 0);
}

static void straight_runs_end_in_corners(void **state)
{
    (void)state;
    double bent[] = {0, 0, 1, 0, 2, 0, 3, 0, 4, 1, 5, 1.5, 6, 1.2};
    double smooth[] = {0, 0, 1, 0, 2, 0, 3, 0, 4, 0.2, 5, 0.7, 6, 1.5};
    double back[] = {0, 0, 2, 0.5, 4, 0, 2, 0.5, 1, 3};
    assert_int_equal(corners_found(bent, 7, false, "learned"), 1);
    assert_int_equal(corners_found(smooth, 7, false, "learned"), 0);
    assert_int_equal(corners_found(back, 5, false, "learned"), 1);
}

static void simplified_lines_have_corners(void **state)
{
    (void)state;
    // An arc of edges that turn by 10 degrees, and three straight edges, as simplification leaves them.
    static const double LENGTHS[] = {0.2, 0.2, 0.2, 0.2, 0.2, 0.2, 2, 2, 2}, TURNS[] = {0, 10, 10, 10, 10, 10, 10, 60, -50};
    double points[2 * 11] = {0}, direction = 0.3;
    for (int i = 0; i < 9; i++)
    {
        direction += TURNS[i] * PI / 180;
        points[2 * i + 2] = points[2 * i] + LENGTHS[i] * cos(direction);
        points[2 * i + 3] = points[2 * i + 1] + LENGTHS[i] * sin(direction);
    }
    assert_int_equal(corners_found(points, 10, false, "learned"), 2);
    // A point within the last edge: no simplification leaves it.
    for (int c = 0; c < 2; c++)
    {
        points[20 + c] = points[18 + c];
        points[18 + c] = (points[16 + c] + points[20 + c]) / 2;
    }
    assert_int_equal(corners_found(points, 11, false, "learned"), 0);
}

static void schemes_that_move_corners_have_none(void **state)
{
    (void)state;
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1};
    assert_int_equal(corners_found(square, 4, true, "corner-cutting:r=0.2,s=0.7"), 0);
    assert_int_equal(corners_found(square, 4, true, "chaikin"), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_polygon_of_corners_stays),
        cmocka_unit_test(pieces_are_open_curves),
        cmocka_unit_test(flags_cut_as_angles_do),
        cmocka_unit_test(one_corner_opens_a_ring),
        cmocka_unit_test(corners_exist_in_every_space),
        cmocka_unit_test(corners_commute_with_symmetries),
        cmocka_unit_test(a_meridian_stays_one),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(straight_runs_stay_straight),
        cmocka_unit_test(what_cannot_be_is_refused),
        cmocka_unit_test(failures_name_the_vertex_of_the_whole),
        cmocka_unit_test(right_angles_are_found),
        cmocka_unit_test(round_curves_have_no_corners),
        cmocka_unit_test(lots_keep_their_corners),
        cmocka_unit_test(straight_runs_end_in_corners),
        cmocka_unit_test(simplified_lines_have_corners),
        cmocka_unit_test(schemes_that_move_corners_have_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "check.h"

#include "batten/curve_file.h"
#include "batten/research/curve_data.h"
#include "batten/research/curve_shapes.h"

#define EXAMPLES TEST_DATA "/../../examples/data/"

static bat_curve outline_curve(const bat_curve_shape *shape, size_t outline, const bat_space *plane)
{
    bat_curve curve;
    check_status(bat_curve_shape_curve(shape, outline, plane, &curve, NULL), BAT_OK);
    return curve;
}

/// Twice the signed area of the triangle a b c.
static double turn(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Whether c, on the line through a and b, lies between them.
static bool is_between(const double *a, const double *b, const double *c)
{
    return fmin(a[0], b[0]) <= c[0] && c[0] <= fmax(a[0], b[0]) && fmin(a[1], b[1]) <= c[1] && c[1] <= fmax(a[1], b[1]);
}

/// Whether the segments a b and c d have a point in common.
static bool segments_meet(const double *a, const double *b, const double *c, const double *d)
{
    double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
    if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
        return true;
    return (abc == 0 && is_between(a, b, c)) || (abd == 0 && is_between(a, b, d)) || (cda == 0 && is_between(c, d, a)) ||
           (cdb == 0 && is_between(c, d, b));
}

/// Whether no two edges meet but neighbours in the vertex that they share.
static bool is_simple(const bat_curve *curve)
{
    size_t count = curve->count, edges = curve->closed ? count : count - 1;
    for (size_t i = 0; i < edges; i++)
        for (size_t j = i + 2; j < edges; j++)
        {
            bool neighbours = curve->closed && i == 0 && j == edges - 1;
            if (!neighbours && segments_meet(curve->points + 2 * i, curve->points + 2 * (i + 1), curve->points + 2 * j,
                                             curve->points + 2 * ((j + 1) % count)))
                return false;
        }
    return true;
}

static double signed_area(const bat_curve *curve)
{
    static const double origin[2] = {0, 0};
    double sum = 0;
    for (size_t i = 0; i < curve->count; i++)
        sum += turn(origin, curve->points + 2 * i, curve->points + 2 * ((i + 1) % curve->count));
    return sum / 2;
}

static void test_simplicity_is_seen(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1}, bow[] = {0, 0, 1, 1, 1, 0, 0, 1}, touch[] = {0, 0, 2, 0, 2, 1, 1, 0, 0, 1};
    assert_true(is_simple(&(bat_curve){.space = &plane, .points = square, .count = 4, .closed = true}));
    assert_false(is_simple(&(bat_curve){.space = &plane, .points = bow, .count = 4, .closed = true}));
    assert_false(is_simple(&(bat_curve){.space = &plane, .points = touch, .count = 5, .closed = true}));
}

static void test_study_is_complete(void **state)
{
    (void)state;
    static const struct
    {
        const char *number, *shape, *scheme;
    } STUDY[] = {{"3.2", "jar", "chaikin"},       {"3.3", "mango", "chaikin"},         {"3.4", "pi", "chaikin"},
                 {"3.5", "car", "chaikin"},       {"4.2", "rabbit", "corner-cutting"}, {"4.3", "hand", "corner-cutting"},
                 {"4.4", "pi", "corner-cutting"}, {"5.2", "U", "four-point"},          {"5.3", "mug", "four-point"},
                 {"5.4", "pi", "four-point"}};
    enum
    {
        FIGURES = sizeof STUDY / sizeof STUDY[0]
    };
    size_t found[FIGURES] = {0}, total = 0;
    assert_int_equal(bat_curve_shape_count(), 8);
    for (size_t i = 0; i < bat_curve_shape_count(); i++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(i);
        for (size_t k = 0; k < shape->figure_count; k++, total++)
            for (size_t s = 0; s < FIGURES; s++)
                found[s] += strcmp(shape->name, STUDY[s].shape) == 0 &&
                            strcmp(shape->figures[k].number, STUDY[s].number) == 0 &&
                            strncmp(shape->figures[k].scheme, STUDY[s].scheme, strlen(STUDY[s].scheme)) == 0;
    }
    assert_int_equal(total, FIGURES);
    for (size_t s = 0; s < FIGURES; s++)
        assert_int_equal(found[s], 1);
    assert_null(bat_curve_shape_at(bat_curve_shape_count()));
    assert_null(bat_curve_shape_at(SIZE_MAX));
}

static void test_polygons(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < bat_curve_shape_count(); i++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(i);
        size_t vertices = 0;
        assert_in_range(shape->outline_count, 1, BAT_SHAPE_MAX_OUTLINES);
        for (size_t o = 0; o < shape->outline_count; o++)
        {
            bat_curve curve = outline_curve(shape, o, &plane);
            check_status(bat_curve_check(&curve, NULL), BAT_OK);
            assert_true(is_simple(&curve));
            assert_true(!curve.closed || fabs(signed_area(&curve)) > 0.01);
            vertices += curve.count;
            bat_curve_free(&curve);
        }
        assert_in_range(vertices, 15, 64);
    }
}

/// Outer contours run counter-clockwise.
static void test_orientation(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < bat_curve_shape_count(); i++)
    {
        bat_curve curve = outline_curve(bat_curve_shape_at(i), 0, &plane);
        assert_true(curve.closed);
        assert_true(signed_area(&curve) > 0.5);
        bat_curve_free(&curve);
    }
}

static void test_jar_and_u_are_symmetric(void **state)
{
    (void)state;
    for (size_t i = 0; i < bat_curve_shape_count(); i++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(i);
        if (strcmp(shape->name, "jar") != 0 && strcmp(shape->name, "U") != 0)
            continue;
        const bat_shape_outline *outline = &shape->outlines[0];
        for (size_t p = 0; p < outline->count; p++)
        {
            size_t mirrored = 0;
            for (size_t q = 0; q < outline->count; q++)
                mirrored +=
                    outline->points[q][0] == -outline->points[p][0] && outline->points[q][1] == outline->points[p][1];
            assert_int_equal(mirrored, 1);
        }
    }
}

/// The curves of each figure have no loops, at every level that can be tried edge against edge.
static void test_refined_curves_are_simple(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < bat_curve_shape_count(); i++)
    {
        const bat_curve_shape *shape = bat_curve_shape_at(i);
        for (size_t k = 0; k < shape->figure_count; k++)
            for (size_t o = 0; o < shape->outline_count; o++)
            {
                bat_curve coarse = outline_curve(shape, o, &plane);
                bat_curve_refine_options how = bat_curve_refine_defaults();
                check_status(bat_curve_scheme_by_name(shape->figures[k].scheme, &how.scheme, NULL), BAT_OK);
                for (how.levels = 1; how.levels <= 5; how.levels++)
                {
                    bat_curve fine;
                    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_OK);
                    if (!is_simple(&fine))
                        fail_msg("%s, outline %zu, %s crosses itself at level %zu", shape->name, o, shape->figures[k].scheme,
                                 how.levels);
                    bat_curve_free(&fine);
                }
                bat_curve_free(&coarse);
            }
    }
}

static void test_bad_requests(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), solid = bat_euclidean(3), disk = bat_disk();
    const bat_curve_shape *mug = bat_curve_shape_at(7);
    bat_curve curve = {.count = 77};
    bat_error error;
    check_status(bat_curve_shape_curve(mug, mug->outline_count, &plane, &curve, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "mug"));
    check_status(bat_curve_shape_curve(mug, SIZE_MAX, &plane, &curve, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_shape_curve(mug, 0, &solid, &curve, NULL), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_shape_curve(mug, 0, &disk, &curve, NULL), BAT_INVALID_ARGUMENT);
    assert_int_equal(curve.count, 77);
}

static bat_curve_set read_example(const char *path)
{
    bat_curve_set set;
    bat_error error;
    if (bat_curve_read(path, NULL, &set, &error) != BAT_OK)
        fail_msg("%s:%zu: %s", path, error.line, error.text);
    assert_int_equal(set.count, 1);
    return set;
}

/// Six decimals of a degree are half a micro-degree from the truth.
static void test_iss_track_is_the_published_one(void **state)
{
    (void)state;
    const double half_micro_degree = 0.5e-6 * 3.14159265358979323846 / 180;
    bat_space sphere = bat_sphere(2);
    bat_curve truth, control;
    check_status(bat_tension_iss_track(&sphere, &truth, &control, NULL), BAT_OK);
    bat_curve_set set = read_example(EXAMPLES "iss-track.geojson");
    const bat_curve *track = &set.curves[0];
    assert_string_equal(track->space->name, "sphere");
    assert_true(track->closed);
    assert_int_equal(track->count, control.count);
    for (size_t i = 0; i < control.count; i++)
        check_near(sphere.distance(&sphere, track->points + 3 * i, control.points + 3 * i), 0, 1.5 * half_micro_degree);
    bat_curve_set_free(&set);
    bat_curve_free(&truth);
    bat_curve_free(&control);
}

static void test_other_examples(void **state)
{
    (void)state;
    static const struct
    {
        const char *path, *space;
        size_t count;
        bool closed;
    } EXAMPLE[] = {
        {EXAMPLES "outline.csv", "plane", 22, true},
        {EXAMPLES "hyperbolic.csv", "disk", 21, true},
        {EXAMPLES "quarter-arc.csv", "plane", 5, false},
        {EXAMPLES "camera-path.obj", "euclidean", 10, false},
    };
    for (size_t i = 0; i < sizeof EXAMPLE / sizeof EXAMPLE[0]; i++)
    {
        bat_curve_set set = read_example(EXAMPLE[i].path);
        assert_string_equal(set.space->name, EXAMPLE[i].space);
        assert_int_equal(set.curves[0].count, EXAMPLE[i].count);
        assert_int_equal(set.curves[0].closed, EXAMPLE[i].closed);
        bat_curve_refine_options how = bat_curve_refine_defaults();
        how.levels = 4;
        bat_curve fine;
        check_status(bat_curve_refine(&set.curves[0], &how, &fine, NULL), BAT_OK);
        assert_int_equal(fine.count, EXAMPLE[i].closed ? 16 * EXAMPLE[i].count : 16 * (EXAMPLE[i].count - 1) + 1);
        if (set.space->point_dim == 2)
            assert_true(is_simple(&fine));
        bat_curve_free(&fine);
        bat_curve_set_free(&set);
    }
}

/// With mirrored ends the angle-based scheme stays on the circle of evenly spaced points.
static void test_quarter_arc_stays_a_circle(void **state)
{
    (void)state;
    bat_curve_set set = read_example(EXAMPLES "quarter-arc.csv");
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.scheme = bat_curve_scheme_angle(BAT_CURVE_TENSION_FOUR_POINT);
    how.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
    bat_curve fine;
    check_status(bat_curve_refine(&set.curves[0], &how, &fine, NULL), BAT_OK);
    for (size_t i = 0; i < fine.count; i++)
        check_near(hypot(fine.points[2 * i], fine.points[2 * i + 1]), 1, 1e-11);
    bat_curve_free(&fine);
    bat_curve_set_free(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simplicity_is_seen),
        cmocka_unit_test(test_study_is_complete),
        cmocka_unit_test(test_polygons),
        cmocka_unit_test(test_orientation),
        cmocka_unit_test(test_jar_and_u_are_symmetric),
        cmocka_unit_test(test_refined_curves_are_simple),
        cmocka_unit_test(test_bad_requests),
        cmocka_unit_test(test_iss_track_is_the_published_one),
        cmocka_unit_test(test_other_examples),
        cmocka_unit_test(test_quarter_arc_stays_a_circle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

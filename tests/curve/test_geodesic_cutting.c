#include "refine_helpers.h"

// Corner cutting in spaces other than R^n: linear masks by geodesics.

enum
{
    COUNT = 6,
    LEVELS = 4
};

/// Points of a plane polygon without symmetry.
static const double FLAT[2 * COUNT] = {0, 0, 1, 0.2, 1.3, 1.1, 0.4, 1.6, -0.5, 1.2, -0.6, 0.3};

/// FLAT, `size` times as large, by exp from the point (0, 0, 1), on the sphere.
static void lift(double size, double *points)
{
    for (size_t i = 0; i < COUNT; i++)
    {
        double x = size * FLAT[2 * i], y = size * FLAT[2 * i + 1], length = hypot(x, y);
        double factor = length > 0 ? sin(length) / length : 1;
        points[3 * i] = factor * x;
        points[3 * i + 1] = factor * y;
        points[3 * i + 2] = cos(length);
    }
}

static double chord(const double *p, const double *q)
{
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
}

/// New points of one level lie at the ratios of the mask, along each edge.
static void one_level_cuts_every_edge(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2), rotations;
    check_status(bat_space_by_name("rotation", 0, &rotations, NULL), BAT_OK);
    const struct
    {
        const char *scheme;
        double ratios[2];
    } cases[] = {{"chaikin", {0.25, 0.75}},
                 {"lane-riesenfeld:order=2", {0.25, 0.75}},
                 {"corner-cutting:r=0.2,s=0.6", {0.2, 0.6}},
                 {"mask:1/2,1,1/2", {0, 0.5}}};
    const bat_space *const spaces[] = {&globe, &rotations};
    bat_random random = bat_random_seed(7);
    for (size_t s = 0; s < 2; s++)
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        {
            const bat_space *space = spaces[s];
            size_t dim = space->point_dim;
            double points[4 * COUNT], expected[4];
            for (size_t i = 0; i < COUNT; i++)
            {
                if (s == 0)
                    continue;
                do
                    space->random_point(space, &random, points + i * dim);
                while (fabs(points[i * dim]) < 0.8); // near the identity
                for (size_t c = dim; c-- > 0;)
                    points[i * dim + c] *= points[i * dim] < 0 ? -1 : 1;
            }
            if (s == 0)
                lift(0.7, points);
            bat_curve ring = {.space = space, .points = points, .count = COUNT, .closed = true};
            bat_curve_refine_options how = options(cases[k].scheme, 1);
            bat_curve fine = refined(&ring, &how);
            assert_int_equal(fine.count, 2 * COUNT);
            for (size_t i = 0; i < COUNT; i++)
                for (size_t side = 0; side < 2; side++)
                {
                    const double *to = points + (i + 1) % COUNT * dim;
                    check_status(bat_space_geodesic(space, points + i * dim, to, cases[k].ratios[side], expected), BAT_OK);
                    double least = INFINITY; // masks may number points from another edge
                    for (size_t j = 0; j < fine.count; j++)
                        least = fmin(least, space->distance(space, fine.points + j * dim, expected));
                    check_near(least, 0, 1e-14);
                }
            bat_curve_free(&fine);
        }
}

/// The masks that are both have one result, to the last bit.
static void lane_riesenfeld_is_the_geodesic_scheme(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2);
    double points[3 * COUNT];
    lift(0.7, points);
    const char *const pairs[][2] = {{"chaikin", "geodesic:order=2"},
                                    {"corner-cutting:r=1/4,s=3/4", "geodesic:order=2"},
                                    {"lane-riesenfeld:order=5", "geodesic:order=5"}};
    for (size_t i = 0; i < 3; i++)
        for (int closed = 0; closed <= 1; closed++)
        {
            bat_curve curve = {.space = &globe, .points = points, .count = COUNT, .closed = closed != 0};
            bat_curve_refine_options how = options(pairs[i][0], LEVELS), other = options(pairs[i][1], LEVELS);
            bat_curve a = refined(&curve, &how), b = refined(&curve, &other);
            size_t count;
            check_status(bat_curve_refined_count(&curve, &how, &count, NULL), BAT_OK);
            assert_int_equal(a.count, count);
            assert_int_equal(a.count, b.count);
            assert_memory_equal(a.points, b.points, 3 * a.count * sizeof *a.points);
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
}

/// A small curve of the sphere is as one of its tangent plane, up to the second power of the size.
static void small_curves_are_as_in_the_plane(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2), plane = bat_euclidean(2);
    const char *const schemes[] = {"chaikin", "corner-cutting:r=0.3,s=0.8", "lane-riesenfeld:order=3"};
    for (size_t k = 0; k < 3; k++)
        for (int closed = 0; closed <= 1; closed++)
        {
            double flat[2 * COUNT], before = 0;
            memcpy(flat, FLAT, sizeof flat);
            bat_curve given = {.space = &plane, .points = flat, .count = COUNT, .closed = closed != 0};
            bat_curve_refine_options how = options(schemes[k], LEVELS);
            bat_curve wanted = refined(&given, &how);
            for (int halving = 0; halving < 4; halving++)
            {
                double points[3 * COUNT], size = ldexp(0.2, -halving), error = 0;
                lift(size, points);
                bat_curve curve = {.space = &globe, .points = points, .count = COUNT, .closed = closed != 0};
                bat_curve fine = refined(&curve, &how);
                assert_int_equal(fine.count, wanted.count);
                for (size_t i = 0; i < fine.count; i++)
                {
                    const double *p = fine.points + 3 * i;
                    double across = hypot(p[0], p[1]), factor = across > 0 ? atan2(across, p[2]) / across / size : 1 / size;
                    error =
                        fmax(error, hypot(factor * p[0] - wanted.points[2 * i], factor * p[1] - wanted.points[2 * i + 1]));
                }
                if (halving > 0)
                    check_near(log2(before / error), 2, 0.1);
                before = error;
                bat_curve_free(&fine);
            }
            bat_curve_free(&wanted);
        }
}

static void cutting_commutes_with_rotations(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2);
    const double quaternion[4] = {0.5, -0.1, 0.7, 0.5};
    double unit[4], matrix[9], length = 0, points[3 * COUNT], turned[3 * COUNT];
    for (size_t i = 0; i < 4; i++)
        length += quaternion[i] * quaternion[i];
    for (size_t i = 0; i < 4; i++)
        unit[i] = quaternion[i] / sqrt(length);
    bat_rotation_to_matrix(unit, matrix);
    lift(0.9, points);
    for (size_t i = 0; i < COUNT; i++)
        for (size_t r = 0; r < 3; r++)
            turned[3 * i + r] = matrix[3 * r] * points[3 * i] + matrix[3 * r + 1] * points[3 * i + 1] +
                                matrix[3 * r + 2] * points[3 * i + 2];
    for (int closed = 0; closed <= 1; closed++)
    {
        bat_curve curve = {.space = &globe, .points = points, .count = COUNT, .closed = closed != 0};
        bat_curve other = {.space = &globe, .points = turned, .count = COUNT, .closed = closed != 0};
        bat_curve_refine_options how = options("corner-cutting:r=0.2,s=0.75", LEVELS);
        bat_curve a = refined(&curve, &how), b = refined(&other, &how);
        for (size_t i = 0; i < a.count; i++)
        {
            double expected[3];
            for (size_t r = 0; r < 3; r++)
                expected[r] = matrix[3 * r] * a.points[3 * i] + matrix[3 * r + 1] * a.points[3 * i + 1] +
                              matrix[3 * r + 2] * a.points[3 * i + 2];
            check_near(chord(b.points + 3 * i, expected), 0, 1e-14);
        }
        bat_curve_free(&a);
        bat_curve_free(&b);
    }
}

/// Open curves keep their ends, and channels go along by the linear mask.
static void open_curves_keep_their_ends(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2), line = bat_euclidean(1);
    double points[3 * COUNT], heights[COUNT] = {3, 5, 4, 9, 1, 2};
    lift(0.7, points);
    bat_curve curve = {.space = &globe, .points = points, .count = COUNT, .channels = heights, .channel_count = 1};
    bat_curve flat = {.space = &line, .points = heights, .count = COUNT};
    bat_curve_refine_options how = options("chaikin", LEVELS);
    bat_curve fine = refined(&curve, &how), graph = refined(&flat, &how);
    assert_memory_equal(fine.points, points, 3 * sizeof *points);
    assert_memory_equal(fine.points + 3 * (fine.count - 1), points + 3 * (COUNT - 1), 3 * sizeof *points);
    assert_int_equal(fine.count, graph.count);
    assert_memory_equal(fine.channels, graph.points, fine.count * sizeof *heights);
    bat_curve_free(&fine);
    bat_curve_free(&graph);
}

static void other_masks_are_refused(void **state)
{
    (void)state;
    bat_space globe = bat_sphere(2);
    double points[3 * COUNT];
    lift(0.7, points);
    bat_curve curve = {.space = &globe, .points = points, .count = COUNT, .closed = true};
    const char *const schemes[] = {"four-point", "six-point", "mask:1/8,4/8,6/8,5/8,2/8,-1/8", "mask:-1/4,1/4,5/4,3/4@-2",
                                   "mask:1/2,1/2,1/4,1/4"};
    for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++)
    {
        bat_curve_refine_options how = options(schemes[i], 1);
        bat_curve fine = {0};
        bat_error error;
        check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_UNSUPPORTED);
        assert_non_null(strstr(error.text, "log-exp-4"));
    }
    bat_curve_refine_options how = options("chaikin", 1);
    bat_curve fine = {0};
    how.snap = true;
    check_status(bat_curve_refine(&curve, &how, &fine, NULL), BAT_UNSUPPORTED);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_level_cuts_every_edge),        cmocka_unit_test(lane_riesenfeld_is_the_geodesic_scheme),
        cmocka_unit_test(small_curves_are_as_in_the_plane), cmocka_unit_test(cutting_commutes_with_rotations),
        cmocka_unit_test(open_curves_keep_their_ends),      cmocka_unit_test(other_masks_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

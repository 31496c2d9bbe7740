#include "refine_helpers.h"

static double *random_points(bat_random *random, size_t count)
{
    double *values = malloc(count * sizeof *values);
    for (size_t i = 0; i < count; i++)
        values[i] = bat_random_normal(random);
    return values;
}

/// One level straight from the definition, for a closed polygon.
static double *naive_level(const bat_mask *mask, const double *points, size_t count, size_t dim)
{
    double *fine = calloc(2 * count * dim, sizeof *fine);
    for (ptrdiff_t j = 0; j < (ptrdiff_t)count; j++)
        for (size_t k = 0; k < mask->count; k++)
        {
            ptrdiff_t n = 2 * (ptrdiff_t)count, i = ((2 * j + mask->first + (ptrdiff_t)k) % n + n) % n;
            for (size_t c = 0; c < dim; c++)
                fine[(size_t)i * dim + c] += mask->coefficients[k] * points[(size_t)j * dim + c];
        }
    return fine;
}

static void linear_schemes_follow_their_masks(void **state)
{
    (void)state;
    const char *names[] = {"chaikin",
                           "corner-cutting:r=0.1,s=0.7",
                           "four-point",
                           "four-point:w=0.05",
                           "six-point",
                           "lane-riesenfeld:order=1",
                           "lane-riesenfeld:order=3",
                           "lane-riesenfeld:order=8",
                           "lane-riesenfeld:order=60",
                           "mask:1/2,1,1/2@-1",
                           "mask:0.1,0.2,0.9,0.8@3",
                           "mask:1,1@0"};
    const size_t dims[] = {1, 2, 3, 4, 7, 600};
    bat_random random = bat_random_seed(1);
    for (size_t s = 0; s < sizeof names / sizeof names[0]; s++)
        for (size_t d = 0; d < sizeof dims / sizeof dims[0]; d++)
        {
            size_t count = 3 + bat_random_bits(&random) % 30, dim = dims[d];
            bat_space space = bat_euclidean(dim);
            bat_curve coarse = {
                .space = &space, .points = random_points(&random, count * dim), .count = count, .closed = true};
            bat_curve_refine_options how = options(names[s], 3);
            bat_curve fine = refined(&coarse, &how);
            assert_int_equal(fine.count, 8 * count);
            double *expected = coarse.points;
            for (size_t level = 0, n = count; level < 3; level++, n *= 2)
            {
                double *next = naive_level(&how.scheme.mask, expected, n, dim);
                free(expected);
                expected = next;
            }
            for (size_t i = 0; i < fine.count * dim; i++)
                check_near(fine.points[i], expected[i], 1e-13);
            free(expected);
            bat_curve_free(&fine);
        }
}

/// Levels one at a time, each from the whole polygon before it, give what the chunks give.
static void levels_compose(void **state)
{
    (void)state;
    const struct
    {
        const char *scheme, *space;
    } cases[] = {{"chaikin", "plane"},
                 {"six-point", "euclidean"},
                 {"angle-4", "plane"},
                 {"angle-6", "sphere"},
                 {"angle-4", "disk"},
                 {"log-exp-4", "sphere"},
                 {"log-exp-6", "disk"},
                 {"angle-6:adaptive=1", "disk"},
                 {"log-exp-4:base=midpoint", "sphere"}};
    bat_random random = bat_random_seed(2);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
    {
        bat_space space;
        check_status(bat_space_by_name(cases[c].space, 0, &space, NULL), BAT_OK);
        double points[3 * 9];
        for (size_t i = 0; i < 9; i++)
        {
            double t = 2 * PI * (double)i / 9, around[3] = {0.5 * cos(t), 0.5 * sin(t), 0.1 * bat_random_normal(&random)};
            check_status(space.project(&space, around, points + i * space.point_dim), BAT_OK);
        }
        bat_curve coarse = {.space = &space, .points = points, .count = 9, .closed = true};
        bat_curve_refine_options at_once = options(cases[c].scheme, 11), one = options(cases[c].scheme, 1);
        bat_curve fine = refined(&coarse, &at_once), step = refined(&coarse, &one);
        for (int level = 1; level < 11; level++)
        {
            bat_curve next = refined(&step, &one);
            bat_curve_free(&step);
            step = next;
        }
        assert_int_equal(fine.count, step.count);
        // Angles over edges of length 1e-3 know their points' last digits a thousandfold; no more than that may differ.
        for (size_t i = 0; i < fine.count * space.point_dim; i++)
            check_near(fine.points[i], step.points[i], 1e-12);
        bat_curve_free(&fine);
        bat_curve_free(&step);
    }
}

static void threads_change_no_byte(void **state)
{
    (void)state;
    const char *names[] = {"chaikin", "four-point", "angle-4", "log-exp-6", "angle-4:adaptive=1"};
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    double flat[14], round[21];
    for (int i = 0; i < 7; i++)
    {
        double t = 2 * PI * i / 7, v[3] = {cos(t), sin(t), 0.3 * cos(3 * t)};
        memcpy(flat + 2 * i, v, sizeof v[0] * 2);
        check_status(sphere.project(&sphere, v, round + 3 * i), BAT_OK);
    }
    for (size_t s = 0; s < sizeof names / sizeof names[0]; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            bool curved = s >= 2;
            bat_curve coarse = {
                .space = curved ? &sphere : &plane, .points = curved ? round : flat, .count = 7, .closed = closed};
            bat_curve_refine_options how = options(names[s], 14);
            how.threads = 1;
            bat_curve one = refined(&coarse, &how);
            how.threads = 3;
            bat_curve three = refined(&coarse, &how);
            assert_int_equal(one.count, three.count);
            assert_memory_equal(one.points, three.points, one.count * one.space->point_dim * sizeof(double));
            bat_curve_free(&one);
            bat_curve_free(&three);
        }
}

static void sets_of_curves_are_shared_by_threads(void **state)
{
    (void)state;
    enum
    {
        CURVES = 200,
        POINTS = 7
    };
    bat_space disk = bat_disk();
    bat_random random = bat_random_seed(3);
    bat_curve coarse[CURVES], fine[CURVES];
    double points[CURVES][2 * POINTS];
    for (int i = 0; i < CURVES; i++)
    {
        for (int k = 0; k < POINTS; k++)
        {
            double t = 2 * PI * k / POINTS, r = 0.3 + 0.2 * bat_random_uniform(&random);
            points[i][2 * k] = r * cos(t);
            points[i][2 * k + 1] = r * sin(t);
        }
        coarse[i] = (bat_curve){.space = &disk, .points = points[i], .count = POINTS, .closed = i % 2 == 0};
    }
    bat_curve_refine_options how = options("log-exp-4", 4);
    bat_error error;
    for (how.threads = 1; how.threads <= 4; how.threads++)
    {
        check_status(bat_curves_refine(coarse, CURVES, &how, fine, &error), BAT_OK);
        for (int i = 0; i < CURVES; i++)
        {
            bat_curve alone = refined(&coarse[i], &how);
            assert_int_equal(alone.count, fine[i].count);
            assert_memory_equal(alone.points, fine[i].points, 2 * alone.count * sizeof(double));
            bat_curve_free(&alone);
            bat_curve_free(&fine[i]);
        }
    }
    // The first curve at fault is named, whichever thread meets one first.
    points[150][3] = points[40][7] = 2;
    how.threads = 3;
    check_status(bat_curves_refine(coarse, CURVES, &how, fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.curve, 40);
    assert_int_equal(error.index, 3);
    for (int i = 0; i < CURVES; i++)
        assert_null(fine[i].points);
}

static void counts_and_ends_are_as_stated(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 2, 3, 1, 4, 4, 6, 3};
    const char *interpolatory[] = {"four-point", "six-point", "angle-4", "angle-6", "log-exp-4", "log-exp-6"};
    for (size_t count = 2; count <= 5; count++)
        for (size_t levels = 0; levels <= 4; levels++)
            for (int rule = BAT_CURVE_END_RULE_REFLECT; rule <= BAT_CURVE_END_RULE_EXTRAPOLATE; rule++)
            {
                bat_curve open = {.space = &plane, .points = points, .count = count};
                for (size_t s = 0; s < 6; s++)
                {
                    bat_curve_refine_options how = options(interpolatory[s], levels);
                    how.ends = (bat_curve_end_rule)rule;
                    bat_curve fine = refined(&open, &how);
                    assert_int_equal(fine.count, ((count - 1) << levels) + 1);
                    for (size_t i = 0; i < count; i++)
                        assert_memory_equal(fine.points + 2 * (i << levels), points + 2 * i, 2 * sizeof(double));
                    bat_curve_free(&fine);
                }
                bat_curve_refine_options how = options("chaikin", levels);
                how.ends = (bat_curve_end_rule)rule;
                bat_curve fine = refined(&open, &how);
                assert_int_equal(fine.count, levels == 0 ? count : ((count - 1) << levels) + 2);
                assert_memory_equal(fine.points, points, 2 * sizeof(double));
                assert_memory_equal(fine.points + 2 * (fine.count - 1), points + 2 * (count - 1), 2 * sizeof(double));
                bat_curve_free(&fine);
            }
    // Chaikin without ends: 2 (n - 1) points of the first level, as in the textbook
    bat_curve open = {.space = &plane, .points = points, .count = 3};
    bat_curve_refine_options how = options("chaikin", 1);
    how.ends = BAT_CURVE_END_RULE_FREE;
    bat_curve fine = refined(&open, &how);
    const double expected[] = {0.25, 0.5, 0.75, 1.5, 1.5, 1.75, 2.5, 1.25};
    assert_int_equal(fine.count, 4);
    for (int i = 0; i < 8; i++)
        check_near(fine.points[i], expected[i], 1e-15);
    bat_curve_free(&fine);
}

/// Cubics by the four-point scheme, quintics by the six-point scheme, straight lines by all; the end rule included.
static void polynomials_are_reproduced(void **state)
{
    (void)state;
    const struct
    {
        const char *name;
        int degree;
        bat_curve_end_rule ends;
    } cases[] = {{"four-point", 3, BAT_CURVE_END_RULE_EXTRAPOLATE},
                 {"four-point", 1, BAT_CURVE_END_RULE_REFLECT},
                 {"six-point", 3, BAT_CURVE_END_RULE_EXTRAPOLATE},
                 {"six-point", 5, BAT_CURVE_END_RULE_FREE},
                 {"chaikin", 1, BAT_CURVE_END_RULE_FREE},
                 {"lane-riesenfeld:order=5", 1, BAT_CURVE_END_RULE_FREE},
                 {"lane-riesenfeld:order=4", 1, BAT_CURVE_END_RULE_REFLECT}};
    bat_space line = bat_euclidean(2);
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++)
    {
        double points[2 * 14];
        for (int i = 0; i < 14; i++)
        {
            points[2 * i] = i;
            points[2 * i + 1] = pow(0.2 * i - 1, cases[c].degree);
        }
        bat_curve coarse = {.space = &line, .points = points, .count = 14};
        bat_curve_refine_options how = options(cases[c].name, 3);
        how.ends = cases[c].ends;
        bat_curve fine = refined(&coarse, &how);
        for (size_t i = 0; i < fine.count; i++)
            check_near(fine.points[2 * i + 1], pow(0.2 * fine.points[2 * i] - 1, cases[c].degree), 1e-12);
        bat_curve_free(&fine);
    }
}

static void circles_are_reproduced_by_outward_angles(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    const char *names[] = {"angle-4", "angle-6", "angle:mu=-0.4", "angle-4:adaptive=1"};
    for (size_t s = 0; s < 4; s++)
        for (int closed = 0; closed < 2; closed++)
        {
            // a whole circle, or an arc of 1.5 radians that the mirror rule continues
            size_t count = closed ? 7 : 5;
            double points[2 * 7];
            for (size_t i = 0; i < count; i++)
            {
                double t = closed ? -2 * PI * (double)i / 7 : 1.5 * (double)i / 4;
                points[2 * i] = 3 + 2 * cos(t);
                points[2 * i + 1] = -1 + 2 * sin(t);
            }
            bat_curve coarse = {.space = &plane, .points = points, .count = count, .closed = closed};
            bat_curve_refine_options how = options(names[s], 6);
            how.ends = BAT_CURVE_END_RULE_EXTRAPOLATE;
            bat_curve fine = refined(&coarse, &how);
            for (size_t i = 0; i < fine.count; i++)
                check_near(hypot(fine.points[2 * i] - 3, fine.points[2 * i + 1] + 1), 2, 1e-13);
            how.scheme.sign = BAT_CURVE_ANGLE_SIGN_PRINTED;
            bat_curve printed = refined(&coarse, &how);
            assert_true(hypot(printed.points[2] - fine.points[2], printed.points[3] - fine.points[3]) > 1e-3);
            bat_curve_free(&fine);
            bat_curve_free(&printed);
        }
}

/// The uniform B-spline of degree `order` at x, knots at the integers shifted so that its support is centred at 0.
static double centred_b_spline(int order, double x)
{
    if (order == 0)
        return x >= -0.5 && x < 0.5 ? 1 : 0;
    double half = 0.5 * (order + 1);
    return ((half + x) * centred_b_spline(order - 1, x + 0.5) + (half - x) * centred_b_spline(order - 1, x - 0.5)) / order;
}

static void snapped_lane_riesenfeld_points_lie_on_the_b_spline(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    bat_random random = bat_random_seed(5);
    for (int order = 1; order <= 7; order++)
    {
        enum
        {
            COUNT = 11,
            LEVELS = 3
        };
        double *points = random_points(&random, COUNT);
        bat_curve coarse = {.space = &line, .points = points, .count = COUNT, .closed = true};
        char name[40];
        (void)snprintf(name, sizeof name, "lane-riesenfeld:order=%d", order);
        bat_curve_refine_options how = options(name, LEVELS);
        how.snap = true;
        bat_curve fine = refined(&coarse, &how);
        double centre = (order & 1) != 0 ? 0 : -0.5, scale = 1 << LEVELS;
        for (size_t i = 0; i < fine.count; i++)
        {
            double x = (double)i / scale - centre * (1 - 1 / scale), value = 0;
            for (int j = -12; j < COUNT + 12; j++)
                value += points[(j + COUNT * 2) % COUNT] * centred_b_spline(order, x - j);
            check_near(fine.points[i], value, 1e-13);
        }
        free(points);
        bat_curve_free(&fine);
    }
}

static void short_and_long_way_ends_work_on_the_sphere(void **state)
{
    (void)state;
    // Steps of 90 degrees: the point after next is antipodal to the end point, which is its own reflection.
    bat_space sphere = bat_sphere(2);
    double points[] = {1, 0, 0, 0, 1, 0, -1, 0, 0, 0, 0, 1};
    bat_curve coarse = {.space = &sphere, .points = points, .count = 4};
    bat_curve_refine_options how = options("angle-4", 3);
    bat_curve fine = refined(&coarse, &how);
    check_status(bat_space_check(&sphere, fine.points, fine.count, NULL), BAT_OK);
    bat_curve_free(&fine);
    // log-exp needs logarithms two points away
    how = options("log-exp-4", 3);
    bat_error error;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_CUT_LOCUS);
    assert_in_range(error.index, 0, 3);
}

static void channels_ride_along(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[3 * 8], heights[2 * 8];
    for (int i = 0; i < 8; i++)
    {
        double t = 0.4 * i, v[3] = {cos(t), sin(t), 0.3};
        check_status(sphere.project(&sphere, v, points + 3 * i), BAT_OK);
        heights[2 * i] = 400 + 3 * i;
        heights[2 * i + 1] = 1;
    }
    bat_curve coarse = {.space = &sphere, .points = points, .count = 8, .channels = heights, .channel_count = 2};
    bat_curve_refine_options how = options("angle-4", 4);
    bat_curve fine = refined(&coarse, &how);
    for (size_t i = 0; i < fine.count; i++)
    {
        check_near(fine.channels[2 * i], 400 + 3 * (double)i / 16, 1e-11);
        check_near(fine.channels[2 * i + 1], 1, 1e-14);
    }
    bat_curve_free(&fine);
    heights[5] = NAN;
    bat_error error;
    check_status(bat_curve_refine(&coarse, &how, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
}

static void zeros_around_a_mask_change_nothing(void **state)
{
    (void)state;
    const char *pairs[][2] = {{"mask:1/4,3/4,3/4,1/4@-2", "mask:0,1/4,3/4,3/4,1/4@-3"},
                              {"mask:1/4,3/4,3/4,1/4@-2", "mask:1/4,3/4,3/4,1/4,0,0,0@-2"},
                              {"mask:1/2,1,1/2@-1", "mask:0,0,0,1/2,1,1/2,0@-4"}};
    bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 1, 2, 3, 1, 4, 4, 6, 3};
    for (size_t p = 0; p < 3; p++)
        for (int rule = BAT_CURVE_END_RULE_REFLECT; rule <= BAT_CURVE_END_RULE_FREE; rule++)
            for (int closed = 0; closed < 2; closed++)
            {
                bat_curve coarse = {.space = &plane, .points = points, .count = 5, .closed = closed};
                bat_curve_refine_options bare = options(pairs[p][0], 2), padded = options(pairs[p][1], 2);
                bare.ends = padded.ends = (bat_curve_end_rule)rule;
                bat_curve a = refined(&coarse, &bare), b = refined(&coarse, &padded);
                assert_int_equal(a.count, b.count);
                assert_memory_equal(a.points, b.points, 2 * a.count * sizeof(double));
                bat_curve_free(&a);
                bat_curve_free(&b);
            }
}

/// The cubic spline with data t^2 is t^2 + 1/3; points whose limit stencil reaches beyond the ends are not made.
static void free_ends_know_only_what_is_given(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(2);
    double points[] = {0, 0, 1, 1, 2, 4, 3, 9, 4, 16};
    bat_curve coarse = {.space = &line, .points = points, .count = 5};
    bat_curve_refine_options how = options("lane-riesenfeld:order=3", 1);
    how.ends = BAT_CURVE_END_RULE_FREE;
    how.snap = true;
    bat_curve fine = refined(&coarse, &how);
    assert_true(fine.count >= 3);
    for (size_t i = 0; i < fine.count; i++)
        check_near(fine.points[2 * i + 1], fine.points[2 * i] * fine.points[2 * i] + 1.0 / 3, 1e-14);
    bat_curve_free(&fine);
}

static void scale_does_not_matter_until_numbers_end(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    const char *names[] = {"angle-4", "angle-6:adaptive=1", "four-point"};
    double star[] = {1, 0, 0.3, 0.4, 0, 1, -0.5, 0.4, -1, 0, -0.2, -0.3, 0, -1, 0.6, -0.5};
    for (size_t s = 0; s < 3; s++)
    {
        bat_curve_refine_options how = options(names[s], 3);
        bat_curve coarse = {.space = &plane, .points = star, .count = 8, .closed = true};
        bat_curve expected = refined(&coarse, &how);
        const int exponents[] = {-900, -500, 500, 900};
        for (size_t e = 0; e < 4; e++)
        {
            double scaled[16];
            for (int i = 0; i < 16; i++)
                scaled[i] = ldexp(star[i], exponents[e]);
            coarse.points = scaled;
            bat_curve fine = refined(&coarse, &how);
            for (size_t i = 0; i < 2 * fine.count; i++)
                check_near(ldexp(fine.points[i], -exponents[e]), expected.points[i], 1e-15);
            bat_curve_free(&fine);
        }
        bat_curve_free(&expected);
    }
    // Beyond the largest double there is no result, and none is claimed.
    double huge[] = {1.5e308, 0, 0, 1.5e308, -1.5e308, 0, 0, -1.5e308};
    bat_curve coarse = {.space = &plane, .points = huge, .count = 4, .closed = true}, fine;
    bat_curve_refine_options how = options("four-point:w=3", 4);
    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_INVALID_POINT);
    how = options("angle-4", 2);
    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_INVALID_POINT);
}

static void the_defaults_fit_every_space(void **state)
{
    (void)state;
    bat_space spaces[] = {bat_euclidean(1), bat_euclidean(2), bat_euclidean(3), bat_sphere(2), bat_sphere(3), bat_disk()};
    bat_random random = bat_random_seed(31);
    for (size_t s = 0; s < 6; s++)
    {
        double points[4 * 5];
        for (size_t i = 0; i < 5; i++)
            spaces[s].random_point(&spaces[s], &random, points + i * spaces[s].point_dim);
        bat_curve coarse = {.space = &spaces[s], .points = points, .count = 5, .closed = true};
        bat_curve fine = refined(&coarse, NULL), fines[1];
        assert_int_equal(fine.count, 5 << 5);
        check_status(bat_curves_refine(&coarse, 1, NULL, fines, NULL), BAT_OK);
        assert_memory_equal(fine.points, fines[0].points, fine.count * spaces[s].point_dim * sizeof(double));
        bat_curve_free(&fine);
        bat_curve_free(&fines[0]);
    }
}

/// A user's flat torus has our exponential but its own logarithm: it is not ours.
static bat_status torus_log(const bat_space *space, const double *p, const double *q, double *tangent)
{
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] = remainder(q[i] - p[i], 1);
    return BAT_OK;
}

static void a_copy_of_a_space_with_another_function_is_another_space(void **state)
{
    (void)state;
    bat_space torus = bat_euclidean(2);
    torus.log = torus_log;
    torus.geodesic = NULL;
    torus.exterior_angle = NULL;
    torus.apex = NULL;
    double points[] = {0.8, 0.1, 0.95, 0.1, 0.1, 0.1, 0.25, 0.1};
    bat_curve coarse = {.space = &torus, .points = points, .count = 4}, fine;
    const char *name;
    (void)bat_curve_scheme_for(&torus, &name);
    assert_string_equal(name, "log-exp-4");
    bat_curve_refine_options how = options("four-point", 1);
    check_status(bat_curve_refine(&coarse, &how, &fine, NULL), BAT_UNSUPPORTED);
    fine = refined(&coarse, NULL);
    for (size_t i = 0; i < fine.count; i++)
        check_near(fine.points[2 * i + 1], 0.1, 1e-15);
    check_near(remainder(fine.points[2 * 48] - 1.025, 1), 0, 1e-3); // across the seam, not back over the middle
    bat_curve_free(&fine);
}

/// Records what it hears and never stops.
static bool listen(void *context, double fraction)
{
    double *heard = context; // the last, and whether it ever fell
    if (!(fraction >= heard[0] && fraction <= 1))
        heard[1] = 1;
    heard[0] = fraction;
    return true;
}

static void progress_goes_from_0_to_1(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[3 * 8], heights[8];
    for (int i = 0; i < 8; i++)
    {
        double t = 2 * PI * i / 8, v[3] = {cos(t), sin(t), 0.3 * cos(2 * t)};
        check_status(sphere.project(&sphere, v, points + 3 * i), BAT_OK);
        heights[i] = i;
    }
    bat_curve coarse[3] = {
        {.space = &sphere, .points = points, .count = 8, .closed = true, .channels = heights, .channel_count = 1}};
    coarse[1] = coarse[2] = coarse[0];
    const char *names[] = {"angle-4", "angle-4:adaptive=1", "log-exp-4"};
    for (size_t s = 0; s < 3; s++)
        for (int threads = 1; threads <= 2; threads++)
        {
            double heard[2] = {0, 0};
            bat_curve fine[3];
            bat_curve_refine_options how = options(names[s], 12);
            how.threads = threads;
            how.progress = (bat_progress){listen, heard};
            check_status(bat_curves_refine(coarse, 3, &how, fine, NULL), BAT_OK);
            check_near(heard[0], 1, 1e-12);
            check_near(heard[1], 0, 0);
            for (int i = 0; i < 3; i++)
                bat_curve_free(&fine[i]);
        }
}

static bool stop_at_once(void *context, double fraction)
{
    *(double *)context = fraction;
    return false;
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2), disk = bat_disk(), solid = bat_euclidean(3);
    bat_error error;
    bat_curve fine = {.count = 77};
    double repeated[] = {0, 0, 1, 0, 1, 0, 2, 2};
    bat_curve curve = {.space = &plane, .points = repeated, .count = 4};
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    assert_int_equal(fine.count, 77);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 0};
    curve = (bat_curve){.space = &plane, .points = square, .count = 4, .closed = true};
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_INVALID_POINT); // the last repeats the first
    curve.count = 2;
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_INVALID_ARGUMENT);
    curve.count = 0;
    curve.closed = false;
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_INVALID_ARGUMENT);
    double poles[] = {0, 0, 1, 0, 0, -1, 1, 0, 0};
    curve = (bat_curve){.space = &sphere, .points = poles, .count = 3};
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
    double outside[] = {0, 0, 0.5, 0.5, 1, 1};
    curve = (bat_curve){.space = &disk, .points = outside, .count = 3};
    check_status(bat_curve_refine(&curve, NULL, &fine, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    outside[5] = NAN;
    check_status(bat_curve_refine(&curve, NULL, &fine, NULL), BAT_INVALID_POINT);

    double good[] = {0, 0, 1, 0, 1, 1, 3, 4};
    curve = (bat_curve){.space = &plane, .points = good, .count = 4};
    bat_curve_refine_options how = options("chaikin", 61);
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how.levels = 60;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_TOO_LARGE);
    how.levels = 45;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_TOO_LARGE);
    how.scheme.mask.first = 4;
    how.levels = 55;
    how.max_points = SIZE_MAX;
    size_t count;
    check_status(bat_curve_refined_count(&curve, &how, &count, &error), BAT_TOO_LARGE);
    how.scheme.mask.first = 5;
    check_status(bat_curve_refined_count(&curve, &how, &count, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "from -8 to 4, not 5"));
    how = options("four-point", 1);
    how.ends = BAT_CURVE_END_RULE_FREE;
    curve.count = 2;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    curve.count = 4;
    how = options("angle-4", 2);
    how.snap = true;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_UNSUPPORTED);
    how.snap = false;
    how.scheme.tension = NAN;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how = options("six-point", 2);
    curve.space = &sphere;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_UNSUPPORTED);
    how = options("angle-4", 2);
    how.ends = (bat_curve_end_rule)7;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how = options("angle-4", 2);
    how.scheme.sign = (bat_curve_angle_sign)9;
    curve.space = &plane;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how.scheme.sign = BAT_CURVE_ANGLE_SIGN_OUTWARD;
    how.scheme.tension = 1e308;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how = options("angle-4", 2);
    curve.channel_count = 1; // and no channels
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    curve.channel_count = 0;
    curve.space = &solid;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_UNSUPPORTED);
    how = options("log-exp-4", 2);
    how.scheme.mask.coefficients[0] += 0.01;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_UNSUPPORTED);
    how = options("chaikin", 2);
    how.scheme.mask.coefficients[1] = INFINITY;
    curve.space = &plane;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);
    how.scheme.mask.count = 0;
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_INVALID_ARGUMENT);

    double buffer[20], fraction = -1;
    how = options("chaikin", 2);
    check_status(bat_curve_refine_into(&curve, &how, buffer, NULL, 10, &error), BAT_TOO_LARGE);
    how.levels = 12;
    how.threads = 1;
    how.progress = (bat_progress){stop_at_once, &fraction};
    check_status(bat_curve_refine(&curve, &how, &fine, &error), BAT_CANCELLED);
    assert_true(fraction > 0 && fraction <= 1);
    assert_int_equal(fine.count, 77);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_schemes_follow_their_masks),
        cmocka_unit_test(levels_compose),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(sets_of_curves_are_shared_by_threads),
        cmocka_unit_test(counts_and_ends_are_as_stated),
        cmocka_unit_test(polynomials_are_reproduced),
        cmocka_unit_test(circles_are_reproduced_by_outward_angles),
        cmocka_unit_test(snapped_lane_riesenfeld_points_lie_on_the_b_spline),
        cmocka_unit_test(short_and_long_way_ends_work_on_the_sphere),
        cmocka_unit_test(channels_ride_along),
        cmocka_unit_test(zeros_around_a_mask_change_nothing),
        cmocka_unit_test(free_ends_know_only_what_is_given),
        cmocka_unit_test(scale_does_not_matter_until_numbers_end),
        cmocka_unit_test(the_defaults_fit_every_space),
        cmocka_unit_test(a_copy_of_a_space_with_another_function_is_another_space),
        cmocka_unit_test(progress_goes_from_0_to_1),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

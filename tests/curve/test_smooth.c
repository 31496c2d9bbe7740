// Smoothing: what stays, what commutes, and how near to the truth it comes.

#include "refine_helpers.h"

#include "batten/curve_measure.h"

enum
{
    COUNT = 120
};

static const double NOISE = 0.02;

static bat_curve smoothed(const bat_curve *curve, double scale, bat_curve_refine_report *report)
{
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.levels = 0;
    how.smooth = scale;
    how.report = report;
    return refined(curve, &how);
}

/// A circle of radius 1 with normal noise. On the sphere a circle of 0.5 radians around a point.
static void make_circle(const bat_space *space, size_t count, bool closed, double noise, double *points)
{
    bat_random random = bat_random_seed(7);
    for (size_t i = 0; i < count; i++)
    {
        double t = 2 * PI * (double)i / (double)(closed ? count : count + 20);
        double x = cos(t) + noise * bat_random_normal(&random), y = sin(t) + noise * bat_random_normal(&random);
        double *p = points + i * space->point_dim;
        p[0] = x;
        p[1] = y;
        if (space->point_dim == 2)
            continue;
        const double middle[3] = {0.36, 0.48, 0.8}, east[3] = {-0.8, 0.6, 0}, north[3] = {-0.48, -0.64, 0.6};
        double vector[3];
        for (int c = 0; c < 3; c++)
            vector[c] = 0.5 * (x * east[c] + y * north[c]);
        check_status(space->exp(space, middle, vector, p), BAT_OK);
    }
}

static double radius_error(const bat_curve *curve)
{
    double sum = 0;
    for (size_t i = 0; i < curve->count; i++)
        sum += pow(hypot(curve->points[2 * i], curve->points[2 * i + 1]) - 1, 2);
    return sqrt(sum / (double)curve->count);
}

static double farthest(const bat_curve *a, const bat_curve *b)
{
    double most = 0;
    for (size_t i = 0; i < a->count; i++)
        most = fmax(most,
                    a->space->distance(a->space, a->points + i * a->space->point_dim, b->points + i * a->space->point_dim));
    return most;
}

static void a_noisy_circle_becomes_one(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    for (int closed = 0; closed < 2; closed++)
    {
        bat_curve_refine_report report;
        make_circle(&plane, COUNT, closed != 0, NOISE, points);
        bat_curve given = {.space = &plane, .points = points, .count = COUNT, .closed = closed != 0};
        bat_curve smooth = smoothed(&given, NAN, &report);
        assert_true(radius_error(&smooth) < 0.4 * NOISE);
        assert_true(fabs(report.noise / NOISE - 1) < 0.2);
        assert_int_equal(report.smoothed, COUNT);
        assert_true(report.largest_move >= report.mean_move && report.mean_move > 0.5 * NOISE);
        bat_curve_free(&smooth);
    }
}

static void a_noisy_line_becomes_straight(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_random random = bat_random_seed(3);
    double points[2 * COUNT], square = 0;
    for (size_t i = 0; i < COUNT; i++)
    {
        bool end = i == 0 || i + 1 == COUNT;
        points[2 * i] = (double)i;
        points[2 * i + 1] = end ? 0 : 0.3 * bat_random_normal(&random);
    }
    bat_curve given = {.space = &plane, .points = points, .count = COUNT};
    bat_curve smooth = smoothed(&given, NAN, NULL);
    for (size_t i = 0; i < COUNT; i++)
        square += smooth.points[2 * i + 1] * smooth.points[2 * i + 1] / COUNT;
    assert_true(sqrt(square) < 0.09);
    bat_curve_free(&smooth);
}

static void what_has_no_noise_stays(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    make_circle(&plane, COUNT, true, 0, points);
    bat_curve given = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    const double scales[] = {NAN, 1e-9};
    for (int k = 0; k < 2; k++)
    {
        bat_curve smooth = smoothed(&given, scales[k], NULL);
        assert_true(farthest(&given, &smooth) < 1e-8);
        bat_curve_free(&smooth);
    }
    make_circle(&plane, 12, true, 0.1, points); // too few points to estimate noise
    given.count = 12;
    bat_curve smooth = smoothed(&given, NAN, NULL);
    assert_memory_equal(smooth.points, points, 24 * sizeof *points);
    bat_curve_free(&smooth);
}

/// Waves of length D keep half of their height, to the accuracy of the discrete sum.
static void a_scale_halves_its_wave(void **state)
{
    (void)state;
    enum
    {
        WAVES = 20,
        POINTS = 40 * WAVES + 1
    };
    static double points[2 * POINTS];
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < POINTS; i++)
    {
        points[2 * i] = (double)i;
        points[2 * i + 1] = 0.1 * sin(2 * PI * (double)i / 40);
    }
    bat_curve given = {.space = &plane, .points = points, .count = POINTS};
    bat_curve smooth = smoothed(&given, 40, NULL);
    double most = 0;
    for (size_t i = POINTS / 4; i < 3 * POINTS / 4; i++)
        most = fmax(most, smooth.points[2 * i + 1]);
    assert_true(fabs(most - 0.05) < 5e-4);
    bat_curve_free(&smooth);
}

static void ends_and_corners_stay(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    unsigned char corners[COUNT] = {0};
    make_circle(&plane, COUNT, true, NOISE, points);
    corners[30] = corners[90] = 1;
    for (int closed = 0; closed < 2; closed++)
    {
        bat_curve given = {.space = &plane, .points = points, .count = COUNT, .closed = closed != 0, .corners = corners};
        bat_curve smooth = smoothed(&given, NAN, NULL);
        assert_memory_equal(smooth.points + 60, points + 60, 2 * sizeof *points);
        assert_memory_equal(smooth.points + 180, points + 180, 2 * sizeof *points);
        assert_true(closed != 0 || memcmp(smooth.points, points, 2 * sizeof *points) == 0);
        assert_true(farthest(&given, &smooth) > NOISE);
        assert_true(smooth.corners[30] != 0 && smooth.corners[31] == 0);
        bat_curve_free(&smooth);
    }
}

/// Renumbering a ring and reversing a curve change nothing but the order.
static void order_makes_no_difference(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    const bat_space *spaces[] = {&plane, &sphere};
    for (int s = 0; s < 2; s++)
        for (int closed = 0; closed < 2; closed++)
            for (int scale = 0; scale < 2; scale++)
            {
                double points[3 * COUNT], other[3 * COUNT];
                size_t dim = spaces[s]->point_dim, turn = closed != 0 ? 17 : 0;
                make_circle(spaces[s], COUNT, closed != 0, NOISE, points);
                for (size_t i = 0; i < COUNT; i++)
                    memcpy(other + (COUNT - 1 - i) * dim, points + (i + turn) % COUNT * dim, dim * sizeof *points);
                bat_curve given = {.space = spaces[s], .points = points, .count = COUNT, .closed = closed != 0};
                bat_curve turned = given;
                turned.points = other;
                bat_curve a = smoothed(&given, scale != 0 ? 0.5 : NAN, NULL);
                bat_curve b = smoothed(&turned, scale != 0 ? 0.5 : NAN, NULL);
                for (size_t i = 0; i < COUNT; i++)
                    assert_true(spaces[s]->distance(spaces[s], b.points + (COUNT - 1 - i) * dim,
                                                    a.points + (i + turn) % COUNT * dim) < 1e-6);
                bat_curve_free(&a);
                bat_curve_free(&b);
            }
}

/// A rotation of the sphere commutes with smoothing; a small circle of noise is smoothed as in the plane.
static void smoothing_belongs_to_the_sphere(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    for (int closed = 0; closed < 2; closed++)
    {
        double points[3 * COUNT], other[3 * COUNT];
        make_circle(&sphere, COUNT, closed != 0, NOISE, points);
        for (size_t i = 0; i < COUNT; i++)
        {
            other[3 * i] = 0.6 * points[3 * i + 1] + 0.8 * points[3 * i + 2];
            other[3 * i + 1] = -0.8 * points[3 * i + 1] + 0.6 * points[3 * i + 2];
            other[3 * i + 2] = points[3 * i];
        }
        bat_curve given = {.space = &sphere, .points = points, .count = COUNT, .closed = closed != 0}, turned = given;
        turned.points = other;
        bat_curve a = smoothed(&given, NAN, NULL), b = smoothed(&turned, NAN, NULL);
        double error = 0;
        for (size_t i = 0; i < COUNT; i++)
        {
            const double *p = a.points + 3 * i, *q = b.points + 3 * i, middle[3] = {0.36, 0.48, 0.8};
            double rotated[3] = {0.6 * p[1] + 0.8 * p[2], -0.8 * p[1] + 0.6 * p[2], p[0]};
            assert_true(sphere.distance(&sphere, rotated, q) < 1e-8);
            error += pow(sphere.distance(&sphere, p, middle) - 0.5, 2) / COUNT;
        }
        assert_true(sqrt(error) < 0.4 * 0.5 * NOISE);
        bat_curve_free(&a);
        bat_curve_free(&b);
    }
}

static void an_outlier_has_little_effect(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    make_circle(&plane, COUNT, true, NOISE, points);
    bat_curve given = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    bat_curve without = smoothed(&given, NAN, NULL);
    points[80] *= 1.5;
    points[81] *= 1.5;
    bat_curve with = smoothed(&given, NAN, NULL);
    assert_true(radius_error(&with) < 0.5 * NOISE);
    assert_true(farthest(&with, &without) < 2 * NOISE);
    bat_curve_free(&with);
    bat_curve_free(&without);
}

/// The border of the pixels whose centres lie in a circle, counter-clockwise by following its unit edges.
static size_t trace_pixels(double radius, double *points)
{
    long x = 0, y = -(long)(radius + 0.5), dx = 1, dy = 0;
    long begin[2] = {x, y};
    size_t count = 0;
    do
    {
        points[2 * count] = (double)x;
        points[2 * count++ + 1] = (double)y;
        x += dx;
        y += dy;
        // The pixels ahead, left and right of the direction.
        double ahead[2] = {(double)x + 0.5 * (double)dx, (double)y + 0.5 * (double)dy};
        bool left = hypot(ahead[0] - 0.5 * (double)dy, ahead[1] + 0.5 * (double)dx) < radius;
        bool right = hypot(ahead[0] + 0.5 * (double)dy, ahead[1] - 0.5 * (double)dx) < radius;
        long old = dx;
        if (right)
        {
            dx = dy;
            dy = -old;
        }
        else if (!left)
        {
            dx = -dy;
            dy = old;
        }
    } while (x != begin[0] || y != begin[1]);
    return count;
}

static void stairs_of_a_circle_become_one(void **state)
{
    (void)state;
    static const double RADII[] = {6.3, 20.4, 50.3};
    static double points[2048];
    bat_space plane = bat_euclidean(2);
    for (int k = 0; k < 3; k++)
    {
        bat_curve given = {.space = &plane, .points = points, .count = trace_pixels(RADII[k], points), .closed = true};
        bat_curve_refine_options how = bat_curve_refine_defaults();
        how.levels = 3;
        how.smooth = NAN;
        bat_curve fine = refined(&given, &how);
        for (size_t i = 0; i < fine.count; i++)
            assert_true(fabs(hypot(fine.points[2 * i], fine.points[2 * i + 1]) - RADII[k]) < 0.5);
        bat_curve_free(&fine);
    }
}

static void rings_stay_simple(void **state)
{
    (void)state;
    // A strait between two straight shores, with a spike that nearly closes it.
    enum
    {
        SHORE = 40
    };
    double points[4 * SHORE];
    bat_space plane = bat_euclidean(2);
    for (size_t i = 0; i < SHORE; i++)
    {
        double spike = i == SHORE / 2 ? 0.55 : 0;
        points[2 * i] = points[2 * (2 * SHORE - 1 - i)] = (double)i;
        points[2 * i + 1] = spike;
        points[2 * (2 * SHORE - 1 - i) + 1] = 0.02 + 1.1 * spike;
    }
    bat_curve given = {.space = &plane, .points = points, .count = 2 * SHORE, .closed = true};
    bool simple;
    for (double scale = 1; scale < 20; scale *= 2)
    {
        bat_curve smooth = smoothed(&given, scale, NULL);
        check_status(bat_curve_is_simple(&smooth, &simple, NULL), BAT_OK);
        assert_true(simple);
        bat_curve_free(&smooth);
    }
}

static void stops_and_counts_follow_the_smooth_curve(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double points[2 * COUNT];
    static double rows[400 * COUNT];
    make_circle(&plane, COUNT, true, NOISE, points);
    bat_curve given = {.space = &plane, .points = points, .count = COUNT, .closed = true};
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.smooth = NAN;
    how.tolerance = 1e-5;
    size_t count;
    bat_curve fine = refined(&given, &how);
    check_status(bat_curve_refined_count(&given, &how, &count, NULL), BAT_OK);
    assert_int_equal(count, fine.count);
    check_status(bat_curve_refine_into(&given, &how, rows, NULL, count, NULL), BAT_OK);
    assert_memory_equal(rows, fine.points, 2 * count * sizeof *rows);
    bat_curve_free(&fine);
}

static void closed_curves_of_other_spaces_are_refused(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(1);
    double points[4 * 8];
    for (size_t i = 0; i < 8; i++)
        rotation.random_point(&rotation, &random, points + 4 * i);
    bat_curve given = {.space = &rotation, .points = points, .count = 8, .closed = true}, fine;
    bat_curve_refine_options how = bat_curve_refine_defaults();
    how.smooth = 1;
    check_status(bat_curve_refine(&given, &how, &fine, NULL), BAT_UNSUPPORTED);
    given.closed = false;
    how.smooth = 1e-6;
    check_status(bat_curve_refine(&given, &how, &fine, NULL), BAT_OK);
    bat_curve_free(&fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_noisy_circle_becomes_one),
        cmocka_unit_test(a_noisy_line_becomes_straight),
        cmocka_unit_test(what_has_no_noise_stays),
        cmocka_unit_test(a_scale_halves_its_wave),
        cmocka_unit_test(ends_and_corners_stay),
        cmocka_unit_test(order_makes_no_difference),
        cmocka_unit_test(smoothing_belongs_to_the_sphere),
        cmocka_unit_test(an_outlier_has_little_effect),
        cmocka_unit_test(stairs_of_a_circle_become_one),
        cmocka_unit_test(rings_stay_simple),
        cmocka_unit_test(stops_and_counts_follow_the_smooth_curve),
        cmocka_unit_test(closed_curves_of_other_spaces_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

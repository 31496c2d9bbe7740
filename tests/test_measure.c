#include "check.h"

#include "batten/measure.h"

static const double PI = 3.14159265358979323846;

/// A closed curve of `count` points, to be freed.
static bat_curve closed_curve(const bat_space *space, size_t count)
{
    double *points = calloc(count * space->point_dim, sizeof *points);
    return (bat_curve){.space = space, .points = points, .count = count, .closed = true};
}

/// A regular polygon about the origin of the plane or the disk (radius as the coordinates have it), or about a pole of the
/// sphere (radius the sine of the colatitude).
static bat_curve regular_polygon(const bat_space *space, size_t count, double radius)
{
    bat_curve polygon = closed_curve(space, count);
    for (size_t i = 0; i < count; i++)
    {
        double angle = 2 * PI * (double)i / (double)count, *p = polygon.points + i * space->point_dim;
        p[0] = radius * cos(angle);
        p[1] = radius * sin(angle);
        if (space->point_dim == 3)
            p[2] = sqrt(1 - radius * radius);
    }
    return polygon;
}

static bat_curve random_curve(const bat_space *space, size_t count, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_curve curve = closed_curve(space, count);
    for (size_t i = 0; i < count; i++)
        space->random_point(space, &random, curve.points + i * space->point_dim);
    return curve;
}

static bat_curve_distance compare(const bat_curve *first, const bat_curve *second, const bat_measure_options *options)
{
    bat_curve_distance distance;
    bat_error error = {0};
    bat_status status = bat_curve_compare(first, second, options, &distance, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return distance;
}

static bat_fairness fairness_of(const bat_curve *curve)
{
    const bat_measure_options options = {.bending_offset = 0};
    bat_fairness fairness;
    check_status(bat_curve_fairness(curve, &options, &fairness, NULL), BAT_OK);
    return fairness;
}

static void concentric_circles(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve first = regular_polygon(&plane, 120, 1), second = regular_polygon(&plane, 120, 1.25);
    bat_curve_distance distance = compare(&first, &second, NULL);
    check_near(distance.mean_nn, 0.25, 1e-15);
    check_near(distance.mean_nn_back, 0.25, 1e-15);
    check_near(distance.mean_symmetric, 0.25, 1e-15);
    check_near(distance.hausdorff, 0.25, 1e-15);
    bat_curve_free(&first);
    bat_curve_free(&second);
}

static void the_two_ways_differ(void **state)
{
    (void)state;
    bat_space line = bat_euclidean(1);
    double part[] = {0, 1, 2}, whole[] = {0, 1, 2, 10, 4, 10};
    bat_curve first = {.space = &line, .points = part, .count = 3};
    bat_curve second = {.space = &line, .points = whole, .count = 6};
    bat_curve_distance distance = compare(&first, &second, NULL);
    check_near(distance.mean_nn, 0, 0);
    check_near(distance.hausdorff_there, 0, 0);
    check_near(distance.mean_nn_back, (8.0 + 2 + 8) / 6, 1e-15);
    check_near(distance.mean_symmetric, 1.5, 1e-15);
    check_near(distance.hausdorff_back, 8, 0);
    check_near(distance.hausdorff, 8, 0);
    assert_int_equal(distance.farthest_back, 3); // the first of the two
    bat_curve_distance turned = compare(&second, &first, NULL);
    check_near(turned.mean_nn, distance.mean_nn_back, 0);
    check_near(turned.hausdorff, distance.hausdorff, 0);
}

static void distances_to_edges_ignore_the_sampling(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1}, middles[] = {0.5, 0, 1, 0.5, 0.5, 1, 0, 0.5};
    bat_curve first = {.space = &plane, .points = middles, .count = 4, .closed = true};
    bat_curve second = {.space = &plane, .points = square, .count = 4, .closed = true};
    bat_measure_options options = bat_measure_defaults();
    check_near(compare(&first, &second, &options).mean_nn, 0.5, 0);
    options.to_segments = true;
    check_near(compare(&first, &second, &options).hausdorff_there, 0, 0);
    check_near(compare(&first, &second, &options).mean_nn_back, sqrt(0.125), 1e-15);
    second.closed = false; // the last middle now misses the left side
    check_near(compare(&first, &second, &options).hausdorff_there, 0.5, 0);
    second.count = 1;
    check_near(compare(&first, &second, &options).hausdorff_there, sqrt(1.25), 1e-15);
}

static void chords_and_arcs_of_the_sphere(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    bat_curve first = random_curve(&sphere, 200, 1), second = random_curve(&sphere, 300, 2);
    bat_curve one = first;
    one.count = 1;
    bat_measure_options geodesic = bat_measure_defaults();
    geodesic.geodesic = true;
    double chord = compare(&one, &second, NULL).hausdorff_there, arc = compare(&one, &second, &geodesic).hausdorff_there;
    check_near(arc, 2 * asin(chord / 2), 1e-15);
    assert_true(compare(&first, &second, &geodesic).mean_nn > compare(&first, &second, NULL).mean_nn);
    bat_curve_free(&first);
    bat_curve_free(&second);
}

/// The definition of the mean of the nearest distances.
static double mean_by_search(const bat_curve *first, const bat_curve *second)
{
    const bat_space *space = first->space;
    double sum = 0;
    for (size_t i = 0; i < first->count; i++)
    {
        double least = INFINITY;
        for (size_t k = 0; k < second->count; k++)
            least = fmin(
                least, space->distance(space, first->points + i * space->point_dim, second->points + k * space->point_dim));
        sum += least;
    }
    return sum / (double)first->count;
}

/// The distance of some other space's maker.
static double distance_of_a_user(const bat_space *space, const double *p, const double *q)
{
    (void)space;
    bat_space sphere = bat_sphere(3);
    return 3 * sphere.distance(&sphere, p, q);
}

static void geodesic_neighbours_are_exact_in_every_space(void **state)
{
    (void)state;
    bat_space user = bat_sphere(3);
    user.distance = distance_of_a_user;
    const bat_space spaces[] = {bat_euclidean(3), bat_sphere(1), bat_sphere(2), bat_sphere(4), bat_disk(), user};
    bat_measure_options geodesic = bat_measure_defaults();
    geodesic.geodesic = true;
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++)
    {
        bat_curve first = random_curve(&spaces[s], 150, 3), second = random_curve(&spaces[s], 220, 4);
        bat_curve_distance distance = compare(&first, &second, &geodesic);
        check_relative(distance.mean_nn, mean_by_search(&first, &second), 1e-14);
        check_relative(distance.mean_nn_back, mean_by_search(&second, &first), 1e-14);
        bat_curve_free(&first);
        bat_curve_free(&second);
    }
}

static void geodesic_neighbours_near_the_rim(void **state)
{
    (void)state;
    bat_space disk = bat_disk();
    bat_random random = bat_random_seed(5);
    bat_curve curves[2] = {closed_curve(&disk, 300), closed_curve(&disk, 300)};
    for (size_t c = 0; c < 2; c++)
        for (size_t i = 0; i < 300; i++)
        {
            // Clusters at a few directions, at every hyperbolic radius up to 14: chords and geodesics disagree widely.
            double direction = (double)(bat_random_bits(&random) % 5) + 1e-5 * bat_random_normal(&random);
            double radius = tanh(7 * bat_random_uniform(&random));
            curves[c].points[2 * i] = radius * cos(direction);
            curves[c].points[2 * i + 1] = radius * sin(direction);
        }
    bat_measure_options geodesic = bat_measure_defaults();
    geodesic.geodesic = true;
    check_relative(compare(&curves[0], &curves[1], &geodesic).mean_nn, mean_by_search(&curves[0], &curves[1]), 1e-14);
    bat_curve_free(&curves[0]);
    bat_curve_free(&curves[1]);
}

/// Turn the first two coordinates, then the last two: an isometry of the sphere.
static void turn(bat_curve *curve)
{
    for (size_t i = 0; i < curve->count; i++)
        for (size_t axis = 0; axis < 2; axis++)
        {
            double *p = curve->points + 3 * i + axis, x = p[0], y = p[1];
            p[0] = cos(0.7) * x - sin(0.7) * y;
            p[1] = sin(0.7) * x + cos(0.7) * y;
        }
}

/// The Möbius translation z -> (z + a) / (1 + conj(a) z), an isometry of the disk.
static void translate(bat_curve *curve, double ax, double ay)
{
    for (size_t i = 0; i < curve->count; i++)
    {
        double *p = curve->points + 2 * i, x = p[0] + ax, y = p[1] + ay;
        double re = 1 + ax * p[0] + ay * p[1], im = ax * p[1] - ay * p[0], norm = re * re + im * im;
        p[0] = (x * re + y * im) / norm;
        p[1] = (y * re - x * im) / norm;
    }
}

static void isometries_change_nothing(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_sphere(2), bat_disk()};
    bat_measure_options geodesic = bat_measure_defaults();
    geodesic.geodesic = true;
    for (size_t s = 0; s < 2; s++)
    {
        bat_curve first = random_curve(&spaces[s], 50, 6), second = random_curve(&spaces[s], 60, 7);
        bat_curve_distance distance = compare(&first, &second, &geodesic);
        bat_fairness fairness = fairness_of(&first);
        if (s == 0)
        {
            turn(&first);
            turn(&second);
        }
        else
        {
            translate(&first, 0.3, -0.5);
            translate(&second, 0.3, -0.5);
        }
        bat_curve_distance moved = compare(&first, &second, &geodesic);
        check_relative(moved.mean_nn, distance.mean_nn, 1e-12);
        check_relative(moved.hausdorff, distance.hausdorff, 1e-12);
        check_relative(fairness_of(&first).bending, fairness.bending, 1e-11);
        check_relative(fairness_of(&first).g1, fairness.g1, 1e-12);
        bat_curve_free(&first);
        bat_curve_free(&second);
    }
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    bat_curve first = random_curve(&sphere, 5000, 8), second = random_curve(&sphere, 4000, 9);
    bat_measure_options options = bat_measure_defaults();
    options.threads = 1;
    bat_curve_distance one = compare(&first, &second, &options);
    options.threads = 3;
    bat_curve_distance three = compare(&first, &second, &options);
    assert_memory_equal(&one, &three, sizeof one);
    bat_curve_free(&first);
    bat_curve_free(&second);
}

static void comparing_refuses_bad_input(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(1), solid = bat_euclidean(3);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0}, broken[] = {0, 0, 1, NAN};
    bat_curve good = {.space = &plane, .points = square, .count = 4}, empty = {.space = &plane};
    bat_curve bad = {.space = &plane, .points = broken, .count = 2}, off = {.space = &sphere, .points = square, .count = 2};
    bat_curve other = {.space = &solid, .points = square, .count = 4};
    bat_measure_options geodesic = bat_measure_defaults(), both;
    geodesic.geodesic = true;
    both = geodesic;
    both.to_segments = true;
    bat_curve_distance untouched = {.mean_nn = -7}, distance = untouched;
    bat_error error;
    check_status(bat_curve_compare(&good, &empty, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_compare(&good, &other, NULL, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_compare(&good, &off, &geodesic, &distance, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_curve_compare(&off, &off, &geodesic, &distance, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 0);
    check_status(bat_curve_compare(&good, &bad, NULL, &distance, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    check_status(bat_curve_compare(&good, &good, &both, &distance, &error), BAT_UNSUPPORTED);
    assert_memory_equal(&distance, &untouched, sizeof distance);
}

/// Half the interior angle b of a regular n-gon of radius r: cot b = c tan(pi / n), c = 1, cos r, cosh r in the three geometries;
/// half the edge e: sin(e/2), e/2, sinh(e/2) = sin r, r, sinh r times sin(pi / n).
static void regular_polygons_have_the_fairness_of_trigonometry(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t n = 3; n <= 3000; n *= 10)
        for (size_t s = 0; s < 3; s++)
        {
            double radius = 0.6, step = PI / (double)n, factor = 1, edge = 2 * radius * sin(step), coordinate = radius;
            if (s == 1)
            {
                factor = cos(radius);
                edge = 2 * asin(sin(radius) * sin(step));
                coordinate = sin(radius);
            }
            if (s == 2)
            {
                factor = cosh(radius);
                edge = 2 * asinh(sinh(radius) * sin(step));
                coordinate = tanh(radius / 2);
            }
            double angle = 2 * atan(factor * tan(step));
            bat_curve polygon = regular_polygon(&spaces[s], n, coordinate);
            bat_fairness fairness = fairness_of(&polygon);
            check_relative(fairness.g1, angle, 1e-8);
            check_relative(fairness.length, (double)n * edge, 1e-8);
            check_relative(fairness.bending, pow(angle / edge, 2), 1e-8);
            bat_fairness published;
            check_status(bat_curve_fairness(&polygon, NULL, &published, NULL), BAT_OK);
            check_relative(published.bending, pow(angle / (edge + BAT_BENDING_OFFSET), 2), 1e-8);
            bat_curve_free(&polygon);
        }
}

static void more_dimensions_agree_with_two(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), many = bat_euclidean(5), sphere = bat_sphere(2), hypersphere = bat_sphere(4);
    bat_curve flat = random_curve(&plane, 40, 10), round = random_curve(&sphere, 40, 11);
    bat_curve wide = closed_curve(&many, 40), rounder = closed_curve(&hypersphere, 40);
    for (size_t i = 0; i < 40; i++)
    {
        memcpy(wide.points + 5 * i + 2, flat.points + 2 * i, 2 * sizeof(double));
        memcpy(rounder.points + 5 * i + 1, round.points + 3 * i, 3 * sizeof(double));
    }
    check_relative(fairness_of(&wide).g1, fairness_of(&flat).g1, 1e-13);
    check_relative(fairness_of(&wide).bending, fairness_of(&flat).bending, 1e-12);
    check_relative(fairness_of(&rounder).g1, fairness_of(&round).g1, 1e-13);
    check_relative(fairness_of(&rounder).bending, fairness_of(&round).bending, 1e-12);
    bat_curve_free(&flat);
    bat_curve_free(&round);
    bat_curve_free(&wide);
    bat_curve_free(&rounder);
}

static void small_angles_keep_their_digits(void **state)
{
    (void)state;
    bat_space solid = bat_euclidean(3);
    double points[] = {-1, 0, 0, 0, 0, 0, 1, 1e-9, 0};
    bat_curve curve = {.space = &solid, .points = points, .count = 3};
    check_relative(fairness_of(&curve).g1, 1e-9, 1e-14);
    points[6] = -1; // a spike, next to pi
    check_relative(PI - fairness_of(&curve).g1, 1e-9, 1e-6);
}

static void ends_of_open_curves_do_not_count(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double corner[] = {0, 0, 2, 0, 2, 2, 4, 2};
    bat_curve curve = {.space = &plane, .points = corner, .count = 4};
    check_near(fairness_of(&curve).g1, PI / 2, 1e-15);
    check_near(fairness_of(&curve).bending, PI * PI / 16, 1e-15);
    check_near(fairness_of(&curve).length, 6, 0);
    curve.count = 2;
    check_near(fairness_of(&curve).bending, 0, 0);
    curve.closed = true; // there and back
    check_near(fairness_of(&curve).g1, PI, 0);
    check_near(fairness_of(&curve).length, 4, 0);
    check_near(fairness_of(&curve).bending, PI * PI / 4, 1e-15);
    curve.count = 1;
    check_near(fairness_of(&curve).g1, 0, 0);
}

static void sets_are_measured_curve_by_curve(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double good[] = {0, 0, 1, 0, 1, 1}, bad[] = {0, 0, NAN, 0, 1, 1};
    bat_curve curves[40];
    bat_fairness fairness[40];
    for (int i = 0; i < 40; i++)
        curves[i] = (bat_curve){.space = &plane, .points = good, .count = i % 2 == 0 ? 3 : 2};
    check_status(bat_curves_fairness(curves, 40, NULL, fairness, NULL, NULL), BAT_OK);
    for (int i = 0; i < 40; i++)
    {
        check_near(fairness[i].length, i % 2 == 0 ? 2 : 1, 0);
        check_near(fairness[i].g1, i % 2 == 0 ? PI / 2 : 0, 1e-15);
    }
    curves[33].points = curves[17].points = bad;
    size_t failed = 0;
    bat_error error;
    check_status(bat_curves_fairness(curves, 40, NULL, fairness, &failed, &error), BAT_INVALID_POINT);
    assert_int_equal(failed, 17);
    assert_int_equal(error.index, 1);
}

static void repeated_points_are_passed_over(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_euclidean(3)};
    for (size_t s = 0; s < 2; s++)
    {
        size_t dim = spaces[s].point_dim;
        bat_curve curve = random_curve(&spaces[s], 6, 12), repeated = closed_curve(&spaces[s], 11);
        const size_t order[] = {0, 0, 1, 1, 1, 2, 3, 4, 5, 5, 0};
        for (size_t i = 0; i < 11; i++)
            memcpy(repeated.points + i * dim, curve.points + order[i] * dim, dim * sizeof(double));
        bat_fairness once = fairness_of(&curve), again = fairness_of(&repeated);
        assert_memory_equal(&again, &once, sizeof once);
        for (size_t i = 0; i < 11; i++)
            memcpy(repeated.points + i * dim, curve.points, dim * sizeof(double));
        check_near(fairness_of(&repeated).bending, 0, 0);
        bat_curve_free(&curve);
        bat_curve_free(&repeated);
    }
}

static void fairness_refuses_bad_input(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double points[] = {1, 0, 0, 0, 1, 0, 0, -1, 0};
    bat_curve curve = {.space = &sphere, .points = points, .count = 3};
    bat_fairness untouched = {-7, -7, -7}, fairness = untouched;
    bat_error error;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 2);
    points[8] = 0.5;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 2);
    curve.count = 2;
    bat_measure_options options = bat_measure_defaults();
    options.bending_offset = -1;
    check_status(bat_curve_fairness(&curve, &options, &fairness, &error), BAT_INVALID_ARGUMENT);
    options.bending_offset = NAN;
    check_status(bat_curve_fairness(&curve, &options, &fairness, &error), BAT_INVALID_ARGUMENT);
    curve.count = 0;
    check_status(bat_curve_fairness(&curve, NULL, &fairness, NULL), BAT_INVALID_ARGUMENT);
    assert_memory_equal(&fairness, &untouched, sizeof fairness);
}

static void summaries(void **state)
{
    (void)state;
    const double four[] = {4, 1, 3, 2}, three[] = {7, -1, 3}, bad[] = {1, NAN};
    bat_summary summary;
    check_status(bat_summarize(four, 4, &summary, NULL), BAT_OK);
    check_near(summary.mean, 2.5, 0);
    check_near(summary.median, 2.5, 0);
    check_near(summary.deviation, sqrt(1.25), 1e-15);
    check_near(summary.least, 1, 0);
    check_near(summary.greatest, 4, 0);
    check_status(bat_summarize(three, 3, &summary, NULL), BAT_OK);
    check_near(summary.median, 3, 0);
    assert_int_equal(summary.count, 3);
    check_status(bat_summarize(three, 1, &summary, NULL), BAT_OK);
    check_near(summary.deviation, 0, 0);
    bat_error error;
    check_status(bat_summarize(bad, 2, &summary, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    check_status(bat_summarize(bad, 0, &summary, &error), BAT_INVALID_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(concentric_circles),
        cmocka_unit_test(the_two_ways_differ),
        cmocka_unit_test(distances_to_edges_ignore_the_sampling),
        cmocka_unit_test(chords_and_arcs_of_the_sphere),
        cmocka_unit_test(geodesic_neighbours_are_exact_in_every_space),
        cmocka_unit_test(geodesic_neighbours_near_the_rim),
        cmocka_unit_test(isometries_change_nothing),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(comparing_refuses_bad_input),
        cmocka_unit_test(regular_polygons_have_the_fairness_of_trigonometry),
        cmocka_unit_test(more_dimensions_agree_with_two),
        cmocka_unit_test(small_angles_keep_their_digits),
        cmocka_unit_test(ends_of_open_curves_do_not_count),
        cmocka_unit_test(sets_are_measured_curve_by_curve),
        cmocka_unit_test(repeated_points_are_passed_over),
        cmocka_unit_test(fairness_refuses_bad_input),
        cmocka_unit_test(summaries),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "measure_helpers.h"

static bat_curve_distance compare(const bat_curve *first, const bat_curve *second, const bat_curve_measure_options *options)
{
    bat_curve_distance distance;
    bat_error error = {0};
    bat_status status = bat_curve_compare(first, second, options, &distance, &error);
    if (status != BAT_OK)
        print_error("%s\n", error.text);
    check_status(status, BAT_OK);
    return distance;
}

static void concentric_circles(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve first = regular_polygon(&plane, 120, 1), second = regular_polygon(&plane, 120, 1.25);
    bat_curve_distance distance = compare(&first, &second, NULL);
    check_near(distance.mean_nn, 0.25, 1e-15);
    check_near(distance.mean_nn_from_second, 0.25, 1e-15);
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
    check_near(distance.hausdorff_from_first, 0, 0);
    check_near(distance.mean_nn_from_second, (8.0 + 2 + 8) / 6, 1e-15);
    check_near(distance.mean_symmetric, 1.5, 1e-15);
    check_near(distance.hausdorff_from_second, 8, 0);
    check_near(distance.hausdorff, 8, 0);
    assert_int_equal(distance.farthest_from_second, 3); // the first of the two
    bat_curve_distance turned = compare(&second, &first, NULL);
    check_near(turned.mean_nn, distance.mean_nn_from_second, 0);
    check_near(turned.hausdorff, distance.hausdorff, 0);
}

static void distances_to_edges_ignore_the_sampling(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1}, middles[] = {0.5, 0, 1, 0.5, 0.5, 1, 0, 0.5};
    bat_curve first = {.space = &plane, .points = middles, .count = 4, .closed = true};
    bat_curve second = {.space = &plane, .points = square, .count = 4, .closed = true};
    bat_curve_measure_options options = bat_curve_measure_defaults();
    check_near(compare(&first, &second, &options).mean_nn, 0.5, 0);
    options.to_segments = true;
    check_near(compare(&first, &second, &options).hausdorff_from_first, 0, 0);
    check_near(compare(&first, &second, &options).mean_nn_from_second, sqrt(0.125), 1e-15);
    second.closed = false; // the last middle now misses the left side
    check_near(compare(&first, &second, &options).hausdorff_from_first, 0.5, 0);
    second.count = 1;
    check_near(compare(&first, &second, &options).hausdorff_from_first, sqrt(1.25), 1e-15);
}

static void chords_and_arcs_of_the_sphere(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    bat_curve first = random_curve(&sphere, 200, 1), second = random_curve(&sphere, 300, 2);
    bat_curve one = first;
    one.count = 1;
    bat_curve_measure_options geodesic = bat_curve_measure_defaults();
    geodesic.geodesic = true;
    double chord = compare(&one, &second, NULL).hausdorff_from_first,
           arc = compare(&one, &second, &geodesic).hausdorff_from_first;
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
    bat_curve_measure_options geodesic = bat_curve_measure_defaults();
    geodesic.geodesic = true;
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++)
    {
        bat_curve first = random_curve(&spaces[s], 150, 3), second = random_curve(&spaces[s], 220, 4);
        bat_curve_distance distance = compare(&first, &second, &geodesic);
        check_relative(distance.mean_nn, mean_by_search(&first, &second), 1e-14);
        check_relative(distance.mean_nn_from_second, mean_by_search(&second, &first), 1e-14);
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
    bat_curve_measure_options geodesic = bat_curve_measure_defaults();
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
    bat_curve_measure_options geodesic = bat_curve_measure_defaults();
    geodesic.geodesic = true;
    for (size_t s = 0; s < 2; s++)
    {
        bat_curve first = random_curve(&spaces[s], 50, 6), second = random_curve(&spaces[s], 60, 7);
        bat_curve_distance distance = compare(&first, &second, &geodesic);
        bat_curve_fairness_values fairness = fairness_of(&first);
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
    bat_curve_measure_options options = bat_curve_measure_defaults();
    options.threads = 1;
    bat_curve_distance one = compare(&first, &second, &options);
    options.threads = 3;
    bat_curve_distance three = compare(&first, &second, &options);
    assert_memory_equal(&one, &three, sizeof one);
    bat_curve_free(&first);
    bat_curve_free(&second);
}

static void distances_magnify_with_the_curves(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(1), bat_euclidean(2), bat_euclidean(3)};
    const double factors[] = {1e200, 1e-170, 1e307, 1e-300};
    const bat_curve_measure_options ways[] = {{0}, {.geodesic = true}, {.to_segments = true}};
    for (size_t s = 0; s < 3; s++)
    {
        bat_curve first = random_curve(&spaces[s], 100, 21), second = random_curve(&spaces[s], 130, 22);
        for (size_t f = 0; f < sizeof factors / sizeof *factors; f++)
        {
            bat_curve a = magnified(&first, factors[f]), b = magnified(&second, factors[f]);
            for (size_t w = 0; w < 3; w++)
            {
                bat_curve_distance expected = compare(&first, &second, &ways[w]), found = compare(&a, &b, &ways[w]);
                check_near(found.mean_nn, factors[f] * expected.mean_nn, factors[f] * 1e-14);
                check_near(found.mean_symmetric, factors[f] * expected.mean_symmetric, factors[f] * 1e-14);
                check_near(found.hausdorff, factors[f] * expected.hausdorff, factors[f] * 1e-14);
                assert_true(s == 0 || found.farthest_from_first == expected.farthest_from_first);
            }
            bat_curve_free(&a);
            bat_curve_free(&b);
        }
        bat_curve_free(&first);
        bat_curve_free(&second);
    }
}

/// Next to the origin of the disk a hyperbolic length is twice the Euclidean one.
static void tiny_curves_of_the_disk_keep_their_distances(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), disk = bat_disk();
    bat_curve first = random_curve(&plane, 80, 23), second = random_curve(&plane, 70, 24);
    bat_curve a = magnified(&first, 1e-170), b = magnified(&second, 1e-170);
    a.space = b.space = &disk;
    bat_curve_measure_options geodesic = bat_curve_measure_defaults();
    geodesic.geodesic = true;
    check_relative(compare(&a, &b, &geodesic).mean_nn, 2e-170 * compare(&first, &second, NULL).mean_nn, 1e-13);
    bat_curve_free(&first);
    bat_curve_free(&second);
    bat_curve_free(&a);
    bat_curve_free(&b);
}

static void distances_that_no_double_holds_are_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), solid = bat_euclidean(3);
    double near[] = {8e307, 8e307, 8e307, 8e307, 8e307, 8e307}, far[] = {-8e307, -8e307, -8e307, 8e307, 8e307, 8e307};
    double beyond[] = {0, 0, 1e308, 0};
    for (int w = 0; w < 3; w++)
    {
        bat_curve_measure_options options = {.geodesic = w == 1, .to_segments = w == 2};
        bat_curve a = {.space = w == 0 ? &plane : &solid, .points = near, .count = 1}, b = a;
        b.points = far;
        bat_curve_distance distance;
        bat_error error;
        check_status(bat_curve_compare(&a, &b, &options, &distance, &error), BAT_INVALID_POINT);
        assert_int_equal(error.index, 0);
        bat_curve out = {.space = &plane, .points = beyond, .count = 2};
        check_status(bat_curve_compare(&out, &out, &options, &distance, &error), BAT_INVALID_POINT);
        assert_int_equal(error.index, 1);
    }
}

static void comparing_reports_and_stops(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2);
    bat_curve first = random_curve(&plane, 20000, 25), second = random_curve(&plane, 10000, 26);
    for (int threads = 1; threads <= 3; threads++)
    {
        watch seen;
        bat_curve_measure_options options = bat_curve_measure_defaults();
        options.threads = threads;
        options.progress = watched(&seen, 2);
        bat_curve_distance distance = compare(&first, &second, &options), untouched = distance;
        assert_true(seen.calls > (threads == 1 ? 1 : 0) && seen.monotone);
        check_near(seen.last, 1, 0);
        // Of several threads the calling one may find all the work done before its turn.
        options.progress = watched(&seen, 0);
        bat_error error;
        bat_status status = bat_curve_compare(&second, &first, &options, &distance, &error);
        assert_true(status == BAT_CANCELLED || (status == BAT_OK && threads > 1));
        if (status == BAT_CANCELLED)
            assert_memory_equal(&distance, &untouched, sizeof distance);
    }
    bat_curve_free(&first);
    bat_curve_free(&second);
}

static void sets_are_compared_pair_by_pair(void **state)
{
    (void)state;
    enum
    {
        PAIRS = 30
    };
    bat_space sphere = bat_sphere(2);
    bat_curve first[PAIRS], second[PAIRS];
    bat_curve_distance distances[PAIRS];
    for (size_t i = 0; i < PAIRS; i++)
    {
        first[i] = random_curve(&sphere, i == 7 ? 3000 : 20 + i, 100 + i);
        second[i] = random_curve(&sphere, 30, 200 + i);
    }
    bat_curve_measure_options options = {.geodesic = true};
    // 2 pairs are measured in turn, 30 by 3 threads together.
    for (size_t count = 2; count <= PAIRS; count += 28)
        for (options.threads = 1; options.threads <= 3; options.threads++)
        {
            watch seen;
            options.progress = watched(&seen, 2);
            check_status(bat_curves_compare(first, second, count, &options, distances, NULL), BAT_OK);
            assert_true(seen.monotone);
            check_near(seen.last, 1, 1e-15);
            for (size_t i = 0; i < count; i++)
            {
                bat_curve_distance alone = compare(&first[i], &second[i], &(bat_curve_measure_options){.geodesic = true});
                assert_memory_equal(&alone, &distances[i], sizeof alone);
            }
            options.progress = watched(&seen, 0);
            bat_error error;
            bat_status status = bat_curves_compare(first, second, count, &options, distances, &error);
            assert_true(status == BAT_CANCELLED || (status == BAT_OK && options.threads > 1));
            assert_true(status == BAT_OK || error.curve == BAT_NO_INDEX);
            options.progress = (bat_progress){0};
            double *broken[] = {second[1].points + 3 * 5, first[count - 1].points + 3 * 4},
                   whole[] = {*broken[0], *broken[1]};
            *broken[0] = *broken[1] = NAN;
            check_status(bat_curves_compare(first, second, count, &options, distances, &error), BAT_INVALID_POINT);
            assert_int_equal(error.curve, 1);
            *broken[0] = whole[0];
            *broken[1] = whole[1];
        }
    check_status(bat_curves_compare(first, second, 0, NULL, NULL, NULL), BAT_OK);
    for (size_t i = 0; i < PAIRS; i++)
    {
        bat_curve_free(&first[i]);
        bat_curve_free(&second[i]);
    }
}

static void comparing_refuses_bad_input(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(1), solid = bat_euclidean(3);
    double square[] = {0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 0, 0}, broken[] = {0, 0, 1, NAN};
    bat_curve good = {.space = &plane, .points = square, .count = 4}, empty = {.space = &plane};
    bat_curve bad = {.space = &plane, .points = broken, .count = 2}, off = {.space = &sphere, .points = square, .count = 2};
    bat_curve other = {.space = &solid, .points = square, .count = 4};
    bat_curve_measure_options geodesic = bat_curve_measure_defaults(), both;
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

static void summaries_of_extreme_numbers(void **state)
{
    (void)state;
    const double large[] = {1.7e308, 1.7e308, 1.6e308, 1.6e308}, small[] = {3e-320, 1e-320}, infinite[] = {1, INFINITY};
    bat_curve_summary summary;
    check_status(bat_curve_summarize(large, 4, &summary, NULL), BAT_OK);
    check_relative(summary.mean, 1.65e308, 1e-15);
    check_relative(summary.median, 1.65e308, 1e-15);
    check_relative(summary.deviation, 5e306, 1e-13);
    check_status(bat_curve_summarize(small, 2, &summary, NULL), BAT_OK);
    check_near(summary.mean, 2e-320, 1e-323);
    check_near(summary.deviation, 1e-320, 1e-323);
    check_status(bat_curve_summarize(infinite, 2, &summary, NULL), BAT_OK);
    assert_true(isinf(summary.mean));
}

static void summaries(void **state)
{
    (void)state;
    const double four[] = {4, 1, 3, 2}, three[] = {7, -1, 3}, bad[] = {1, NAN};
    bat_curve_summary summary;
    check_status(bat_curve_summarize(four, 4, &summary, NULL), BAT_OK);
    check_near(summary.mean, 2.5, 0);
    check_near(summary.median, 2.5, 0);
    check_near(summary.deviation, sqrt(1.25), 1e-15);
    check_near(summary.least, 1, 0);
    check_near(summary.greatest, 4, 0);
    check_status(bat_curve_summarize(three, 3, &summary, NULL), BAT_OK);
    check_near(summary.median, 3, 0);
    assert_int_equal(summary.count, 3);
    check_status(bat_curve_summarize(three, 1, &summary, NULL), BAT_OK);
    check_near(summary.deviation, 0, 0);
    bat_error error;
    check_status(bat_curve_summarize(bad, 2, &summary, &error), BAT_INVALID_ARGUMENT);
    assert_int_equal(error.index, 1);
    check_status(bat_curve_summarize(bad, 0, &summary, &error), BAT_INVALID_ARGUMENT);
}

/// The tables name each measure once, by the place of its field; there are measures of one curve and of two.
static void measures_are_listed(void **state)
{
    (void)state;
    bat_measure measure, other;
    bool found[2] = {false, false};
    for (size_t curves = 1; curves <= 2; curves++)
        for (size_t i = 0; bat_curve_measures(curves, i, &measure); i++)
        {
            bool hausdorff = strcmp(measure.name, "hausdorff") == 0, bending = strcmp(measure.name, "bending") == 0;
            assert_true(!hausdorff || measure.offset == offsetof(bat_curve_distance, hausdorff));
            assert_true(!bending || measure.offset == offsetof(bat_curve_fairness_values, bending));
            found[curves - 1] = found[curves - 1] || (curves == 1 ? bending : hausdorff);
            for (size_t k = 0; k < i; k++)
            {
                assert_true(bat_curve_measures(curves, k, &other));
                assert_true(strcmp(other.name, measure.name) != 0 && other.offset != measure.offset);
            }
        }
    assert_true(found[0] && found[1]);
    assert_false(bat_curve_measures(0, 0, &measure) || bat_curve_measures(3, 0, &measure));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(measures_are_listed),
        cmocka_unit_test(concentric_circles),
        cmocka_unit_test(the_two_ways_differ),
        cmocka_unit_test(distances_to_edges_ignore_the_sampling),
        cmocka_unit_test(chords_and_arcs_of_the_sphere),
        cmocka_unit_test(geodesic_neighbours_are_exact_in_every_space),
        cmocka_unit_test(geodesic_neighbours_near_the_rim),
        cmocka_unit_test(isometries_change_nothing),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(distances_magnify_with_the_curves),
        cmocka_unit_test(tiny_curves_of_the_disk_keep_their_distances),
        cmocka_unit_test(distances_that_no_double_holds_are_refused),
        cmocka_unit_test(comparing_reports_and_stops),
        cmocka_unit_test(sets_are_compared_pair_by_pair),
        cmocka_unit_test(comparing_refuses_bad_input),
        cmocka_unit_test(summaries_of_extreme_numbers),
        cmocka_unit_test(summaries),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

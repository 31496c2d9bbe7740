// Boundaries found in clouds without connectivity: the loop that is known, whatever the order of the points; or a reason.
#include "cloud_helpers.h"

/// A bump over the unit square, with points along its boundary and at random inside.
static void bump(double u, double v, double point[3])
{
    point[0] = u + 0.1 * v * v;
    point[1] = v - 0.1 * u * v;
    point[2] = 0.4 * sin(3 * u) * cos(2 * v);
}

static bat_cloud bump_cloud(size_t side, size_t interior, double noise, double unevenness, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_cloud cloud = {0};
    double point[3], u, v;
    for (size_t i = 0; i < 4 * side + interior; i++)
    {
        around_square((double)i / (double)(4 * side), &u, &v);
        if (i >= 4 * side)
        {
            u = pow(bat_random_uniform(&random), unevenness);
            v = bat_random_uniform(&random);
        }
        bump(u, v, point);
        for (int k = 0; k < 3; k++)
            point[k] += noise * bat_random_normal(&random);
        add_point(&cloud, point[0], point[1], point[2]);
    }
    cloud.boundary_count = 4 * side;
    return cloud;
}

static void must_find(bat_cloud *cloud)
{
    bat_error error = {0};
    if (bat_cloud_find_boundary(cloud, &error) != BAT_OK)
        fail_msg("%s", error.text);
    check_status(bat_cloud_check(cloud, NULL), BAT_OK);
    assert_false(cloud->has_corners);
}

static void assert_none(bat_cloud *cloud, const char *words)
{
    bat_error error = {0};
    check_status(bat_cloud_find_boundary(cloud, &error), BAT_NO_CONVERGENCE);
    check_status(bat_cloud_find_boundary(cloud, NULL), BAT_NO_CONVERGENCE);
    if (strstr(error.text, words) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", error.text, words);
    assert_int_equal(cloud->boundary_count, 0);
}

static void test_clean_boundaries_are_found_point_for_point(void **state)
{
    (void)state;
    static const size_t sides[] = {6, 12, 33}, interiors[] = {30, 120, 1000};
    for (size_t i = 0; i < 3; i++)
        for (uint64_t seed = 0; seed < 3; seed++)
        {
            // A regular boundary of a surface that is flat there: no point of it lies behind its neighbours.
            bat_cloud cloud = bump_cloud(sides[i], interiors[i], 0, 1, seed), before;
            for (size_t k = 0; k < cloud.count; k++)
                cloud.points[3 * k + 2] = 0;
            check_status(bat_cloud_copy(&cloud, &before, NULL), BAT_OK);
            shuffle_cloud(&cloud, seed);
            must_find(&cloud);
            double mean, spacing = 1 / sqrt((double)cloud.count);
            assert_true(distance_to_loop(cloud.points, cloud.boundary_count, before.points, 4 * sides[i], &mean) <
                        0.5 * spacing);
            assert_true(distance_to_loop(before.points, 4 * sides[i], cloud.points, cloud.boundary_count, &mean) <
                        0.5 * spacing);
            bat_cloud_free(&cloud);
            bat_cloud_free(&before);
        }
}

static void test_noise_and_uneven_density(void **state)
{
    (void)state;
    static const struct
    {
        size_t side, interior;
        double noise, unevenness, most, max_mean; ///< in spacings
    } cases[] = {{33, 1000, 0, 2, 1, 0.2},      {33, 1000, 0.005, 1, 1.5, 0.4}, {33, 1000, 0.01, 1, 2.5, 0.7},
                 {15, 200, 0.05, 1, 5, 1.6},    {33, 1000, 0.05, 1, 9, 3.2},    {8, 50, 0.01, 1, 1, 0.4},
                 {33, 1000, 0.005, 2, 1.5, 0.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (uint64_t seed = 0; seed < 2; seed++)
        {
            bat_cloud clean = bump_cloud(cases[i].side, 0, 0, 1, seed),
                      cloud = bump_cloud(cases[i].side, cases[i].interior, cases[i].noise, cases[i].unevenness, seed);
            shuffle_cloud(&cloud, seed);
            must_find(&cloud);
            double means[2], greatest[2], spacing = 1 / sqrt((double)cloud.count);
            greatest[0] =
                distance_to_loop(cloud.points, cloud.boundary_count, clean.points, clean.boundary_count, &means[0]);
            greatest[1] =
                distance_to_loop(clean.points, clean.boundary_count, cloud.points, cloud.boundary_count, &means[1]);
            for (int k = 0; k < 2; k++)
                if (greatest[k] > cases[i].most * spacing || means[k] > cases[i].max_mean * spacing)
                    fail_msg("case %zu, seed %u: %g and on average %g spacings off", i, (unsigned)seed,
                             greatest[k] / spacing, means[k] / spacing);
            bat_cloud_free(&cloud);
            bat_cloud_free(&clean);
        }
}

static void test_grids(void **state)
{
    (void)state;
    for (size_t side = 4; side <= 30; side += 13)
    {
        bat_cloud cloud = {0};
        for (size_t i = 0; i < side * side; i++)
            add_point(&cloud, (double)(i % side), (double)(i / side), 0.01 * (double)(i % side * (i / side)));
        shuffle_cloud(&cloud, side);
        must_find(&cloud);
        assert_int_equal(cloud.boundary_count, 4 * (side - 1));
        for (size_t i = 0; i < cloud.count; i++)
        {
            const double *p = cloud.points + 3 * i, last = (double)(side - 1);
            bool outer = p[0] == 0 || p[1] == 0 || p[0] == last || p[1] == last;
            assert_int_equal(outer, i < cloud.boundary_count);
            const double *next = cloud.points + 3 * ((i + 1) % cloud.boundary_count);
            if (outer)
                check_near(hypot(next[0] - p[0], next[1] - p[1]), 1, 0);
        }
        bat_cloud_free(&cloud);
    }
}

static void test_order_tells_where_points_were(void **state)
{
    (void)state;
    bat_cloud cloud = bump_cloud(10, 100, 0, 1, 5), before;
    shuffle_cloud(&cloud, 1);
    check_status(bat_cloud_copy(&cloud, &before, NULL), BAT_OK);
    must_find(&cloud);
    size_t *order = malloc(cloud.count * sizeof *order);
    memcpy(order, cloud.order, cloud.count * sizeof *order);
    for (size_t i = 0; i < cloud.count; i++)
        assert_memory_equal(cloud.points + 3 * i, before.points + 3 * order[i], 3 * sizeof(double));
    for (size_t i = cloud.boundary_count + 1; i < cloud.count; i++)
        assert_true(order[i] > order[i - 1]);
    // Finding it again changes nothing but perhaps the direction, and keeps saying where points were in the input.
    size_t count = cloud.boundary_count;
    bat_cloud again;
    check_status(bat_cloud_copy(&cloud, &again, NULL), BAT_OK);
    must_find(&again);
    assert_int_equal(again.boundary_count, count);
    assert_true(is_same_loop(cloud.points, again.points, count));
    for (size_t i = 0; i < cloud.count; i++)
        assert_memory_equal(again.points + 3 * i, before.points + 3 * again.order[i], 3 * sizeof(double));
    free(order);
    bat_cloud_free(&again);
    bat_cloud_free(&cloud);
    bat_cloud_free(&before);
}

static void test_place_and_size_do_not_matter(void **state)
{
    (void)state;
    static const double sizes[] = {0x1p-900, 1, 0x1p900};
    bat_cloud reference = bump_cloud(12, 150, 0.005, 1, 9);
    shuffle_cloud(&reference, 2);
    for (size_t i = 0; i < 3; i++)
    {
        bat_cloud cloud, unit;
        check_status(bat_cloud_copy(&reference, &cloud, NULL), BAT_OK);
        check_status(bat_cloud_copy(&reference, &unit, NULL), BAT_OK);
        for (size_t k = 0; k < 3 * cloud.count; k++)
            cloud.points[k] *= sizes[i];
        must_find(&cloud);
        must_find(&unit);
        assert_int_equal(cloud.boundary_count, unit.boundary_count);
        assert_memory_equal(cloud.order, unit.order, cloud.count * sizeof *cloud.order);
        bat_cloud_free(&cloud);
        bat_cloud_free(&unit);
    }
    bat_cloud_free(&reference);
}

static void test_small_gaps_and_stray_points_are_left_alone(void **state)
{
    (void)state;
    bat_cloud whole = bump_cloud(33, 1000, 0, 1, 3), cloud = {0};
    for (size_t i = 0; i < whole.count; i++)
    {
        const double *p = whole.points + 3 * i, hole[3] = {0.5, 0.45, p[2]};
        if (i < whole.boundary_count || distance_of(p, hole) > 0.07)
            add_point(&cloud, p[0], p[1], p[2]);
    }
    add_point(&cloud, 3, 3, 3);
    add_point(&cloud, -2, 0, 1);
    shuffle_cloud(&cloud, 4);
    must_find(&cloud);
    double mean;
    assert_true(distance_to_loop(cloud.points, cloud.boundary_count, whole.points, whole.boundary_count, &mean) < 0.02);
    assert_true(distance_to_loop(whole.points, whole.boundary_count, cloud.points, cloud.boundary_count, &mean) < 0.02);
    bat_cloud_free(&cloud);
    bat_cloud_free(&whole);
}

static void test_what_is_no_patch_is_refused(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 4; seed++)
    {
        bat_random random = bat_random_seed(seed);
        bat_cloud sphere = {0}, ring = {0}, two = {0}, ball = {0};
        for (int i = 0; i < 800; i++)
        {
            double x = bat_random_normal(&random), y = bat_random_normal(&random), z = bat_random_normal(&random),
                   length = sqrt(x * x + y * y + z * z);
            add_point(&sphere, x / length, y / length, z / length);
            add_point(&ball, x, y, z);
            double r = sqrt(0.25 + 0.75 * bat_random_uniform(&random)), t = 6.283185307 * bat_random_uniform(&random);
            add_point(&ring, r * cos(t), r * sin(t), 0.1 * x);
            ring.points[3 * ring.count - 1] = 0.2 * r * r;
            double u = bat_random_uniform(&random), v = bat_random_uniform(&random);
            add_point(&two, u + (i % 2 == 0 ? 2 : 0), v, 0.1 * u * v);
        }
        assert_none(&sphere, "closed");
        assert_none(&ring, "several boundary loops");
        assert_none(&two, "several pieces");
        assert_none(&ball, "fill a volume");
        bat_cloud_free(&ball);
        bat_cloud_free(&sphere);
        bat_cloud_free(&ring);
        bat_cloud_free(&two);
    }
}

/// A shell is the way out for several pieces where all are closed, and only there.
static void test_closed_pieces_lead_to_a_shell(void **state)
{
    (void)state;
    for (int open = 0; open < 2; open++)
    {
        bat_random random = bat_random_seed(5);
        bat_cloud cloud = {0};
        bat_error error = {0};
        for (int i = 0; i < 1600; i++)
        {
            double x = bat_random_normal(&random), y = bat_random_normal(&random), z = bat_random_normal(&random),
                   length = sqrt(x * x + y * y + z * z);
            if (i % 2 == 0)
                add_point(&cloud, x / length, y / length, z / length);
            else
                add_point(&cloud, x / length + 3, y / length, (open && z > 0 ? -z : z) / length);
        }
        assert_none(&cloud, "several pieces");
        check_status(bat_cloud_find_boundary(&cloud, &error), BAT_NO_CONVERGENCE);
        assert_string_equal(error.remedy, open ? "" : "shell");
        bat_cloud_free(&cloud);
    }
}

static void test_two_sheets_are_told(void **state)
{
    (void)state;
    // Sheets that are as far apart as their points: a disc would run along a surface between them.
    for (uint64_t seed = 0; seed < 3; seed++)
    {
        bat_cloud cloud = bump_cloud(0, 2000, 0.001, 1, seed);
        for (size_t i = 0; i < cloud.count; i += 2)
            cloud.points[3 * i + 2] += 0.02;
        assert_none(&cloud, "two sheets");
        bat_cloud_free(&cloud);
        // Uniform noise of the same size is one sheet.
        bat_random random = bat_random_seed(seed);
        cloud = bump_cloud(0, 2000, 0, 1, seed);
        for (size_t i = 0; i < cloud.count; i++)
            cloud.points[3 * i + 2] += 0.02 * bat_random_uniform(&random);
        must_find(&cloud);
        bat_cloud_free(&cloud);
    }
}

static void test_curves_are_told(void **state)
{
    (void)state;
    bat_cloud helix = {0};
    for (int i = 0; i < 2000; i++)
        add_point(&helix, cos(0.01 * i), sin(0.01 * i), 0.002 * i);
    assert_none(&helix, "along a curve");
    bat_cloud_free(&helix);
}

static void test_scan_lines(void **state)
{
    (void)state;
    // Lines 20 times as far apart as the points on them.
    bat_cloud cloud = {0};
    double point[3], mean;
    for (int line = 0; line <= 30; line++)
        for (int i = 0; i <= 600; i++)
        {
            bump(line / 30.0, i / 600.0, point);
            add_point(&cloud, point[0], point[1], point[2]);
        }
    bat_cloud clean = bump_cloud(100, 0, 0, 1, 0);
    shuffle_cloud(&cloud, 1);
    must_find(&cloud);
    assert_true(distance_to_loop(cloud.points, cloud.boundary_count, clean.points, clean.boundary_count, &mean) < 1 / 30.0);
    assert_true(distance_to_loop(clean.points, clean.boundary_count, cloud.points, cloud.boundary_count, &mean) < 1 / 30.0);
    bat_cloud_free(&cloud);
    bat_cloud_free(&clean);
}

static void test_outliers_are_left_out(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 4; seed++)
    {
        bat_random random = bat_random_seed(seed + 77);
        bat_cloud cloud = bump_cloud(33, 1500, 0, 1, seed), clean = bump_cloud(100, 0, 0, 1, 0);
        for (int i = 0; i < 160; i++)
            add_point(&cloud, bat_random_uniform(&random), bat_random_uniform(&random), bat_random_uniform(&random) - 0.5);
        shuffle_cloud(&cloud, seed);
        cloud.boundary_count = 0;
        must_find(&cloud);
        double mean;
        assert_true(distance_to_loop(clean.points, clean.boundary_count, cloud.points, cloud.boundary_count, &mean) < 0.15);
        assert_true(mean < 0.03);
        bat_cloud_free(&cloud);
        bat_cloud_free(&clean);
    }
}

static void test_too_few_or_degenerate_points(void **state)
{
    (void)state;
    bat_cloud cloud = {0}, line = {0};
    for (int i = 0; i < 3; i++)
        add_point(&cloud, i, i * i, 0);
    assert_none(&cloud, "fewer than four");
    bat_cloud_free(&cloud);
    bat_error error = {0};
    check_status(bat_cloud_find_boundary(&cloud, &error), BAT_INVALID_ARGUMENT);
    for (int i = 0; i < 50; i++)
        add_point(&line, i, 2 * i, 3 * i);
    assert_none(&line, "lie along a line");
    add_point(&line, 0, 0, 0);
    check_status(bat_cloud_find_boundary(&line, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 50);
    bat_cloud_free(&line);
}

/// A loop that the file gives, found again in the shuffled points. Distances are in the spacing of the cloud's points: the
/// median distance to the nearest other one.
static void find_again(const char *name, double most_off, double max_mean, double max_mean_of_given)
{
    char path[1024];
    (void)snprintf(path, sizeof path, SHARED_DATA "/data/clouds/%s.xyz", name);
    bat_cloud given = {0}, cloud;
    bat_error error = {0};
    if (bat_cloud_read(path, NULL, &given, &error) != BAT_OK)
    {
        print_message("%s is not here: skipped\n", path);
        skip();
    }
    check_status(bat_cloud_copy(&given, &cloud, NULL), BAT_OK);
    shuffle_cloud(&cloud, 7);
    must_find(&cloud);
    enum
    {
        SAMPLES = 101
    };
    double nearest[SAMPLES];
    for (size_t s = 0; s < SAMPLES; s++)
    {
        double least = INFINITY;
        for (size_t i = 0; i < cloud.count; i++)
            if (i != s)
                least = fmin(
                    least, distance_of(cloud.points + 3 * (cloud.count - 1 - s), cloud.points + 3 * (cloud.count - 1 - i)));
        size_t at = s;
        for (; at > 0 && nearest[at - 1] > least; at--)
            nearest[at] = nearest[at - 1];
        nearest[at] = least;
    }
    double mean, spacing = nearest[SAMPLES / 2];
    double off = distance_to_loop(cloud.points, cloud.boundary_count, given.points, given.boundary_count, &mean);
    if (off > most_off * spacing || mean > max_mean * spacing)
        fail_msg("%s: found %g and on average %g spacings from the given loop", name, off / spacing, mean / spacing);
    (void)distance_to_loop(given.points, given.boundary_count, cloud.points, cloud.boundary_count, &mean);
    if (mean > max_mean_of_given * spacing)
        fail_msg("%s: given on average %g spacings from the loop that was found", name, mean / spacing);
    bat_cloud_free(&cloud);
    bat_cloud_free(&given);
}

static void test_loops_of_scans_are_found_again(void **state)
{
    (void)state;
    // The face's loop is smooth. Nefertiti's has teeth as deep as several spacings, whose notches the disc does not enter.
    find_again("face-9283", 0, 0, 0);
    find_again("nefertiti-532", 1, 0.1, 0.5);
    find_again("nefertiti-1043", 1, 0.1, 0.6);
    find_again("nefertiti-2062", 2, 0.1, 0.9);
    find_again("nefertiti-3253", 2, 0.1, 1);
    find_again("nefertiti-6024", 3.5, 0.3, 1.3);
    find_again("nefertiti-8818", 4.5, 0.4, 1.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_clean_boundaries_are_found_point_for_point),
        cmocka_unit_test(test_noise_and_uneven_density),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_order_tells_where_points_were),
        cmocka_unit_test(test_place_and_size_do_not_matter),
        cmocka_unit_test(test_small_gaps_and_stray_points_are_left_alone),
        cmocka_unit_test(test_what_is_no_patch_is_refused),
        cmocka_unit_test(test_closed_pieces_lead_to_a_shell),
        cmocka_unit_test(test_two_sheets_are_told),
        cmocka_unit_test(test_curves_are_told),
        cmocka_unit_test(test_scan_lines),
        cmocka_unit_test(test_outliers_are_left_out),
        cmocka_unit_test(test_too_few_or_degenerate_points),
        cmocka_unit_test(test_loops_of_scans_are_found_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

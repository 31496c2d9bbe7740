#include "check.h"

#include "batten/curve_measure.h"
#include "batten/research/curve_data.h"
#include "learn/safetensors.h"
#include "research/data/control_polygon.h"
#include "research/data/tension_curves.h"

static const double PI = 3.14159265358979323846;
static const size_t TRUTH = BAT_TENSION_TRUTH_POINTS, CONTROL = BAT_TENSION_CONTROL_POINTS;
static bat_tension_data data;

static int make_data(void **state)
{
    (void)state;
    return bat_tension_data_make(&data, NULL) == BAT_OK ? 0 : -1;
}

static int free_data(void **state)
{
    (void)state;
    bat_tension_data_free(&data);
    return 0;
}

static const double *truth_point(const bat_tension_set *set, size_t row, size_t point)
{
    return set->truth + (row * TRUTH + point) * set->dim;
}

static const double *control_point(const bat_tension_set *set, size_t row, size_t point)
{
    return set->control + (row * CONTROL + point) * set->dim;
}

static void the_split_is_the_published_one(void **state)
{
    (void)state;
    const size_t validation[] = {88, 79, 73}, train[] = {312, 321, 327};
    const size_t validation_heads[3][6] = {{1, 4, 5, 8, 9, 14}, {0, 7, 15, 16, 25, 31}, {2, 3, 6, 10, 11, 12}};
    const size_t train_heads[3][6] = {{0, 1, 3, 5, 6, 10}, {2, 4, 7, 12, 13, 14}, {8, 9, 17, 19, 29, 35}};
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        assert_int_equal(data.validation[s].count, validation[s]);
        assert_int_equal(data.train[s].count, train[s]);
        assert_memory_equal(data.validation[s].index, validation_heads[s], sizeof validation_heads[s]);
        assert_memory_equal(data.train[s].index, train_heads[s], sizeof train_heads[s]);
    }
}

static void every_curve_has_one_place(void **state)
{
    (void)state;
    bool position_taken[2][960] = {{false}}, number_taken[3][BAT_TENSION_CURVES] = {{false}};
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        for (size_t part = 0; part < 2; part++)
        {
            const bat_tension_set *set = part == 0 ? &data.train[s] : &data.validation[s];
            for (size_t i = 0; i < set->count; i++)
            {
                assert_in_range(set->index[i], 0, part == 0 ? 959 : 239);
                assert_in_range(set->number[i], 0, BAT_TENSION_CURVES - 1);
                assert_false(position_taken[part][set->index[i]]);
                assert_false(number_taken[s][set->number[i]]);
                position_taken[part][set->index[i]] = number_taken[s][set->number[i]] = true;
            }
        }
}

static void points_lie_in_their_spaces(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        const bat_tension_set *set = &data.train[s];
        for (size_t i = 0; i < set->count; i++)
        {
            bat_curve truth = bat_tension_truth(set, i, &spaces[s]), control = bat_tension_control(set, i, &spaces[s]);
            check_status(bat_curve_check(&truth, NULL), BAT_OK);
            check_status(bat_curve_check(&control, NULL), BAT_OK);
        }
    }
}

/// One curve of each family, as published.
static void families_have_the_published_coordinates(void **state)
{
    (void)state;
    const struct
    {
        size_t space, row, number;
        double truth[3], control[3]; // points 123 and 6
    } expected[] = {
        {0, 1, 256, {0.30411574244499207, 0.6981654167175293}, {-0.42478033900260925, 0}},
        {0, 5, 325, {-0.4234875738620758, 0.6837341785430908}, {0.3224736452102661, -0.6399385333061218}},
        {0, 4, 2, {-0.2131178230047226, -0.1779879331588745}, {0.4028403162956238, 0.5106859803199768}},
        {0, 0, 95, {0.7130830883979797, 0.7010303735733032}, {-0.8944539427757263, -0.028727274388074875}},
        {1,
         6,
         117,
         {-0.6752848029136658, -0.7366489768028259, 0.03658895567059517},
         {-0.8164966106414795, 0.5773502588272095, 0}},
        {1,
         1,
         268,
         {0.8815267086029053, 0.07313408702611923, 0.4664354622364044},
         {0.6903987526893616, -0.5309790968894958, -0.4913356602191925}},
        {1,
         0,
         359,
         {0.700941264629364, 0.6835424304008484, 0.20359531044960022},
         {-0.9766038656234741, -0.006136263720691204, -0.21495859324932098}},
        {2, 2, 93, {0.2563592493534088, 0.3086252212524414}, {-0.10705877095460892, -0.43991780281066895}},
        {2, 1, 277, {0.217367023229599, 0.21197150647640228}, {-0.30360618233680725, -0.0019076389726251364}},
        {2, 0, 11, {0.4642716944217682, 0.4274299442768097}, {-0.324383407831192, 0.11291854083538055}},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
    {
        const bat_tension_set *set = &data.validation[expected[i].space];
        size_t row = expected[i].row;
        assert_int_equal(set->number[row], expected[i].number);
        for (size_t axis = 0; axis < set->dim; axis++)
        {
            check_near(truth_point(set, row, 123)[axis], expected[i].truth[axis], 1e-7);
            check_near(control_point(set, row, 6)[axis], expected[i].control[axis], 1e-7);
        }
    }
}

/// Curves with a symmetry, whose quarters end at a vertex.
static void ties_between_vertices_break_as_published(void **state)
{
    (void)state;
    const struct
    {
        size_t space, row, vertices[BAT_TENSION_CONTROL_POINTS];
    } expected[] = {
        {0, 1, {0, 64, 137, 250, 364, 437, 500, 564, 637, 750, 864, 937}},
        {0, 47, {0, 82, 169, 251, 332, 419, 500, 582, 669, 750, 832, 919}},
        {1, 6, {0, 81, 160, 255, 307, 404, 500, 581, 660, 755, 807, 904}},
        {1, 0, {0, 88, 175, 250, 338, 425, 501, 588, 675, 751, 838, 925}},
        {2, 1, {0, 84, 167, 251, 334, 417, 501, 584, 667, 751, 834, 917}},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
    {
        const bat_tension_set *set = &data.validation[expected[i].space];
        for (size_t k = 0; k < CONTROL; k++)
            assert_memory_equal(control_point(set, expected[i].row, k),
                                truth_point(set, expected[i].row, expected[i].vertices[k]), set->dim * sizeof(double));
    }
}

static void equal_shares_are_reached_whatever_the_rounding(void **state)
{
    (void)state;
    enum
    {
        COUNT = 96,
        EVERY = 8
    };
    bat_random random = bat_random_seed(1);
    double ring[2 * COUNT], line[COUNT + 1], lengths[COUNT + 2];
    size_t samples[COUNT / EVERY];
    for (size_t trial = 0; trial < 200; trial++)
    {
        double size = exp(20 * (bat_random_uniform(&random) - 0.5)), phase = 2 * PI * bat_random_uniform(&random);
        for (size_t i = 0; i <= COUNT; i++)
            line[i] = phase + size * (double)i;
        arc_samples(line, COUNT + 1, 1, false, lengths, COUNT / EVERY, samples);
        for (size_t k = 0; k < COUNT / EVERY; k++)
            assert_int_equal(samples[k], EVERY * k);
        for (size_t i = 0; i < COUNT; i++)
        {
            ring[2 * i] = size * cos(phase + 2 * PI * (double)i / COUNT);
            ring[2 * i + 1] = size * sin(phase + 2 * PI * (double)i / COUNT);
        }
        arc_samples(ring, COUNT, 2, true, lengths, COUNT / EVERY, samples);
        for (size_t k = 0; k < COUNT / EVERY; k++)
            assert_int_equal(samples[k], EVERY * k);
    }
}

/// One curve of the data set before rounding, with its chord lengths and samples.
typedef struct sampled_curve
{
    double points[3 * BAT_TENSION_TRUTH_POINTS], lengths[BAT_TENSION_TRUTH_POINTS + 1];
    size_t samples[BAT_TENSION_CONTROL_POINTS];
} sampled_curve;

static void sample(sampled_curve *curve, size_t space)
{
    size_t dim = data.train[space].dim;
    arc_samples(curve->points, TRUTH, dim, true, curve->lengths, CONTROL, curve->samples);
}

/// The length to a vertex as a share of the whole.
static double share(const sampled_curve *curve, size_t vertex)
{
    return curve->lengths[vertex] / curve->lengths[TRUTH];
}

/// No length lies so near to the bound between "reached" and "not reached" that rounding could move it across, only vertices
/// at their share give way to the next, and the chosen vertices lie so far from their neighbours that coordinates tell them
/// apart.
static void no_choice_hangs_on_rounding(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(TENSION_SEED);
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        for (size_t number = 0; number < BAT_TENSION_CURVES; number++)
        {
            sampled_curve curve;
            tension_curve((bat_tension_space)s, number, &stream, curve.points);
            sample(&curve, s);
            for (size_t k = 0; k < CONTROL; k++)
            {
                size_t vertex = curve.samples[k];
                double due = (double)k / (double)CONTROL, least = due - ARC_SAMPLES_TOLERANCE;
                bool next = tension_tie_takes_next((bat_tension_space)s, number, k);
                assert_true(share(&curve, vertex) > least + 1e-11);
                assert_true(vertex == 0 || share(&curve, vertex - 1) < least - 1e-11);
                assert_true(!next || fabs(share(&curve, vertex) - due) < ARC_SAMPLES_TOLERANCE);
                vertex += next;
                assert_true(curve.lengths[vertex + 1] - curve.lengths[vertex] > 1e-5);
                assert_true(vertex == 0 || curve.lengths[vertex] - curve.lengths[vertex - 1] > 1e-5);
            }
        }
}

static void noise_moves_no_control_point(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(TENSION_SEED);
    bat_random random = bat_random_seed(1);
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        for (size_t number = 0; number < BAT_TENSION_CURVES; number++)
        {
            sampled_curve exact, noisy;
            tension_curve((bat_tension_space)s, number, &stream, exact.points);
            for (size_t i = 0; i < data.train[s].dim * TRUTH; i++)
                noisy.points[i] = exact.points[i] + 1e-13 * (2 * bat_random_uniform(&random) - 1);
            sample(&exact, s);
            sample(&noisy, s);
            assert_memory_equal(noisy.samples, exact.samples, sizeof exact.samples);
        }
}

/// The greatest difference between an array of the file and `count` doubles.
static double difference(const safetensors *file, const char *name, const double *ours, size_t count)
{
    double *theirs = malloc(count * sizeof *theirs), greatest = 0;
    check_status(safetensors_doubles(file, name, count, theirs, NULL), BAT_OK);
    for (size_t i = 0; i < count; i++)
        greatest = fmax(greatest, fabs(theirs[i] - ours[i]));
    free(theirs);
    return greatest;
}

/// Compare one part of the split with its file; false when the file is not there. Control points that agree are the same
/// vertices: see no_choice_hangs_on_rounding().
static bool agree_with_file(const char *path, const bat_tension_set *sets, bool with_truth)
{
    const char *const spaces[] = {"euclidean", "spherical", "hyperbolic"};
    safetensors file;
    bat_status status = safetensors_read(path, &file, NULL);
    if (status == BAT_FILE_ACCESS)
    {
        print_message("skipped: there is no %s\n", path);
        return false;
    }
    check_status(status, BAT_OK);
    for (size_t s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        const bat_tension_set *set = &sets[s];
        int64_t index[BAT_TENSION_CURVES];
        char name[64];
        (void)snprintf(name, sizeof name, "%s.index", spaces[s]);
        check_status(safetensors_integers(&file, name, set->count, index, NULL), BAT_OK);
        for (size_t i = 0; i < set->count; i++)
            assert_int_equal(index[i], set->index[i]);
        (void)snprintf(name, sizeof name, "%s.control", spaces[s]);
        check_near(difference(&file, name, set->control, set->count * CONTROL * set->dim), 0, 1e-7);
        (void)snprintf(name, sizeof name, "%s.truth", spaces[s]);
        if (with_truth)
            check_near(difference(&file, name, set->truth, set->count * TRUTH * set->dim), 0, 1e-7);
    }
    safetensors_free(&file);
    return true;
}

static void every_curve_is_the_published_one(void **state)
{
    (void)state;
    if (!agree_with_file(SHARED_DATA "/oracle/tension/val.safetensors", data.validation, true) ||
        !agree_with_file(SHARED_DATA "/oracle/tension/train.safetensors", data.train, false))
        skip();
}

static void the_track_is_an_orbit_and_an_arc(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), circle = bat_sphere(1);
    bat_curve truth, control;
    check_status(bat_tension_iss_track(&sphere, &truth, &control, NULL), BAT_OK);
    assert_int_equal(truth.count, 520);
    assert_int_equal(control.count, 16);
    assert_true(truth.closed && control.closed);
    check_status(bat_space_check(&sphere, truth.points, truth.count, NULL), BAT_OK);
    const double *p = truth.points;
    check_near(atan2(p[1], p[0]) * 180 / PI, -155, 1e-12);
    check_near(asin(p[3 * 120 + 2]) * 180 / PI, 51.64, 1e-12); // a quarter of the orbit
    check_near(asin(p[3 * 360 + 2]) * 180 / PI, -51.64, 1e-12);
    // Half a period later the station is 180 degrees on, and the earth has turned by half of 92.68 minutes.
    check_near(atan2(p[3 * 240 + 1], p[3 * 240]) * 180 / PI, 25 - 360 * 46.34 / (23 * 60 + 56.067), 1e-11);
    assert_memory_equal(p + 3 * 480, p + 3 * 479, 3 * sizeof *p);
    double step = sphere.distance(&sphere, p + 3 * 479, p) / 40;
    for (size_t i = 480; i < 520; i++)
        check_near(sphere.distance(&sphere, p + 3 * 479, p + 3 * i), step * (double)(i - 480), 1e-14);
    assert_memory_equal(control.points, p, 3 * sizeof *p);
    bat_curve_free(&truth);
    bat_curve_free(&control);
    check_status(bat_tension_iss_track(&circle, &truth, &control, NULL), BAT_INVALID_ARGUMENT);
}

/// Table 5 of the paper by accurate formulas: five levels of each scheme, to the digits given.
static void the_track_gives_the_known_figures(void **state)
{
    (void)state;
    const struct
    {
        const char *scheme;
        double mean_nn, hausdorff, bending, g1;
    } rows[] = {
        {"angle-4:sign=printed", .00414, .0275, 129.5, 2.235},
        {"angle-6:sign=printed", .00529, .0382, 253.5, 2.906},
        {"angle-4", .00241, .0263, 1.7, .138},
        {"angle-6", .00384, .0386, 1.4, .060},
        {"log-exp-4", .00216, .0226, 2.1, .143},
        {"log-exp-6", .00314, .0305, 1.6, .075},
    };
    bat_space sphere = bat_sphere(2);
    bat_curve truth, control;
    check_status(bat_tension_iss_track(&sphere, &truth, &control, NULL), BAT_OK);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
    {
        bat_curve_refine_options options = bat_curve_refine_defaults();
        bat_curve fine;
        bat_curve_distance distance;
        bat_curve_fairness_values fairness;
        check_status(bat_curve_scheme_by_name(rows[i].scheme, &options.scheme, NULL), BAT_OK);
        check_status(bat_curve_refine(&control, &options, &fine, NULL), BAT_OK);
        check_status(bat_curve_compare(&fine, &truth, NULL, &distance, NULL), BAT_OK);
        check_status(bat_curve_fairness(&fine, NULL, &fairness, NULL), BAT_OK);
        check_near(distance.mean_nn, rows[i].mean_nn, 5.1e-6);
        check_near(distance.hausdorff, rows[i].hausdorff, 5.1e-5);
        check_near(fairness.bending, rows[i].bending, 5.1e-2);
        check_near(fairness.g1, rows[i].g1, 5.1e-4);
        bat_curve_free(&fine);
    }
    bat_curve_free(&truth);
    bat_curve_free(&control);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_split_is_the_published_one),
        cmocka_unit_test(every_curve_has_one_place),
        cmocka_unit_test(points_lie_in_their_spaces),
        cmocka_unit_test(families_have_the_published_coordinates),
        cmocka_unit_test(ties_between_vertices_break_as_published),
        cmocka_unit_test(equal_shares_are_reached_whatever_the_rounding),
        cmocka_unit_test(no_choice_hangs_on_rounding),
        cmocka_unit_test(noise_moves_no_control_point),
        cmocka_unit_test(every_curve_is_the_published_one),
        cmocka_unit_test(the_track_is_an_orbit_and_an_arc),
        cmocka_unit_test(the_track_gives_the_known_figures),
    };
    return cmocka_run_group_tests(tests, make_data, free_data);
}

#include "check.h"

#include "batten/research/curve_data.h"
#include "research/data/tension_set.h"

enum
{
    TRUTH = BAT_TENSION_TRUTH_POINTS,
    CONTROL = BAT_TENSION_CONTROL_POINTS,
    CURVES = 60
};

static bat_space space_of(bat_tension_space space)
{
    return space == BAT_TENSION_SPACE_PLANE    ? bat_euclidean(2)
           : space == BAT_TENSION_SPACE_SPHERE ? bat_sphere(2)
                                               : bat_disk();
}

static bat_tension_set make(bat_tension_space space, bat_tension_set_kind kind, size_t count, uint64_t seed)
{
    bat_tension_set set;
    bat_error error;
    assert_int_equal(bat_tension_set_make(space, kind, count, seed, &set, &error), BAT_OK);
    assert_int_equal(set.count, count);
    assert_int_equal(set.dim, space == BAT_TENSION_SPACE_SPHERE ? 3 : 2);
    return set;
}

/// Call `check` on a small set of each kind in each space.
static void for_every_set(void (*check)(bat_tension_space space, bat_tension_set_kind kind, const bat_tension_set *set))
{
    const bat_tension_set_kind kinds[] = {BAT_TENSION_SET_KIND_RESAMPLED, BAT_TENSION_SET_KIND_UNSEEN};
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        for (size_t k = 0; k < 2; k++)
        {
            bat_tension_set set = make((bat_tension_space)s, kinds[k], CURVES, BAT_TENSION_TEST_SEED);
            check((bat_tension_space)s, kinds[k], &set);
            bat_tension_set_free(&set);
        }
}

static double chord(const double *p, const double *q, size_t dim)
{
    double squared = 0;
    for (size_t i = 0; i < dim; i++)
        squared += (q[i] - p[i]) * (q[i] - p[i]);
    return sqrt(squared);
}

static void check_points(bat_tension_space space, bat_tension_set_kind kind, const bat_tension_set *set)
{
    (void)kind;
    bat_space geometry = space_of(space);
    check_status(bat_space_check(&geometry, set->truth, set->count * TRUTH, NULL), BAT_OK);
    for (size_t i = 0; i < set->count; i++)
    {
        assert_int_equal(set->number[i], i);
        assert_int_equal(set->index[i], i);
    }
}

static void points_lie_in_their_spaces(void **state)
{
    (void)state;
    for_every_set(check_points);
}

/// The truth's point that a control point is, from a known one on.
static size_t vertex_of(const bat_tension_set *set, size_t curve, size_t k, size_t from)
{
    const double *truth = set->truth + curve * TRUTH * set->dim, *p = set->control + (curve * CONTROL + k) * set->dim;
    for (size_t i = 0; i < TRUTH; i++)
        if (memcmp(truth + (from + i) % TRUTH * set->dim, p, set->dim * sizeof *p) == 0)
            return from + i;
    fail_msg("control point %zu of curve %zu is none of the curve's", k, curve);
    return 0;
}

/// Between neighbours lies a twelfth of the curve's length, give or take a step at both ends.
static void check_spacing(bat_tension_space space, bat_tension_set_kind kind, const bat_tension_set *set)
{
    (void)space;
    (void)kind;
    for (size_t c = 0; c < set->count; c++)
    {
        const double *truth = set->truth + c * TRUTH * set->dim;
        double total = 0, longest = 0;
        for (size_t i = 0; i < TRUTH; i++)
        {
            double step = chord(truth + i * set->dim, truth + (i + 1) % TRUTH * set->dim, set->dim);
            total += step;
            longest = fmax(longest, step);
        }
        assert_true(longest <= 0.02 * total);
        size_t vertex = vertex_of(set, c, 0, 0);
        for (size_t k = 0; k < CONTROL; k++)
        {
            size_t next = vertex_of(set, c, (k + 1) % CONTROL, vertex);
            double length = 0;
            for (size_t i = vertex; i < next; i++)
                length += chord(truth + i % TRUTH * set->dim, truth + (i + 1) % TRUTH * set->dim, set->dim);
            check_near(length, total / CONTROL, longest + 1e-8 * total);
            vertex = next;
        }
    }
}

static void control_points_are_even_points_of_the_curve(void **state)
{
    (void)state;
    for_every_set(check_spacing);
}

static void check_edges(bat_tension_space space, bat_tension_set_kind kind, const bat_tension_set *set)
{
    (void)space;
    (void)kind;
    for (size_t c = 0; c < set->count; c++)
    {
        const double *control = set->control + c * CONTROL * set->dim;
        double sum = 0, shortest = INFINITY;
        for (size_t k = 0; k < CONTROL; k++)
        {
            double edge = chord(control + k * set->dim, control + (k + 1) % CONTROL * set->dim, set->dim);
            sum += edge;
            shortest = fmin(shortest, edge);
        }
        assert_true(shortest >= sum / CONTROL / 50);
    }
}

static void no_edge_is_much_shorter_than_the_others(void **state)
{
    (void)state;
    for_every_set(check_edges);
}

/// Two families by their equations.
static void numbers_tell_the_family(void **state)
{
    (void)state;
    bat_tension_set set = make(BAT_TENSION_SPACE_DISK, BAT_TENSION_SET_KIND_RESAMPLED, 40, 1);
    for (size_t c = 1; c < set.count; c += 4) // circles: four points are concyclic
    {
        const double *p = set.truth + c * TRUTH * 2;
        double a = chord(p, p + 500, 2), b = chord(p + 500, p + 1000, 2), d = chord(p + 1000, p + 1500, 2);
        double e = chord(p + 1500, p, 2), f = chord(p, p + 1000, 2), g = chord(p + 500, p + 1500, 2);
        check_relative(f * g, a * d + b * e, 1e-12); // Ptolemy
    }
    bat_tension_set_free(&set);
    set = make(BAT_TENSION_SPACE_PLANE, BAT_TENSION_SET_KIND_RESAMPLED, 40, 1);
    for (size_t c = 0; c < set.count; c += 5) // ellipses: (x / a)^2 + (y / b)^2 = 1
    {
        const double *p = set.truth + c * TRUTH * 2;
        double a = p[0], b = p[2 * TRUTH / 4 + 1];
        for (size_t i = 0; i < TRUTH; i++)
            check_near(p[2 * i] * p[2 * i] / a / a + p[2 * i + 1] * p[2 * i + 1] / b / b, 1, 1e-11);
    }
    bat_tension_set_free(&set);
}

static void the_seed_decides_and_the_count_does_not(void **state)
{
    (void)state;
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        bat_tension_space space = (bat_tension_space)s;
        bat_tension_set few = make(space, BAT_TENSION_SET_KIND_UNSEEN, 7, 5),
                        many = make(space, BAT_TENSION_SET_KIND_UNSEEN, 20, 5);
        bat_tension_set other = make(space, BAT_TENSION_SET_KIND_UNSEEN, 7, 6);
        assert_memory_equal(few.truth, many.truth, 7 * TRUTH * few.dim * sizeof(double));
        assert_memory_equal(few.control, many.control, 7 * CONTROL * few.dim * sizeof(double));
        for (size_t c = 0; c < 7; c++)
            assert_memory_not_equal(few.truth + c * TRUTH * few.dim, other.truth + c * TRUTH * few.dim,
                                    TRUTH * few.dim * sizeof(double));
        bat_tension_set_free(&few);
        bat_tension_set_free(&many);
        bat_tension_set_free(&other);
    }
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    bat_tension_set set = {.count = 77};
    bat_error error;
    check_status(bat_tension_set_make(BAT_TENSION_SPACE_PLANE, BAT_TENSION_SET_KIND_PUBLISHED, 3, 1, &set, &error),
                 BAT_INVALID_ARGUMENT);
    check_status(bat_tension_set_make(BAT_TENSION_SPACE_PLANE, BAT_TENSION_SET_KIND_RESAMPLED, 0, 1, &set, &error),
                 BAT_INVALID_ARGUMENT);
    check_status(bat_tension_set_make(BAT_TENSION_SPACE_COUNT, BAT_TENSION_SET_KIND_RESAMPLED, 3, 1, &set, NULL),
                 BAT_INVALID_ARGUMENT);
    check_status(bat_tension_set_make(BAT_TENSION_SPACE_DISK, BAT_TENSION_SET_KIND_RESAMPLED, SIZE_MAX / 2, 1, &set, &error),
                 BAT_NO_MEMORY);
    assert_int_equal(set.count, 77);
}

/// Streams that differ in one argument only differ from their first number on, and have nothing to do with each other.
static void no_two_streams_begin_alike(void **state)
{
    (void)state;
    enum
    {
        MOST = 3 * 3 * 4 * 8
    };
    double first[MOST], sum = 0, products = 0;
    size_t count = 0;
    for (int purpose = TENSION_TRAINING; purpose <= TENSION_UNSEEN_TEST; purpose++)
        for (int space = 0; space < 3; space++)
            for (uint64_t seed = 0; seed < 4; seed++)
                for (uint64_t number = 0; number < 8; number++)
                {
                    bat_random random = tension_stream((tension_purpose)purpose, (bat_tension_space)space, seed, number);
                    first[count++] = bat_random_uniform(&random);
                }
    for (size_t i = 0; i < MOST; i++)
    {
        for (size_t j = 0; j < i; j++)
            assert_true(first[i] != first[j]);
        sum += first[i] - 0.5;
        products += i > 0 ? (first[i] - 0.5) * (first[i - 1] - 0.5) : 0;
    }
    check_near(sum / MOST, 0, 4 * sqrt(1.0 / 12 / MOST));
    check_near(products / MOST, 0, 4 * sqrt(1.0 / 144 / MOST));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_lie_in_their_spaces),
        cmocka_unit_test(control_points_are_even_points_of_the_curve),
        cmocka_unit_test(no_edge_is_much_shorter_than_the_others),
        cmocka_unit_test(numbers_tell_the_family),
        cmocka_unit_test(the_seed_decides_and_the_count_does_not),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(no_two_streams_begin_alike),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

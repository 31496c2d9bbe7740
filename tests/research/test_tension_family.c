#include "check.h"

#include "batten/curve.h"
#include "batten/curve_measure.h"
#include "research/data/control_polygon.h"
#include "research/data/fillet.h"
#include "research/data/tension_family.h"

enum
{
    POINTS = 1000,
    DRAWS = 200,
    MAX_CONTROL = 64
};

static const double PI = 3.14159265358979323846;

static size_t dim_of(bat_tension_space space)
{
    return space == BAT_TENSION_SPACE_SPHERE ? 3 : 2;
}

static bat_space space_of(bat_tension_space space)
{
    return space == BAT_TENSION_SPACE_PLANE    ? bat_euclidean(2)
           : space == BAT_TENSION_SPACE_SPHERE ? bat_sphere(2)
                                               : bat_disk();
}

static double chord(const double *p, const double *q, size_t dim)
{
    double squared = 0;
    for (size_t i = 0; i < dim; i++)
        squared += (q[i] - p[i]) * (q[i] - p[i]);
    return sqrt(squared);
}

/// Call `check` on some curves of every family.
static void for_every_family(void (*check)(bat_tension_space space, bool unseen, size_t family, bat_random *random,
                                           const double *points))
{
    double points[3 * POINTS];
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
        for (int unseen = 0; unseen < 2; unseen++)
        {
            bat_tension_space space = (bat_tension_space)s;
            bat_random random = bat_random_seed(5);
            for (size_t family = 0; family < tension_family_count(space, unseen); family++)
                for (int draw = 0; draw < DRAWS; draw++)
                {
                    tension_family_draw(space, unseen, family, &random, POINTS, points);
                    check(space, unseen, family, &random, points);
                }
        }
}

static void names_are_told_apart(void **state)
{
    (void)state;
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        bat_tension_space space = (bat_tension_space)s;
        size_t trained = tension_family_count(space, false), unseen = tension_family_count(space, true);
        assert_true(trained >= 3 && unseen >= 2);
        for (size_t i = 0; i < trained + unseen; i++)
            for (size_t j = 0; j < i; j++)
                assert_string_not_equal(tension_family_name(space, i >= trained, i < trained ? i : i - trained),
                                        tension_family_name(space, j >= trained, j < trained ? j : j - trained));
    }
}

static void check_points(bat_tension_space space, bool unseen, size_t family, bat_random *random, const double *points)
{
    (void)unseen;
    (void)family;
    (void)random;
    double greatest = 0;
    size_t dim = dim_of(space);
    for (size_t i = 0; i < POINTS; i++)
    {
        const double *p = points + i * dim, origin[3] = {0};
        double radius = chord(p, origin, dim);
        assert_true(isfinite(radius));
        greatest = fmax(greatest, radius);
        if (space == BAT_TENSION_SPACE_SPHERE)
            check_near(radius, 1, 1e-15);
    }
    if (space == BAT_TENSION_SPACE_PLANE)
        check_near(greatest, 1, 1e-14);
    if (space == BAT_TENSION_SPACE_DISK)
        assert_true(greatest > 0.05 && greatest < 0.95);
}

static void points_lie_in_their_spaces(void **state)
{
    (void)state;
    for_every_family(check_points);
}

/// Also between the last point and the first.
static void check_gaps(bat_tension_space space, bool unseen, size_t family, bat_random *random, const double *points)
{
    (void)random;
    size_t dim = dim_of(space);
    double total = 0, longest = 0;
    for (size_t i = 0; i < POINTS; i++)
    {
        double length = chord(points + i * dim, points + (i + 1) % POINTS * dim, dim);
        assert_true(length > 0);
        longest = fmax(longest, length);
        total += length;
    }
    if (longest > 0.02 * total)
        fail_msg("%s: a gap of %g", tension_family_name(space, unseen, family), longest / total);
}

static void curves_are_closed_and_have_no_gaps(void **state)
{
    (void)state;
    for_every_family(check_gaps);
}

static void same_stream_same_curve(void **state)
{
    (void)state;
    double first[3 * POINTS], second[3 * POINTS];
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        bat_tension_space space = (bat_tension_space)s;
        size_t bytes = POINTS * dim_of(space) * sizeof(double);
        bat_random one = bat_random_seed(1), same = bat_random_seed(1);
        tension_family_draw(space, false, 0, &one, POINTS, first);
        tension_family_draw(space, false, 0, &same, POINTS, second);
        assert_memory_equal(first, second, bytes);
        tension_family_draw(space, false, 0, &same, POINTS, second);
        assert_memory_not_equal(first, second, bytes);
    }
}

/// More points of the same curve contain the fewer ones.
static void curves_do_not_depend_on_the_number_of_points(void **state)
{
    (void)state;
    static double coarse[3 * 120], fine[3 * 360];
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        bat_tension_space space = (bat_tension_space)s;
        size_t dim = dim_of(space);
        for (size_t family = 0; family < tension_family_count(space, false); family++)
        {
            const char *name = tension_family_name(space, false, family);
            bool exact = space == BAT_TENSION_SPACE_SPHERE || strcmp(name, "circle") == 0;
            bat_random one = bat_random_seed(7 + family), same = one;
            tension_family_draw(space, false, family, &one, 120, coarse);
            tension_family_draw(space, false, family, &same, 360, fine);
            // Centre and largest radius of the others hang a little on the points.
            for (size_t i = 0; i < 120 * dim; i++)
                check_near(fine[i / dim * 3 * dim + i % dim], coarse[i], exact ? 1e-12 : 2e-3);
        }
    }
}

static void even_sampling_is_that_of_the_published_data(void **state)
{
    (void)state;
    double points[2 * POINTS], lengths[POINTS + 1];
    size_t expected[MAX_CONTROL], samples[MAX_CONTROL];
    bat_random random = bat_random_seed(3);
    for (size_t n = 4; n <= MAX_CONTROL; n++)
    {
        tension_family_draw(BAT_TENSION_SPACE_PLANE, false, n % 5, &random, POINTS, points);
        arc_samples(points, POINTS, 2, true, lengths, n, expected);
        tension_control_plan plan = {.count = n};
        assert_true(tension_control_sample(BAT_TENSION_SPACE_PLANE, points, POINTS, &plan, NULL, lengths, samples));
        assert_memory_equal(samples, expected, n * sizeof *samples);
    }
}

/// On a circle lengths are angles.
static void start_and_jitter_do_as_they_say(void **state)
{
    (void)state;
    double points[2 * POINTS], lengths[POINTS + 1];
    size_t samples[20];
    for (size_t i = 0; i < POINTS; i++)
    {
        points[2 * i] = cos(2 * PI * (double)i / POINTS);
        points[2 * i + 1] = sin(2 * PI * (double)i / POINTS);
    }
    tension_control_plan turned = {.count = 20, .start = 0.93};
    assert_true(tension_control_sample(BAT_TENSION_SPACE_PLANE, points, POINTS, &turned, NULL, lengths, samples));
    for (size_t k = 0; k < 20; k++)
        assert_int_equal(samples[k], (930 + 50 * k) % POINTS);

    bat_random random = bat_random_seed(8);
    tension_control_plan uneven = {.count = 20, .start = 0.001, .jitter = 0.6};
    double low = 0, high = 0;
    for (int draw = 0; draw < 200; draw++)
    {
        assert_true(tension_control_sample(BAT_TENSION_SPACE_PLANE, points, POINTS, &uneven, &random, lengths, samples));
        for (size_t k = 0; k < 20; k++)
        {
            double moved = remainder((double)samples[k] - (1 + 50 * (double)k), POINTS) / 50;
            assert_true(moved >= -0.3 && moved <= 0.3 + 1.0 / 50);
            low = fmin(low, moved);
            high = fmax(high, moved);
        }
    }
    assert_true(low < -0.27 && high > 0.27);
}

static void unfit_neighbours_are_refused(void **state)
{
    (void)state;
    double lengths[9];
    size_t samples[4];
    tension_control_plan four = {.count = 4};
    // There and back: the second and the fourth coincide, but they are no neighbours; then neighbours do.
    const double back[] = {0, 0, 1, 0, 2, 0, 1, 0}, twice[] = {0, 0, 1, 0, 2, 0, 2, 0, 2, 0, 2, 0, 2, 1e-9, 1, 0};
    assert_true(tension_control_sample(BAT_TENSION_SPACE_PLANE, back, 4, &four, NULL, lengths, samples));
    tension_control_plan three = {.count = 3};
    const double triangle[] = {0, 0, 1, 0};
    assert_false(tension_control_sample(BAT_TENSION_SPACE_PLANE, triangle, 2, &three, NULL, lengths, samples));
    tension_control_plan eight = {.count = 8};
    size_t more[8];
    assert_false(tension_control_sample(BAT_TENSION_SPACE_PLANE, twice, 8, &eight, NULL, lengths, more));
    const double poles[] = {0, 0, 1, 0.01, 0, -0.99995, 1, 0, 0};
    assert_false(tension_control_sample(BAT_TENSION_SPACE_SPHERE, poles, 3, &three, NULL, lengths, samples));
}

static void check_control(bat_tension_space space, bool unseen, size_t family, bat_random *random, const double *points)
{
    (void)unseen;
    (void)family;
    double lengths[POINTS + 1];
    size_t samples[MAX_CONTROL];
    tension_control_plan plan = {.count = 4 + (size_t)(61 * bat_random_uniform(random)),
                                 .start = bat_random_uniform(random),
                                 .jitter = 0.9 * bat_random_uniform(random)};
    if (!tension_control_sample(space, points, POINTS, &plan, random, lengths, samples))
        return;
    size_t wraps = 0;
    for (size_t k = 0; k < plan.count; k++)
    {
        assert_in_range(samples[k], 0, POINTS - 1);
        wraps += samples[(k + 1) % plan.count] < samples[k];
    }
    assert_int_equal(wraps, 1);
}

static void control_points_follow_the_curve(void **state)
{
    (void)state;
    for_every_family(check_control);
}

static double total_turning(bat_tension_space space, const double *points)
{
    bat_space geometry = space_of(space);
    size_t dim = dim_of(space);
    double turning = 0;
    for (size_t i = 0; i < POINTS; i++)
        turning += fabs(geometry.exterior_angle(&geometry, points + (i + POINTS - 1) % POINTS * dim, points + i * dim,
                                                points + (i + 1) % POINTS * dim));
    return turning;
}

static void check_turning(bat_tension_space space, bool unseen, size_t family, bat_random *random, const double *points)
{
    (void)random;
    if (unseen && total_turning(space, points) > 7.5 * PI)
        fail_msg("%s turns by %g pi", tension_family_name(space, unseen, family), total_turning(space, points) / PI);
}

static void unseen_curves_turn_moderately(void **state)
{
    (void)state;
    for_every_family(check_turning);
}

/// The point at a signed distance from the middle of the space on the ray through `vertex`, which has distance `radius`.
static void on_ray(const bat_space *space, const double *middle, const double *vertex, double radius, double at,
                   double *point)
{
    assert_int_equal(bat_space_geodesic(space, middle, vertex, at / radius, point), BAT_OK);
}

/// The centre of a fillet at `vertex` lies on the corner's bisector, here a ray; it is as far from the arc's begin as from
/// its middle.
static void find_centre(const bat_space *space, const double *vertex, double radius, const double *begin, const double *apex,
                        double *centre)
{
    const double middle[3] = {0, 0, 1};
    double low = -0.5, high = radius;
    for (int i = 0; i < 60; i++)
    {
        double at = 0.5 * (low + high);
        on_ray(space, middle, vertex, radius, at, centre);
        *(space->distance(space, centre, begin) > space->distance(space, centre, apex) ? &high : &low) = at;
    }
}

static void fillets_are_circles_that_touch_the_edges(void **state)
{
    (void)state;
    enum
    {
        MANY = 3000
    };
    static double points[3 * MANY];
    const double radius = 0.9, share = 0.45;
    fillet_polygon polygon = {3, {radius, radius, radius}, {0, 2 * PI / 3, 4 * PI / 3}, {share, share, share}};
    for (int s = 0; s < BAT_TENSION_SPACE_COUNT; s++)
    {
        bat_tension_space kind = (bat_tension_space)s;
        bat_space space = space_of(kind);
        size_t dim = dim_of(kind);
        fillet_points(kind, &polygon, MANY, points);
        for (size_t i = 0; i < MANY; i++)
        {
            double angle = space.exterior_angle(&space, points + (i + MANY - 1) % MANY * dim, points + i * dim,
                                                points + (i + 1) % MANY * dim);
            assert_true(angle > -1e-9 && angle < 0.01);
        }
        const double corners[BAT_TENSION_SPACE_COUNT][2][3] = {
            {{radius, 0}, {-radius / 2, radius * sqrt(0.75)}},
            {{sin(radius), 0, cos(radius)}, {-sin(radius) / 2, sin(radius) * sqrt(0.75), cos(radius)}},
            {{tanh(radius / 2), 0}, {-tanh(radius / 2) / 2, tanh(radius / 2) * sqrt(0.75)}},
        };
        const double *vertex = corners[s][0];
        double reach = share * space.distance(&space, vertex, corners[s][1]), centre[3], apex[3];
        size_t arc = 0;
        while (space.distance(&space, vertex, points + arc * dim) < reach + 1e-12)
            arc++;
        assert_in_range(arc, MANY / 10, MANY / 3);
        check_near(space.distance(&space, vertex, points), reach, 1e-12);
        // Of the arc's points its middle one, up to half a step; the distance from the centre does not hang on it much.
        memcpy(apex, points + arc / 2 * dim, dim * sizeof *apex);
        find_centre(&space, vertex, radius, points, apex, centre);
        for (size_t i = 0; i < arc; i++)
            check_near(space.distance(&space, centre, points + i * dim), space.distance(&space, centre, points), 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_told_apart),
        cmocka_unit_test(points_lie_in_their_spaces),
        cmocka_unit_test(curves_are_closed_and_have_no_gaps),
        cmocka_unit_test(same_stream_same_curve),
        cmocka_unit_test(curves_do_not_depend_on_the_number_of_points),
        cmocka_unit_test(even_sampling_is_that_of_the_published_data),
        cmocka_unit_test(start_and_jitter_do_as_they_say),
        cmocka_unit_test(unfit_neighbours_are_refused),
        cmocka_unit_test(control_points_follow_the_curve),
        cmocka_unit_test(unseen_curves_turn_moderately),
        cmocka_unit_test(fillets_are_circles_that_touch_the_edges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

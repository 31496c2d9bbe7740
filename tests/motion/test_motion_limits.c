// New times within limits of speed and acceleration: the limits hold, the path stays, and known times are the least.

#include "check.h"

#include "batten/motion_spline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    DIM = 16,
    DENSE = 20011,
    PATH = 1000
};

static const double PI = 3.14159265358979323846;

static bat_motion_spline *make(const bat_space *space, double *points, double *times, size_t count, double period,
                               const bat_motion_spline_options *options)
{
    bat_motion_spline *spline = NULL;
    bat_error error = {.text = ""};
    bat_hermite_curve keys = {.space = space, .points = points, .times = times, .count = count, .closed = period > 0};
    keys.closing_time = period - (times[count - 1] - times[0]);
    bat_status status = bat_motion_spline_make(&keys, options, &spline, &error);
    if (status != BAT_OK)
        fail_msg("%s", error.text);
    return spline;
}

static double duration_of(const bat_motion_spline *spline)
{
    bat_motion_keys keys = bat_motion_spline_keys(spline);
    return keys.end - keys.begin;
}

/// The greatest speeds and accelerations at many times, of all or of both parts of a rigid motion, over their limits.
static double excess_of(const bat_motion_spline *spline, const bat_motion_spline_options *limits)
{
    bat_motion_keys keys = bat_motion_spline_keys(spline);
    const bat_space *space = keys.space;
    double point[DIM], v[DIM], a[DIM], excess = 0;
    bool rigid = strcmp(space->name, "rigid") == 0;
    for (size_t i = 0; i < DENSE; i++)
    {
        double time = fmin(keys.begin + (keys.end - keys.begin) * (double)i / (DENSE - 1), keys.end);
        assert_int_equal(bat_motion_spline_at(spline, time, point, v, a, NULL), BAT_OK);
        double speed = sqrt(rigid ? v[0] * v[0] + v[1] * v[1] + v[2] * v[2] : space->inner(space, point, v, v));
        double bend = sqrt(rigid ? a[0] * a[0] + a[1] * a[1] + a[2] * a[2] : space->inner(space, point, a, a));
        double turn = rigid ? sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]) : 0;
        double twist = rigid ? sqrt(a[3] * a[3] + a[4] * a[4] + a[5] * a[5]) : 0;
        excess = limits->max_speed > 0 ? fmax(excess, speed / limits->max_speed) : excess;
        excess = limits->max_acceleration > 0 ? fmax(excess, bend / limits->max_acceleration) : excess;
        excess = limits->max_angular_speed > 0 ? fmax(excess, turn / limits->max_angular_speed) : excess;
        excess = limits->max_angular_acceleration > 0 ? fmax(excess, twist / limits->max_angular_acceleration) : excess;
    }
    return excess;
}

/// A line of length 5: accelerate, go on, brake.
static void a_line_is_gone_by_the_clock(void **state)
{
    (void)state;
    const bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 3, 4}, times[] = {7, 9};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.max_acceleration = 2;
    bat_motion_spline *spline = make(&plane, points, times, 2, 0, &options);
    check_near(duration_of(spline), 2 * sqrt(5.0 / 2), 1e-6);
    double point[2], v[2], a[2], half = duration_of(spline) / 2;
    assert_int_equal(bat_motion_spline_at(spline, 7 + 0.3 * half, point, v, a, NULL), BAT_OK);
    check_near(hypot(point[0], point[1]), 0.09 * half * half, 1e-6);
    check_near(hypot(v[0], v[1]), 0.6 * half, 1e-6);
    check_near(hypot(a[0], a[1]), 2, 1e-6);
    bat_motion_spline_free(spline);
    options.max_speed = 3;
    spline = make(&plane, points, times, 2, 0, &options);
    check_near(duration_of(spline), 5.0 / 3 + 3.0 / 2, 1e-5);
    bat_motion_spline_free(spline);
    options.max_acceleration = 0;
    spline = make(&plane, points, times, 2, 0, &options);
    check_near(duration_of(spline), 5.0 / 3, 1e-6);
    bat_motion_spline_free(spline);
}

/// A circle of radius 2 has the constant speed of its centripetal acceleration; a turn about an axis goes like a line.
static void circles_and_turns_have_known_times(void **state)
{
    (void)state;
    enum
    {
        KEYS = 64
    };
    const bat_space plane = bat_euclidean(2);
    double points[2 * KEYS], times[KEYS];
    for (size_t i = 0; i < KEYS; i++)
    {
        times[i] = (double)i + 0.3 * sin((double)i);
        points[2 * i] = 2 * cos(2 * PI * times[i] / KEYS);
        points[2 * i + 1] = 2 * sin(2 * PI * times[i] / KEYS);
    }
    bat_motion_spline_options options = bat_motion_spline_defaults();
    options.max_acceleration = 0.5;
    bat_motion_spline *spline = make(&plane, points, times, KEYS, KEYS, &options);
    check_near(duration_of(spline), 4 * PI, 0.02); // the spline is no exact circle
    assert_true(excess_of(spline, &options) <= 1 + 1e-6);
    bat_motion_spline_free(spline);
    const bat_space rotation = bat_rotation();
    double turns[] = {1, 0, 0, 0, cos(0.75), 0, 0, sin(0.75), cos(1.5), 0, 0, sin(1.5)};
    options.max_acceleration = 2;
    options.max_speed = 1.5;
    spline = make(&rotation, turns, (double[]){0, 1, 2}, 3, 0, &options);
    check_near(duration_of(spline), 3 / 1.5 + 1.5 / 2, 1e-5);
    bat_motion_spline_free(spline);
}

static bat_space any_space(void)
{
    // The functions of rotations without their name: derivatives by differences.
    static bat_space any;
    any = bat_sphere(2);
    any.name = "own";
    return any;
}

static void limits_hold_in_every_space(void **state)
{
    (void)state;
    bat_space rigid, spaces[] = {bat_euclidean(1), bat_euclidean(3),         bat_rotation(), bat_sphere(2),
                                 bat_disk(),       bat_positive_definite(2), any_space(),    {0}};
    assert_int_equal(bat_rigid(1, &rigid, NULL), BAT_OK);
    spaces[7] = rigid;
    bat_random random = bat_random_seed(11);
    for (size_t s = 0; s < sizeof spaces / sizeof *spaces; s++)
        for (size_t round = 0; round < 6; round++)
        {
            const bat_space *space = &spaces[s];
            double points[12 * DIM], times[12], goal[DIM], centre[DIM], way[DIM];
            size_t count = 3 + 2 * round % 9, dim = space->point_dim;
            bool closed = round % 3 == 2;
            space->random_point(space, &random, centre);
            for (size_t i = 0; i < count; i++)
            {
                times[i] = (i > 0 ? times[i - 1] : 0) + 0.2 + bat_random_uniform(&random);
                space->random_point(space, &random, goal);
                assert_int_equal(space->log(space, centre, goal, way), BAT_OK);
                for (size_t c = 0; c < space->tangent_dim; c++)
                    way[c] *= 0.4;
                assert_int_equal(space->exp(space, centre, way, points + i * dim), BAT_OK);
                if (i == 2 && round == 4) // a rest
                    memcpy(points + i * dim, points + (i - 1) * dim, dim * sizeof *points);
            }
            bat_motion_spline_options options = bat_motion_spline_defaults();
            double period = closed ? times[count - 1] - times[0] + 0.7 : 0;
            bat_motion_spline *given = make(space, points, times, count, period, &options);
            options.max_speed = round % 2 == 0 ? 0.7 : 0;
            options.max_acceleration = round != 2 ? 0.9 : 0;
            options.max_angular_acceleration = s == 7 && round > 2 ? 0.4 : 0;
            options.max_angular_speed = s == 7 && round > 1 ? 0.3 : 0;
            bat_motion_spline *spline = make(space, points, times, count, period, &options);
            double excess = excess_of(spline, &options);
            if (!(excess <= 1 + 1e-6) || !(excess > 0.999))
                fail_msg("%s, round %zu: %.9f", space->name, round, excess);
            bat_motion_keys keys = bat_motion_spline_keys(spline), old = bat_motion_spline_keys(given);
            static double polygon[(PATH + 1) * DIM];
            double point[DIM], v[DIM], later[DIM], log[DIM], longest = 0;
            for (size_t k = 0; k <= PATH; k++)
            {
                double at = fmin(old.begin + (old.end - old.begin) * (double)k / PATH, old.end);
                assert_int_equal(bat_motion_spline_at(given, at, polygon + k * dim, NULL, NULL, NULL), BAT_OK);
                longest = k > 0 ? fmax(longest, space->distance(space, polygon + (k - 1) * dim, polygon + k * dim)) : 0;
            }
            for (size_t i = 0; i < count; i++)
            {
                assert_int_equal(bat_motion_spline_at(spline, keys.times[i], point, NULL, NULL, NULL), BAT_OK);
                assert_memory_equal(point, keys.points + i * dim, dim * sizeof *point);
            }
            // The path is that of the given motion.
            for (size_t i = 0; i < 50; i++)
            {
                double nearest = INFINITY, time = keys.begin + (keys.end - keys.begin) * (double)i / 50;
                assert_int_equal(bat_motion_spline_at(spline, time, point, v, NULL, NULL), BAT_OK);
                for (size_t k = 0; k <= PATH; k++)
                    nearest = fmin(nearest, space->distance(space, point, polygon + k * dim));
                assert_true(nearest <= longest);
                // Velocities are the derivatives of the points.
                double step = 1e-6 * (keys.end - keys.begin);
                assert_int_equal(bat_motion_spline_at(spline, time + step, later, NULL, NULL, NULL), BAT_OK);
                assert_int_equal(space->log(space, point, later, log), BAT_OK);
                for (size_t c = 0; c < space->tangent_dim; c++)
                    check_near(log[c] / step, v[c], 1e-3);
            }
            bat_motion_spline_free(given);
            bat_motion_spline_free(spline);
        }
}

static void bad_limits_are_refused(void **state)
{
    (void)state;
    const bat_space plane = bat_euclidean(2);
    double points[] = {0, 0, 3, 4}, times[] = {0, 1};
    bat_hermite_curve keys = {.space = &plane, .points = points, .times = times, .count = 2};
    bat_motion_spline_options options = bat_motion_spline_defaults();
    bat_motion_spline *spline = NULL;
    bat_error error;
    options.max_speed = -1;
    assert_int_equal(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    options.max_speed = 0;
    options.max_angular_speed = 1;
    assert_int_equal(bat_motion_spline_make(&keys, &options, &spline, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "max_angular_speed"));
    assert_null(spline);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_is_gone_by_the_clock),
        cmocka_unit_test(circles_and_turns_have_known_times),
        cmocka_unit_test(limits_hold_in_every_space),
        cmocka_unit_test(bad_limits_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

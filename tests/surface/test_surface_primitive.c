// Simple shapes that points lie on: exact and noisy ones come back, others are not told.
#include "check.h"

#include "batten/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    COUNT = 1200
};

/// A turned frame, and a place far from the origin.
static const double FRAME[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}, ORIGIN[3] = {100, -40, 7};

/// Points of a shape in its own frame, for u and v in [-1, 1].
typedef void shape_points(double u, double v, double at[3]);

static void plane(double u, double v, double at[3])
{
    memcpy(at, (const double[3]){u, v, 0}, 3 * sizeof *at);
}

static void sphere(double u, double v, double at[3])
{
    memcpy(at, (const double[3]){sin(u) * cos(v), sin(v), cos(u) * cos(v)}, 3 * sizeof *at);
}

/// One axis is longer by a hundredth.
static void ellipsoid(double u, double v, double at[3])
{
    sphere(u, v, at);
    at[0] *= 1.01;
}

static void cylinder(double u, double v, double at[3])
{
    memcpy(at, (const double[3]){cos(u), sin(u), v}, 3 * sizeof *at);
}

/// With its apex at (0, 0, -2) and half an angle of 0.4.
static void cone(double u, double v, double at[3])
{
    double radius = tan(0.4) * (2 + v);
    memcpy(at, (const double[3]){radius * cos(u), radius * sin(u), v}, 3 * sizeof *at);
}

/// Flat, as a countersink, with its apex at the origin and half an angle of 1.25.
static void flat_cone(double u, double v, double at[3])
{
    double radius = 1.5 + v, height = radius / tan(1.25);
    memcpy(at, (const double[3]){radius * cos(2 * u), radius * sin(2 * u), height}, 3 * sizeof *at);
}

static void bump(double u, double v, double at[3])
{
    memcpy(at, (const double[3]){u, v, 0.3 * exp(-2 * (u * u + v * v))}, 3 * sizeof *at);
}

/// A cloud of a shape with noise. Release it with free(cloud.points).
static bat_cloud make(shape_points *shape, double size, double noise, uint64_t seed)
{
    bat_random random = bat_random_seed(seed);
    bat_cloud cloud = {.points = malloc(COUNT * 3 * sizeof(double)), .count = COUNT};
    assert_non_null(cloud.points);
    for (size_t i = 0; i < COUNT; i++)
    {
        double at[3];
        shape(2 * bat_random_uniform(&random) - 1, 2 * bat_random_uniform(&random) - 1, at);
        for (size_t c = 0; c < 3; c++)
            cloud.points[3 * i + c] = size * (ORIGIN[c] + FRAME[0][c] * at[0] + FRAME[1][c] * at[1] + FRAME[2][c] * at[2]) +
                                      size * noise * bat_random_normal(&random);
    }
    return cloud;
}

static bat_surface_primitive find(shape_points *shape, double size, double noise, uint64_t seed)
{
    bat_surface_primitive found;
    const bat_surface_result result = {.noise = size * noise};
    bat_cloud cloud = make(shape, size, noise, seed);
    check_status(bat_surface_find_primitive(&cloud, &result, &found, NULL), BAT_OK);
    free(cloud.points);
    return found;
}

/// The distance of the place from that of the shape, along its axis or not, in units of the size.
static double off_axis(const bat_surface_primitive *found, double size)
{
    double from[3], along = 0, squared = 0;
    for (int c = 0; c < 3; c++)
    {
        from[c] = found->place[c] / size - ORIGIN[c];
        along += from[c] * FRAME[2][c];
        squared += from[c] * from[c];
    }
    return sqrt(fmax(squared - along * along, 0));
}

/// The sine of the angle between the axes.
static double tilt(const bat_surface_primitive *found)
{
    double along = 0;
    for (int c = 0; c < 3; c++)
        along += found->axis[c] * FRAME[2][c];
    return sqrt(fmax(1 - along * along, 0));
}

static void exact_shapes_come_back(void **state)
{
    (void)state;
    for (double size = 1e-3; size < 1e4; size *= 1e3)
    {
        bat_surface_primitive found = find(plane, size, 0, 1);
        assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_PLANE);
        assert_true(tilt(&found) < 1e-7 && isnan(found.radius) && isnan(found.angle));
        found = find(sphere, size, 0, 2);
        assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_SPHERE);
        check_near(found.radius / size, 1, 1e-9);
        assert_true(off_axis(&found, size) < 1e-9);
        found = find(cylinder, size, 0, 3);
        assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_CYLINDER);
        check_near(found.radius / size, 1, 1e-9);
        assert_true(off_axis(&found, size) < 1e-7 && tilt(&found) < 1e-7);
        found = find(cone, size, 0, 4);
        assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_CONE);
        check_near(found.angle, 0.4, 1e-9);
        assert_true(off_axis(&found, size) < 1e-7 && tilt(&found) < 1e-7);
        for (int c = 0; c < 3; c++)
            check_near(found.place[c] / size, ORIGIN[c] - 2 * FRAME[2][c], 1e-7);
        found = find(flat_cone, size, 0, 5);
        assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_CONE);
        check_near(found.angle, 1.25, 1e-9);
    }
}

/// Radii and angles of noisy shapes are within four of their standard deviations, which are not much too large.
static void deviations_are_those_of_repetitions(void **state)
{
    (void)state;
    enum
    {
        SEEDS = 12
    };
    static shape_points *const SHAPES[] = {sphere, cylinder, cone};
    for (size_t k = 0; k < 3; k++)
    {
        double squares = 0;
        for (uint64_t seed = 10; seed < 10 + SEEDS; seed++)
        {
            bat_surface_primitive found = find(SHAPES[k], 1, 0.005, seed);
            assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_SPHERE + (int)k);
            double error = k < 2 ? (found.radius - 1) / found.radius_deviation : (found.angle - 0.4) / found.angle_deviation;
            assert_true(fabs(error) < 4);
            squares += error * error;
            check_near(found.rms, 0.005, 5e-4);
            if (k > 0)
                assert_true(tilt(&found) < 4 * found.axis_deviation);
        }
        assert_true(squares / SEEDS > 0.3 && squares / SEEDS < 3);
    }
}

/// What differs from a shape by more than the noise tells is not one; what differs by less may be.
static void near_misses_are_not_told(void **state)
{
    (void)state;
    for (uint64_t seed = 30; seed < 36; seed++)
    {
        assert_int_equal(find(ellipsoid, 1, 0.0005, seed).kind, BAT_SURFACE_PRIMITIVE_NONE);
        assert_int_equal(find(bump, 1, 0.01, seed).kind, BAT_SURFACE_PRIMITIVE_NONE);
    }
    assert_int_equal(find(ellipsoid, 1, 0, 36).kind, BAT_SURFACE_PRIMITIVE_NONE);
    assert_int_equal(find(ellipsoid, 1, 0.03, 37).kind, BAT_SURFACE_PRIMITIVE_SPHERE);
}

/// All points lie on a shape, or none is told; a dozen tell nothing.
static void outliers_and_few_points_tell_none(void **state)
{
    (void)state;
    const bat_surface_result result = {.noise = 0.005};
    bat_surface_primitive found;
    bat_cloud cloud = make(plane, 1, 0.005, 40);
    check_status(bat_surface_find_primitive(&cloud, &result, &found, NULL), BAT_OK);
    assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_PLANE);
    for (size_t c = 0; c < 3; c++)
        cloud.points[300 + c] += 0.06 * FRAME[2][c];
    check_status(bat_surface_find_primitive(&cloud, &result, &found, NULL), BAT_OK);
    assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_NONE);
    cloud.count = 12;
    check_status(bat_surface_find_primitive(&cloud, &result, &found, NULL), BAT_OK);
    assert_int_equal(found.kind, BAT_SURFACE_PRIMITIVE_NONE);
    free(cloud.points);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_shapes_come_back),
        cmocka_unit_test(deviations_are_those_of_repetitions),
        cmocka_unit_test(near_misses_are_not_told),
        cmocka_unit_test(outliers_and_few_points_tell_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

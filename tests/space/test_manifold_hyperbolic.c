#include "manifold_checks.h"

#include "reference/manifold_reference.h"

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

static void identities_hold(void **state)
{
    (void)state;
    const struct
    {
        size_t dimension;
        double reach, rounding;
    } cases[] = {{1, 3, 4e-14}, {2, 3, 6e-14}, {3, 3, 6e-14}, {3, 0.3, 1e-14}, {10, 3, 6e-14}, {40, 3, 6e-14}};
    for (size_t i = 0; i < COUNT_OF(cases); i++)
    {
        bat_space space = bat_hyperbolic(cases[i].dimension);
        manifold_check(&(manifold_case){.space = &space,
                                        .seed = 10 * (uint64_t)i,
                                        .trials = 500,
                                        .reach = cases[i].reach,
                                        .rounding = cases[i].rounding});
    }
}

/// What the rounding of the coordinates does to distances at a radius.
static double rounding_at(double radius)
{
    return 1.1e-16 * exp(radius);
}

static void meets_reference(void **state)
{
    (void)state;
    bat_space space = bat_hyperbolic(3);
    for (size_t i = 0; i < COUNT_OF(HYPERBOLIC_REFERENCE); i++)
    {
        const hyperbolic_reference *r = &HYPERBOLIC_REFERENCE[i];
        double v[3], d = r->distance;
        double tolerance = fmin(1e-14 + 8 * rounding_at(r->radius), d > 10 ? 1e-13 : INFINITY);
        check_relative(space.distance(&space, r->p, r->q), d, tolerance);
        check_relative(space.distance(&space, r->q, r->p), d, tolerance);
        check_status(space.log(&space, r->p, r->q, v), BAT_OK);
        check_relative(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), d, tolerance);
        for (int k = 0; k < 3; k++)
            check_near(v[k], r->log[k], 4 * tolerance * d);
        const double u[3] = {0.3, -0.7, 0.2};
        check_status(space.transport(&space, r->p, r->q, u, v), BAT_OK);
        for (int k = 0; k < 3; k++)
            check_near(v[k], r->transported[k], 4 * tolerance);
    }
}

static void place(const double *direction, double radius, double *point)
{
    point[0] = cosh(radius);
    for (int i = 0; i < 3; i++)
        point[i + 1] = sinh(radius) * direction[i];
}

/// From the apex lengths keep their relative accuracy as far as numbers go; between far points, that of their coordinates.
static void far_points_are_reached(void **state)
{
    (void)state;
    bat_space space = bat_hyperbolic(3);
    const double apex[4] = {1, 0, 0, 0}, out[3] = {0.6, 0, 0.8}, back[3] = {-0.6, 0, -0.8}, aside[3] = {0.8, 0, -0.6};
    double p[4], q[4], r[4], v[3];
    for (double radius = 0.5; radius <= 340; radius += 0.5)
    {
        place(out, radius, p);
        assert_null(space.fault(&space, p));
        check_relative(space.distance(&space, apex, p), radius, 4e-16 * (1 + radius));
        check_status(space.log(&space, p, apex, v), BAT_OK);
        check_near(v[0], -0.6 * radius, 1e-14 * radius);
        for (int i = 0; i < 3; i++)
            v[i] = radius * out[i];
        check_status(space.exp(&space, apex, v, q), BAT_OK);
        check_relative(q[3], p[3], 1e-15 * (1 + radius));
        // straight through the apex, and by the sides of a right angle there
        place(back, radius, q);
        check_relative(space.distance(&space, p, q), 2 * radius, 1e-15 * (1 + radius));
        check_status(space.geodesic(&space, p, q, 0.5, r), BAT_OK);
        check_near(space.distance(&space, r, apex), 0, 1e-15);
        place(aside, radius, q);
        check_near(space.distance(&space, p, q), 2 * asinh(sinh(radius) * sqrt(0.5)), 1e-15 * (1 + radius));
        check_status(space.geodesic(&space, p, q, 0.5, r), BAT_OK);
        check_near(space.distance(&space, p, r), space.distance(&space, r, q), 1e-14 * (1 + radius));
        check_near(2 * space.distance(&space, p, r), space.distance(&space, p, q), 1e-14 * (1 + radius));
    }
    for (double radius = 1; radius <= 15; radius += 0.5)
    {
        place(out, radius, p);
        const double step[3] = {0.01, 0.02, -0.02};
        check_status(space.exp(&space, p, step, q), BAT_OK);
        check_near(space.distance(&space, p, q), 0.03, 8 * rounding_at(radius));
        check_status(space.log(&space, p, q, v), BAT_OK);
        for (int i = 0; i < 3; i++)
            check_near(v[i], step[i], 8 * rounding_at(radius));
        // home again
        check_status(space.log(&space, p, apex, v), BAT_OK);
        check_status(space.exp(&space, p, v, q), BAT_OK);
        check_near(space.distance(&space, q, apex), 0, 8 * rounding_at(radius));
    }
}

/// For n = 2 the space is the disk: z = x / (1 + x0), with the same frames.
static void dimension_two_is_the_disk(void **state)
{
    (void)state;
    bat_space space = bat_hyperbolic(2), disk = bat_disk();
    bat_random random = bat_random_seed(50);
    for (int trial = 0; trial < 500; trial++)
    {
        double p[3], q[3], z[2], w[2], v[2], expected[2], u[2] = {0.3, -0.4};
        space.random_point(&space, &random, p);
        space.random_point(&space, &random, q);
        for (int i = 0; i < 2; i++)
        {
            z[i] = p[i + 1] / (1 + p[0]);
            w[i] = q[i + 1] / (1 + q[0]);
        }
        double scale = 1e-15 * (p[0] + q[0]) * (p[0] + q[0]);
        check_near(space.distance(&space, p, q), disk.distance(&disk, z, w), scale);
        check_status(space.log(&space, p, q, v), BAT_OK);
        check_status(disk.log(&disk, z, w, expected), BAT_OK);
        check_near(v[0], expected[0], 4 * scale);
        check_near(v[1], expected[1], 4 * scale);
        check_status(space.transport(&space, p, q, u, v), BAT_OK);
        check_status(disk.transport(&disk, z, w, u, expected), BAT_OK);
        check_near(v[0], expected[0], 4 * scale);
        check_near(v[1], expected[1], 4 * scale);
        check_status(space.exp(&space, p, u, q), BAT_OK);
        check_status(disk.exp(&disk, z, u, w), BAT_OK);
        check_near(q[1] / (1 + q[0]), w[0], 4 * scale);
        check_near(q[2] / (1 + q[0]), w[1], 4 * scale);
    }
}

static void boost(double rapidity, int axis, const double *p, double *image)
{
    memcpy(image, p, 4 * sizeof *p);
    image[0] = cosh(rapidity) * p[0] + sinh(rapidity) * p[axis];
    image[axis] = sinh(rapidity) * p[0] + cosh(rapidity) * p[axis];
}

/// Boosts keep distances, and angles between what log and transport give.
static void lorentz_maps_change_nothing(void **state)
{
    (void)state;
    bat_space space = bat_hyperbolic(3);
    bat_random random = bat_random_seed(51);
    for (int trial = 0; trial < 500; trial++)
    {
        double x[3][4], y[3][4], v[3], w[3], moved[3], gram[2][2];
        for (int k = 0; k < 3; k++)
        {
            double once[4];
            space.random_point(&space, &random, x[k]);
            boost(0.7, 1, x[k], once);
            boost(-1.1, 2 + trial % 2, once, y[k]);
        }
        check_near(space.distance(&space, x[0], x[1]), space.distance(&space, y[0], y[1]), 1e-12);
        for (int k = 0; k < 2; k++)
        {
            double(*z)[4] = k == 0 ? x : y;
            check_status(space.log(&space, z[0], z[1], v), BAT_OK);
            check_status(space.log(&space, z[0], z[2], w), BAT_OK);
            gram[k][0] = space.inner(&space, z[0], v, w);
            check_status(space.transport(&space, z[0], z[1], w, moved), BAT_OK);
            check_status(space.log(&space, z[1], z[2], v), BAT_OK);
            gram[k][1] = space.inner(&space, z[1], v, moved);
        }
        check_near(gram[0][0], gram[1][0], 1e-11);
        check_near(gram[0][1], gram[1][1], 1e-11);
    }
}

static void points_off_the_hyperboloid_are_brought_onto_it(void **state)
{
    (void)state;
    bat_space space = bat_hyperbolic(3);
    bat_random random = bat_random_seed(52);
    for (int trial = 0; trial < 500; trial++)
    {
        double p[4], off[4], near[4], shift = 0.5 * (bat_random_uniform(&random) - 0.5);
        space.random_point(&space, &random, p);
        // along the Euclidean normal (x0, -x)
        double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
        for (int i = 0; i < 4; i++)
            off[i] = p[i] + (i == 0 ? -1 : 1) * shift * p[i] / length;
        check_status(space.project(&space, off, near), BAT_OK);
        assert_null(space.fault(&space, near));
        for (int i = 0; i < 4; i++)
            check_near(near[i], p[i], 1e-13);
        check_status(space.project(&space, p, p), BAT_OK);
    }
    double apex[4] = {1, 0, 0, 0}, above[4] = {1.5, 0, 0, 0}, high[4] = {3, 0, 0, 0}, infinite[4] = {INFINITY, 0, 0, 0},
           p[4];
    double far[4] = {1e200, 1e200, 0, 0}, below[4] = {-4, 1, 0, 0}, bad[4] = {2, 1, 0, 0}, lost[4] = {NAN, 0, 0, 0};
    assert_null(space.fault(&space, apex));
    assert_string_equal(space.fault(&space, bad), "not on the hyperboloid");
    assert_string_equal(space.fault(&space, far), "too far from the apex");
    assert_string_equal(space.fault(&space, infinite), "not finite");
    assert_string_equal(space.fault(&space, lost), "not finite");
    check_status(space.project(&space, above, p), BAT_OK);
    assert_memory_equal(p, apex, sizeof p);
    check_status(space.project(&space, below, p), BAT_OK);
    assert_null(space.fault(&space, p));
    check_status(space.project(&space, high, p), BAT_INVALID_POINT);
    check_status(space.project(&space, infinite, p), BAT_INVALID_POINT);
    double long_way[3] = {350, 0, 0}, longer[3] = {1e300, 0, 0};
    check_status(space.exp(&space, apex, long_way, p), BAT_INVALID_POINT);
    check_status(space.exp(&space, apex, longer, p), BAT_INVALID_POINT);
    bat_space none = bat_hyperbolic(0), huge = bat_hyperbolic(5000);
    assert_int_equal(none.dimension, 1);
    assert_int_equal(huge.point_dim, BAT_SPACE_MAX_DIM);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identities_hold),
        cmocka_unit_test(meets_reference),
        cmocka_unit_test(far_points_are_reached),
        cmocka_unit_test(dimension_two_is_the_disk),
        cmocka_unit_test(lorentz_maps_change_nothing),
        cmocka_unit_test(points_off_the_hyperboloid_are_brought_onto_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "check.h"

#include "batten/space.h"
#include "reference/space_reference.h"

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

/// What the rounding of the coordinates of a point of the disk alone does to hyperbolic lengths there.
static double disk_rounding(const double *z)
{
    return 1.1e-16 * 2 / (1 - z[0] * z[0] - z[1] * z[1]);
}

static double length(const bat_space *space, const double *p, const double *v)
{
    return sqrt(space->inner(space, p, v, v));
}

static void sphere_meets_reference(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    for (size_t i = 0; i < COUNT_OF(SPHERE_REFERENCE); i++)
    {
        const double *p = SPHERE_REFERENCE[i].p, *q = SPHERE_REFERENCE[i].q;
        double d = SPHERE_REFERENCE[i].distance, v[3];
        check_relative(sphere.distance(&sphere, p, q), d, 1e-13);
        check_status(sphere.log(&sphere, p, q, v), BAT_OK);
        // Near the antipode the direction is known only as well as the coordinates fix it.
        double direction = fmax(1e-13, 4e-16 / fabs(sin(d)));
        for (int k = 0; k < 3; k++)
            check_near(v[k], SPHERE_REFERENCE[i].log[k], d * (d > 3 ? direction : 1e-13));
        check_relative(length(&sphere, p, v), d, 1e-13);
    }
}

static void disk_meets_reference(void **state)
{
    (void)state;
    bat_space disk = bat_disk();
    for (size_t i = 0; i < COUNT_OF(DISK_REFERENCE); i++)
    {
        const double *p = DISK_REFERENCE[i].p, *q = DISK_REFERENCE[i].q;
        double d = DISK_REFERENCE[i].distance, v[2];
        check_relative(disk.distance(&disk, p, q), d, 1e-13);
        check_status(disk.log(&disk, p, q, v), BAT_OK);
        for (int k = 0; k < 2; k++)
            check_near(v[k], DISK_REFERENCE[i].log[k], d * (1e-13 + 4 * disk_rounding(p)));
    }
}

/// Random pairs at all separations, a fraction of them tiny.
static void random_pair(const bat_space *space, bat_random *random, double *p, double *q)
{
    double v[BAT_SPACE_MAX_DIM];
    space->random_point(space, random, p);
    do
    {
        space->random_point(space, random, q);
    } while (space->log(space, p, q, v) != BAT_OK);
    double shrink = pow(10, -8 * bat_random_uniform(random) * (bat_random_bits(random) & 1 ? 1 : 0));
    for (size_t i = 0; i < space->tangent_dim; i++)
        v[i] *= shrink;
    assert_int_equal(space->exp(space, p, v, q), BAT_OK);
}

static void check_identities(const bat_space *space, uint64_t seed, double scale)
{
    bat_random random = bat_random_seed(seed);
    double p[8], q[8], r[8], v[8], w[8], u[8], tu[8], tw[8];
    for (int trial = 0; trial < 500; trial++)
    {
        random_pair(space, &random, p, q);
        assert_null(space->fault(space, p));
        assert_null(space->fault(space, q));
        double d = space->distance(space, p, q);
        double allowance = 4e-15 * scale;
        check_near(space->distance(space, q, p), d, 1e-15 * scale * (1 + d));
        check_status(space->log(space, p, q, v), BAT_OK);
        check_near(length(space, p, v), d, allowance * (1 + d));
        // exp inverts log to the rounding of the coordinates
        check_status(space->exp(space, p, v, r), BAT_OK);
        check_near(space->distance(space, q, r), 0, allowance * (1 + d));
        // transport keeps inner products, takes the velocity along the geodesic, and comes back
        check_status(space->log(space, q, p, w), BAT_OK);
        check_status(space->transport(space, p, q, v, tw), BAT_OK);
        for (size_t i = 0; i < space->tangent_dim; i++)
            check_near(tw[i], -w[i], 1e-14 * scale * (1 + d) * (d > 2.5 ? 50 : 1));
        random_pair(space, &random, p, r);
        check_status(space->log(space, p, r, u), BAT_OK);
        if (space->log(space, p, q, v) != BAT_OK || space->transport(space, p, q, u, tu) != BAT_OK)
            continue;
        check_status(space->transport(space, p, q, v, tw), BAT_OK);
        double uv = space->inner(space, p, u, v);
        check_near(space->inner(space, q, tu, tw), uv, 1e-13 * scale * (1 + fabs(uv)));
        check_status(space->transport(space, q, p, tu, u), BAT_OK);
        check_status(space->log(space, p, r, w), BAT_OK);
        for (size_t i = 0; i < space->tangent_dim; i++)
            check_near(u[i], w[i], 1e-13 * scale * (1 + fabs(w[i])));
        // the geodesic's share of the distance
        double t = bat_random_uniform(&random);
        d = space->distance(space, p, q);
        check_status(bat_space_geodesic(space, p, q, t, r), BAT_OK);
        check_near(space->distance(space, p, r), t * d, allowance * (1 + d));
        check_near(space->distance(space, r, q), (1 - t) * d, allowance * (1 + d));
    }
}

static void identities_hold(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), space5 = bat_euclidean(5), circle = bat_sphere(1), sphere = bat_sphere(2),
              sphere4 = bat_sphere(4), disk = bat_disk();
    check_identities(&plane, 1, 1);
    check_identities(&space5, 2, 1);
    check_identities(&circle, 3, 1);
    check_identities(&sphere, 4, 1);
    check_identities(&sphere4, 5, 1);
    check_identities(&disk, 6, 50); // random points reach radius 3, where coordinates are 20 times finer than lengths
}

static void disk_is_accurate_near_the_rim(void **state)
{
    (void)state;
    bat_space disk = bat_disk();
    for (double radius = 1; radius <= 15; radius += 0.5)
    {
        double p[2] = {tanh(radius / 2) * cos(radius), tanh(radius / 2) * sin(radius)}, origin[2] = {0, 0}, v[2], q[2];
        double unit = disk_rounding(p);
        check_near(disk.distance(&disk, origin, p), radius, 4 * unit + 1e-15 * radius);
        check_status(disk.log(&disk, p, origin, v), BAT_OK);
        check_status(disk.exp(&disk, p, v, q), BAT_OK);
        check_near(disk.distance(&disk, q, origin), 0, 8 * unit);
        // a step outwards and back, at the accuracy of the farther point
        double step[2] = {0.01, -0.02};
        check_status(disk.exp(&disk, p, step, q), BAT_OK);
        check_near(disk.distance(&disk, p, q), hypot(0.01, 0.02), 8 * disk_rounding(q));
        check_status(disk.log(&disk, p, q, v), BAT_OK);
        check_near(v[0], 0.01, 8 * disk_rounding(q));
        check_near(v[1], -0.02, 8 * disk_rounding(q));
    }
}

/// Between points near the rim, on the same side and on opposite ones, to what the coordinates of the ends allow.
static void disk_geodesics_reach_their_ends(void **state)
{
    (void)state;
    bat_space disk = bat_disk();
    bat_random random = bat_random_seed(8);
    for (int trial = 0; trial < 2000; trial++)
    {
        double radius = 15 * bat_random_uniform(&random), p[2], q[2], r[2], v[2];
        double a = 6.283185307179586 * bat_random_uniform(&random), b = 6.283185307179586 * bat_random_uniform(&random);
        b = trial % 4 == 0 ? a + 1e-6 * b : b;
        p[0] = tanh(radius / 2) * cos(a), p[1] = tanh(radius / 2) * sin(a);
        q[0] = tanh(radius / 2) * cos(b), q[1] = tanh(radius / 2) * sin(b);
        double unit = disk_rounding(p) + 1e-15, d = disk.distance(&disk, p, q), share = bat_random_uniform(&random);
        check_status(bat_space_geodesic(&disk, p, q, 1, r), BAT_OK);
        check_near(disk.distance(&disk, r, q), 0, 4 * unit);
        check_status(bat_space_geodesic(&disk, p, q, 0, r), BAT_OK);
        check_near(disk.distance(&disk, r, p), 0, 4 * unit);
        check_status(bat_space_geodesic(&disk, p, q, share, r), BAT_OK);
        check_near(disk.distance(&disk, p, r), share * d, 16 * unit * (1 + d));
        check_near(disk.distance(&disk, r, q), (1 - share) * d, 16 * unit * (1 + d));
        // exp keeps the length of the tangent however far it goes
        check_status(disk.log(&disk, p, q, v), BAT_OK);
        check_status(disk.exp(&disk, p, v, r), BAT_OK);
        check_near(disk.distance(&disk, p, r), d, 16 * unit * (1 + d));
    }
}

static void cut_locus_is_a_status(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2);
    double p[3] = {0, 0, 1}, antipode[3] = {0, 0, -1}, v[3] = {7, 7, 7}, near[3];
    check_status(sphere.log(&sphere, p, antipode, v), BAT_CUT_LOCUS);
    check_status(sphere.transport(&sphere, p, antipode, p, v), BAT_CUT_LOCUS);
    check_near(sphere.distance(&sphere, p, antipode), 3.14159265358979323846, 1e-15);
    double off[3] = {1e-8, 0, -1};
    check_status(sphere.project(&sphere, off, near), BAT_OK);
    check_status(sphere.log(&sphere, p, near, v), BAT_OK);
    check_near(v[0], 3.14159265358979323846 - 1e-8, 1e-13);
    check_near(v[1], 0, 1e-13);
}

static void points_outside_are_found(void **state)
{
    (void)state;
    bat_space sphere = bat_sphere(2), disk = bat_disk(), plane = bat_euclidean(2);
    double points[6] = {0, 0, 1, 0, 0, 1.001};
    bat_error error;
    check_status(bat_space_check(&sphere, points, 2, &error), BAT_INVALID_POINT);
    assert_int_equal(error.index, 1);
    assert_non_null(strstr(error.text, "unit length"));
    double rim[2] = {0.6, 0.8}, inside[2] = {0.6, nextafter(0.8, 0)}, outside[2] = {2, 0}, nan_point[2] = {NAN, 0};
    assert_non_null(disk.fault(&disk, rim));
    assert_null(disk.fault(&disk, inside));
    assert_non_null(disk.fault(&disk, outside));
    assert_non_null(disk.fault(&disk, nan_point));
    assert_non_null(plane.fault(&plane, nan_point));
    double zero[3] = {0, 0, 0}, image[3], huge[3] = {1e300, 1e300, 0};
    check_status(sphere.project(&sphere, zero, image), BAT_INVALID_POINT);
    check_status(sphere.project(&sphere, huge, image), BAT_OK);
    check_near(image[0], sqrt(0.5), 1e-15);
    double far[2] = {1000, 0}, origin[2] = {0, 0};
    check_status(disk.exp(&disk, origin, far, image), BAT_INVALID_POINT);
}

/// Turning left is positive, mirroring changes the sign, and an apex sees its edge under the angle asked for.
static void oriented_surfaces_turn_left(void **state)
{
    (void)state;
    bat_space spaces[3] = {bat_euclidean(2), bat_sphere(2), bat_disk()};
    bat_random random = bat_random_seed(9);
    for (int s = 0; s < 3; s++)
    {
        const bat_space *space = &spaces[s];
        for (int trial = 0; trial < 200; trial++)
        {
            double p[3], q[3], apex[3], before[3];
            do
            {
                random_pair(space, &random, p, q);
            } while (space->distance(space, p, q) < 1e-3 || space->distance(space, p, q) > 1);
            double angle = 0.7 * (2 * bat_random_uniform(&random) - 1);
            check_status(space->apex(space, p, q, angle, apex), BAT_OK);
            // equal sides
            check_near(space->distance(space, p, apex), space->distance(space, apex, q), 1e-12);
            // going q -> p -> apex turns by pi less the base angle, to the left when the apex is left of p -> q
            memcpy(before, q, sizeof before);
            double turn = space->exterior_angle(space, before, p, apex);
            check_near(turn, copysign(3.14159265358979323846, -angle) + angle, 1e-11);
            check_near(space->exterior_angle(space, apex, p, before), -turn, 1e-11);
        }
    }
    double far_p[2] = {-0.99, 0}, far_q[2] = {0.99, 0}, apex[2];
    check_status(spaces[2].apex(&spaces[2], far_p, far_q, 0.7, apex), BAT_INVALID_POINT);
}

/// Isometries: rotations of the sphere, Möbius translations of the disk.
static void isometries_change_nothing(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(12);
    bat_space disk = bat_disk();
    for (int trial = 0; trial < 200; trial++)
    {
        double a[2], p[2], q[2], r[2], ap[2], aq[2], ar[2], vp[2], vq[2], vr[2], origin[2] = {0, 0};
        disk.random_point(&disk, &random, a);
        disk.random_point(&disk, &random, p);
        disk.random_point(&disk, &random, q);
        disk.random_point(&disk, &random, r);
        check_status(disk.log(&disk, origin, p, vp), BAT_OK);
        check_status(disk.log(&disk, origin, q, vq), BAT_OK);
        check_status(disk.log(&disk, origin, r, vr), BAT_OK);
        // exp at a of a vector in a's frame is the translation of exp at the origin
        check_status(disk.exp(&disk, a, vp, ap), BAT_OK);
        check_status(disk.exp(&disk, a, vq, aq), BAT_OK);
        check_status(disk.exp(&disk, a, vr, ar), BAT_OK);
        check_near(disk.distance(&disk, ap, aq), disk.distance(&disk, p, q), 1e-11);
        check_near(sin(disk.exterior_angle(&disk, ap, aq, ar) - disk.exterior_angle(&disk, p, q, r)), 0, 1e-11);
    }
}

static void names_and_batches_work(void **state)
{
    (void)state;
    bat_space space;
    bat_error error;
    check_status(bat_space_by_name("sphere", 0, &space, &error), BAT_OK);
    assert_int_equal(space.point_dim, 3);
    check_status(bat_space_by_name("sphere", 5, &space, &error), BAT_OK);
    assert_int_equal(space.dimension, 4);
    check_status(bat_space_by_name("plane", 3, &space, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_space_by_name("torus", 0, &space, &error), BAT_INVALID_ARGUMENT);
    assert_non_null(strstr(error.text, "torus"));
    check_status(bat_space_by_name("sphere", 0, &space, NULL), BAT_OK);
    double p[6] = {1, 0, 0, 1, 0, 0}, q[6] = {0, 1, 0, -1, 0, 0}, v[6], d[2];
    bat_space_distances(&space, p, q, 2, d);
    check_near(d[0], 1.57079632679489661923, 1e-15);
    check_status(bat_space_logs(&space, p, q, 2, v, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
    check_near(v[1], 1.57079632679489661923, 1e-15);
    check_status(bat_space_exps(&space, p, v, 1, q, &error), BAT_OK);
    check_near(q[1], 1, 1e-15);
    double share = 0.5, middle[3];
    check_status(bat_space_geodesics(&space, p, q, &share, 1, middle, &error), BAT_OK);
    check_near(middle[0], sqrt(0.5), 1e-15);
}

/// Row by row what the space's own function says, up to the first row at fault.
static void tangents_are_transported_in_rows(void **state)
{
    (void)state;
    enum
    {
        ROWS = 5
    };
    const bat_space spaces[] = {bat_euclidean(3), bat_sphere(2), bat_disk()};
    for (size_t s = 0; s < sizeof spaces / sizeof spaces[0]; s++)
    {
        const bat_space *space = &spaces[s];
        size_t dim = space->point_dim, tangent_dim = space->tangent_dim;
        double p[3 * ROWS], q[3 * ROWS], v[3 * ROWS], moved[3 * ROWS], back[3 * ROWS];
        bat_random random = bat_random_seed(17 + s);
        for (size_t i = 0; i < ROWS; i++)
        {
            random_pair(space, &random, p + i * dim, q + i * dim);
            check_status(space->log(space, p + i * dim, q + (i + ROWS - 1) % (i + 1) * dim, v + i * tangent_dim), BAT_OK);
        }
        check_status(bat_space_transports(space, p, q, v, ROWS, moved, NULL), BAT_OK);
        check_status(bat_space_transports(space, q, p, moved, ROWS, back, NULL), BAT_OK);
        for (size_t i = 0; i < ROWS; i++)
        {
            const double *one = v + i * tangent_dim, *other = moved + i * tangent_dim;
            check_relative(space->inner(space, q + i * dim, other, other), space->inner(space, p + i * dim, one, one),
                           1e-11);
            for (size_t k = 0; k < tangent_dim; k++)
                check_near(back[i * tangent_dim + k], one[k], 1e-11);
        }
    }
    const bat_space *sphere = &spaces[1];
    double p[] = {1, 0, 0, 1, 0, 0, 1, 0, 0}, q[] = {0, 1, 0, -1, 0, 0, 0, 0, 1}, v[] = {0, 1, 0, 0, 1, 0, 0, 1, 0};
    double moved[9] = {7, 7, 7, 7, 7, 7, 7, 7, 7};
    bat_error error;
    check_status(bat_space_transports(sphere, p, q, v, 3, moved, &error), BAT_CUT_LOCUS);
    assert_int_equal(error.index, 1);
    check_near(moved[0], -1, 1e-15);
    check_near(moved[1], 0, 1e-15);
    assert_true(moved[6] == 7 && moved[8] == 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_meets_reference),
        cmocka_unit_test(disk_meets_reference),
        cmocka_unit_test(identities_hold),
        cmocka_unit_test(disk_is_accurate_near_the_rim),
        cmocka_unit_test(disk_geodesics_reach_their_ends),
        cmocka_unit_test(cut_locus_is_a_status),
        cmocka_unit_test(points_outside_are_found),
        cmocka_unit_test(oriented_surfaces_turn_left),
        cmocka_unit_test(isometries_change_nothing),
        cmocka_unit_test(names_and_batches_work),
        cmocka_unit_test(tangents_are_transported_in_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

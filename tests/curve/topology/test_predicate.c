// The exact predicates against integer arithmetic.

#include "check.h"

#include "batten/base.h"
#include "curve/topology/edge_tree.h"

__extension__ typedef __int128 wide;

enum
{
    TRIALS = 200000
};

static int sign_of(wide value)
{
    return (value > 0) - (value < 0);
}

/// det[a, b, c] of vectors of whole numbers.
static wide determinant(const int64_t *a, const int64_t *b, const int64_t *c)
{
    return (wide)a[0] * ((wide)b[1] * c[2] - (wide)b[2] * c[1]) + (wide)a[1] * ((wide)b[2] * c[0] - (wide)b[0] * c[2]) +
           (wide)a[2] * ((wide)b[0] * c[1] - (wide)b[1] * c[0]);
}

static int64_t whole(bat_random *random, int bits)
{
    return (int64_t)(bat_random_bits(random) >> (64 - bits)) - ((int64_t)1 << (bits - 1));
}

/// A point near the line through two others: a + t (b - a) / 8, off by up to 2 in each coordinate.
static void near_line(bat_random *random, const int64_t *a, const int64_t *b, int dim, int64_t *c)
{
    int64_t t = whole(random, 5);
    for (int k = 0; k < dim; k++)
        c[k] = a[k] + t * ((b[k] - a[k]) / 8) + (bat_random_bits(random) % 4 == 0 ? whole(random, 2) : 0);
}

static void to_doubles(const int64_t *from, int dim, double scale, double *to)
{
    for (int k = 0; k < dim; k++)
        to[k] = (double)from[k] * scale;
}

static void orientations_in_the_plane_are_exact(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(1);
    int zeros = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        int64_t p[3][3];
        double x[3][2];
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 2; k++)
                p[i][k] = whole(&random, 46) * 8;
        near_line(&random, p[0], p[1], 2, p[2]);
        double scale = ldexp(1, (int)whole(&random, 9));
        for (int i = 0; i < 3; i++)
        {
            p[i][2] = 1;
            to_doubles(p[i], 2, scale, x[i]);
        }
        int expected = sign_of(determinant(p[0], p[1], p[2]));
        zeros += expected == 0;
        assert_int_equal(predicate_orientation(SURFACE_PLANE, x[0], x[1], x[2]), expected);
        assert_int_equal(predicate_orientation(SURFACE_PLANE, x[1], x[0], x[2]), -expected);
    }
    assert_true(zeros > 1000);
}

/// Vectors of any length stand for points of the sphere: whole numbers of 40 bits have determinants below 2^127.
static void orientations_on_the_sphere_are_exact(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(2);
    int zeros = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        int64_t p[3][3];
        double x[3][3];
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++)
                p[i][k] = whole(&random, 30) * 8;
        near_line(&random, p[0], p[1], 3, p[2]);
        for (int i = 0; i < 3; i++)
            to_doubles(p[i], 3, 0x1p-36, x[i]);
        int expected = sign_of(determinant(p[0], p[1], p[2]));
        zeros += expected == 0;
        assert_int_equal(predicate_orientation(SURFACE_SPHERE, x[0], x[1], x[2]), expected);
        assert_int_equal(predicate_orientation(SURFACE_SPHERE, x[2], x[1], x[0]), -expected);
    }
    assert_true(zeros > 1000);
}

/// Points of the disk with denominators 2^20: (x, y, 1 + x^2 + y^2) in whole numbers is (2^20 m, 2^20 n, 2^40 + m^2 + n^2).
static void orientations_in_the_disk_are_exact(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    int zeros = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        int64_t p[3][3];
        double x[3][2];
        for (int i = 0; i < 3; i++)
        {
            // On geodesics through the origin and on the real axis many triples are degenerate.
            int64_t m = whole(&random, 20), n = trial % 3 == 0 ? m : trial % 3 == 1 ? 0 : whole(&random, 20);
            if (i == 2 && trial % 2 == 0)
                n += whole(&random, 2);
            x[i][0] = (double)m * 0x1p-20;
            x[i][1] = (double)n * 0x1p-20;
            p[i][0] = m * (1 << 20);
            p[i][1] = n * (1 << 20);
            p[i][2] = ((int64_t)1 << 40) + m * m + n * n;
        }
        int expected = sign_of(determinant(p[0], p[1], p[2]));
        zeros += expected == 0;
        assert_int_equal(predicate_orientation(SURFACE_DISK, x[0], x[1], x[2]), expected);
        assert_int_equal(predicate_orientation(SURFACE_DISK, x[1], x[2], x[0]), expected);
    }
    assert_true(zeros > 1000);
}

/// Edges with ends on a small grid, where most cases are degenerate, by rational arithmetic.
static bool grid_edges_meet(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d)
{
    int64_t ux = b[0] - a[0], uy = b[1] - a[1], vx = d[0] - c[0], vy = d[1] - c[1], wx = c[0] - a[0], wy = c[1] - a[1];
    int64_t cross = ux * vy - uy * vx, s = wx * vy - wy * vx, t = wx * uy - wy * ux;
    if (cross != 0)
    {
        if (cross < 0)
        {
            cross = -cross;
            s = -s;
            t = -t;
        }
        return s >= 0 && s <= cross && t >= 0 && t <= cross;
    }
    if (t != 0)
        return false;
    int64_t square = ux * ux + uy * uy, from = wx * ux + wy * uy, to = from + vx * ux + vy * uy;
    return (from >= 0 || to >= 0) && (from <= square || to <= square);
}

static void edges_on_a_grid_meet_as_rationals_do(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    int meeting = 0;
    for (int trial = 0; trial < TRIALS; trial++)
    {
        int64_t p[4][2];
        double flat[4][2], ball[4][3];
        for (int i = 0; i < 4; i++)
        {
            for (int k = 0; k < 2; k++)
                p[i][k] = (int64_t)(bat_random_bits(&random) % 7) - 3;
            to_doubles(p[i], 2, 0x1p-3, flat[i]);
            to_doubles(p[i], 2, 1, ball[i]); // the central projection of the plane z = 1
            ball[i][2] = 1;
        }
        if ((p[0][0] == p[1][0] && p[0][1] == p[1][1]) || (p[2][0] == p[3][0] && p[2][1] == p[3][1]))
            continue;
        bool expected = grid_edges_meet(p[0], p[1], p[2], p[3]);
        meeting += expected;
        assert_int_equal(predicate_edges_meet(SURFACE_PLANE, flat[0], flat[1], flat[2], flat[3]), expected);
        assert_int_equal(predicate_edges_meet(SURFACE_SPHERE, ball[0], ball[1], ball[2], ball[3]), expected);
        for (int i = 2; i < 4; i++)
            for (int k = 0; k < 3; k++)
                ball[i][k] = -ball[i][k];
        assert_false(predicate_edges_meet(SURFACE_SPHERE, ball[0], ball[1], ball[2], ball[3]));
    }
    assert_true(meeting > TRIALS / 10);
}

/// Edges of the disk on diameters and between them.
static void edges_of_the_disk_meet(void **state)
{
    (void)state;
    const double a[2] = {-0.5, 0}, b[2] = {0.5, 0}, c[2] = {0.25, 0}, d[2] = {0.75, 0}, e[2] = {0.625, 0};
    const double up[2] = {0.25, 0.5}, down[2] = {0.25, -0.5}, far_up[2] = {0.75, 0.5};
    assert_true(predicate_edges_meet(SURFACE_DISK, a, b, c, d));
    assert_false(predicate_edges_meet(SURFACE_DISK, a, c, e, d));
    assert_true(predicate_edges_meet(SURFACE_DISK, a, c, c, d));
    assert_true(predicate_edges_meet(SURFACE_DISK, a, b, up, down));
    assert_true(predicate_edges_meet(SURFACE_DISK, a, b, c, up));
    assert_false(predicate_edges_meet(SURFACE_DISK, a, b, far_up, up));
    assert_true(predicate_folds_back(SURFACE_DISK, a, b, c));
    assert_false(predicate_folds_back(SURFACE_DISK, a, c, b));
    // The geodesic between up and down bulges towards the origin: it passes left of c.
    const double left[2] = {0.125, 0}, near_c[2] = {0.24, 0};
    assert_true(predicate_edges_meet(SURFACE_DISK, left, near_c, up, down));
    assert_false(predicate_edges_meet(SURFACE_DISK, near_c, d, up, down));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orientations_in_the_plane_are_exact),
        cmocka_unit_test(orientations_on_the_sphere_are_exact),
        cmocka_unit_test(orientations_in_the_disk_are_exact),
        cmocka_unit_test(edges_on_a_grid_meet_as_rationals_do),
        cmocka_unit_test(edges_of_the_disk_meet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

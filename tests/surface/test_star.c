// Stars of points in the plane and in space, and their weights.

#include "check.h"

#include "surface/parameterize/weights.h"

#include "batten/base.h"

enum
{
    MOST = 200
};

typedef struct scatter
{
    double planar[MOST][2];
    double inverse[MOST][2];
    size_t ring[STAR_MAX_RING];
    size_t count;
    bool closed;
} scatter;

/// Finds the star of the origin among `points` random points of the square with corners (-1, -1) and (1, 1), moved by
/// `shift`.
static scatter find_random(size_t points, double shift, uint64_t seed)
{
    scatter made = {0};
    bat_random random = bat_random_seed(seed);
    for (size_t k = 0; k < 2 * points; k++)
        made.planar[k / 2][k % 2] = 2 * bat_random_uniform(&random) - 1 + shift;
    made.count = star_find((const double(*)[2])made.planar, points, made.inverse, made.ring, &made.closed);
    return made;
}

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/// The centre of the circle through the origin, a and b.
static void circle_centre(const double a[2], const double b[2], double centre[2])
{
    double twice = 2 * cross(a, b), aa = a[0] * a[0] + a[1] * a[1], bb = b[0] * b[0] + b[1] * b[1];
    centre[0] = (b[1] * aa - a[1] * bb) / twice;
    centre[1] = (a[0] * bb - b[0] * aa) / twice;
}

/// Delaunay's property: no point within the circle through the origin and two consecutive corners.
static void triangles_have_empty_circles(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++)
    {
        size_t points = 12 + seed % 80;
        scatter s = find_random(points, 0, seed);
        for (size_t k = 0; k + (s.closed ? 0 : 1) < s.count; k++)
        {
            const double *a = s.planar[s.ring[k]], *b = s.planar[s.ring[(k + 1) % s.count]];
            double centre[2];
            assert_true(cross(a, b) > 0);
            circle_centre(a, b, centre);
            for (size_t p = 0; p < points; p++)
                assert_true(hypot(s.planar[p][0] - centre[0], s.planar[p][1] - centre[1]) >=
                            hypot(centre[0], centre[1]) * (1 - 1e-12));
        }
    }
}

/// Qhull's triangulation of the same points and the origin has the same star.
static void stars_are_those_of_a_triangulation(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 60; seed++)
    {
        size_t points = 8 + seed % 40, ring[STAR_MAX_RING], count, first = 0;
        scatter s = find_random(points, seed % 3 == 0 ? 0.9 : 0, seed);
        s.planar[points][0] = s.planar[points][1] = 0;
        assert_int_equal(triangulated_star_find((const double(*)[2])s.planar, points + 1, points, ring, &count, NULL),
                         BAT_OK);
        if (s.count < 3)
        {
            assert_int_equal(count, 0);
            continue;
        }
        assert_int_equal(count, s.count);
        while (ring[first] != s.ring[0])
            assert_true(++first < count);
        for (size_t k = 0; k < count; k++)
            assert_int_equal(ring[(first + k) % count], s.ring[k]);
    }
}

static void stars_on_the_hull_are_open(void **state)
{
    (void)state;
    size_t open = 0;
    for (uint64_t seed = 1; seed <= 50; seed++)
    {
        scatter s = find_random(30, 1.001, seed);
        assert_false(s.closed);
        assert_true(s.count >= 2);
        // All corners within half a turn after the first.
        for (size_t k = 1; k < s.count; k++)
            assert_true(cross(s.planar[s.ring[0]], s.planar[s.ring[k]]) > 0);
        open++;
    }
    assert_int_equal(open, 50);
}

/// Around a point of a square grid the four nearest triangulate: the diagonal ones lie on the same empty circles.
static void grids_give_four_neighbours(void **state)
{
    (void)state;
    double planar[48][2], inverse[48][2];
    size_t ring[STAR_MAX_RING], count = 0;
    bool closed;
    for (int i = -3; i <= 3; i++)
        for (int j = -3; j <= 3; j++)
            if (i != 0 || j != 0)
            {
                planar[count][0] = 0.1 * i;
                planar[count++][1] = 0.1 * j;
            }
    assert_int_equal(star_find((const double(*)[2])planar, count, inverse, ring, &closed), 4);
    assert_true(closed);
    for (size_t k = 0; k < 4; k++)
        check_near(hypot(planar[ring[k]][0], planar[ring[k]][1]), 0.1, 1e-15);
}

static void points_at_the_origin_do_not_count(void **state)
{
    (void)state;
    const double planar[5][2] = {{0, 0}, {1, 0}, {-1, 1}, {-1, -1}, {0, 0}};
    double inverse[5][2];
    size_t ring[STAR_MAX_RING];
    bool closed;
    assert_int_equal(star_find(planar, 5, inverse, ring, &closed), 3);
    assert_true(closed);
    assert_int_equal(star_find(planar, 1, inverse, ring, &closed), 0);
    assert_false(closed);
}

static void check_average(const double (*ring)[2], size_t count)
{
    double weights[STAR_MAX_RING], sum = 0, mean[2] = {0, 0}, size = 0;
    star_shape_preserving(ring, count, weights);
    for (size_t k = 0; k < count; k++)
    {
        assert_true(weights[k] > 0);
        sum += weights[k];
        mean[0] += weights[k] * ring[k][0];
        mean[1] += weights[k] * ring[k][1];
        size = fmax(size, hypot(ring[k][0], ring[k][1]));
    }
    check_near(sum, 1, 1e-14);
    check_near(mean[0], 0, 1e-14 * size);
    check_near(mean[1], 0, 1e-14 * size);
}

static void weights_make_the_middle_an_average(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= 200; seed++)
    {
        scatter s = find_random(10 + seed % 60, 0, seed);
        double ring[STAR_MAX_RING][2];
        for (size_t k = 0; k < s.count; k++)
        {
            ring[k][0] = s.planar[s.ring[k]][0];
            ring[k][1] = s.planar[s.ring[k]][1];
        }
        if (s.closed)
            check_average((const double(*)[2])ring, s.count);
    }
}

static void weights_of_a_regular_ring_are_equal(void **state)
{
    (void)state;
    for (size_t count = 3; count <= 12; count++)
    {
        double ring[12][2], weights[12];
        for (size_t k = 0; k < count; k++)
        {
            ring[k][0] = cos(2 * 3.14159265358979323846 * (double)k / (double)count);
            ring[k][1] = sin(2 * 3.14159265358979323846 * (double)k / (double)count);
        }
        star_shape_preserving((const double(*)[2])ring, count, weights);
        for (size_t k = 0; k < count; k++)
            check_near(weights[k], 1 / (double)count, 1e-14);
    }
}

/// Four corners on two lines through the middle: each triangle has the middle on a side, between opposite corners.
static void weights_of_a_cross_balance_opposite_corners(void **state)
{
    (void)state;
    const double ring[4][2] = {{1, 0}, {0, 2}, {-3, 0}, {0, -5}};
    double weights[4];
    star_shape_preserving(ring, 4, weights);
    const double expected[4] = {3.0 / 8, 5.0 / 14, 1.0 / 8, 2.0 / 14};
    for (size_t k = 0; k < 4; k++)
        check_near(weights[k], expected[k], 1e-15);
}

/// A flat ring stays as it is but for a turn; a cone's angles are scaled to a full turn.
static void rings_unfold(void **state)
{
    (void)state;
    const double flat[5][3] = {{1, 0, 0}, {0.5, 2, 0}, {-1, 0.5, 0}, {-2, -1, 0}, {0.3, -1, 0}};
    double ring[5][2], cone[6][3];
    assert_true(star_unfold(flat, 5, ring));
    for (size_t k = 0; k < 5; k++)
    {
        check_near(ring[k][0], flat[k][0], 1e-14);
        check_near(ring[k][1], flat[k][1], 1e-14);
    }
    for (size_t k = 0; k < 5; k++)
    {
        double angle = 2 * 3.14159265358979323846 * (double)k / 5;
        cone[k][0] = cos(angle);
        cone[k][1] = sin(angle);
        cone[k][2] = 1.5;
    }
    assert_true(star_unfold((const double(*)[3])cone, 5, ring));
    for (size_t k = 0; k < 5; k++)
    {
        double angle = 2 * 3.14159265358979323846 * (double)k / 5;
        check_near(ring[k][0], sqrt(3.25) * cos(angle), 1e-14);
        check_near(ring[k][1], sqrt(3.25) * sin(angle), 1e-14);
    }
    const double half[3][3] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    assert_false(star_unfold(half, 3, ring));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_have_empty_circles),
        cmocka_unit_test(stars_are_those_of_a_triangulation),
        cmocka_unit_test(stars_on_the_hull_are_open),
        cmocka_unit_test(grids_give_four_neighbours),
        cmocka_unit_test(points_at_the_origin_do_not_count),
        cmocka_unit_test(weights_make_the_middle_an_average),
        cmocka_unit_test(weights_of_a_regular_ring_are_equal),
        cmocka_unit_test(weights_of_a_cross_balance_opposite_corners),
        cmocka_unit_test(rings_unfold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

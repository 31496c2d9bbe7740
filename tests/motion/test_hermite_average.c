// The manifold-Hermite De Casteljau average: definition 3.4, proposition 3.6, isometries, and R^n in closed form.

#include "hermite_helpers.h"

static void average(const bat_space *space, const hermite_pair *pair, double weight, double *point, double *direction)
{
    check_status(bat_hermite_average(space, pair->p0, pair->v0, pair->p1, pair->v1, weight, point, direction), BAT_OK);
}

static void ends_come_back_bit_for_bit(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(1);
    for (size_t s = 0; s < SPACES; s++)
    {
        const bat_space *space = &spaces[s];
        hermite_pair pair = random_pair(space, &random, 0.7, 1);
        double point[DIM], direction[DIM];
        average(space, &pair, 0, point, direction);
        assert_memory_equal(point, pair.p0, space->point_dim * sizeof *point);
        assert_memory_equal(direction, pair.v0, space->tangent_dim * sizeof *point);
        average(space, &pair, 1, point, direction);
        assert_memory_equal(point, pair.p1, space->point_dim * sizeof *point);
        assert_memory_equal(direction, pair.v1, space->tangent_dim * sizeof *point);
        // and continuously
        average(space, &pair, 1e-9, point, direction);
        check_near(space->distance(space, point, pair.p0), 0, 1e-8);
        check_near(gap(space, point, direction, pair.v0), 0, 1e-7);
        average(space, &pair, 1 - 1e-9, point, direction);
        check_near(space->distance(space, point, pair.p1), 0, 1e-8);
        check_near(gap(space, point, direction, pair.v1), 0, 1e-7);
    }
}

static void travel_the_other_way_gives_the_same(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(2);
    for (size_t trial = 0; trial < 20 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        hermite_pair pair = random_pair(space, &random, 0.9, 2), back = pair;
        memcpy(back.p0, pair.p1, sizeof back.p0);
        memcpy(back.p1, pair.p0, sizeof back.p1);
        negate(space, pair.v1, back.v0);
        negate(space, pair.v0, back.v1);
        double weight = trial % 3 == 0 ? 0.5 : bat_random_uniform(&random);
        double point[DIM], direction[DIM], other[DIM], turned[DIM];
        average(space, &pair, weight, point, direction);
        average(space, &back, 1 - weight, other, turned);
        negate(space, turned, turned);
        check_near(space->distance(space, point, other), 0, 2e-14);
        check_near(gap(space, point, direction, turned), 0, 2e-13);
        check_near(length_of(space, point, direction), 1, 1e-14);
    }
}

static void isometries_commute(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(3);
    for (size_t trial = 0; trial < 20 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        hermite_pair pair = random_pair(space, &random, 0.8, 1.5), moved;
        double centre[DIM], point[DIM], direction[DIM], image[DIM], turned[DIM], expected[DIM], along[DIM];
        space->random_point(space, &random, centre);
        reflect(space, centre, pair.p0, pair.v0, moved.p0, moved.v0);
        reflect(space, centre, pair.p1, pair.v1, moved.p1, moved.v1);
        double weight = trial % 2 == 0 ? 0.5 : 0.37;
        average(space, &pair, weight, point, direction);
        average(space, &moved, weight, image, turned);
        reflect(space, centre, point, direction, expected, along);
        check_near(space->distance(space, image, expected), 0, 1e-12);
        check_near(gap(space, image, turned, along), 0, 1e-11);
    }
}

/// H_w((p, v), (p_t, v_t)) with p_t = exp(t v) tends to (p, v); it lies on the geodesic.
static void diagonal_is_kept(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(4);
    for (size_t s = 0; s < SPACES; s++)
    {
        const bat_space *space = &spaces[s];
        double point[DIM], direction[DIM];
        for (double t = 1e-2; t > 1e-7; t *= 0.1)
        {
            hermite_pair pair = random_pair(space, &random, t, 0);
            average(space, &pair, 0.3, point, direction);
            // a coordinate's rounding becomes an angle when divided by t
            check_near(space->distance(space, pair.p0, point), 0.3 * t, 1e-13);
            double back[DIM];
            check_status(space->transport(space, point, pair.p0, direction, back), BAT_OK);
            check_near(gap(space, pair.p0, back, pair.v0), 0, 1e-14 + 2e-13 / t);
        }
        hermite_pair pair = random_pair(space, &random, 0.5, 1);
        check_status(bat_hermite_average(space, pair.p0, pair.v0, pair.p0, pair.v0, 0.5, point, direction), BAT_OK);
        assert_memory_equal(point, pair.p0, space->point_dim * sizeof *point);
        assert_memory_equal(direction, pair.v0, space->tangent_dim * sizeof *point);
    }
}

static void geodesics_are_reproduced(void **state)
{
    (void)state;
    bat_space spaces[SPACES];
    all_spaces(spaces);
    bat_random random = bat_random_seed(5);
    for (size_t trial = 0; trial < 10 * SPACES; trial++)
    {
        const bat_space *space = &spaces[trial % SPACES];
        hermite_pair pair = random_pair(space, &random, 0.2 + 0.1 * (double)(trial / SPACES), 0);
        double weight = trial % 2 == 0 ? 0.5 : bat_random_uniform(&random) * 1.4 - 0.2, point[DIM], direction[DIM],
               expected[DIM], along[DIM];
        average(space, &pair, weight, point, direction);
        check_status(bat_space_geodesic(space, pair.p0, pair.p1, weight, expected), BAT_OK);
        check_status(space->transport(space, pair.p0, point, pair.v0, along), BAT_OK);
        check_near(space->distance(space, point, expected), 0, 1e-13);
        check_near(gap(space, point, direction, along), 0, 1e-12);
    }
}

/// In R^n the average is a point of the cubic Bezier curve of eq. (2.4), here in Bernstein's form, with angles by arc
/// cosines.
static void euclidean_average_is_bernsteins(void **state)
{
    (void)state;
    bat_space space = bat_euclidean(3);
    bat_random random = bat_random_seed(6);
    for (int trial = 0; trial < 50; trial++)
    {
        hermite_pair pair = random_pair(&space, &random, 2, 1);
        double way[3], d = 0, angles[2] = {0, 0}, expected[3], slope[3], length = 0, point[3], direction[3];
        for (int c = 0; c < 3; c++)
        {
            way[c] = pair.p1[c] - pair.p0[c];
            d += way[c] * way[c];
        }
        d = sqrt(d);
        for (int c = 0; c < 3; c++)
        {
            angles[0] += pair.v0[c] * way[c] / d;
            angles[1] += pair.v1[c] * way[c] / d;
        }
        double quarter = (acos(angles[0]) + acos(angles[1])) / 4, alpha = d / (3 * cos(quarter) * cos(quarter));
        double w = bat_random_uniform(&random) * 1.6 - 0.3, m = 1 - w;
        for (int c = 0; c < 3; c++)
        {
            double b[4] = {pair.p0[c], pair.p0[c] + alpha * pair.v0[c], pair.p1[c] - alpha * pair.v1[c], pair.p1[c]};
            expected[c] = m * m * m * b[0] + 3 * m * m * w * b[1] + 3 * m * w * w * b[2] + w * w * w * b[3];
            slope[c] = m * m * (b[1] - b[0]) + 2 * m * w * (b[2] - b[1]) + w * w * (b[3] - b[2]);
            length += slope[c] * slope[c];
        }
        average(&space, &pair, w, point, direction);
        for (int c = 0; c < 3; c++)
        {
            check_near(point[c], expected[c], 1e-13);
            check_near(direction[c], slope[c] / sqrt(length), 1e-12);
        }
    }
}

static void bad_pairs_are_refused(void **state)
{
    (void)state;
    bat_space plane = bat_euclidean(2), sphere = bat_sphere(2);
    double p[2] = {0, 0}, q[2] = {1, 0}, u[2] = {-1, 0}, v[2] = {0, 1}, w[2] = {1, 0}, point[3], direction[3];
    // both tangents against the edge: the angles sum to 2 pi
    check_status(bat_hermite_average(&plane, p, u, q, u, 0.5, point, direction), BAT_INVALID_POINT);
    // one of them alone is admissible
    check_status(bat_hermite_average(&plane, p, u, q, w, 0.5, point, direction), BAT_OK);
    check_status(bat_hermite_average(&plane, p, u, p, v, 0.5, point, direction), BAT_INVALID_POINT);
    double north[3] = {0, 0, 1}, south[3] = {0, 0, -1}, east[3] = {1, 0, 0};
    check_status(bat_hermite_average(&sphere, north, east, south, east, 0.5, point, direction), BAT_CUT_LOCUS);
    // tiny and huge coordinates neither underflow nor overflow: angles pi / 2 and 0
    double alpha = 1 / (3 * pow(cos(PI / 8), 2)), slope = atan2(alpha, 2 - alpha);
    for (int exponent = -300; exponent <= 300; exponent += 100)
    {
        double far[2] = {pow(10, exponent), 0};
        check_status(bat_hermite_average(&plane, p, v, far, w, 0.5, point, direction), BAT_OK);
        check_near(direction[0], cos(slope), 1e-14);
        check_near(direction[1], -sin(slope), 1e-14);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ends_come_back_bit_for_bit), cmocka_unit_test(travel_the_other_way_gives_the_same),
        cmocka_unit_test(isometries_commute),         cmocka_unit_test(diagonal_is_kept),
        cmocka_unit_test(geodesics_are_reproduced),   cmocka_unit_test(euclidean_average_is_bernsteins),
        cmocka_unit_test(bad_pairs_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

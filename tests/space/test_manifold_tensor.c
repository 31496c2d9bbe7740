#include "manifold_checks.h"

#include "reference/manifold_reference.h"

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

enum
{
    NUMBERS = BAT_POSITIVE_DEFINITE_MAX_SIDE * (BAT_POSITIVE_DEFINITE_MAX_SIDE + 1) / 2,
    AREA = BAT_POSITIVE_DEFINITE_MAX_SIDE * BAT_POSITIVE_DEFINITE_MAX_SIDE
};

static void identities_hold(void **state)
{
    (void)state;
    const struct
    {
        size_t side;
        int trials;
        double reach, rounding;
    } cases[] = {{1, 1000, 20, 2e-15}, {2, 1000, 3, 2e-13}, {3, 1000, 3, 4e-13}, {3, 300, 0.3, 4e-14},
                 {4, 300, 3, 4e-13},   {5, 100, 3, 4e-13},  {9, 20, 3, 8e-13},   {32, 2, 2, 8e-12}};
    for (size_t i = 0; i < COUNT_OF(cases); i++)
    {
        bat_space space = bat_positive_definite(cases[i].side);
        assert_int_equal(space.dimension, cases[i].side * (cases[i].side + 1) / 2);
        manifold_check(&(manifold_case){.space = &space,
                                        .seed = 10 * (uint64_t)i,
                                        .trials = cases[i].trials,
                                        .reach = cases[i].reach,
                                        .rounding = cases[i].rounding});
    }
}

static void meets_reference(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(TENSOR_REFERENCE); i++)
    {
        const tensor_reference *r = &TENSOR_REFERENCE[i];
        bat_space space = bat_positive_definite((size_t)r->side);
        double v[6], tolerance = 1e-14 * r->condition;
        check_relative(space.distance(&space, r->p, r->q), r->distance, tolerance);
        check_status(space.log(&space, r->p, r->q, v), BAT_OK);
        for (size_t k = 0; k < space.tangent_dim; k++)
            check_near(v[k], r->log[k], tolerance * r->distance);
        const double u[6] = {0.3, -0.7, 0.2, 0.5, 0.1, -0.4};
        check_status(space.transport(&space, r->p, r->q, u, v), BAT_OK);
        for (size_t k = 0; k < space.tangent_dim; k++)
            check_near(v[k], r->transported[k], tolerance);
    }
}

static void whole(size_t n, const double *packed, double *a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            a[i * n + j] = a[j * n + i] = *packed++;
}

/// g a g^T by its upper triangle
static void congruent(size_t n, const double *g, const double *packed, double *image)
{
    double a[AREA], half[AREA];
    whole(n, packed, a);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            half[i * n + j] = 0;
            for (size_t k = 0; k < n; k++)
                half[i * n + j] += g[i * n + k] * a[k * n + j];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++, image++)
        {
            *image = 0;
            for (size_t k = 0; k < n; k++)
                *image += half[i * n + k] * g[j * n + k];
        }
}

/// A -> G A G^T takes points to points, velocities to velocities, and keeps everything between them.
static void congruence_changes_nothing(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(40);
    for (int trial = 0; trial < 200; trial++)
    {
        size_t n = 1 + (size_t)trial % 6;
        bat_space space = bat_positive_definite(n);
        double g[AREA], p[NUMBERS], q[NUMBERS], r[NUMBERS], gp[NUMBERS], gq[NUMBERS], gr[NUMBERS];
        double v[NUMBERS], u[NUMBERS], image[NUMBERS], expected[NUMBERS];
        for (size_t i = 0; i < n * n; i++)
            g[i] = 0.3 * bat_random_normal(&random) + (i % (n + 1) == 0 ? 2 : 0);
        space.random_point(&space, &random, p);
        space.random_point(&space, &random, q);
        congruent(n, g, p, gp);
        congruent(n, g, q, gq);
        double d = space.distance(&space, p, q);
        check_near(space.distance(&space, gp, gq), d, 1e-12 * (1 + d));
        check_status(space.log(&space, p, q, v), BAT_OK);
        check_status(bat_positive_definite_velocity(&space, p, v, u), BAT_OK);
        congruent(n, g, u, expected);
        check_status(space.log(&space, gp, gq, v), BAT_OK);
        check_status(bat_positive_definite_velocity(&space, gp, v, image), BAT_OK);
        for (size_t i = 0; i < space.tangent_dim; i++)
            check_near(image[i], expected[i], 1e-11);
        // transport commutes with it
        manifold_tangent(&space, &random, p, 1, u);
        check_status(bat_positive_definite_velocity(&space, p, u, expected), BAT_OK);
        congruent(n, g, expected, image);
        check_status(bat_positive_definite_tangent(&space, gp, image, v), BAT_OK);
        check_near(manifold_length(&space, gp, v), 1, 1e-11);
        check_status(space.transport(&space, gp, gq, v, image), BAT_OK);
        check_status(space.transport(&space, p, q, u, v), BAT_OK);
        check_status(bat_positive_definite_velocity(&space, q, v, u), BAT_OK);
        congruent(n, g, u, expected);
        check_status(bat_positive_definite_tangent(&space, gq, expected, v), BAT_OK);
        check_near(manifold_difference(&space, gq, v, image, 1), 0, 1e-11);
        check_status(space.geodesic(&space, p, q, 0.3, r), BAT_OK);
        congruent(n, g, r, gr);
        check_status(space.geodesic(&space, gp, gq, 0.3, r), BAT_OK);
        check_near(space.distance(&space, r, gr), 0, 1e-11);
    }
}

/// The inner product is trace(A^-1 V A^-1 W), and velocities are what exp does to first order.
static void coordinates_mean_what_they_say(void **state)
{
    (void)state;
    bat_space space = bat_positive_definite(2);
    bat_random random = bat_random_seed(41);
    for (int trial = 0; trial < 100; trial++)
    {
        double p[3], v[3], w[3], s[3], t[3], back[3], near[3];
        space.random_point(&space, &random, p);
        for (int i = 0; i < 3; i++)
        {
            v[i] = bat_random_normal(&random);
            w[i] = bat_random_normal(&random);
        }
        check_status(bat_positive_definite_tangent(&space, p, v, s), BAT_OK);
        check_status(bat_positive_definite_tangent(&space, p, w, t), BAT_OK);
        double det = p[0] * p[2] - p[1] * p[1], i[3] = {p[2] / det, -p[1] / det, p[0] / det};
        double a[4] = {i[0] * v[0] + i[1] * v[1], i[0] * v[1] + i[1] * v[2], i[1] * v[0] + i[2] * v[1],
                       i[1] * v[1] + i[2] * v[2]};
        double b[4] = {i[0] * w[0] + i[1] * w[1], i[0] * w[1] + i[1] * w[2], i[1] * w[0] + i[2] * w[1],
                       i[1] * w[1] + i[2] * w[2]};
        double trace = a[0] * b[0] + a[1] * b[2] + a[2] * b[1] + a[3] * b[3];
        check_near(space.inner(&space, p, s, t), trace, 1e-11 * (1 + fabs(trace)));
        check_status(bat_positive_definite_velocity(&space, p, s, back), BAT_OK);
        for (int k = 0; k < 3; k++)
        {
            check_near(back[k], v[k], 1e-12);
            s[k] *= 1e-6;
        }
        check_status(space.exp(&space, p, s, near), BAT_OK);
        for (int k = 0; k < 3; k++)
            check_near((near[k] - p[k]) * 1e6, v[k], 1e-4);
    }
}

/// Commuting matrices interpolate by powers of their eigenvalues, however far apart.
static void diagonal_tensors_are_products_of_numbers(void **state)
{
    (void)state;
    bat_space space = bat_positive_definite(3);
    double p[6] = {1e-20, 0, 0, 1, 0, 1e20}, q[6] = {1e20, 0, 0, 4, 0, 1e20}, r[6], v[6];
    double far = 40 * log(10);
    check_relative(space.distance(&space, p, q), hypot(far, log(4)), 1e-15);
    check_status(space.log(&space, p, q, v), BAT_OK);
    check_relative(v[0], far, 1e-15);
    check_relative(v[3], log(4), 1e-15);
    check_near(v[5], 0, 0);
    check_status(space.geodesic(&space, p, q, 0.5, r), BAT_OK);
    check_relative(r[0], 1.0, 1e-14);
    check_relative(r[3], 2.0, 1e-15);
    check_relative(r[5], 1e20, 1e-15);
    check_status(space.transport(&space, p, q, v, r), BAT_OK);
    for (int i = 0; i < 6; i++)
        check_near(r[i], v[i], 1e-13);
}

static void faults_are_named(void **state)
{
    (void)state;
    bat_space space = bat_positive_definite(2), none = bat_positive_definite(0), huge = bat_positive_definite(99);
    assert_int_equal(none.point_dim, 1);
    assert_int_equal(huge.point_dim, NUMBERS);
    double good[3] = {2, 1, 1}, indefinite[3] = {1, 2, 1}, singular[3] = {1, 1, 1}, negative[3] = {-1, 0, 1}, v[3],
           w[3] = {0};
    double infinite[3] = {1, NAN, 1}, tiny[3] = {1e-250, 0, 1e-250}, big[3] = {1e250, 0, 1e250}, p[3];
    assert_null(space.fault(&space, good));
    assert_null(space.fault(&space, tiny));
    assert_string_equal(space.fault(&space, indefinite), "not positive definite");
    assert_string_equal(space.fault(&space, singular), "not positive definite");
    assert_string_equal(space.fault(&space, negative), "not positive definite");
    assert_string_equal(space.fault(&space, infinite), "not finite");
    check_status(space.project(&space, indefinite, p), BAT_INVALID_POINT);
    check_status(space.project(&space, good, p), BAT_OK);
    check_status(space.log(&space, good, indefinite, v), BAT_INVALID_POINT);
    check_status(space.log(&space, indefinite, good, v), BAT_INVALID_POINT);
    check_status(space.log(&space, tiny, big, v), BAT_INVALID_POINT);
    check_status(space.transport(&space, tiny, big, w, v), BAT_INVALID_POINT);
    assert_true(isnan(space.distance(&space, tiny, big)));
    check_status(space.geodesic(&space, tiny, big, 0.5, p), BAT_INVALID_POINT);
    double far[3] = {800, 0, 0}, back[3] = {-800, 0, 0}, lost[3] = {NAN, 0, 0}, skew[3] = {60, 60, -60};
    check_status(space.exp(&space, good, far, p), BAT_INVALID_POINT);
    check_status(space.exp(&space, good, back, p), BAT_INVALID_POINT);
    check_status(space.exp(&space, good, lost, p), BAT_INVALID_POINT);
    check_status(space.exp(&space, good, skew, p), BAT_INVALID_POINT);
    check_status(bat_positive_definite_tangent(&space, indefinite, w, v), BAT_INVALID_POINT);
    check_status(bat_positive_definite_velocity(&space, indefinite, w, v), BAT_INVALID_POINT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identities_hold),
        cmocka_unit_test(meets_reference),
        cmocka_unit_test(congruence_changes_nothing),
        cmocka_unit_test(coordinates_mean_what_they_say),
        cmocka_unit_test(diagonal_tensors_are_products_of_numbers),
        cmocka_unit_test(faults_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

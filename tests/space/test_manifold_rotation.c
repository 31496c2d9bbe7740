#include "manifold_checks.h"

#include "reference/manifold_reference.h"

#define COUNT_OF(array) (sizeof(array) / sizeof(array)[0])

static const double PI = 3.14159265358979323846;

static void identities_hold(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    manifold_check(&(manifold_case){.space = &rotation, .seed = 1, .trials = 2000, .reach = PI - 1e-6, .rounding = 3e-15});
}

static void meets_reference(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    for (size_t i = 0; i < COUNT_OF(ROTATION_REFERENCE); i++)
    {
        const rotation_reference *r = &ROTATION_REFERENCE[i];
        double v[3];
        check_relative(rotation.distance(&rotation, r->p, r->q), r->distance, 1e-14);
        check_status(rotation.log(&rotation, r->p, r->q, v), BAT_OK);
        for (int k = 0; k < 3; k++)
        {
            check_near(v[k], r->log[k], 1e-14 * r->distance);
            check_near(-v[k] / r->distance, -r->log[k] / r->distance, 1e-14);
        }
        const double u[3] = {0.3, -0.7, 0.2};
        check_status(rotation.transport(&rotation, r->p, r->q, u, v), BAT_OK);
        for (int k = 0; k < 3; k++)
            check_near(v[k], r->transported[k], 1e-14);
    }
}

static void both_signs_are_one_rotation(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(2);
    for (int trial = 0; trial < 500; trial++)
    {
        double p[4], q[4], opposite[4], u[3] = {1, 2, 3}, v[3], w[3], r[4], s[4];
        rotation.random_point(&rotation, &random, p);
        rotation.random_point(&rotation, &random, q);
        for (int i = 0; i < 4; i++)
            opposite[i] = -q[i];
        assert_null(rotation.fault(&rotation, opposite));
        check_near(rotation.distance(&rotation, q, opposite), 0, 0);
        check_near(rotation.distance(&rotation, p, opposite), rotation.distance(&rotation, p, q), 0);
        check_status(rotation.log(&rotation, p, q, v), BAT_OK);
        check_status(rotation.log(&rotation, p, opposite, w), BAT_OK);
        assert_memory_equal(v, w, sizeof v);
        check_status(rotation.transport(&rotation, p, q, u, v), BAT_OK);
        check_status(rotation.transport(&rotation, p, opposite, u, w), BAT_OK);
        assert_memory_equal(v, w, sizeof v);
        // what comes out has the sign nearer to the point it starts from
        double t = bat_random_uniform(&random);
        check_status(rotation.geodesic(&rotation, p, q, t, r), BAT_OK);
        check_status(rotation.geodesic(&rotation, p, opposite, t, s), BAT_OK);
        assert_memory_equal(r, s, sizeof r);
        assert_true(p[0] * r[0] + p[1] * r[1] + p[2] * r[2] + p[3] * r[3] > 0);
        check_status(rotation.log(&rotation, opposite, p, v), BAT_OK);
        check_status(rotation.exp(&rotation, opposite, v, r), BAT_OK);
        assert_true(opposite[0] * r[0] + opposite[1] * r[1] + opposite[2] * r[2] + opposite[3] * r[3] > 0);
    }
}

static void multiply(const double *a, const double *b, double *product)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            product[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

/// The metric is invariant from both sides: in the body's frame R -> A R changes no vector, and R -> R A turns them by A^T.
static void turning_everything_changes_nothing(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(3);
    for (int trial = 0; trial < 300; trial++)
    {
        double a[4], p[4], q[4], m[9], mp[9], mq[9], product[9], left_p[4], left_q[4], right_p[4], right_q[4];
        double v[3], left[3], right[3];
        rotation.random_point(&rotation, &random, a);
        rotation.random_point(&rotation, &random, p);
        rotation.random_point(&rotation, &random, q);
        bat_rotation_to_matrix(a, m);
        bat_rotation_to_matrix(p, mp);
        bat_rotation_to_matrix(q, mq);
        multiply(m, mp, product);
        check_status(bat_rotation_from_matrix(product, left_p, NULL), BAT_OK);
        multiply(m, mq, product);
        check_status(bat_rotation_from_matrix(product, left_q, NULL), BAT_OK);
        multiply(mp, m, product);
        check_status(bat_rotation_from_matrix(product, right_p, NULL), BAT_OK);
        multiply(mq, m, product);
        check_status(bat_rotation_from_matrix(product, right_q, NULL), BAT_OK);
        check_status(rotation.log(&rotation, p, q, v), BAT_OK);
        check_status(rotation.log(&rotation, left_p, left_q, left), BAT_OK);
        check_status(rotation.log(&rotation, right_p, right_q, right), BAT_OK);
        double tolerance = 1e-14 / (1e-3 + PI - rotation.distance(&rotation, p, q));
        for (int k = 0; k < 3; k++)
        {
            check_near(left[k], v[k], tolerance);
            check_near(right[k], m[k] * v[0] + m[3 + k] * v[1] + m[6 + k] * v[2], tolerance);
        }
    }
}

static void half_turns_are_the_cut_locus(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    double p[4] = {1, 0, 0, 0}, half_turn[4] = {0, 0.6, 0, 0.8}, v[3] = {1, 2, 3}, w[3], q[4];
    check_status(rotation.log(&rotation, p, half_turn, v), BAT_CUT_LOCUS);
    check_status(rotation.transport(&rotation, p, half_turn, v, w), BAT_CUT_LOCUS);
    check_status(rotation.geodesic(&rotation, p, half_turn, 0.5, q), BAT_CUT_LOCUS);
    check_near(rotation.distance(&rotation, p, half_turn), PI, 1e-15);
    double near[4] = {1e-9, 0.6, 0, 0.8};
    check_status(rotation.log(&rotation, p, near, v), BAT_OK);
    check_near(v[0], 0.6 * (PI - 2e-9), 1e-14);
    check_near(v[2], 0.8 * (PI - 2e-9), 1e-14);
    bat_error error;
    double both[8] = {1, 0, 0, 0, 0, 0.6, 0, 0.8};
    bat_curve curve = {.space = &rotation, .points = both, .count = 2}, fine = {0};
    bat_curve_refine_options options = bat_curve_refine_defaults();
    check_status(bat_curve_scheme_by_name("log-exp-4", &options.scheme, &error), BAT_OK);
    check_status(bat_curve_refine(&curve, &options, &fine, &error), BAT_CUT_LOCUS);
}

static void forms_agree(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(4);
    for (int trial = 0; trial < 1000; trial++)
    {
        double v[3], q[4], r[4], m[9], w[3];
        double angle = manifold_separation(&random, PI), length;
        do
        {
            for (int i = 0; i < 3; i++)
                v[i] = bat_random_normal(&random);
            length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        } while (length < 0.1);
        for (int i = 0; i < 3; i++)
            v[i] *= angle / length;
        check_status(bat_rotation_from_vector(v, q, NULL), BAT_OK);
        bat_rotation_to_vector(q, w);
        for (int i = 0; i < 3; i++)
            check_near(w[i], v[i], 2e-15 * angle);
        bat_rotation_to_matrix(q, m);
        check_status(bat_rotation_from_matrix(m, r, NULL), BAT_OK);
        assert_true(r[0] >= 0);
        check_near(rotation.distance(&rotation, q, r), 0, 2e-15);
        check_status(bat_rotation_nearest(m, r, NULL), BAT_OK);
        check_near(rotation.distance(&rotation, q, r), 0, 4e-15);
        // m v = v: the axis stays; and m turns by the angle
        for (int i = 0; i < 3; i++)
            check_near(m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2], v[i], 2e-15 * angle);
        check_near(m[0] + m[4] + m[8], 1 + 2 * cos(angle), 2e-15);
    }
    // a quarter turn about z takes x to y
    double quarter[3] = {0, 0, PI / 2}, q[4], m[9];
    check_status(bat_rotation_from_vector(quarter, q, NULL), BAT_OK);
    bat_rotation_to_matrix(q, m);
    check_near(m[3], 1, 1e-15);
    check_near(m[1], -1, 1e-15);
}

/// The nearest rotation to R S is R for every positive definite S.
static void nearest_rotation_is_the_polar_factor(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 300; trial++)
    {
        double q[4], r[4], m[9], x[9], s[9], product[9];
        rotation.random_point(&rotation, &random, q);
        bat_rotation_to_matrix(q, m);
        for (int i = 0; i < 9; i++)
            x[i] = bat_random_normal(&random);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                s[3 * i + j] = x[i] * x[j] + x[3 + i] * x[3 + j] + x[6 + i] * x[6 + j] + (i == j ? 0.1 : 0);
        multiply(m, s, product);
        check_status(bat_rotation_nearest(product, r, NULL), BAT_OK);
        check_near(rotation.distance(&rotation, q, r), 0, 1e-13);
    }
}

static void faults_are_named(void **state)
{
    (void)state;
    bat_space rotation = bat_rotation();
    bat_error error;
    double q[4] = {1, 0, 0, 0.001}, unit[4], zero[4] = {0}, infinite[4] = {INFINITY, 0, 0, 0};
    assert_string_equal(rotation.fault(&rotation, q), "not a quaternion of unit length");
    assert_string_equal(rotation.fault(&rotation, infinite), "not finite");
    check_status(rotation.project(&rotation, q, unit), BAT_OK);
    assert_null(rotation.fault(&rotation, unit));
    check_status(rotation.project(&rotation, zero, unit), BAT_INVALID_POINT);
    check_status(rotation.project(&rotation, infinite, unit), BAT_INVALID_POINT);
    double far[3] = {1e300, 0, 0}, p[4] = {1, 0, 0, 0};
    check_status(rotation.exp(&rotation, p, far, q), BAT_INVALID_POINT);
    check_status(bat_rotation_from_vector(far, q, &error), BAT_INVALID_POINT);
    double reflection[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, skewed[9] = {1, 1e-6, 0, 0, 1, 0, 0, 0, 1}, m[9] = {NAN};
    check_status(bat_rotation_from_matrix(reflection, q, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "the matrix is a reflection: its determinant is -1");
    check_status(bat_rotation_from_matrix(skewed, q, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "the matrix is not orthogonal");
    check_status(bat_rotation_from_matrix(m, q, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "the matrix is not finite");
    check_status(bat_rotation_nearest(m, q, NULL), BAT_INVALID_POINT);
    check_status(bat_rotation_nearest(reflection, q, &error), BAT_INVALID_POINT);
    memset(m, 0, sizeof m);
    check_status(bat_rotation_nearest(m, q, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "the matrix is equally near to several rotations");
    check_status(bat_rotation_nearest(skewed, q, NULL), BAT_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identities_hold),
        cmocka_unit_test(meets_reference),
        cmocka_unit_test(both_signs_are_one_rotation),
        cmocka_unit_test(turning_everything_changes_nothing),
        cmocka_unit_test(half_turns_are_the_cut_locus),
        cmocka_unit_test(forms_agree),
        cmocka_unit_test(nearest_rotation_is_the_polar_factor),
        cmocka_unit_test(faults_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "manifold_checks.h"

static const double PI = 3.14159265358979323846;

static void identities_hold(void **state)
{
    (void)state;
    bat_space rigid;
    check_status(bat_rigid(0.7, &rigid, NULL), BAT_OK);
    manifold_check(&(manifold_case){.space = &rigid, .seed = 1, .trials = 1000, .reach = PI - 1e-6, .rounding = 1e-14});
    const bat_space spaces[] = {bat_positive_definite(2), bat_sphere(2), bat_euclidean(3), bat_hyperbolic(3),
                                bat_rotation()};
    const double weights[] = {0.5, 2, 1, 3, 1.5};
    const bat_product_factors factors = {.spaces = spaces, .weights = weights, .count = 5};
    bat_space product;
    check_status(bat_product(&factors, &product, NULL), BAT_OK);
    assert_int_equal(product.dimension, 3 + 2 + 3 + 3 + 3);
    assert_int_equal(product.point_dim, 3 + 3 + 3 + 4 + 4);
    assert_int_equal(product.tangent_dim, 3 + 3 + 3 + 3 + 3);
    check_near(product.injectivity, 1.5 * PI, 1e-15);
    manifold_check(&(manifold_case){.space = &product, .seed = 2, .trials = 500, .reach = 4.5, .rounding = 4e-13});
    // a product is a space like any other
    const bat_space nested[] = {product, rigid};
    const bat_product_factors outer = {.spaces = nested, .count = 2};
    bat_space both;
    check_status(bat_product(&outer, &both, NULL), BAT_OK);
    check_near(both.injectivity, PI, 1e-15);
    manifold_check(&(manifold_case){.space = &both, .seed = 3, .trials = 200, .reach = 3, .rounding = 4e-13});
}

static void rigid_motions_are_a_product(void **state)
{
    (void)state;
    const bat_space spaces[] = {bat_euclidean(3), bat_rotation()};
    const double weights[] = {0.25, 1};
    const bat_product_factors factors = {.spaces = spaces, .weights = weights, .count = 2};
    bat_space rigid, product;
    check_status(bat_rigid(0.25, &rigid, NULL), BAT_OK);
    check_status(bat_product(&factors, &product, NULL), BAT_OK);
    assert_int_equal(rigid.point_dim, product.point_dim);
    assert_int_equal(rigid.tangent_dim, product.tangent_dim);
    assert_true(rigid.injectivity == product.injectivity);
    bat_random random = bat_random_seed(4), again = random;
    for (int trial = 0; trial < 300; trial++)
    {
        double p[7], q[7], r[7], s[7], u[6] = {1, 2, 3, 0.1, 0.2, 0.3}, v[6], w[6];
        product.random_point(&product, &again, p);
        rigid.random_point(&rigid, &random, r);
        assert_memory_equal(p, r, sizeof p);
        product.random_point(&product, &again, q);
        rigid.random_point(&rigid, &random, r);
        check_relative(rigid.distance(&rigid, p, q), product.distance(&product, p, q), 1e-15);
        check_status(rigid.log(&rigid, p, q, v), BAT_OK);
        check_status(product.log(&product, p, q, w), BAT_OK);
        assert_memory_equal(v, w, sizeof v);
        check_relative(rigid.inner(&rigid, p, u, v), product.inner(&product, p, u, v), 1e-15);
        check_status(rigid.transport(&rigid, p, q, u, v), BAT_OK);
        check_status(product.transport(&product, p, q, u, w), BAT_OK);
        assert_memory_equal(v, w, sizeof v);
        check_status(rigid.exp(&rigid, p, u, r), BAT_OK);
        check_status(product.exp(&product, p, u, s), BAT_OK);
        assert_memory_equal(r, s, sizeof r);
        check_status(rigid.geodesic(&rigid, p, q, 0.3, r), BAT_OK);
        check_status(product.geodesic(&product, p, q, 0.3, s), BAT_OK);
        assert_memory_equal(r, s, sizeof r);
    }
}

/// The pose g p: rotate by `turn` and move by `shift`.
static void move(const double *turn, const double *shift, const double *p, double *image)
{
    double m[9];
    bat_rotation_to_matrix(turn, m);
    for (int i = 0; i < 3; i++)
        image[i] = m[3 * i] * p[0] + m[3 * i + 1] * p[1] + m[3 * i + 2] * p[2] + shift[i];
    const double *a = turn, *b = p + 3;
    image[3] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    image[4] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    image[5] = a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3];
    image[6] = a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1];
}

static void moving_the_fixed_frame_changes_nothing(void **state)
{
    (void)state;
    bat_space rigid, rotation = bat_rotation();
    check_status(bat_rigid(2, &rigid, NULL), BAT_OK);
    bat_random random = bat_random_seed(5);
    for (int trial = 0; trial < 300; trial++)
    {
        double turn[4], shift[3] = {1, -2, 3}, p[7], q[7], gp[7], gq[7], r[7], gr[7], s[7], v[6], gv[6];
        rotation.random_point(&rotation, &random, turn);
        rigid.random_point(&rigid, &random, p);
        rigid.random_point(&rigid, &random, q);
        move(turn, shift, p, gp);
        move(turn, shift, q, gq);
        check_near(rigid.distance(&rigid, p, q), rigid.distance(&rigid, gp, gq), 1e-13);
        check_status(rigid.log(&rigid, p, q, v), BAT_OK);
        check_status(rigid.log(&rigid, gp, gq, gv), BAT_OK);
        for (int i = 3; i < 6; i++)
            check_near(gv[i], v[i], 1e-10);
        check_status(rigid.geodesic(&rigid, p, q, 0.3, r), BAT_OK);
        move(turn, shift, r, gr);
        check_status(rigid.geodesic(&rigid, gp, gq, 0.3, s), BAT_OK);
        check_near(rigid.distance(&rigid, gr, s), 0, 1e-10);
    }
}

static void cut_loci_and_faults_are_the_factors(void **state)
{
    (void)state;
    bat_space rigid, product;
    bat_error error;
    check_status(bat_rigid(1, &rigid, NULL), BAT_OK);
    double p[7] = {0, 0, 0, 1, 0, 0, 0}, half_turn[7] = {5, 0, 0, 0, 1, 0, 0}, off[7] = {0, 0, 0, 2, 0, 0, 0};
    double lost[7] = {NAN, 0, 0, 1, 0, 0, 0}, v[6] = {0}, w[6], q[7], far[6] = {DBL_MAX, 0, 0, 0, 0, 0};
    check_status(rigid.log(&rigid, p, half_turn, v), BAT_CUT_LOCUS);
    check_status(rigid.transport(&rigid, p, half_turn, v, w), BAT_CUT_LOCUS);
    check_status(rigid.geodesic(&rigid, p, half_turn, 0.5, q), BAT_CUT_LOCUS);
    check_near(rigid.distance(&rigid, p, half_turn), hypot(5, PI), 1e-14);
    assert_string_equal(rigid.fault(&rigid, off), "not a quaternion of unit length");
    assert_string_equal(rigid.fault(&rigid, lost), "not finite");
    check_status(rigid.project(&rigid, lost, q), BAT_INVALID_POINT);
    check_status(rigid.project(&rigid, off, q), BAT_OK);
    assert_null(rigid.fault(&rigid, q));
    p[0] = DBL_MAX;
    check_status(rigid.exp(&rigid, p, far, q), BAT_INVALID_POINT);

    const bat_space spaces[] = {bat_sphere(2), bat_positive_definite(2)};
    const bat_product_factors factors = {.spaces = spaces, .count = 2};
    check_status(bat_product(&factors, &product, &error), BAT_OK);
    double good[6] = {0, 0, 1, 1, 0, 1}, antipode[6] = {0, 0, -1, 1, 0, 1}, bad[6] = {0, 0, 1, 1, 2, 1}, u[6];
    assert_null(product.fault(&product, good));
    assert_string_equal(product.fault(&product, bad), "not positive definite");
    check_status(product.project(&product, bad, u), BAT_INVALID_POINT);
    check_status(product.log(&product, good, antipode, u), BAT_CUT_LOCUS);
    check_status(product.log(&product, good, bad, u), BAT_INVALID_POINT);
    check_status(bat_space_check(&product, bad, 1, &error), BAT_INVALID_POINT);
    assert_string_equal(error.text, "point 0 is not positive definite");
}

static void wrong_products_are_refused(void **state)
{
    (void)state;
    bat_space product = {.name = "untouched"};
    bat_error error;
    const bat_space spaces[] = {bat_euclidean(1000), bat_euclidean(25)};
    const double zero[] = {1, 0}, lost[] = {NAN, 1};
    check_status(bat_product(&(bat_product_factors){.spaces = spaces}, &product, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "a product needs at least one factor");
    check_status(bat_product(&(bat_product_factors){spaces, zero, 2}, &product, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "the weight of factor 1 is not a positive number");
    assert_int_equal(error.index, 1);
    check_status(bat_product(&(bat_product_factors){spaces, lost, 2}, &product, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_product(&(bat_product_factors){spaces, NULL, 2}, &product, &error), BAT_TOO_LARGE);
    assert_string_equal(error.text, "with factor 1 a point has more than 1024 coordinates");
    assert_string_equal(product.name, "untouched");
    check_status(bat_rigid(0, &product, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_rigid(-1, &product, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_rigid(INFINITY, &product, &error), BAT_INVALID_ARGUMENT);
    check_status(bat_rigid(NAN, &product, &error), BAT_INVALID_ARGUMENT);
    assert_string_equal(error.text, "the weight of translations is not a positive number");
    assert_string_equal(product.name, "untouched");
}

static void names_are_known(void **state)
{
    (void)state;
    const struct
    {
        const char *name;
        size_t point_dim, dimension;
    } good[] = {{"rotation", 0, 3}, {"rotation", 4, 3},   {"rigid", 0, 6},      {"rigid", 7, 6},
                {"spd", 0, 6},      {"spd", 1, 1},        {"spd", 3, 3},        {"spd", 10, 10},
                {"spd", 528, 528},  {"hyperbolic", 0, 2}, {"hyperbolic", 2, 1}, {"hyperbolic", 12, 11}},
      bad[] = {{"rotation", 3, 0}, {"rigid", 6, 0},      {"spd", 2, 0},          {"spd", 7, 0},
               {"spd", 561, 0},    {"hyperbolic", 1, 0}, {"hyperbolic", 1025, 0}};
    bat_error error;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
    {
        bat_space space;
        check_status(bat_space_by_name(good[i].name, good[i].point_dim, &space, &error), BAT_OK);
        assert_string_equal(space.name, good[i].name);
        assert_int_equal(space.dimension, good[i].dimension);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    {
        bat_space space;
        check_status(bat_space_by_name(bad[i].name, bad[i].point_dim, &space, &error), BAT_INVALID_ARGUMENT);
        assert_non_null(strstr(error.text, "coordinates, not"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identities_hold),
        cmocka_unit_test(rigid_motions_are_a_product),
        cmocka_unit_test(moving_the_fixed_frame_changes_nothing),
        cmocka_unit_test(cut_loci_and_faults_are_the_factors),
        cmocka_unit_test(wrong_products_are_refused),
        cmocka_unit_test(names_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

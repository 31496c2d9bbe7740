#include "research/data/mersenne.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
// cmocka.h needs the four above.
#include <cmocka.h>

// The expected numbers are those of NumPy 1.24's RandomState.

/// Equal but for the last digit of the logarithm and the square root.
static void assert_close(double value, double expected)
{
    assert_true(fabs(value - expected) <= 4e-16 * fabs(expected));
}

static void bits_follow_the_seed(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(42);
    const uint32_t first[] = {1608637542u, 3421126067u, 4083286876u, 787846414u};
    for (size_t i = 0; i < 4; i++)
        assert_int_equal(mersenne_bits(&stream), first[i]);

    stream = mersenne_seed(0);
    assert_int_equal(mersenne_bits(&stream), 2357136044u);
    stream = mersenne_seed(UINT32_MAX);
    assert_int_equal(mersenne_bits(&stream), 419326371u);
    assert_int_equal(mersenne_bits(&stream), 479346978u);
}

static void bits_go_on_past_each_refill(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(42);
    uint32_t drawn[2000];
    for (size_t i = 0; i < 2000; i++)
        drawn[i] = mersenne_bits(&stream);
    assert_int_equal(drawn[623], 1077437785u);
    assert_int_equal(drawn[624], 108880612u);
    assert_int_equal(drawn[1999], 2238969328u);
}

static void uniform_has_53_bits(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(42);
    const double expected[] = {0x1.7f8771e5f51ecp-2, 0x1.e6c4068bbd654p-1, 0x1.76c7e8f1e6751p-1, 0x1.32835d6632cb0p-1};
    for (size_t i = 0; i < 4; i++)
        assert_true(mersenne_uniform(&stream) == expected[i]);
}

static void normal_comes_in_pairs(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(42);
    const double expected[] = {0.4967141530112327, -0.13826430117118466, 0.6476885381006925, 1.5230298564080254,
                               -0.23415337472333597};
    for (size_t i = 0; i < 5; i++)
        assert_close(mersenne_normal(&stream), expected[i]);
}

static void spare_normal_outlives_other_draws(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(3);
    assert_close(mersenne_normal(&stream), 0x1.c9e38e3e13df2p+0);
    assert_true(mersenne_uniform(&stream) == 0x1.29e2ee8f87b1ep-2);
    assert_int_equal(mersenne_below(&stream, 3), 0);
    assert_close(mersenne_normal(&stream), 0x1.befc703152c8ap-2);
    assert_close(mersenne_normal(&stream), -0x1.bd80f8e1fbeb8p+0);
}

static void below_rejects_as_choice_does(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(7);
    const uint32_t thirds[] = {0, 1, 2, 0, 1, 2, 0, 1, 2, 2, 2, 0, 2, 0, 0, 0, 0, 2, 2, 0, 0, 1, 0, 0};
    for (size_t i = 0; i < sizeof thirds / sizeof *thirds; i++)
        assert_int_equal(mersenne_below(&stream, 3), thirds[i]);
    assert_true(mersenne_uniform(&stream) == 0x1.0ce2c2832fe5cp-2);

    stream = mersenne_seed(7);
    const uint32_t thousandths[] = {175, 196, 537, 502, 579, 211, 919, 615, 348, 185};
    for (size_t i = 0; i < sizeof thousandths / sizeof *thousandths; i++)
        assert_int_equal(mersenne_below(&stream, 1000), thousandths[i]);
    assert_int_equal(mersenne_below(&stream, 1), 0); // draws nothing
    assert_true(mersenne_uniform(&stream) == 0x1.13b5bb10e3428p-1);
}

static void permutation_shuffles_from_the_end(void **state)
{
    (void)state;
    mersenne stream = mersenne_seed(42);
    size_t order[1200];
    const size_t ten[] = {8, 1, 5, 0, 7, 2, 9, 4, 3, 6};
    mersenne_permutation(&stream, order, 10);
    assert_memory_equal(order, ten, sizeof ten);
    mersenne_permutation(&stream, order, 1);
    assert_int_equal(order[0], 0);
    const size_t seven[] = {4, 1, 0, 3, 5, 6, 2};
    mersenne_permutation(&stream, order, 7);
    assert_memory_equal(order, seven, sizeof seven);
    assert_true(mersenne_uniform(&stream) == 0x1.24975bb5443e8p-3);

    stream = mersenne_seed(42);
    mersenne_permutation(&stream, order, 1200);
    const size_t first[] = {1178, 865, 101, 439, 58, 1120};
    assert_memory_equal(order, first, sizeof first);
    assert_int_equal(order[1199], 1126);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_follow_the_seed),
        cmocka_unit_test(bits_go_on_past_each_refill),
        cmocka_unit_test(uniform_has_53_bits),
        cmocka_unit_test(normal_comes_in_pairs),
        cmocka_unit_test(spare_normal_outlives_other_draws),
        cmocka_unit_test(below_rejects_as_choice_does),
        cmocka_unit_test(permutation_shuffles_from_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

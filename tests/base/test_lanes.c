#include "check.h"

#include "base/lanes.h"
#include "batten/base.h"

static const double EPSILON = 2.220446049250313e-16;

/// Against the C library, which is correct to about one unit in the last place.
static void functions_agree_with_the_c_library(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(4);
    for (int i = 0; i < 200000; i++)
    {
        double scale = pow(10, -300 * bat_random_uniform(&random) * (i & 1));
        double x = bat_random_normal(&random) * scale, y = bat_random_normal(&random) * scale;
        check_relative(lane_atan2(y, x), atan2(y, x), 4 * EPSILON);
        double angle = (2 * bat_random_uniform(&random) - 1) * 0.7853981633974483;
        check_relative(lane_tan(angle * scale), tan(angle * scale), 4 * EPSILON);
        double s = 9.869604401089358 * bat_random_uniform(&random);
        s *= i % 3 == 0 ? scale : 1;
        check_near(lane_cos_root(s), cos(sqrt(s)), 8 * EPSILON);
        check_near(lane_sinc_root(s), s > 0 ? sin(sqrt(s)) / sqrt(s) : 1, 8 * EPSILON);
        double t = 0.41421356 * bat_random_uniform(&random) * (i % 3 == 0 ? scale : 1);
        check_relative(lane_atan_over_root(t * t), t * t > 0 ? atan(t) / t : 1, 4 * EPSILON);
    }
}

static void axes_and_the_origin_are_exact(void **state)
{
    (void)state;
    assert_true(lane_atan2(0, 0) == 0);
    assert_true(lane_atan2(0, 1) == 0);
    assert_true(lane_atan2(1, 0) == LANES_HALF_PI);
    assert_true(lane_atan2(-1, 0) == -LANES_HALF_PI);
    assert_true(lane_atan2(0, -1) == LANES_PI);
    assert_true(lane_atan2(-0.0, -1) == -LANES_PI);
    assert_true(lane_tan(0) == 0);
    assert_true(lane_cos_root(0) == 1);
    assert_true(lane_sinc_root(0) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(functions_agree_with_the_c_library),
        cmocka_unit_test(axes_and_the_origin_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

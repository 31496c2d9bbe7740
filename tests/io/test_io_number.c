#include "test_io_helpers.h"

#include "io/common/number_text.h"
#include "space/degrees.h"

#include <float.h>
#include <stdio.h>

static void check_round_trip(double value)
{
    char text[NUMBER_TEXT_SIZE + 1];
    char *end = number_write(text, value);
    assert_true(end - text <= NUMBER_TEXT_SIZE);
    *end = '\0';
    double back = strtod(text, NULL), read = 0.0;
    assert_memory_equal(&back, &value, sizeof value);
    assert_null(number_read(text, end, &read));
    assert_memory_equal(&read, &value, sizeof value);
}

static double from_bits(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void numbers_read_back_as_the_same_double(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(7);
    for (int i = 0; i < 200000; i++)
    {
        double any = from_bits(bat_random_bits(&random));
        if (isfinite(any))
            check_round_trip(any);
        double usual = ldexp(bat_random_uniform(&random) - 0.5, (int)(bat_random_bits(&random) % 70) - 18);
        check_round_trip(usual);
        check_round_trip(nextafter(floor(usual), INFINITY));
    }
    const double special[] = {0.0,      -0.0, DBL_MAX, -DBL_MAX, DBL_MIN, DBL_TRUE_MIN, 1e-5,    1e15,
                              1e15 + 1, 1e16, 1e22,    1e23,     0.1,     0.3,          1.0 / 3, 9.999999999999999e14};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
    {
        check_round_trip(special[i]);
        check_round_trip(nextafter(special[i], 0.0));
        check_round_trip(nextafter(special[i], 2.0));
    }
    for (int power = -1074; power < 1024; power++)
        check_round_trip(ldexp(1.0, power));
}

static void numbers_are_as_short_as_printf_makes_them(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(11);
    for (int i = 0; i < 100000; i++)
    {
        double value = ldexp(0.5 + bat_random_uniform(&random), (int)(bat_random_bits(&random) % 60) - 13);
        char text[NUMBER_TEXT_SIZE + 1], expected[64];
        *number_write(text, value) = '\0';
        for (int digits = 15; digits <= 17; digits++)
        {
            (void)snprintf(expected, sizeof expected, "%.*g", digits, value);
            if (strtod(expected, NULL) == value)
                break;
        }
        if (strchr(expected, 'e') == NULL)
            assert_string_equal(text, expected);
    }
}

static void fixed_numbers_have_no_trailing_zeros(void **state)
{
    (void)state;
    const struct
    {
        int64_t units;
        int decimals;
        const char *text;
    } cases[] = {{0, 10, "0"},
                 {1, 10, "0.0000000001"},
                 {-1800000000000, 10, "-180"},
                 {-125, 1, "-12.5"},
                 {1234500, 5, "12.345"},
                 {42, 0, "42"},
                 {-179999999999999999, 15, "-179.999999999999999"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char text[NUMBER_TEXT_SIZE + 1];
        *number_write_fixed(text, cases[i].units, cases[i].decimals) = '\0';
        assert_string_equal(text, cases[i].text);
    }
}

static void what_is_no_decimal_number_is_refused(void **state)
{
    (void)state;
    const char *bad[] = {"",    "-",   "+",    ".",     "e5",  "1e",  "1e+", "0x10",
                         "nan", "inf", "-inf", "1.2.3", "1 2", "1,5", "1f",  "--1"};
    double value;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_string_equal(number_read(bad[i], bad[i] + strlen(bad[i]), &value), "is not a number");
    const char *large[] = {"1e309", "-2e308", "1e999999999999", "100000000000000000000e300"};
    for (size_t i = 0; i < sizeof large / sizeof *large; i++)
        assert_string_equal(number_read(large[i], large[i] + strlen(large[i]), &value), "is too large");
    const char *good[] = {
        "1", "+1", "1.", ".5", "-.5e-3", "1E+2", "00012", "1e-400", "0.1234567890123456789", "0e999999999999"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
    {
        assert_null(number_read(good[i], good[i] + strlen(good[i]), &value));
        assert_true(value == strtod(good[i], NULL));
    }
}

/// Halfway between 1 and the next double, which rounds to the even 1, and slightly more.
static void long_numbers_round_right(void **state)
{
    (void)state;
    enum
    {
        ZEROS = 5000
    };
    static const char halfway[] = "1.00000000000000011102230246251565404236316680908203125";
    char text[sizeof halfway + ZEROS + 16];
    double value;
    assert_null(number_read(halfway, halfway + sizeof halfway - 1, &value));
    assert_true(value == 1.0);
    (void)strcpy(text, halfway);
    memset(text + sizeof halfway - 1, '0', ZEROS);
    for (char last = '0'; last <= '1'; last++)
    {
        text[sizeof halfway - 1 + ZEROS] = last;
        assert_null(number_read(text, text + sizeof halfway + ZEROS, &value));
        assert_true(value == (last == '0' ? 1.0 : 1.0 + DBL_EPSILON));
    }
    // The exponent may compensate for any number of zeros on either side of the point.
    text[0] = '.';
    memset(text + 1, '0', ZEROS);
    (void)strcpy(text + 1 + ZEROS, "125e5001");
    assert_null(number_read(text, text + strlen(text), &value));
    assert_true(value == 1.25);
    text[0] = '8';
    (void)strcpy(text + 1 + ZEROS, "e-5001");
    assert_null(number_read(text, text + strlen(text), &value));
    assert_true(value == 0.8);
}

/// Numbers of up to 21 digits and powers of ten of all sizes, against strtod().
static void numbers_of_any_length_round_right(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(13);
    for (int i = 0; i < 400000; i++)
    {
        char text[64];
        int digits = 1 + (int)(bat_random_bits(&random) % 21), point = (int)(bat_random_bits(&random) % 24) - 1, size = 0;
        for (int k = 0; k < digits; k++)
        {
            if (k == point)
                text[size++] = '.';
            text[size++] = (char)('0' + bat_random_bits(&random) % (i % 2 == 0 ? 10 : 2));
        }
        if (i % 3 == 0)
            size += snprintf(text + size, sizeof text - (size_t)size, "e%d", (int)(bat_random_bits(&random) % 70) - 35);
        text[size] = '\0';
        double value = 0.0, expected = strtod(text, NULL);
        assert_null(number_read(text, text + size, &value));
        if (value != expected)
            fail_msg("%s is read as %.17g", text, value);
    }
}

static void numbers_end_where_they_end(void **state)
{
    (void)state;
    static const struct
    {
        const char *text;
        int size; ///< of the number; -1 when there is none
    } cases[] = {{"1", 1},  {"-1.5e3 2", 6}, {"1.2.3", 3},  {"1e5e5", 3}, {"7/8", 1},  {"+.5#", 3},
                 {"1.", 2}, {"1ex", -1},     {"1e", -1},    {"x", -1},    {"", -1},    {"-", -1},
                 {".", -1}, {"nan", -1},     {"1e400", -1}, {"0x10", 1},  {"12\n", 2}, {"1e-400 ", 6}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        double value;
        const char *text = cases[i].text, *end = number_scan(text, text + strlen(text), &value);
        if (cases[i].size < 0)
            assert_null(end);
        else
            assert_ptr_equal(end, text + cases[i].size);
    }
    static const char cut[] = "123";
    double value;
    assert_ptr_equal(number_scan(cut, cut + 2, &value), cut + 2);
    assert_true(value == 12);
    assert_null(number_scan(cut, cut, &value));
}

static void right_angles_are_exact(void **state)
{
    (void)state;
    const double east[3] = {0, 1, 0}, west[3] = {-1, 0, 0}, north[3] = {0, 0, 1};
    double point[3];
    degrees_to_point(90, 0, point);
    assert_memory_equal(point, east, sizeof point);
    degrees_to_point(-180, 0, point);
    assert_memory_equal(point, west, sizeof point);
    degrees_to_point(540 - 360, 0, point);
    assert_memory_equal(point, west, sizeof point);
    degrees_to_point(-77, 90, point);
    assert_memory_equal(point, north, sizeof point);
}

static void degrees_survive_the_unit_vector(void **state)
{
    (void)state;
    bat_random random = bat_random_seed(3);
    double units = degree_units_per_radian(10);
    for (int i = 0; i < 100000; i++)
    {
        int64_t longitude = (int64_t)(bat_random_uniform(&random) * 3599999999999.0) - 1799999999999;
        int64_t latitude = (int64_t)(bat_random_uniform(&random) * 1799000000000.0) - 899500000000;
        double point[3];
        degrees_to_point((double)longitude * 1e-10, (double)latitude * 1e-10, point);
        assert_true(fabs(point[0] * point[0] + point[1] * point[1] + point[2] * point[2] - 1) < 5e-16);
        degree_units back = degrees_of_point(point, units);
        assert_true(back.longitude == longitude && back.latitude == latitude);
    }
}

static void the_edge_of_the_map_shows_as_such_at_any_precision(void **state)
{
    (void)state;
    for (int decimals = 0; decimals <= DEGREE_MAX_DECIMALS; decimals++)
    {
        double units = degree_units_per_radian(decimals);
        int64_t degree = number_power_of_ten(decimals);
        const double west[3] = {-1, 0, 0}, east[3] = {-1, -0.0, 0}, south[3] = {0, 0, -1};
        assert_true(degrees_of_point(west, units).longitude == 180 * degree);
        assert_true(degrees_of_point(east, units).longitude == -180 * degree);
        assert_true(degrees_of_point(south, units).latitude == -90 * degree);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(numbers_read_back_as_the_same_double),
                                       cmocka_unit_test(numbers_are_as_short_as_printf_makes_them),
                                       cmocka_unit_test(fixed_numbers_have_no_trailing_zeros),
                                       cmocka_unit_test(what_is_no_decimal_number_is_refused),
                                       cmocka_unit_test(long_numbers_round_right),
                                       cmocka_unit_test(numbers_of_any_length_round_right),
                                       cmocka_unit_test(numbers_end_where_they_end),
                                       cmocka_unit_test(right_angles_are_exact),
                                       cmocka_unit_test(degrees_survive_the_unit_vector),
                                       cmocka_unit_test(the_edge_of_the_map_shows_as_such_at_any_precision)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

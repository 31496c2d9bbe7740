#include "check.h"

#include "draw/common/ticks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void ticks_are_round(void **state)
{
    (void)state;
    tick_list ticks = ticks_linear(-0.11, 0.52, 6.0);
    char label[TICK_LABEL_SIZE];
    assert_int_equal(ticks.count, 7);
    tick_label(&ticks, 0, label);
    assert_string_equal(label, "\xe2\x80\x93"
                               "0.1");
    tick_label(&ticks, 1, label);
    assert_string_equal(label, "0.0");
    tick_label(&ticks, 6, label);
    assert_string_equal(label, "0.5");
    for (int i = 0; i < 200; i++) // never too many, never none, whatever the range
    {
        double low = 1.1 * pow(10.0, -150.0 + i);
        double high = low * (1.5 + i);
        assert_true(ticks_linear(low, high, 8.0).count >= 2);
        assert_true(ticks_linear(-high, low, 8.0).count <= TICKS_MAX);
    }
}

static void scales_are_told(void **state)
{
    (void)state;
    const struct
    {
        double low, high;
        const char *text;
    } cases[] = {{0.0, 99999.0, ""},
                 {-2e6, 1.0,
                  "\xc3\x97"
                  "10\xe2\x81\xb6"},
                 {0.0, 4e-5,
                  "\xc3\x97"
                  "10\xe2\x81\xbb\xe2\x81\xb6"},
                 {405e3, 455e3,
                  "\xc3\x97"
                  "10\xc2\xb3"},
                 {999.0, 1001.0, ""},
                 {999500.0, 1000500.0, "+1000000"},
                 {999999.0, 1000001.0, "+1000000"},
                 {-1000001.0, -999999.0,
                  "\xe2\x80\x93"
                  "1000000"},
                 {4499999.994, 4500000.006,
                  "\xc3\x97"
                  "10\xe2\x81\xbb\xc2\xb3 + 4500000"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    {
        char text[TICK_SCALE_SIZE];
        tick_scale_text(ticks_scale(cases[i].low, cases[i].high), text);
        assert_string_equal(text, cases[i].text);
    }
}

/// Whatever the range, labels are short, differ, and mean their ticks.
static void labels_are_short_and_differ(void **state)
{
    (void)state;
    const double shares[] = {0.0, 0.5, -1.0, 30.0, -4e3, 1e5, 3e6, -2e8};
    for (int power = -14; power <= 14; power++)
    {
        for (size_t i = 0; i < sizeof shares / sizeof *shares; i++)
        {
            double range = 1.7 * pow(10.0, power);
            double low = shares[i] * range;
            tick_list ticks = ticks_linear(low, low + range, 7.0);
            ticks_use_scale(&ticks, ticks_scale(low, low + range));
            char before[TICK_LABEL_SIZE] = "";
            for (size_t k = 0; k < ticks.count; k++)
            {
                char label[TICK_LABEL_SIZE];
                tick_label(&ticks, k, label);
                assert_true(strlen(label) <= 12 && strcmp(label, before) != 0);
                bool minus = strncmp(label, "\xe2\x80\x93", 3) == 0;
                double shown = minus ? -strtod(label + 3, NULL) : strtod(label, NULL);
                double meant = shown * pow(10.0, ticks.scale.exponent) + ticks.scale.offset;
                check_near(meant, ticks.values[k], 1e-6 * range);
                (void)strcpy(before, label);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ticks_are_round),
        cmocka_unit_test(scales_are_told),
        cmocka_unit_test(labels_are_short_and_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

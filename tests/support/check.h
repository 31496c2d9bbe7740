#ifndef TESTS_SUPPORT_CHECK_H
#define TESTS_SUPPORT_CHECK_H

// What cmocka needs before it, and comparisons of doubles that say by how much they failed.

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static inline void check_near_at(double actual, double expected, double tolerance, const char *file, int line)
{
    if (fabs(actual - expected) <= tolerance)
        return;
    print_error("%s:%d: %.17g is not within %g of %.17g (off by %g)\n", file, line, actual, tolerance, expected,
                actual - expected);
    fail();
}

/// |actual - expected| <= tolerance; fails on NaN.
#define check_near(actual, expected, tolerance) check_near_at((actual), (expected), (tolerance), __FILE__, __LINE__)
/// The same relative to the expected value.
#define check_relative(actual, expected, tolerance)                                                                         \
    check_near_at((actual), (expected), (tolerance)*fabs(expected), __FILE__, __LINE__)
#define check_status(actual, expected) assert_int_equal((actual), (expected))

#endif

#include "io/number_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

__extension__ typedef unsigned __int128 wide;

enum
{
    MAX_POWER = 18,         ///< the largest power of ten in an int64_t
    EXACT_POWER = 22,       ///< the largest power of ten that is a double
    SIGNIFICANT_DIGITS = 17 ///< always enough for a double
};

int64_t number_power_of_ten(int decimals)
{
    static const int64_t powers[MAX_POWER + 1] = {1,
                                                  10,
                                                  100,
                                                  1000,
                                                  10000,
                                                  100000,
                                                  1000000,
                                                  10000000,
                                                  100000000,
                                                  1000000000,
                                                  10000000000,
                                                  100000000000,
                                                  1000000000000,
                                                  10000000000000,
                                                  100000000000000,
                                                  1000000000000000,
                                                  10000000000000000,
                                                  100000000000000000,
                                                  1000000000000000000};
    return powers[decimals];
}

static int digit_count(uint64_t value)
{
    int digits = 1;
    while (digits <= MAX_POWER && value >= (uint64_t)number_power_of_ten(digits))
        digits++;
    return digits;
}

/// Write exactly `digits` digits, with leading zeros.
static char *write_padded(char *out, uint64_t value, int digits)
{
    static const char pairs[] =
        "0001020304050607080910111213141516171819202122232425262728293031323334353637383940414243444546"
        "4748495051525354555657585960616263646566676869707172737475767778798081828384858687888990919293"
        "949596979899";
    int left = digits;
    for (; left >= 2; left -= 2)
    {
        memcpy(out + left - 2, pairs + 2 * (value % 100), 2);
        value /= 100;
    }
    if (left == 1)
        *out = (char)('0' + value);
    return out + digits;
}

/// Write `units` * 10^-decimals without trailing zeros, 0 <= decimals <= 21, units < 10^18.
static char *write_decimal(char *out, uint64_t units, int decimals)
{
    uint64_t whole = 0;
    uint64_t fraction = units;
    int zeros = decimals > MAX_POWER ? decimals - MAX_POWER : 0;
    if (zeros == 0)
    {
        uint64_t one = (uint64_t)number_power_of_ten(decimals);
        whole = units / one;
        fraction = units % one;
    }
    out = write_padded(out, whole, digit_count(whole));
    if (fraction == 0)
        return out;
    *out++ = '.';
    for (int i = 0; i < zeros; i++)
        *out++ = '0';
    out = write_padded(out, fraction, decimals - zeros);
    while (out[-1] == '0')
        out--;
    return out;
}

char *number_write_fixed(char *out, int64_t units, int decimals)
{
    if (units < 0)
        *out++ = '-';
    return write_decimal(out, units < 0 ? (uint64_t)-units : (uint64_t)units, decimals);
}

/// The number of digits before the point of 1e-5 <= value < 1e15; zero or negative counts the zeros after it.
static int leading_digits(double value)
{
    if (value >= 1.0)
        return digit_count((uint64_t)value);
    int digits = 0;
    for (double bound = 0.1; value < bound; bound /= 10.0)
        digits--;
    return digits;
}

/// Shortest digits of 1e-5 <= value < 1e15 by exact integers. With value = m 2^-s and N = m 10^k, a decimal c 10^-k is read back
/// as the value when |c 2^s - N| < 10^k / 2, half a unit in the last place (half of that below a power of two).
static char *write_fraction(char *out, double value)
{
    int exponent;
    double mantissa = frexp(value, &exponent);
    uint64_t m = (uint64_t)ldexp(mantissa, 53);
    int s = 53 - exponent;
    int k = SIGNIFICANT_DIGITS - leading_digits(value);
    wide power = k <= MAX_POWER ? (wide)number_power_of_ten(k)
                                : (wide)number_power_of_ten(MAX_POWER) * (wide)number_power_of_ten(k - MAX_POWER);
    wide n = (wide)m * power;
    uint64_t digits = (uint64_t)(n >> s);
    wide below = n - ((wide)digits << s);
    wide tolerance = mantissa == 0.5 ? power / 4 : power / 2;
    for (int drop = 2;; drop--)
    {
        uint64_t step = (uint64_t)number_power_of_ten(drop);
        uint64_t candidate = digits / step;
        wide error = ((wide)(digits % step) << s) + below;
        wide unit = (wide)step << s;
        if (2 * error > unit || (2 * error == unit && candidate % 2 == 1))
        {
            candidate++;
            error = unit - error;
        }
        if (drop == 0 || error < tolerance)
            return write_decimal(out, candidate, k - drop);
    }
}

/// What printf() writes for "%.*g" of a positive number, with a point in place of the locale's decimal separator.
static char *write_digits(char *out, double value, int digits)
{
    char text[2 * NUMBER_TEXT_SIZE];
    (void)snprintf(text, sizeof text, "%.*g", digits, value);
    const char *at = text;
    for (; *at >= '0' && *at <= '9'; at++)
        *out++ = *at;
    if (*at == '\0' || *at == 'e')
        return stpcpy(out, at);
    while (*at < '0' || *at > '9')
        at++;
    *out++ = '.';
    return stpcpy(out, at);
}

/// Any positive finite number, slowly.
static char *write_general(char *out, double value)
{
    char text[NUMBER_TEXT_SIZE];
    double back = 0.0;
    for (int digits = 15; digits <= SIGNIFICANT_DIGITS && back != value; digits++)
        (void)number_read(text, write_digits(text, value, digits), &back);
    return stpcpy(out, text);
}

char *number_write(char *out, double value)
{
    static const double smallest = 1e-5, largest = 1e15;
    if (signbit(value))
        *out++ = '-';
    value = fabs(value);
    if (value < largest && value == floor(value))
        return write_decimal(out, (uint64_t)value, 0);
    if (value >= smallest && value < largest)
        return write_fraction(out, value);
    return write_general(out, value);
}

/// The parts of a decimal number: all its digits as one integer, times 10^exponent.
typedef struct decimal
{
    uint64_t mantissa; ///< that integer, as far as 18 digits go
    int64_t digits;    ///< its significant ones
    int64_t exponent;
    bool negative;
} decimal;

static bool is_digit(const char *at, const char *end)
{
    return at < end && *at >= '0' && *at <= '9';
}

static const char *scan_digits(const char *at, const char *end, decimal *number, int exponent_step)
{
    for (; is_digit(at, end); at++)
    {
        unsigned digit = (unsigned)(*at - '0');
        if (number->digits > 0 || digit > 0)
            number->digits++;
        if (number->digits <= 18)
            number->mantissa = 10 * number->mantissa + digit;
        number->exponent -= exponent_step;
    }
    return at;
}

static const char *scan_exponent(const char *at, const char *end, decimal *number)
{
    static const int64_t cap = INT64_MAX / 1000; // beyond what any number of digits makes up for
    bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    if (!is_digit(at, end))
        return NULL;
    int64_t exponent = 0;
    for (; is_digit(at, end); at++)
        exponent = exponent > cap ? exponent : 10 * exponent + (*at - '0');
    number->exponent += negative ? -exponent : exponent;
    return at;
}

/// Whether the whole text is [+-] digits [. digits] [e [+-] digits], with a digit before or after the point.
static bool scan_decimal(const char *begin, const char *end, decimal *number)
{
    const char *at = begin;
    number->negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    const char *whole = at;
    at = scan_digits(at, end, number, 0);
    bool any = at > whole;
    if (at < end && *at == '.')
    {
        const char *fraction = ++at;
        at = scan_digits(at, end, number, 1);
        any = any || at > fraction;
    }
    if (any && at < end && (*at == 'e' || *at == 'E'))
        at = scan_exponent(at + 1, end, number);
    return any && at == end;
}

/// The digits as an integer and an exponent, which strtod() reads alike in every locale. No number between two doubles that is
/// halfway has more than 767 digits, so that of those beyond it only matters whether one is not zero.
static double convert_long(const char *at, const char *end, const decimal *number)
{
    enum
    {
        DIGITS = 800,
        EXPONENT_SIZE = 24
    };
    char text[DIGITS + EXPONENT_SIZE];
    size_t size = 0;
    for (; at < end && *at != 'e' && *at != 'E'; at++)
        if (is_digit(at, end) && (size > 0 || *at != '0'))
        {
            if (size < DIGITS)
                text[size++] = *at;
            else if (*at != '0')
                text[DIGITS - 1] = '1';
        }
    if (size == 0)
        return 0.0;
    text[size] = 'e';
    *number_write_fixed(text + size + 1, number->exponent + number->digits - (int64_t)size, 0) = '\0';
    return strtod(text, NULL);
}

const char *number_read(const char *begin, const char *end, double *value)
{
    static const double exact_powers[EXACT_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                         1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                         1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    decimal number = {0};
    if (!scan_decimal(begin, end, &number))
        return "is not a number";
    // Both factors are exact doubles, so that one operation rounds right (Clinger 1990).
    if (number.digits <= 15 && number.exponent >= -EXACT_POWER && number.exponent <= EXACT_POWER)
    {
        double mantissa = (double)number.mantissa;
        *value = number.exponent < 0 ? mantissa / exact_powers[-number.exponent] : mantissa * exact_powers[number.exponent];
    }
    else
        *value = convert_long(begin, end, &number);
    *value = number.negative ? -*value : *value;
    return isfinite(*value) ? NULL : "is too large";
}

bool number_resembles(const char *begin, const char *end)
{
    if (begin < end && (*begin == '-' || *begin == '+'))
        begin++;
    if (begin < end && *begin == '.')
        begin++;
    if (is_digit(begin, end))
        return true;
    size_t size = (size_t)(end - begin);
    return (size == 3 && (strncasecmp(begin, "nan", size) == 0 || strncasecmp(begin, "inf", size) == 0)) ||
           (size == 8 && strncasecmp(begin, "infinity", size) == 0);
}

const char *text_excerpt(char excerpt[EXCERPT_SIZE], const char *begin, const char *end)
{
    size_t size = 0;
    for (; begin < end && size < EXCERPT_SIZE - 1; begin++)
        excerpt[size++] = *begin >= ' ' && *begin <= '~' ? *begin : '?';
    excerpt[size] = '\0';
    return excerpt;
}

#include "io/common/number_text.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <strings.h>

/// @file
/// Decimal text to doubles and back, correctly rounded, by exact integers of 128 bits (Clinger, "How to read floating point
/// numbers accurately", 1990). Rare cases use strtod() and printf().

// 32-bit machines have no 128-bit integers. The C library converts numbers there, as exactly but more slowly.
#if defined(__SIZEOF_INT128__)
__extension__ typedef unsigned __int128 wide;
#endif

enum
{
    MAX_POWER = 18,         ///< the largest power of ten in an int64_t
    EXACT_POWER = 22,       ///< the largest power of ten that is a double
    WIDE_POWER = 27,        ///< the largest power of five in a uint64_t
    MANTISSA_DIGITS = 19,   ///< every uint64_t holds this many digits
    SIGNIFICANT_DIGITS = 17 ///< sufficient for any double
};

int64_t number_power_of_ten(int decimals)
{
    static const int64_t powers[MAX_POWER + 1] = {(int64_t)1e0,  (int64_t)1e1,  (int64_t)1e2,  (int64_t)1e3,  (int64_t)1e4,
                                                  (int64_t)1e5,  (int64_t)1e6,  (int64_t)1e7,  (int64_t)1e8,  (int64_t)1e9,
                                                  (int64_t)1e10, (int64_t)1e11, (int64_t)1e12, (int64_t)1e13, (int64_t)1e14,
                                                  (int64_t)1e15, (int64_t)1e16, (int64_t)1e17, (int64_t)1e18};
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
        "4748495051525354555657585960616263646566676869707172737475767778798081828384858687888990919293949596979899";
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

#if defined(__SIZEOF_INT128__)
/// The number of digits before the decimal point for 1e-5 <= value < 1e15; zeros after the point count as negative.
static int leading_digits(double value)
{
    if (value >= 1.0)
        return digit_count((uint64_t)value);
    int digits = 0;
    for (double bound = 0.1; value < bound; bound /= 10.0)
        digits--;
    return digits;
}

/// Write the shortest digits of 1e-5 <= value < 1e15. Let value = m 2^-s and N = m 10^k. A decimal c 10^-k is read back as
/// the value when |c 2^s - N| < 10^k / 2, half a unit in the last place, or half of that below a power of two.
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

#endif

/// Write a positive number as printf("%.*g") does, with a decimal point in every locale.
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

/// Write any positive finite number, by trial of 15 to 17 digits.
static char *write_general(char *out, double value)
{
    char text[NUMBER_TEXT_SIZE];
    double back = 0.0;
    for (int digits = 15; digits <= SIGNIFICANT_DIGITS && back != value; digits++)
        (void)number_read(text, write_digits(text, value, digits), &back);
    return stpcpy(out, text);
}

#if !defined(__SIZEOF_INT128__)
static char *write_fraction(char *out, double value)
{
    return write_general(out, value);
}
#endif

char *number_write(char *out, double value)
{
    static const double smallest = 1e-5, largest = 1e15;
    if (signbit(value))
        *out++ = '-';
    value = fabs(value);
    if (!isfinite(value))
        return stpcpy(out, isnan(value) ? "nan" : "inf");
    if (value < largest && value == floor(value))
        return write_decimal(out, (uint64_t)value, 0);
    if (value >= smallest && value < largest)
        return write_fraction(out, value);
    return write_general(out, value);
}

/// A decimal number: its digits as an integer, times 10^exponent.
typedef struct decimal
{
    uint64_t mantissa; ///< the integer modulo 2^64; exact for up to 19 significant digits
    size_t digits;     ///< the number of digits, including leading zeros
    int64_t exponent;
    bool negative;
} decimal;

static bool is_digit(const char *at, const char *end)
{
    return at < end && *at >= '0' && *at <= '9';
}

static const char *scan_digits(const char *at, const char *end, decimal *number)
{
    const char *begin = at;
    uint64_t mantissa = number->mantissa;
    for (; is_digit(at, end); at++)
        mantissa = 10 * mantissa + (unsigned)(*at - '0');
    number->mantissa = mantissa;
    number->digits += (size_t)(at - begin);
    return at;
}

static const char *scan_exponent(const char *at, const char *end, decimal *number)
{
    static const int64_t cap = INT64_MAX / 1000; // no number of digits compensates for a larger exponent
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

/// Scan [+-] digits [. digits] [e [+-] digits] with at least one digit before the exponent. Returns the end, or null.
static const char *scan_decimal(const char *at, const char *end, decimal *number)
{
    *number = (decimal){.negative = at < end && *at == '-'};
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    at = scan_digits(at, end, number);
    if (at < end && *at == '.')
    {
        const char *fraction = at + 1;
        at = scan_digits(fraction, end, number);
        number->exponent = fraction - at;
    }
    if (number->digits == 0)
        return NULL;
    return at < end && (*at == 'e' || *at == 'E') ? scan_exponent(at + 1, end, number) : at;
}

/// Convert by strtod(), which reads an integer with an exponent alike in every locale. A midpoint between two doubles has at
/// most 767 digits. So of the digits beyond 800 it only matters whether one is not zero.
static double convert_long(const char *at, const char *end, const decimal *number)
{
    enum
    {
        DIGITS = 800,
        EXPONENT_SIZE = 24
    };
    char text[DIGITS + EXPONENT_SIZE];
    size_t size = 0;
    int64_t significant = 0;
    for (; at < end && *at != 'e' && *at != 'E'; at++)
        if (is_digit(at, end) && (significant > 0 || *at != '0'))
        {
            significant++;
            if (size < DIGITS)
                text[size++] = *at;
            else if (*at != '0')
                text[DIGITS - 1] = '1';
        }
    if (size == 0)
        return 0.0;
    text[size] = 'e';
    *number_write_fixed(text + size + 1, number->exponent + significant - (int64_t)size, 0) = '\0';
    return strtod(text, NULL);
}

#if defined(__SIZEOF_INT128__)
/// `mantissa` * 2^exponent, rounded, for results far from overflow and underflow.
static double scale_by_two(uint64_t mantissa, int exponent)
{
    uint64_t bits = (uint64_t)(DBL_MAX_EXP - 1 + exponent) << (DBL_MANT_DIG - 1);
    double power;
    memcpy(&power, &bits, sizeof power);
    return (double)mantissa * power;
}

/// `mantissa` * 10^exponent for -27 <= exponent <= 27. The product or quotient with 5^27 has at least 62 exact bits. Its
/// last bit is set when there is a remainder, so it rounds like the exact value.
static double convert_wide(uint64_t mantissa, int exponent)
{
    int power = abs(exponent), first = power > MAX_POWER ? MAX_POWER : power, second = power - first;
    // 5^power: the odd part of a power of ten, or of the product of two.
    uint64_t five = ((uint64_t)number_power_of_ten(first) >> first) * ((uint64_t)number_power_of_ten(second) >> second);
    int shift = __builtin_clzll(mantissa);
    mantissa <<= shift;
    if (exponent >= 0)
    {
        wide product = (wide)mantissa * five;
        uint64_t high = (uint64_t)(product >> 64), low = (uint64_t)product;
        if (high == 0)
            return scale_by_two(low, exponent - shift);
        int up = __builtin_clzll(high);
        high = up > 0 ? high << up | low >> (64 - up) : high;
        return scale_by_two(high | (low << up != 0), 64 - up + exponent - shift);
    }
    int divisor_shift = __builtin_clzll(five);
    uint64_t divisor = five << divisor_shift;
    wide dividend = (wide)mantissa << 63;
    uint64_t quotient = (uint64_t)(dividend / divisor);
    bool rest = (uint64_t)dividend != quotient * divisor;
    return scale_by_two(quotient | rest, divisor_shift - shift - 63 + exponent);
}

#endif

/// Convert the number from `begin` to `end`.
static double convert(const char *begin, const char *end, decimal *number)
{
    static const double exact_powers[EXACT_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                         1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                         1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    static const uint64_t exact_mantissa = (uint64_t)1 << DBL_MANT_DIG;
    for (const char *at = begin; number->digits > MANTISSA_DIGITS && at < end && (*at < '1' || *at > '9'); at++)
        number->digits -= *at == '0';
    int64_t exponent = number->exponent;
    bool exact = number->digits <= MANTISSA_DIGITS;
    double value;
    if (exact && number->mantissa == 0)
        value = 0.0;
    // Both factors are exact doubles, so one operation rounds correctly (Clinger, 1990).
    else if (FLT_EVAL_METHOD == 0 && exact && number->mantissa <= exact_mantissa && exponent >= -EXACT_POWER &&
             exponent <= EXACT_POWER)
        value = exponent < 0 ? (double)number->mantissa / exact_powers[-exponent]
                             : (double)number->mantissa * exact_powers[exponent];
#if defined(__SIZEOF_INT128__)
    else if (exact && exponent >= -WIDE_POWER && exponent <= WIDE_POWER)
        value = convert_wide(number->mantissa, (int)exponent);
#endif
    else
        value = convert_long(begin, end, number);
    return number->negative ? -value : value;
}

const char *number_scan(const char *begin, const char *end, double *value)
{
    decimal number;
    const char *at = scan_decimal(begin, end, &number);
    if (at == NULL)
        return NULL;
    *value = convert(begin, at, &number);
    return isfinite(*value) ? at : NULL;
}

const char *number_read(const char *begin, const char *end, double *value)
{
    decimal number;
    if (scan_decimal(begin, end, &number) != end)
        return "is not a number";
    *value = convert(begin, end, &number);
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

void text_append_real(text_buffer *text, const char *before, double value)
{
    text_append_string(text, before);
    char *out = text_reserve(text, NUMBER_TEXT_SIZE);
    if (out != NULL)
        text_advance(text, number_write(out, value));
}

void text_append_fixed(text_buffer *text, const char *before, int64_t units, int decimals)
{
    text_append_string(text, before);
    char *out = text_reserve(text, NUMBER_TEXT_SIZE);
    if (out != NULL)
        text_advance(text, number_write_fixed(out, units, decimals));
}

void text_append_number(text_buffer *text, double value, char after)
{
    text_append_real(text, "", value);
    text_append(text, &after, 1);
}

void text_append_numbers(text_buffer *text, const char *before, const double *numbers, size_t count)
{
    text_append_string(text, before);
    char *out = text_reserve(text, count * (NUMBER_TEXT_SIZE + 1) + 1);
    if (out == NULL)
        return;
    for (size_t i = 0; i < count; i++)
    {
        out = number_write(out, numbers[i]);
        *out++ = i + 1 < count ? ' ' : '\n';
    }
    text_advance(text, out);
}

void text_append_count(text_buffer *text, size_t count, const char *after)
{
    text_append_fixed(text, "", (int64_t)count, 0);
    text_append_string(text, after);
}

void text_append_format(text_buffer *text, const char *format, ...)
{
    char made[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(made, sizeof made, format, arguments);
    va_end(arguments);
    text_append_string(text, made);
}

#include "curve/analysis/analysis_symbol.h"

#include "base/error.h"
#include "curve/mask.h"

#include <float.h>
#include <math.h>

/// Rounding of a coefficient that a reader of decimal numbers or a short formula leaves.
#define COEFFICIENT_ROUNDING (16.0 * DBL_EPSILON)

/// The largest coefficient that can be analysed; beyond it sums of 1 would drown in rounding.

/// Constants are reproduced when the coefficients of even index sum to 1, and those of odd index too.
static bat_status check_sums(const bat_mask *mask, bat_error *error)
{
    double sums[2] = {0.0, 0.0};
    double size = 1.0;
    for (size_t k = 0; k < mask->count; k++)
    {
        sums[(unsigned)(mask->first + (int)k) % 2] += mask->coefficients[k];
        size += fabs(mask->coefficients[k]);
    }
    for (size_t parity = 0; parity < 2; parity++)
    {
        if (!(fabs(sums[parity] - 1.0) <= 4.0 * COEFFICIENT_ROUNDING * size))
            return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                             "the mask's coefficients of %s index sum to %.12g, not 1", parity == 0 ? "even" : "odd",
                             sums[parity]);
    }
    return BAT_OK;
}

static void multiply_by_factor(bat_mask *mask)
{
    for (size_t k = mask->count; k > 0; --k)
        mask->coefficients[k] = (k < mask->count ? mask->coefficients[k] : 0.0) + mask->coefficients[k - 1];
    ++mask->count;
}

/// The first `count` coefficients of the power series a(z) / (1 + z)^n, from the low end (step 1) or, for the reversed
/// polynomial, from the high end (step -1) of the mask.
static void divide_series(const double *start, ptrdiff_t step, size_t n, size_t count, double *series)
{
    for (size_t k = 0; k < count; k++)
        series[k] = start[(ptrdiff_t)k * step];
    for (size_t division = 0; division < n; division++)
        for (size_t k = 1; k < count; k++)
            series[k] -= series[k - 1];
}

bool symbol_divide(const bat_mask *mask, size_t n, bat_mask *quotient, double *remainder)
{
    *quotient = (bat_mask){.count = mask->count - n, .first = mask->first};
    const size_t upper = quotient->count / 2;
    const size_t lower = quotient->count - upper;
    double series[BAT_MASK_MAX];
    divide_series(mask->coefficients, 1, n, lower, quotient->coefficients);
    divide_series(mask->coefficients + mask->count - 1, -1, n, upper, series);
    for (size_t k = 0; k < upper; k++)
        quotient->coefficients[quotient->count - 1 - k] = series[k];

    bat_mask product = *quotient;
    bat_mask size = *quotient;
    for (size_t k = 0; k < size.count; k++)
        size.coefficients[k] = fabs(size.coefficients[k]);
    for (size_t factor = 0; factor < n; factor++)
    {
        multiply_by_factor(&product);
        multiply_by_factor(&size);
    }
    const double tolerance = COEFFICIENT_ROUNDING + 2.0 * (double)n * DBL_EPSILON;
    *remainder = 0.0;
    for (size_t k = 0; k < mask->count; k++)
    {
        const double difference = fabs(mask->coefficients[k] - product.coefficients[k]);
        *remainder = fmax(*remainder, difference);
        if (!(difference <= tolerance * size.coefficients[k]))
            return false;
    }
    return true;
}

bat_status symbol_make(const bat_mask *mask, mask_symbol *result, bat_error *error)
{
    bat_status status = mask_check(mask, error);
    if (status == BAT_OK)
        status = check_sums(mask, error);
    if (status != BAT_OK)
        return status;

    *result = (mask_symbol){.mask = mask_trimmed(mask)};
    const bat_mask *trimmed = &result->mask;
    result->last = trimmed->first + (int)trimmed->count - 1;
    for (size_t k = 0; k < trimmed->count; k++)
        result->shift += 0.5 * (trimmed->first + (int)k) * trimmed->coefficients[k];
    // check_sums() has seen a(-1) = 0, so one factor is there even where this test is a little stricter.
    result->multiplicity = trimmed->count - 1;
    while (!symbol_divide(trimmed, result->multiplicity, &result->quotient, &result->remainder) && result->multiplicity > 1)
        --result->multiplicity;
    return BAT_OK;
}

bat_mask symbol_difference(const mask_symbol *symbol, size_t order)
{
    bat_mask mask = symbol->quotient;
    for (size_t factor = order; factor < symbol->multiplicity; factor++)
        multiply_by_factor(&mask);
    return mask;
}

/// x (x - 1) … (x - n + 1) / n!
static double binomial(double x, size_t n)
{
    double product = 1.0;
    for (size_t j = 0; j < n; j++)
        product *= (x - (double)j) / (double)(j + 1);
    return product;
}

size_t symbol_reproduction_degree(const mask_symbol *symbol)
{
    // Both sides are divided by k! and indices are counted from the middle of the mask, which changes neither condition.
    const double middle = round(symbol->shift);
    size_t degree = 0;
    for (size_t k = 1; k < symbol->multiplicity; k++)
    {
        double moment = 0.0;
        double size = 0.0;
        for (size_t i = 0; i < symbol->mask.count; i++)
        {
            const double term = symbol->mask.coefficients[i] * binomial(symbol->mask.first + (double)i - middle, k);
            moment += term;
            size += fabs(term);
        }
        const double target = 2.0 * binomial(symbol->shift - middle, k);
        if (!(fabs(moment - target) <= COEFFICIENT_ROUNDING * (double)symbol->mask.count * (size + fabs(target))))
            break;
        degree = k;
    }
    return degree;
}

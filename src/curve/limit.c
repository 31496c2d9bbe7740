#include "curve/limit.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/mask.h"
#include "linalg/dense.h"
#include "linalg/vector.h"

#include <string.h>

/// @file
/// Limits of linear schemes. docs/algorithms/curve-analysis.md explains the mathematics.

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
            return ERROR_ARGUMENT(error, "the mask's coefficients of %s index sum to %.12g, not 1",
                                  parity == 0 ? "even" : "odd", sums[parity]);
    }
    return BAT_OK;
}

void mask_multiply_by_factor(bat_mask *mask)
{
    for (size_t k = mask->count; k > 0; --k)
        mask->coefficients[k] = (k < mask->count ? mask->coefficients[k] : 0.0) + mask->coefficients[k - 1];
    ++mask->count;
}

/// The first `count` coefficients of the series a(z) / (1 + z)^n, from the mask's low end (step 1) or high end (step -1).
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
        mask_multiply_by_factor(&product);
        mask_multiply_by_factor(&size);
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

void limit_matrix(const bat_mask *mask, double *matrix)
{
    const ptrdiff_t size = (ptrdiff_t)limit_matrix_size(mask);
    const ptrdiff_t first = limit_matrix_first(mask);
    for (ptrdiff_t row = 0; row < size; row++)
    {
        for (ptrdiff_t column = 0; column < size; column++)
        {
            const ptrdiff_t index = (first + row) - 2 * (first + column) - mask->first;
            matrix[row * size + column] = index >= 0 && index < (ptrdiff_t)mask->count ? mask->coefficients[index] : 0.0;
        }
    }
}

/// Rounding of the weights, in units of epsilon, their count and the largest: limit points, and tangents.
#define POINT_ROUNDING 4.0
#define TANGENT_ROUNDING 64.0

/// Set weights at rounding level to zero and leave out those at the ends.
static void clean_stencil(bat_mask_stencil *stencil, double rounding)
{
    double largest = vector_largest(stencil->count, stencil->weights);
    const double tolerance = rounding * DBL_EPSILON * (double)stencil->count * largest;
    size_t begin = stencil->count;
    size_t end = 0;
    for (size_t k = 0; k < stencil->count; k++)
    {
        if (fabs(stencil->weights[k]) <= tolerance)
            stencil->weights[k] = 0.0;
        else
        {
            begin = k < begin ? k : begin;
            end = k + 1;
        }
    }
    if (begin >= end)
        return;
    memmove(stencil->weights, stencil->weights + begin, (end - begin) * sizeof *stencil->weights);
    memset(stencil->weights + (end - begin), 0, (BAT_MASK_MAX - (end - begin)) * sizeof *stencil->weights);
    stencil->first += (int)begin;
    stencil->count = end - begin;
}

static void scale_to_sum_one(bat_mask_stencil *stencil)
{
    double sum = 0.0;
    for (size_t k = 0; k < stencil->count; k++)
        sum += stencil->weights[k];
    for (size_t k = 0; k < stencil->count; k++)
        stencil->weights[k] /= sum;
}

bat_status limit_left(const bat_mask *mask, double eigenvalue, bool against_index, bat_mask_stencil *stencil,
                      bat_error *error)
{
    const size_t size = limit_matrix_size(mask);
    *stencil = (bat_mask_stencil){.count = size, .first = limit_matrix_first(mask)};
    double *matrix = memory_array(size * size, sizeof *matrix);
    if (matrix == NULL)
        return error_memory(error, size * size * sizeof *matrix);
    limit_matrix(mask, matrix);
    double constraint[BAT_MASK_MAX];
    for (size_t i = 0; i < size; i++)
        constraint[i] = against_index ? (double)i - 0.5 * (double)(size - 1) : 1.0;
    const bat_status status = dense_left_vector(size, matrix, eigenvalue, constraint, stencil->weights, error);
    free(matrix);
    clean_stencil(stencil, against_index ? TANGENT_ROUNDING : POINT_ROUNDING);
    return status;
}

bat_status limit_point(const mask_symbol *symbol, bat_mask_stencil *stencil, bat_error *error)
{
    const bat_status status = limit_left(&symbol->mask, 1.0, false, stencil, error);
    scale_to_sum_one(stencil);
    return status;
}

double limit_weight(const bat_mask_stencil *stencil, int offset)
{
    const int k = offset - stencil->first;
    return k >= 0 && k < (int)stencil->count ? stencil->weights[k] : 0.0;
}

/// values(k) <- sum over l of a(2 k - l + digit) values(l), which takes phi(t + k) to phi((t + digit) / 2 + k).
static void prepend_digit(const bat_mask *mask, unsigned digit, double *values)
{
    const ptrdiff_t size = (ptrdiff_t)mask->count - 1;
    double next[BAT_MASK_MAX];
    for (ptrdiff_t k = 0; k < size; k++)
    {
        next[k] = 0.0;
        for (ptrdiff_t l = 0; l < size; l++)
        {
            const ptrdiff_t index = 2 * k - l + (ptrdiff_t)digit;
            if (index >= 0 && index <= size)
                next[k] += mask->coefficients[index] * values[l];
        }
    }
    memcpy(values, next, (size_t)size * sizeof *values);
}

void limit_vertex(const mask_symbol *symbol, const bat_mask_stencil *point, bat_mask_stencil *stencil)
{
    static const int DIGITS = 40;
    const bat_mask *mask = &symbol->mask;
    const size_t size = mask->count - 1;
    double whole = floor(symbol->shift);
    uint64_t fraction = (uint64_t)llround(ldexp(symbol->shift - whole, DIGITS));
    if (fraction == (uint64_t)1 << DIGITS)
    {
        whole += 1.0;
        fraction = 0;
    }

    // phi(t + k) for k = first … last - 1 and t = 0, then t with the binary digits of the fraction, the last digit first.
    double values[BAT_MASK_MAX];
    for (size_t k = 0; k < size; k++)
        values[k] = limit_weight(point, -(mask->first + (int)k));
    for (size_t digit = 0; digit < DIGITS && fraction != 0; digit++)
    {
        const uint64_t low = fraction & (((uint64_t)1 << (digit + 1)) - 1);
        if (low != 0)
            prepend_digit(mask, (unsigned)(fraction >> digit) & 1u, values);
    }

    // The limit at i + shift weighs point i + m by phi(shift - m), and shift - m = t + k for m = whole - k.
    *stencil = (bat_mask_stencil){.count = size, .first = (int)whole - symbol->last + 1};
    for (size_t m = 0; m < size; m++)
        stencil->weights[m] = values[size - 1 - m];
    clean_stencil(stencil, POINT_ROUNDING);
    scale_to_sum_one(stencil);
}

/// The longest iterated mask that is written out.
#define ITERATED_LIMIT ((size_t)1 << 17)

double mask_operator_norm(const double *coefficients, size_t count, size_t arity)
{
    double norm = 0.0;
    for (size_t residue = 0; residue < arity && residue < count; residue++)
    {
        double sum = 0.0;
        for (size_t i = residue; i < count; i += arity)
            sum += fabs(coefficients[i]);
        norm = fmax(norm, sum);
    }
    return norm;
}

void iterated_mask_end(iterated_mask *iterated)
{
    free(iterated->coefficients);
    free(iterated->next);
}

bat_status iterated_mask_begin(const bat_mask *mask, iterated_mask *iterated, bat_error *error)
{
    const size_t room = ITERATED_LIMIT + 2 * mask->count;
    *iterated = (iterated_mask){.mask = mask,
                                .coefficients = memory_array(room, sizeof(double)),
                                .next = memory_array(room, sizeof(double)),
                                .count = 1,
                                .arity = 1,
                                .norm_of_step = mask_operator_norm(mask->coefficients, mask->count, 2)};
    if (iterated->coefficients == NULL || iterated->next == NULL)
    {
        iterated_mask_end(iterated);
        return error_memory(error, room * sizeof(double));
    }
    iterated->coefficients[0] = 1.0;
    return BAT_OK;
}

bool iterated_mask_step(iterated_mask *iterated)
{
    const size_t count = iterated->count + (iterated->mask->count - 1) * iterated->arity;
    if (count > ITERATED_LIMIT)
        return false;
    memset(iterated->next, 0, count * sizeof *iterated->next);
    for (size_t k = 0; k < iterated->mask->count; k++)
    {
        const double factor = iterated->mask->coefficients[k];
        double *target = iterated->next + k * iterated->arity;
        vector_add(iterated->count, factor, iterated->coefficients, target);
    }
    SWAP(iterated->coefficients, iterated->next);
    iterated->count = count;
    iterated->arity *= 2;
    return true;
}

bat_status mask_iterated_norm(const bat_mask *mask, size_t depth, double *best, bat_error *error)
{
    iterated_mask iterated;
    const bat_status status = iterated_mask_begin(mask, &iterated, error);
    if (status != BAT_OK)
        return status;
    *best = HUGE_VAL;
    for (size_t steps = 1; steps <= depth && iterated_mask_step(&iterated); steps++)
    {
        const double norm = mask_operator_norm(iterated.coefficients, iterated.count, iterated.arity);
        const double sums = (double)(steps * (mask->count + 1));
        const double rounding = sums * DBL_EPSILON * pow(iterated.norm_of_step, (double)steps);
        const double bound = norm + (steps == 1 ? 0.0 : rounding);
        *best = fmin(*best, pow(bound, 1.0 / (double)steps) * (1.0 + 4.0 * DBL_EPSILON));
    }
    iterated_mask_end(&iterated);
    return BAT_OK;
}

bat_status bat_mask_limit_stencil(const bat_mask *mask, bat_mask_stencil *stencil, bat_error *error)
{
    static const size_t DEPTH = 12; // longest products of steps that are tried
    mask_symbol symbol;
    bat_mask_stencil point;
    double growth;
    bat_status status = symbol_make(mask, &symbol, error);
    if (status == BAT_OK)
        status = mask_iterated_norm(&symbol.quotient, DEPTH, &growth, error);
    if (status == BAT_OK && !(growth < 1))
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                           "the scheme is not known to converge, so it has no limit points (differences may grow by %.6g)",
                           growth);
    if (status == BAT_OK)
        status = limit_point(&symbol, &point, error);
    if (status == BAT_OK)
        limit_vertex(&symbol, &point, stencil);
    return status;
}

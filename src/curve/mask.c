#include "curve/mask.h"

#include "base/error.h"

#include <float.h>
#include <math.h>

/// Where the coefficients that are not zero begin and end; `end - begin` is 0 for an empty or vanishing mask.
static void mask_support(const bat_mask *mask, size_t *begin, size_t *end)
{
    *begin = 0;
    *end = mask->count <= BAT_MASK_MAX ? mask->count : 0;
    while (*begin < *end && mask->coefficients[*begin] == 0.0)
        ++*begin;
    while (*begin < *end && mask->coefficients[*end - 1] == 0.0)
        --*end;
}

/// Larger coefficients or indices are a mistake; with these, sums and index arithmetic are safe.
static const double COEFFICIENT_LIMIT = 1e6;
static const int INDEX_LIMIT = 1000000;

bat_status mask_check(const bat_mask *mask, bat_error *error)
{
    if (mask->count < 1 || mask->count > BAT_MASK_MAX)
        return ERROR_ARGUMENT(error, "a mask has 1 to %d coefficients, not %zu", BAT_MASK_MAX, mask->count);
    for (size_t k = 0; k < mask->count; k++)
    {
        if (!isfinite(mask->coefficients[k]))
            return error_set(error, BAT_INVALID_ARGUMENT, k, 0, "coefficient %zu of the mask is not a finite number", k);
        if (fabs(mask->coefficients[k]) > COEFFICIENT_LIMIT)
            return error_set(error, BAT_INVALID_ARGUMENT, k, 0, "coefficient %zu of the mask, %g, is beyond %g", k,
                             mask->coefficients[k], COEFFICIENT_LIMIT);
    }
    if (mask->first < -INDEX_LIMIT || mask->first > INDEX_LIMIT)
        return ERROR_ARGUMENT(error, "the first index of a mask lies in -%d … %d, not %d", INDEX_LIMIT, INDEX_LIMIT,
                              mask->first);
    return BAT_OK;
}

bat_status mask_check_place(const bat_mask *mask, bat_error *error)
{
    int count = (int)mask->count;
    if (mask->first < -2 * count || mask->first > count)
        return ERROR_ARGUMENT(error, "the first index of a mask of %d coefficients lies from %d to %d, not %d", count,
                              -2 * count, count, mask->first);
    return BAT_OK;
}

bat_mask mask_trimmed(const bat_mask *mask)
{
    size_t begin, end;
    mask_support(mask, &begin, &end);
    bat_mask trimmed = {.count = end - begin, .first = mask->first + (int)begin};
    for (size_t k = 0; k < trimmed.count; k++)
        trimmed.coefficients[k] = mask->coefficients[begin + k];
    return trimmed;
}

/// New point 2 j + parity is the sum over m of a(2 m + parity) times old point j - m.
mask_taps mask_taps_of(const bat_mask *mask, int parity)
{
    mask_taps taps = {.count = 0};
    int last = mask->first + (int)mask->count - 1;
    for (int index = last; index >= mask->first; index--)
    {
        double weight = mask->coefficients[index - mask->first];
        if (((index - parity) & 1) != 0 || (weight == 0 && taps.count == 0))
            continue;
        if (taps.count == 0)
            taps.start = -(index - parity) / 2;
        taps.weights[taps.count++] = weight;
    }
    while (taps.count > 0 && taps.weights[taps.count - 1] == 0)
        taps.count--;
    return taps;
}

bat_mask bat_mask_chaikin(void)
{
    return (bat_mask){.coefficients = {0.25, 0.75, 0.75, 0.25}, .count = 4, .first = -2};
}

bat_mask bat_mask_corner_cutting(double r, double s)
{
    return (bat_mask){.coefficients = {r, s, 1.0 - r, 1.0 - s}, .count = 4, .first = -2};
}

bat_mask bat_mask_four_point(double w)
{
    return (bat_mask){.coefficients = {-w, 0.0, 0.5 + w, 1.0, 0.5 + w, 0.0, -w}, .count = 7, .first = -3};
}

bat_mask bat_mask_six_point(double w)
{
    const double inner = 9.0 / 16.0 + 2.0 * w;
    const double middle = -(1.0 / 16.0 + 3.0 * w);
    return (bat_mask){
        .coefficients = {w, 0.0, middle, 0.0, inner, 1.0, inner, 0.0, middle, 0.0, w}, .count = 11, .first = -5};
}

bat_mask bat_mask_lane_riesenfeld(size_t order)
{
    if (order < 1 || order > BAT_MASK_MAX - 2)
        return (bat_mask){.count = 0};
    bat_mask mask = {.coefficients = {1.0, 1.0}, .count = 2};
    for (size_t averaging = 0; averaging < order; averaging++)
    {
        for (size_t k = mask.count; k > 0; --k)
            mask.coefficients[k] = 0.5 * (mask.coefficients[k] + mask.coefficients[k - 1]);
        mask.coefficients[0] *= 0.5;
        ++mask.count;
    }
    mask.first = -(int)(mask.count / 2);
    return mask;
}

bool mask_is_interpolatory(const bat_mask *mask)
{
    size_t begin, end;
    mask_support(mask, &begin, &end);
    bool has_one = false;
    for (size_t k = begin; k < end; k++)
    {
        const long long index = (long long)mask->first + (long long)k;
        if (index % 2 != 0)
            continue;
        if (mask->coefficients[k] != (index == 0 ? 1.0 : 0.0))
            return false;
        has_one = has_one || index == 0;
    }
    return has_one;
}

/// Pairs of coefficients may differ by the rounding of a few operations, as 0.3 and 1 - 0.7 do.
bool mask_is_symmetric(const bat_mask *mask)
{
    size_t begin, end;
    mask_support(mask, &begin, &end);
    if (begin == end)
        return false;
    double largest = 0.0;
    for (size_t k = begin; k < end; k++)
        largest = fmax(largest, fabs(mask->coefficients[k]));
    const double tolerance = 4.0 * DBL_EPSILON * largest;
    for (size_t k = begin; k < end; k++)
    {
        // Written so that a NaN is not symmetric.
        if (!(fabs(mask->coefficients[k] - mask->coefficients[begin + end - 1 - k]) <= tolerance))
            return false;
    }
    return true;
}

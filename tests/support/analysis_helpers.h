#ifndef TESTS_SUPPORT_ANALYSIS_HELPERS_H
#define TESTS_SUPPORT_ANALYSIS_HELPERS_H

// Masks to analyse, and refinement as such to compare with.

#include "check.h"

#include "batten/research/curve_analysis.h"

static inline bat_analysis analyze(bat_mask mask)
{
    bat_analysis analysis;
    bat_error error = {.text = ""};
    if (bat_mask_analyze(&mask, NULL, &analysis, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return analysis;
}

static inline bat_analysis analyze_to_depth(bat_mask mask, size_t depth)
{
    bat_mask_analyze_options options = bat_mask_analyze_defaults();
    options.depth = depth;
    bat_analysis analysis;
    check_status(bat_mask_analyze(&mask, &options, &analysis, NULL), BAT_OK);
    return analysis;
}

static inline double weight(const bat_mask_stencil *stencil, int offset)
{
    const int k = offset - stencil->first;
    return k >= 0 && k < (int)stencil->count ? stencil->weights[k] : 0.0;
}

/// A mask of `count` random coefficients, averaged `smoothings` times, which makes its scheme converge.
static inline bat_mask random_mask(bat_random *random, size_t count, size_t smoothings, int first)
{
    bat_mask mask = {.count = count, .first = first};
    double sum = 0.0;
    for (size_t k = 0; k < count; ++k)
    {
        mask.coefficients[k] = bat_random_uniform(random) + 0.1;
        sum += mask.coefficients[k];
    }
    for (size_t k = 0; k < count; ++k)
        mask.coefficients[k] *= 2.0 / sum;
    for (size_t s = 0; s < smoothings; ++s)
    {
        for (size_t k = mask.count; k > 0; --k)
            mask.coefficients[k] = 0.5 * ((k < mask.count ? mask.coefficients[k] : 0.0) + mask.coefficients[k - 1]);
        mask.coefficients[0] *= 0.5;
        ++mask.count;
    }
    return mask;
}

static inline bat_mask reversed(const bat_mask *mask)
{
    bat_mask result = {.count = mask->count, .first = 1 - mask->first - (int)mask->count};
    for (size_t k = 0; k < mask->count; ++k)
        result.coefficients[k] = mask->coefficients[mask->count - 1 - k];
    return result;
}

/// A row of points with indices first … first + count - 1.
typedef struct row
{
    double values[4096];
    int first;
    int count;
} row;

/// The points of the next level that the row determines.
static inline row refine(const bat_mask *mask, const row *coarse)
{
    // Index i needs the points from (i - last of the mask) / 2, rounded up, to (i - first of the mask) / 2, rounded down.
    row fine = {.first = 2 * coarse->first + mask->first + (int)mask->count - 2};
    const int last = 2 * (coarse->first + coarse->count - 1) + mask->first + 1;
    for (int i = fine.first; i <= last; ++i)
    {
        double sum = 0.0;
        for (int k = 0; k < (int)mask->count; ++k)
        {
            const int doubled = i - mask->first - k;
            if (doubled % 2 != 0)
                continue;
            const int j = doubled / 2 - coarse->first;
            assert_in_range(j, 0, coarse->count - 1);
            sum += mask->coefficients[k] * coarse->values[j];
        }
        fine.values[fine.count++] = sum;
    }
    return fine;
}

/// Keep the points from first to last.
static inline void crop(row *r, int first, int last)
{
    const int cut = first > r->first ? first - r->first : 0;
    memmove(r->values, r->values + cut, (size_t)(r->count - cut) * sizeof *r->values);
    r->first += cut;
    r->count -= cut;
    if (r->first + r->count - 1 > last)
        r->count = last - r->first + 1;
}

/// The limit at a parameter of the index parametrization, by 28 levels of refinement of the few points that matter.
static inline double brute_limit(const bat_mask *mask, const row *points, double parameter)
{
    const int reach = 2 * (int)mask->count;
    row now = *points;
    int centre = 0;
    for (int level = 1; level <= 28; ++level)
    {
        now = refine(mask, &now);
        centre = (int)floor(ldexp(parameter, level));
        crop(&now, centre - reach, centre + reach);
    }
    return now.values[centre - now.first];
}

static inline row random_points(bat_random *random, int half)
{
    row points = {.first = -half, .count = 2 * half + 1};
    for (int i = 0; i < points.count; ++i)
        points.values[i] = bat_random_normal(random);
    return points;
}

static inline double apply(const bat_mask_stencil *stencil, const row *points, int at)
{
    double sum = 0.0;
    for (size_t k = 0; k < stencil->count; ++k)
        sum += stencil->weights[k] * points->values[at + stencil->first + (int)k - points->first];
    return sum;
}

#endif

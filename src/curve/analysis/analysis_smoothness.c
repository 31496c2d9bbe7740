#include "curve/analysis/analysis_smoothness.h"

#include "base/error.h"
#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The longest iterated mask that is written out.
#define ITERATED_LIMIT ((size_t)1 << 17)

void smoothness_matrices(const bat_mask *mask, double *matrices)
{
    const size_t n = smoothness_dimension(mask);
    const ptrdiff_t degree = (ptrdiff_t)mask->count - 1;
    for (ptrdiff_t parity = 0; parity < 2; parity++)
    {
        for (size_t row = 0; row < n; row++)
        {
            for (size_t column = 0; column < n; column++)
            {
                const ptrdiff_t index = (ptrdiff_t)row - 2 * (ptrdiff_t)column + degree - parity;
                matrices[((size_t)parity * n + row) * n + column] =
                    index >= 0 && index <= degree ? mask->coefficients[index] : 0.0;
            }
        }
    }
}

/// The largest sum of moduli over a residue class of indices: the maximum norm of subdivision with this arity.
static double operator_norm(const double *coefficients, size_t count, size_t arity)
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

/// The mask of several subdivision steps taken as one: q(z) q(z^2) … q(z^(2^(steps - 1))).
typedef struct iterated_mask
{
    const bat_mask *mask;
    double *coefficients;
    double *next;
    size_t count;
    size_t arity;
    double norm_of_step;
} iterated_mask;

static void iterated_mask_end(iterated_mask *iterated)
{
    free(iterated->coefficients);
    free(iterated->next);
}

static bat_status iterated_mask_begin(const bat_mask *mask, iterated_mask *iterated, bat_error *error)
{
    const size_t room = ITERATED_LIMIT + 2 * mask->count;
    *iterated = (iterated_mask){.mask = mask,
                                .coefficients = memory_array(room, sizeof(double)),
                                .next = memory_array(room, sizeof(double)),
                                .count = 1,
                                .arity = 1,
                                .norm_of_step = operator_norm(mask->coefficients, mask->count, 2)};
    if (iterated->coefficients == NULL || iterated->next == NULL)
    {
        iterated_mask_end(iterated);
        return error_memory(error, room * sizeof(double));
    }
    iterated->coefficients[0] = 1.0;
    return BAT_OK;
}

/// One more step; false when the mask gets too long.
static bool iterated_mask_step(iterated_mask *iterated)
{
    const size_t count = iterated->count + (iterated->mask->count - 1) * iterated->arity;
    if (count > ITERATED_LIMIT)
        return false;
    memset(iterated->next, 0, count * sizeof *iterated->next);
    for (size_t k = 0; k < iterated->mask->count; k++)
    {
        const double factor = iterated->mask->coefficients[k];
        double *target = iterated->next + k * iterated->arity;
        for (size_t i = 0; i < iterated->count; i++)
            target[i] += factor * iterated->coefficients[i];
    }
    double *swap = iterated->coefficients;
    iterated->coefficients = iterated->next;
    iterated->next = swap;
    iterated->count = count;
    iterated->arity *= 2;
    return true;
}

/// What rounding may have done to the operator norm after `steps`.
static double iterated_mask_rounding(const iterated_mask *iterated, size_t steps)
{
    return (double)(steps * (iterated->mask->count + 1)) * DBL_EPSILON * pow(iterated->norm_of_step, (double)steps);
}

/// min over k <= depth of |S^k|^(1/k) in the maximum norm (Dyn 1992): cheap, and good when nothing else is.
static bat_status iterated_norm(const bat_mask *mask, size_t depth, double *best, bat_error *error)
{
    iterated_mask iterated;
    const bat_status status = iterated_mask_begin(mask, &iterated, error);
    if (status != BAT_OK)
        return status;
    *best = HUGE_VAL;
    for (size_t steps = 1; steps <= depth && iterated_mask_step(&iterated); steps++)
    {
        const double norm = operator_norm(iterated.coefficients, iterated.count, iterated.arity);
        const double bound = norm + (steps == 1 ? 0.0 : iterated_mask_rounding(&iterated, steps));
        *best = fmin(*best, pow(bound, 1.0 / (double)steps) * (1.0 + 4.0 * DBL_EPSILON));
    }
    iterated_mask_end(&iterated);
    return BAT_OK;
}

bat_status smoothness_is_bounded(const bat_mask *mask, double factor, size_t depth, bool *bounded, bat_error *error)
{
    iterated_mask iterated;
    const bat_status status = iterated_mask_begin(mask, &iterated, error);
    if (status != BAT_OK)
        return status;
    *bounded = false;
    double power = 1.0;
    for (size_t steps = 1; steps <= depth && !*bounded && iterated_mask_step(&iterated); steps++)
    {
        power *= factor;
        *bounded =
            power * operator_norm(iterated.coefficients, iterated.count, iterated.arity) <= 1.0 + BAT_ANALYSIS_EQUALITY;
    }
    iterated_mask_end(&iterated);
    return BAT_OK;
}

bat_status smoothness_radius(const bat_mask *mask, const bat_mask_analyze_options *options, double stop_below,
                             joint_radius *radius, bat_error *error)
{
    double known_upper;
    bat_status status = iterated_norm(mask, options->depth, &known_upper, error);
    if (status != BAT_OK)
        return status;
    matrix_set set;
    status = matrix_set_make(smoothness_dimension(mask), 2, &set, error);
    if (status != BAT_OK)
        return status;
    smoothness_matrices(mask, set.entries);
    const joint_radius_limits limits = {.depth = options->depth,
                                        .vertices = options->vertices,
                                        .tolerance = options->tolerance,
                                        .stop_below = stop_below,
                                        .stop_from = HUGE_VAL,
                                        .known_upper = known_upper};
    status = joint_radius_bound(&set, &limits, radius, error);
    matrix_set_free(&set);
    return status;
}

#include "curve/analysis/analysis_symbol.h"

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

// Integer shifts of phi are stable unless some z on the unit circle is a "zero": phi^(x + 2 pi k) = 0 for all integers k,
// where z = exp(-i x). The refinement equation says: if z is a zero and w^2 = z, then a(w) = 0 or w is a zero, for both
// roots w. There are finitely many zeros, and 1 is none. So when a has no two zeros w and -w on the circle, then every zero
// has exactly one root that is a zero, and squaring permutes them; the zeros w form cycles of roots of unity of odd order,
// with a(-w) = 0 throughout. (Jia and Wang 1993, theorem 2, where the converse is proven too.)
//
// Both conditions are checked with the quotient q(z) = a(z) / (1 + z)^n on cells of the circle: a's other zeros, at z = -1,
// pair with z = 1, where a is 2, and belong to the cycle of 1. A cell counts as free of zeros when |q| at its middle exceeds
// what q can change within the cell. Doubling the angle takes cell c to the cells 2 c and 2 c + 1, so a cycle of zeros is a
// cycle in a graph.

/// Cells of the circle, a power of two.
#define CELLS 16384u
/// Rounding in a value of q, relative to the sum of the moduli of its coefficients.
#define VALUE_ROUNDING 1e-13

/// A lower bound of |q| over cell `cell` of the circle, whose middle has the angle 2 pi (cell + 1/2) / CELLS.
static double min_modulus(const bat_mask *q, size_t cell, double distance)
{
    const double pi = 3.14159265358979323846;
    const double angle = 2.0 * pi * ((double)cell + 0.5) / CELLS;
    const double middle = 0.5 * (double)(q->count - 1);
    double real = 0.0;
    double imaginary = 0.0;
    double size = 0.0;
    double slope = 0.0;
    for (size_t k = 0; k < q->count; k++)
    {
        real += q->coefficients[k] * cos((double)k * angle);
        imaginary += q->coefficients[k] * sin((double)k * angle);
        size += fabs(q->coefficients[k]);
        slope += fabs(q->coefficients[k]) * fabs((double)k - middle);
    }
    return hypot(real, imaginary) - slope * pi / CELLS - VALUE_ROUNDING * size - distance;
}

static bool has_symmetric_zeros(const bool *may_vanish)
{
    for (size_t cell = 0; cell < CELLS / 2; cell++)
        if (may_vanish[cell] && may_vanish[cell + CELLS / 2])
            return true;
    return false;
}

/// Whether cell `cell` of w may be on a cycle, given which others may: it needs one before it and one after it. The two
/// cells that touch w = 1 may not follow themselves, since only w = 1 stays there.
static bool keeps_company(const bool *alive, size_t cell)
{
    const size_t after[2] = {2 * cell % CELLS, (2 * cell + 1) % CELLS};
    const size_t before[2] = {cell / 2, cell / 2 + CELLS / 2};
    bool has_after = false;
    bool has_before = false;
    for (size_t i = 0; i < 2; i++)
    {
        has_after = has_after || (after[i] != cell && alive[after[i]]);
        has_before = has_before || (before[i] != cell && alive[before[i]]);
    }
    return has_after && has_before;
}

static bool has_cycle(bool *alive)
{
    for (bool changed = true; changed;)
    {
        changed = false;
        for (size_t cell = 0; cell < CELLS; cell++)
        {
            if (alive[cell] && !keeps_company(alive, cell))
            {
                alive[cell] = false;
                changed = true;
            }
        }
    }
    for (size_t cell = 0; cell < CELLS; cell++)
        if (alive[cell])
            return true;
    return false;
}

bool smoothness_is_stable(const bat_mask *quotient, double distance)
{
    bool may_vanish[CELLS];
    bool alive[CELLS];
    for (size_t cell = 0; cell < CELLS; cell++)
        may_vanish[cell] = min_modulus(quotient, cell, distance) <= 0.0;
    for (size_t cell = 0; cell < CELLS; cell++)
        alive[cell] = may_vanish[(cell + CELLS / 2) % CELLS];
    return !has_symmetric_zeros(may_vanish) && !has_cycle(alive);
}

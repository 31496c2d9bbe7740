#include "base/choice.h"
#include "base/error.h"
#include "base/option.h"
#include "curve/mask.h"
#include "research/analysis/analysis_symbol.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// a(z) / (1 + z)^order, the mask that refines differences of that order; `order` up to the multiplicity.
static bat_mask symbol_difference(const mask_symbol *symbol, size_t order)
{
    bat_mask mask = symbol->quotient;
    for (size_t factor = order; factor < symbol->multiplicity; factor++)
        mask_multiply_by_factor(&mask);
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

/// The largest degree d below the multiplicity with a^(k)(1) = 2 shift (shift - 1) … (shift - k + 1) for all k <= d
/// (Dyn, Hormann, Sabin and Shen 2008, theorem 4.3).
static size_t symbol_reproduction_degree(const mask_symbol *symbol)
{
    // Both sides are divided by k! and indices are counted from the middle of the mask, which changes neither condition.
    const double middle = round(symbol->shift);
    size_t degree = 0;
    for (size_t k = 1; k < symbol->multiplicity; k++)
    {
        double moment = 0.0, size = 0.0;
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

/// Whether the subdivision operator of the mask times `factor` has powers of norm at most 1, looking at the first `depth`.
static bat_status smoothness_is_bounded(const bat_mask *mask, double factor, size_t depth, bool *bounded, bat_error *error)
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
            power * mask_operator_norm(iterated.coefficients, iterated.count, iterated.arity) <= 1.0 + BAT_ANALYSIS_EQUALITY;
    }
    iterated_mask_end(&iterated);
    return BAT_OK;
}

bat_status smoothness_radius(const bat_mask *mask, const bat_mask_analyze_options *options, double stop_below,
                             joint_radius *radius, bat_error *error)
{
    double known_upper;
    bat_status status = mask_iterated_norm(mask, options->depth, &known_upper, error);
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
    double real = 0.0, imaginary = 0.0, size = 0.0, slope = 0.0;
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
    bool has_after = false, has_before = false;
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
    bool may_vanish[CELLS], alive[CELLS];
    for (size_t cell = 0; cell < CELLS; cell++)
        may_vanish[cell] = min_modulus(quotient, cell, distance) <= 0.0;
    for (size_t cell = 0; cell < CELLS; cell++)
        alive[cell] = may_vanish[(cell + CELLS / 2) % CELLS];
    return !has_symmetric_zeros(may_vanish) && !has_cycle(alive);
}

static const bat_choice VERDICTS[] = {
    CHOICE("undecided", "a deeper search may tell", BAT_ANALYSIS_VERDICT_UNDECIDED),
    CHOICE("proven", "proven", BAT_ANALYSIS_VERDICT_PROVEN),
    CHOICE("disproven", "disproven", BAT_ANALYSIS_VERDICT_DISPROVEN),
};
const bat_family bat_analysis_verdict_family = FAMILY("verdict", VERDICTS);

bat_mask_analyze_options bat_mask_analyze_defaults(void)
{
    return (bat_mask_analyze_options){.depth = 12, .tolerance = 1e-10, .vertices = 1000};
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mask_analyze_options, depth, OPTION_SIZE, 1, BAT_ANALYSIS_MAX_DEPTH),
    OPTION_FIELD(bat_mask_analyze_options, tolerance, OPTION_ABOVE, 0, 1),
    OPTION_FIELD(bat_mask_analyze_options, vertices, OPTION_SIZE, 1, ANALYSIS_VERTEX_LIMIT),
};

const bat_options_table bat_mask_analyze_fields = OPTIONS_TABLE(bat_mask_analyze_options, FIELDS, NULL);

/// The largest k >= 0 with radius < 2^-k, or -1: limits are C^k where differences of order k + 1 shrink faster than 2^-k,
/// and those of order k + 1 <= n shrink like the larger of `radius` and 2^-(k + 1). Never above n - 1.
static int proven_smoothness(double radius, size_t multiplicity)
{
    int order = -1;
    while (order + 1 < (int)multiplicity && radius * (1.0 + BAT_ANALYSIS_EQUALITY) < ldexp(1.0, -(order + 1)))
        ++order;
    return order;
}

/// The smallest k with radius >= 2^-k. C^k needs k + 1 factors 1 + z, so it ends at the multiplicity anyway.
static int disproven_smoothness(double radius, size_t multiplicity)
{
    int order = 0;
    while (order < (int)multiplicity && radius * (1.0 + BAT_ANALYSIS_EQUALITY) < ldexp(1.0, -order))
        ++order;
    return order;
}

static void describe_symbol(const mask_symbol *symbol, bat_analysis *analysis)
{
    analysis->mask = symbol->mask;
    analysis->multiplicity = symbol->multiplicity;
    analysis->quotient = symbol->quotient;
    analysis->remainder = symbol->remainder;
    analysis->is_interpolatory = mask_is_interpolatory(&symbol->mask);
    analysis->is_symmetric = mask_is_symmetric(&symbol->mask);
    analysis->shift = symbol->shift;
    analysis->generation_degree = symbol->multiplicity - 1;
    analysis->reproduction_degree = symbol_reproduction_degree(symbol);
}

static void describe_product(const joint_radius *radius, bat_analysis *analysis)
{
    analysis->radius_lower = radius->lower;
    analysis->radius_upper = radius->upper;
    analysis->depth = radius->length;
    const matrix_word *word = &radius->leaders[0];
    for (size_t t = 0; radius->leader_count > 0 && t < word->length; t++)
        analysis->product[t] = (char)('0' + word->letters[t]);
}

static bat_analysis_verdict convergence(const joint_radius *radius)
{
    if (radius->upper < 1.0)
        return BAT_ANALYSIS_VERDICT_PROVEN;
    return radius->lower * (1.0 + BAT_ANALYSIS_EQUALITY) >= 1.0 ? BAT_ANALYSIS_VERDICT_DISPROVEN
                                                                : BAT_ANALYSIS_VERDICT_UNDECIDED;
}

static bat_status describe_smoothness(const mask_symbol *symbol, const bat_mask_analyze_options *options,
                                      bat_analysis *analysis, bat_error *error)
{
    joint_radius radius;
    bat_status status = smoothness_radius(&symbol->quotient, options, 0.0, &radius, error);
    if (status != BAT_OK)
        return status;
    describe_product(&radius, analysis);
    analysis->converges = convergence(&radius);
    analysis->exponent_lower = -log2(radius.upper);
    analysis->exponent_upper = INFINITY;
    analysis->smooth_proven =
        analysis->converges == BAT_ANALYSIS_VERDICT_PROVEN ? proven_smoothness(radius.upper, symbol->multiplicity) : -1;
    analysis->smooth_disproven = analysis->converges == BAT_ANALYSIS_VERDICT_DISPROVEN ? 0 : -1;
    analysis->is_stable = analysis->converges == BAT_ANALYSIS_VERDICT_PROVEN &&
                          (analysis->is_interpolatory || smoothness_is_stable(&symbol->quotient, 0.0));
    if (analysis->is_stable)
    {
        analysis->exponent_upper = -log2(radius.lower);
        analysis->smooth_disproven = disproven_smoothness(radius.lower, symbol->multiplicity);
    }
    return BAT_OK;
}

static bat_status describe_limits(const mask_symbol *symbol, bat_analysis *analysis, bat_error *error)
{
    analysis->matrix_first = limit_matrix_first(&symbol->mask);
    analysis->matrix_size = limit_matrix_size(&symbol->mask);
    const size_t entries = analysis->matrix_size * analysis->matrix_size;
    analysis->matrix = memory_array(entries, sizeof *analysis->matrix);
    if (analysis->matrix == NULL)
        return error_memory(error, entries * sizeof *analysis->matrix);
    limit_matrix(&symbol->mask, analysis->matrix);
    bat_status status = limit_eigenvalues(symbol, analysis, error);
    if (status != BAT_OK || analysis->converges != BAT_ANALYSIS_VERDICT_PROVEN)
        return status;
    status = limit_point(symbol, &analysis->limit, error);
    if (status == BAT_OK)
        status = limit_tangent(symbol, analysis, &analysis->tangent, error);
    if (status == BAT_OK)
        limit_vertex(symbol, &analysis->limit, &analysis->vertex);
    return status;
}

/// Whether the local matrix has a Jordan block at 2^-order: then differences of that order shrink like k 2^(-order k) only.
static bool is_defective_at(const bat_analysis *analysis, size_t order)
{
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        if (value->real == ldexp(1.0, -(int)order) && value->imaginary == 0.0)
            return value->vector_count < value->multiplicity;
    }
    return false;
}

/// The derivative of order m - 1 is Lipschitz continuous where differences of order m are at most a multiple of 2^-m in
/// every level, and for a stable scheme only there.
static bat_status describe_lipschitz(const mask_symbol *symbol, size_t depth, bat_analysis *analysis, bat_error *error)
{
    analysis->lipschitz = BAT_ANALYSIS_VERDICT_UNDECIDED;
    if (analysis->smooth_proven < 0)
        return BAT_OK;
    const size_t order = (size_t)analysis->smooth_proven + 1;
    const bat_mask difference = symbol_difference(symbol, order);
    bool is_bounded;
    const bat_status status = smoothness_is_bounded(&difference, ldexp(1.0, (int)order), depth, &is_bounded, error);
    if (status != BAT_OK)
        return status;
    const bool is_smaller = analysis->exponent_upper < (double)order - BAT_ANALYSIS_EQUALITY;
    if (is_bounded)
        analysis->lipschitz = BAT_ANALYSIS_VERDICT_PROVEN;
    else if (analysis->is_stable && (is_smaller || is_defective_at(analysis, order)))
        analysis->lipschitz = BAT_ANALYSIS_VERDICT_DISPROVEN;
    return BAT_OK;
}

bat_status bat_mask_analyze(const bat_mask *mask, const bat_mask_analyze_options *options, bat_analysis *analysis,
                            bat_error *error)
{
    const bat_mask_analyze_options chosen = options != NULL ? *options : bat_mask_analyze_defaults();
    mask_symbol symbol;
    bat_status status = bat_options_check(&bat_mask_analyze_fields, &chosen, error);
    if (status == BAT_OK)
        status = symbol_make(mask, &symbol, error);
    if (status != BAT_OK)
        return status;
    bat_analysis result = {0};
    describe_symbol(&symbol, &result);
    status = describe_smoothness(&symbol, &chosen, &result, error);
    if (status == BAT_OK)
        status = describe_limits(&symbol, &result, error);
    if (status == BAT_OK)
        status = describe_lipschitz(&symbol, chosen.depth, &result, error);
    if (status == BAT_OK)
        *analysis = result;
    else
        bat_analysis_free(&result);
    return status;
}

void bat_analysis_free(bat_analysis *analysis)
{
    free(analysis->matrix);
    free(analysis->eigenvalues);
    free(analysis->eigenvectors);
    *analysis = (bat_analysis){0};
}

bool bat_analysis_derivative_exponent(const bat_analysis *analysis, size_t order, double *lower, double *upper)
{
    if (analysis->smooth_proven < 0 || order > (size_t)analysis->smooth_proven)
        return false;
    *lower = fmin(1.0, analysis->exponent_lower - (double)order);
    *upper = fmin(1.0, analysis->exponent_upper - (double)order);
    return true;
}

bat_status bat_mask_difference(const bat_mask *mask, size_t order, bat_mask *difference, bat_error *error)
{
    mask_symbol symbol;
    const bat_status status = symbol_make(mask, &symbol, error);
    if (status != BAT_OK)
        return status;
    if (order > symbol.multiplicity)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                         "differences of order %zu have no mask: 1 + z is only %zu times in the symbol", order,
                         symbol.multiplicity);
    *difference = symbol_difference(&symbol, order);
    return BAT_OK;
}

#include "batten/curve_analysis.h"
#include "curve/mask.h"

#include "base/choice.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "curve/analysis/analysis_symbol.h"

#include <math.h>
#include <stdlib.h>

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

static bat_status mask_analyze_options_check(const void *opaque, bat_error *error)
{
    static const option_field FIELDS[] = {
        OPTION_FIELD(bat_mask_analyze_options, depth, OPTION_SIZE, 1, BAT_ANALYSIS_MAX_DEPTH),
        OPTION_FIELD(bat_mask_analyze_options, tolerance, OPTION_ABOVE, 0, 1),
        OPTION_FIELD(bat_mask_analyze_options, vertices, OPTION_SIZE, 1, ANALYSIS_VERTEX_LIMIT),
    };
    return OPTIONS_CHECK(opaque, FIELDS, error);
}

const bat_options_table bat_mask_analyze_fields = {"bat_mask_analyze_options", mask_analyze_options_check};

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

#include "batten/research/mask_sweep.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/option.h"
#include "curve/mask.h"
#include "research/analysis/analysis_symbol.h"
#include "research/analysis/eigen.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Coefficients may be off the straight line between two parameters by this share of the largest.
#define AFFINE_ROUNDING 1e-13
/// The highest smoothness that a sweep looks for.
#define SMOOTHNESS_LIMIT 30
/// Disproofs are quick, but reach less far around a parameter than proofs: halve so much further for them.
#define DISPROOF_SHARE 0x1p-6
/// Intervals are not halved below this share of the range, whatever the tolerance.
#define SHORTEST_SHARE 1e-9

/// Points of half the ellipse of a complex leading eigenvector when a threshold is to be proven.
#define PHASES_OF_PROOF 16

/// Rounds of growth of a polytope for every unit of depth.
#define ROUNDS_OF_PROOF 2

bat_mask_sweep_options bat_mask_sweep_defaults(void)
{
    return (bat_mask_sweep_options){.begin = 0.0, .end = 1.0, .smoothness = 1, .analysis = bat_mask_analyze_defaults()};
}

/// The state of a sweep.
typedef struct sweep
{
    bat_mask_family family;
    void *context;
    const bat_mask_sweep_options *options;
    double tolerance;
    size_t factors;      ///< how many times every mask of the family has 1 + z
    matrix_word breaker; ///< the product that gave the last disproof; it often serves next door; length 0 for none
    bat_mask_interval *intervals;
    size_t count;
    size_t capacity;
    bat_error *error;
} sweep;

static bool has_all_factors(const sweep *s)
{
    return s->factors > s->options->smoothness;
}

static bat_status append(sweep *s, double begin, double end, bat_analysis_verdict verdict)
{
    if (s->count > 0 && begin < end)
    {
        bat_mask_interval *last = &s->intervals[s->count - 1];
        if (last->verdict == verdict && last->end == begin && last->begin < last->end)
        {
            last->end = end;
            return BAT_OK;
        }
    }
    bool added = ARRAY_ADD(s->intervals, s->capacity, s->count, (bat_mask_interval){begin, end, verdict});
    return added ? BAT_OK : error_memory(s->error, (s->count + 1) * sizeof *s->intervals);
}

static bool same_support(const bat_mask *a, const bat_mask *b)
{
    return a->count == b->count && a->first == b->first;
}

/// Compare masks at a few parameters with the straight line between the masks at both ends.
static bat_status check_affine(const sweep *s, const bat_mask *begin, const bat_mask *end)
{
    static const double shares[] = {0.5, 0.25, 0.8};
    const double from = s->options->begin;
    const double length = s->options->end - from;
    bool affine = same_support(begin, end);
    for (size_t i = 0; affine && i < sizeof shares / sizeof *shares; i++)
    {
        const bat_mask mask = s->family(s->context, from + shares[i] * length);
        affine = same_support(&mask, begin);
        for (size_t k = 0; affine && k < mask.count; k++)
        {
            const double expected = (1.0 - shares[i]) * begin->coefficients[k] + shares[i] * end->coefficients[k];
            const double size = 1.0 + fabs(begin->coefficients[k]) + fabs(end->coefficients[k]);
            affine = fabs(mask.coefficients[k] - expected) <= AFFINE_ROUNDING * size;
        }
    }
    return affine ? BAT_OK
                  : error_set(s->error, BAT_UNSUPPORTED, BAT_NO_INDEX, 0,
                              "a sweep needs masks of one length that depend on the parameter as a + t b");
}

static bat_mask quotient_at(const sweep *s, double parameter, size_t order)
{
    const bat_mask mask = s->family(s->context, parameter);
    bat_mask quotient;
    double remainder;
    symbol_divide(&mask, order, &quotient, &remainder);
    return quotient;
}

/// Sum of the moduli of the differences of coefficients.
static double mask_distance(const bat_mask *a, const bat_mask *b)
{
    double sum = 0.0;
    for (size_t k = 0; k < a->count; k++)
        sum += fabs(a->coefficients[k] - b->coefficients[k]);
    return sum;
}

static bool is_stable_between(const sweep *s, double begin, double end)
{
    const bat_mask first = s->family(s->context, begin);
    const bat_mask last = s->family(s->context, end);
    if (mask_is_interpolatory(&first) && mask_is_interpolatory(&last))
        return true;
    const bat_mask left = quotient_at(s, begin, s->factors);
    const bat_mask middle = quotient_at(s, 0.5 * (begin + end), s->factors);
    const bat_mask right = quotient_at(s, end, s->factors);
    return smoothness_is_stable(&middle, fmax(mask_distance(&left, &middle), mask_distance(&middle, &right)));
}

/// The matrices of both ends of an interval, then those of its middle.
typedef struct interval_matrices
{
    matrix_set all;
    matrix_set ends;
    matrix_set middle;
} interval_matrices;

static bat_status interval_matrices_make(const sweep *s, double begin, double end, interval_matrices *m)
{
    const bat_mask masks[3] = {quotient_at(s, begin, s->factors), quotient_at(s, end, s->factors),
                               quotient_at(s, 0.5 * (begin + end), s->factors)};
    const size_t n = smoothness_dimension(&masks[0]);
    const bat_status status = matrix_set_make(n, 6, &m->all, s->error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < 3; i++)
        smoothness_matrices(&masks[i], matrix_set_at(&m->all, 2 * i));
    m->ends = (matrix_set){n, 4, matrix_set_at(&m->all, 0)};
    m->middle = (matrix_set){n, 2, matrix_set_at(&m->all, 4)};
    return BAT_OK;
}

/// The largest Frobenius distance of a matrix at an end from that of the middle.
static double largest_distance(const interval_matrices *m)
{
    const size_t square = m->all.dimension * m->all.dimension;
    double largest = 0.0;
    for (size_t e = 0; e < 4; e++)
    {
        double sum = 0.0;
        for (size_t i = 0; i < square; i++)
        {
            const double difference = matrix_set_at(&m->ends, e)[i] - matrix_set_at(&m->middle, e % 2)[i];
            sum += difference * difference;
        }
        largest = fmax(largest, sqrt(sum));
    }
    return largest;
}

static bat_status grow_below(const matrix_set *hull, const matrix_set *middle, const joint_radius *middle_radius,
                             const joint_radius_limits *limits, double threshold, bool *proven, bat_error *error)
{
    polytope_growth growth;
    const double rate = threshold * (1.0 - limits->tolerance);
    bat_status status =
        joint_radius_growth(hull, middle, middle_radius, rate, PHASES_OF_PROOF, limits->vertices, &growth, error);
    if (status != BAT_OK)
        return status;
    bool closed = false;
    *proven = false;
    for (size_t round = 0; round < ROUNDS_OF_PROOF * limits->depth && !closed && !growth.full && !*proven; round++)
    {
        double bound;
        status = polytope_growth_round(&growth, &bound, &closed, error);
        if (status != BAT_OK)
            break;
        *proven = bound < threshold;
    }
    polytope_growth_free(&growth);
    return status;
}

/// Try to prove that the joint spectral radius of `hull`, and so of every set of matrices between its members, is below
/// `threshold`, with a polytope that starts at the leading eigenvectors of products of `middle`.
static bat_status prove_below(const matrix_set *hull, const matrix_set *middle, const joint_radius *middle_radius,
                              const joint_radius_limits *limits, double threshold, bool *proven, bat_error *error)
{
    const size_t square = hull->dimension * hull->dimension;
    matrix_set both;
    bat_status status = matrix_set_make(hull->dimension, hull->count + middle->count, &both, error);
    if (status != BAT_OK)
        return status;
    memcpy(both.entries, hull->entries, hull->count * square * sizeof *both.entries);
    memcpy(both.entries + hull->count * square, middle->entries, middle->count * square * sizeof *both.entries);
    matrix_set_balance(&both);
    const matrix_set scaled_hull = {hull->dimension, hull->count, both.entries};
    const matrix_set scaled_middle = {hull->dimension, middle->count, both.entries + hull->count * square};
    status = grow_below(&scaled_hull, &scaled_middle, middle_radius, limits, threshold, proven, error);
    matrix_set_free(&both);
    return status;
}

/// A lower bound of the spectral radius^(1 / length) of a product for every choice of factors within `distance` (Frobenius
/// norm) of those of the set.
static bat_status word_below(const matrix_set *set, const matrix_word *word, double distance, double *bound,
                             bat_error *error)
{
    const size_t n = set->dimension;
    double *memory = memory_array(2 * n * n, sizeof *memory);
    if (memory == NULL)
        return error_memory(error, 2 * n * n * sizeof *memory);
    double radius;
    const double error_norm = matrix_word_product(set, word, distance, memory, memory + n * n);
    const bat_status status = dense_spectral_radius_below(n, memory, error_norm, &radius, error);
    if (status == BAT_OK)
        *bound = pow(radius, 1.0 / (double)word->length) * (1.0 - 2.0 * DBL_EPSILON);
    free(memory);
    return status;
}

/// What is known of an interval, and of its middle.
typedef struct judgement
{
    bat_analysis_verdict interval;
    bat_analysis_verdict middle;
} judgement;

/// Try to disprove C^k for an interval by one product, whose growth rate must be at least `threshold` throughout.
static bat_status disprove(const sweep *s, double begin, double end, const interval_matrices *m, const matrix_word *word,
                           double threshold, judgement *result)
{
    double at_middle, throughout;
    bat_status status = word_below(&m->middle, word, 0.0, &at_middle, s->error);
    if (status == BAT_OK)
        status = word_below(&m->middle, word, largest_distance(m), &throughout, s->error);
    if (status != BAT_OK || at_middle * (1.0 + BAT_ANALYSIS_EQUALITY) < threshold)
        return status;
    result->middle = BAT_ANALYSIS_VERDICT_DISPROVEN;
    if (throughout * (1.0 + BAT_ANALYSIS_EQUALITY) >= threshold && is_stable_between(s, begin, end))
        result->interval = BAT_ANALYSIS_VERDICT_DISPROVEN;
    return BAT_OK;
}

/// Judge an interval by its matrices: C^k holds exactly where their joint spectral radius is below 2^-k.
static bat_status judge_matrices(sweep *s, double begin, double end, const interval_matrices *m, judgement *result)
{
    const double threshold = ldexp(1.0, -(int)s->options->smoothness);
    if (s->breaker.length > 0)
    {
        const bat_status status = disprove(s, begin, end, m, &s->breaker, threshold, result);
        if (status != BAT_OK || result->middle == BAT_ANALYSIS_VERDICT_DISPROVEN)
            return status;
    }
    const bat_mask_analyze_options *analysis = &s->options->analysis;
    const joint_radius_limits limits = {.depth = analysis->depth,
                                        .vertices = analysis->vertices,
                                        .tolerance = analysis->tolerance,
                                        .stop_below = threshold,
                                        .stop_from = threshold,
                                        .known_upper = HUGE_VAL};
    joint_radius radius;
    bat_status status = joint_radius_bound(&m->middle, &limits, &radius, s->error);
    if (status != BAT_OK || radius.leader_count == 0)
        return status;
    if (radius.lower >= threshold)
    {
        s->breaker = radius.leaders[0];
        return disprove(s, begin, end, m, &s->breaker, threshold, result);
    }
    if (radius.upper >= threshold)
        return BAT_OK;
    result->middle = BAT_ANALYSIS_VERDICT_PROVEN;
    bool proven;
    status = prove_below(&m->ends, &m->middle, &radius, &limits, threshold, &proven, s->error);
    if (status == BAT_OK && proven)
        result->interval = BAT_ANALYSIS_VERDICT_PROVEN;
    return status;
}

static bat_status judge(sweep *s, double begin, double end, judgement *result)
{
    *result = (judgement){BAT_ANALYSIS_VERDICT_UNDECIDED, BAT_ANALYSIS_VERDICT_UNDECIDED};
    if (!has_all_factors(s))
    {
        // C^k needs the factor (1 + z)^(k + 1) when the scheme is stable, and the caller has taken out where it is there.
        result->interval =
            is_stable_between(s, begin, end) ? BAT_ANALYSIS_VERDICT_DISPROVEN : BAT_ANALYSIS_VERDICT_UNDECIDED;
        return BAT_OK;
    }
    interval_matrices matrices;
    bat_status status = interval_matrices_make(s, begin, end, &matrices);
    if (status == BAT_OK)
    {
        status = judge_matrices(s, begin, end, &matrices, result);
        matrix_set_free(&matrices.all);
    }
    return status;
}

/// Judge an interval, halving it where no verdict covers it all.
static bat_status judge_parts(sweep *s, double begin, double end)
{
    const bat_progress *progress = &s->options->progress;
    const double share = (begin - s->options->begin) / (s->options->end - s->options->begin);
    if (progress->report != NULL && !progress->report(progress->context, share))
        return error_set(s->error, BAT_CANCELLED, BAT_NO_INDEX, 0, "the sweep was cancelled");
    judgement result;
    bat_status status = judge(s, begin, end, &result);
    if (status != BAT_OK)
        return status;
    const double middle = 0.5 * (begin + end);
    const double shortest = s->tolerance * (result.middle == BAT_ANALYSIS_VERDICT_DISPROVEN ? DISPROOF_SHARE : 1.0);
    if (result.interval != BAT_ANALYSIS_VERDICT_UNDECIDED || end - begin <= shortest || middle <= begin || middle >= end)
        return append(s, begin, end, result.interval);
    status = judge_parts(s, begin, middle);
    return status == BAT_OK ? judge_parts(s, middle, end) : status;
}

/// Take intervals shorter than the tolerance that touch an undecided one into it: splinters help nobody.
static void join_splinters(sweep *s)
{
    for (size_t i = 0; i < s->count; i++)
    {
        bat_mask_interval *interval = &s->intervals[i];
        const bool is_splinter = interval->begin < interval->end && interval->end - interval->begin < s->tolerance;
        const bool after = i > 0 && s->intervals[i - 1].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED;
        const bool before = i + 1 < s->count && s->intervals[i + 1].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED;
        if (is_splinter && (after || before))
            interval->verdict = BAT_ANALYSIS_VERDICT_UNDECIDED;
    }
    const size_t count = s->count;
    s->count = 0;
    for (size_t i = 0; i < count; i++)
    {
        const bat_mask_interval interval = s->intervals[i];
        (void)append(s, interval.begin, interval.end, interval.verdict);
    }
}

static bat_status judge_point(sweep *s, double parameter)
{
    const bat_mask mask = s->family(s->context, parameter);
    bat_analysis analysis;
    const bat_status status = bat_mask_analyze(&mask, &s->options->analysis, &analysis, s->error);
    if (status != BAT_OK)
        return status;
    const int wanted = (int)s->options->smoothness;
    bat_analysis_verdict verdict = BAT_ANALYSIS_VERDICT_UNDECIDED;
    if (analysis.smooth_proven >= wanted)
        verdict = BAT_ANALYSIS_VERDICT_PROVEN;
    else if (analysis.smooth_disproven >= 0 && analysis.smooth_disproven <= wanted)
        verdict = BAT_ANALYSIS_VERDICT_DISPROVEN;
    bat_analysis_free(&analysis);
    return append(s, parameter, parameter, verdict);
}

/// a^(j)(-1) / j!, up to its sign.
static double derivative_at_minus_one(const bat_mask *mask, size_t j)
{
    double sum = 0.0;
    for (size_t k = 0; k < mask->count; k++)
    {
        double term = (k % 2 == 0 ? 1.0 : -1.0) * mask->coefficients[k];
        for (size_t i = 0; i < j; i++)
            term *= ((double)k - (double)i) / (double)(i + 1);
        sum += term;
    }
    return sum;
}

/// Where the family has more factors than elsewhere: the one parameter at which the first derivative of a at -1 that does
/// not vanish for all of them does.
static bool exceptional_parameter(const sweep *s, const bat_mask *begin, const bat_mask *end, double *parameter)
{
    const double left = derivative_at_minus_one(begin, s->factors);
    const double right = derivative_at_minus_one(end, s->factors);
    if (left == right)
        return false;
    const double share = left / (left - right);
    *parameter = s->options->begin + share * (s->options->end - s->options->begin);
    return share >= 0.0 && share <= 1.0;
}

static size_t common_factors(const sweep *s, const bat_mask *begin, const bat_mask *end)
{
    const bat_mask middle = s->family(s->context, 0.5 * (s->options->begin + s->options->end));
    bat_mask quotient;
    double remainder;
    size_t factors = 1;
    while (factors + 1 < begin->count && symbol_divide(begin, factors + 1, &quotient, &remainder) &&
           symbol_divide(end, factors + 1, &quotient, &remainder) &&
           symbol_divide(&middle, factors + 1, &quotient, &remainder))
        ++factors;
    return factors;
}

static const option_field FIELDS[] = {
    OPTION_FIELD(bat_mask_sweep_options, begin, OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_mask_sweep_options, end, OPTION_NUMBER, -INFINITY, INFINITY),
    OPTION_FIELD(bat_mask_sweep_options, smoothness, OPTION_SIZE, 0, SMOOTHNESS_LIMIT),
    OPTION_FIELD(bat_mask_sweep_options, tolerance, OPTION_NUMBER, 0, INFINITY),
    OPTION_STRUCT(bat_mask_sweep_options, analysis, bat_mask_analyze_fields),
};

static bat_status mask_sweep_options_check(const void *opaque, bat_error *error)
{
    const bat_mask_sweep_options *options = opaque;
    if (options->begin < options->end)
        return BAT_OK;
    return error_option(error, "end", "is %.10g, but must be above begin, %.10g", options->end, options->begin);
}

const bat_options_table bat_mask_sweep_fields = OPTIONS_TABLE(bat_mask_sweep_options, FIELDS, mask_sweep_options_check);

static bat_status check_masks(const sweep *s, const bat_mask *begin, const bat_mask *end)
{
    mask_symbol symbol;
    bat_status status = symbol_make(begin, &symbol, s->error);
    if (status == BAT_OK)
        status = symbol_make(end, &symbol, s->error);
    return status == BAT_OK ? check_affine(s, begin, end) : status;
}

static bat_status sweep_run(sweep *s, const bat_mask *begin, const bat_mask *end)
{
    const double from = s->options->begin;
    const double to = s->options->end;
    double exception;
    if (!has_all_factors(s) && exceptional_parameter(s, begin, end, &exception))
    {
        bat_status status = exception > from ? judge_parts(s, from, exception) : BAT_OK;
        if (status == BAT_OK)
            status = judge_point(s, exception);
        return status == BAT_OK && exception < to ? judge_parts(s, exception, to) : status;
    }
    bat_status status = judge_parts(s, from, to);
    if (status == BAT_OK)
        join_splinters(s);
    // The ends of the range are often where a family degenerates; they deserve a verdict of their own.
    if (status == BAT_OK && s->intervals[0].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED)
        status = judge_point(s, from);
    if (status == BAT_OK && s->intervals[0].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED)
    {
        const bat_mask_interval point = s->intervals[s->count - 1];
        memmove(s->intervals + 1, s->intervals, (s->count - 1) * sizeof *s->intervals);
        s->intervals[0] = point;
    }
    if (status == BAT_OK && s->intervals[s->count - 1].verdict == BAT_ANALYSIS_VERDICT_UNDECIDED)
        status = judge_point(s, to);
    return status;
}

bat_status bat_mask_sweep(bat_mask_family family, void *context, const bat_mask_sweep_options *options,
                          bat_mask_interval **intervals, size_t *count, bat_error *error)
{
    const bat_mask_sweep_options defaults = bat_mask_sweep_defaults();
    options = options != NULL ? options : &defaults;
    bat_status status = bat_options_check(&bat_mask_sweep_fields, options, error);
    if (status != BAT_OK)
        return status;
    const double length = options->end - options->begin;
    sweep s = {.family = family, .context = context, .options = options, .error = error};
    s.tolerance = fmax(options->tolerance > 0.0 ? options->tolerance : ldexp(length, -15), SHORTEST_SHARE * length);
    const bat_mask begin = family(context, options->begin);
    const bat_mask end = family(context, options->end);
    status = check_masks(&s, &begin, &end);
    if (status == BAT_OK)
    {
        s.factors = common_factors(&s, &begin, &end);
        status = sweep_run(&s, &begin, &end);
    }
    if (status != BAT_OK)
    {
        free(s.intervals);
        return status;
    }
    *intervals = s.intervals;
    *count = s.count;
    return BAT_OK;
}

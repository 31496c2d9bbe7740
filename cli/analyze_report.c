#include "analyze.h"

#include <math.h>
#include <string.h>

/// Matrices larger than this are left to --json.
#define LARGEST_MATRIX 10
/// Difference masks up to this order are shown.
#define LARGEST_ORDER 6
/// Numbers are shown over a common denominator up to this, or up to a power of two of 40 binary digits.
#define LARGEST_DENOMINATOR 65536.0
#define FRACTION_TOLERANCE 2e-13

/// Whether all numbers are multiples of 1 / denominator, to rounding.
static bool fits_denominator(const double *numbers, size_t count, double denominator)
{
    for (size_t i = 0; i < count; ++i)
    {
        const double multiple = numbers[i] * denominator;
        if (!(fabs(multiple - round(multiple)) <= FRACTION_TOLERANCE * denominator) || fabs(multiple) > 1e15)
            return false;
    }
    return true;
}

/// The smallest common denominator of numbers that have one; 0 for others.
static double common_denominator(const double *numbers, size_t count)
{
    for (double denominator = 1.0; denominator <= LARGEST_DENOMINATOR; denominator += 1.0)
    {
        if (fits_denominator(numbers, count, denominator))
            return denominator;
    }
    for (int exponent = 17; exponent <= 40; ++exponent)
    {
        const double denominator = ldexp(1.0, exponent);
        bool exact = true;
        for (size_t i = 0; i < count; ++i)
            exact = exact && numbers[i] * denominator == round(numbers[i] * denominator);
        if (exact)
            return denominator;
    }
    return 0.0;
}

static void print_number(FILE *out, double number, double denominator)
{
    if (denominator > 0.0)
        fprintf(out, "%.0f", round(number * denominator) + 0.0);
    else
        fprintf(out, "%.10g", number);
}

/// "[1 3 3 1] / 4"
static void print_list(FILE *out, const double *numbers, size_t count)
{
    const double denominator = common_denominator(numbers, count);
    fputc('[', out);
    for (size_t i = 0; i < count; ++i)
    {
        if (i > 0)
            fputc(' ', out);
        print_number(out, numbers[i], denominator);
    }
    fputc(']', out);
    if (denominator > 1.0)
        fprintf(out, " / %.0f", denominator);
}

static void print_fraction(FILE *out, double number)
{
    const double denominator = common_denominator(&number, 1);
    print_number(out, number, denominator);
    if (denominator > 1.0)
        fprintf(out, "/%.0f", denominator);
}

/// A polynomial with constant term first: "-1 + 4 z - z^2".
static void print_polynomial(FILE *out, const double *coefficients, size_t count, double denominator)
{
    bool is_first = true;
    for (size_t k = 0; k < count; ++k)
    {
        const double number = denominator > 0.0 ? round(coefficients[k] * denominator) : coefficients[k];
        if (number == 0.0)
            continue;
        if (is_first)
            fputs(number < 0.0 ? "-" : "", out);
        else
            fputs(number < 0.0 ? " - " : " + ", out);
        is_first = false;
        if (fabs(number) != 1.0 || k == 0)
            fprintf(out, denominator > 0.0 ? "%.0f" : "%.10g", fabs(number));
        if (k > 0)
            fputs(fabs(number) != 1.0 ? " z" : "z", out);
        if (k > 1)
            fprintf(out, "^%zu", k);
    }
}

/// a(z) = z^-3 (1 + z)^4 (-1 + 4 z - z^2) / 16
static void print_symbol(FILE *out, const bat_analysis *analysis)
{
    const bat_mask *quotient = &analysis->quotient;
    const double denominator = common_denominator(quotient->coefficients, quotient->count);
    fputs("  a(z) = ", out);
    if (analysis->mask.first != 0)
        fprintf(out, "z^%d ", analysis->mask.first);
    fputs("(1 + z)", out);
    if (analysis->multiplicity > 1)
        fprintf(out, "^%zu", analysis->multiplicity);
    const bool is_unit = quotient->count == 1 && denominator > 0.0 && round(quotient->coefficients[0] * denominator) == 1.0;
    if (!is_unit)
    {
        fputs(" (", out);
        print_polynomial(out, quotient->coefficients, quotient->count, denominator);
        fputc(')', out);
    }
    if (denominator > 1.0)
        fprintf(out, " / %.0f", denominator);
    fputc('\n', out);
}

static void print_differences(FILE *out, const bat_analysis *analysis)
{
    for (size_t order = 1; order <= analysis->multiplicity && order <= LARGEST_ORDER; ++order)
    {
        bat_mask difference;
        if (bat_mask_difference(&analysis->mask, order, &difference, NULL) != BAT_OK)
            return;
        fprintf(out, "  differences of order %zu  ", order);
        print_list(out, difference.coefficients, difference.count);
        fputc('\n', out);
    }
}

static void report_symbol(FILE *out, const bat_analysis *analysis)
{
    fputs("Symbol\n", out);
    fprintf(out, "  mask, from index %d:    ", analysis->mask.first);
    print_list(out, analysis->mask.coefficients, analysis->mask.count);
    fputc('\n', out);
    print_symbol(out, analysis);
    print_differences(out, analysis);
    if (analysis->remainder > 0.0)
        fprintf(out, "  the factors fit the given coefficients to %.1e\n", analysis->remainder);
    fprintf(out, "  %s, %s\n", analysis->is_symmetric ? "symmetric" : "not symmetric",
            analysis->is_interpolatory ? "interpolatory" : "approximating");
    fputs("\nPolynomials\n", out);
    fprintf(out, "  generates degree %zu, reproduces degree %zu with point i at (i + shift) / 2^level, shift = ",
            analysis->generation_degree, analysis->reproduction_degree);
    print_fraction(out, analysis->shift);
    fputs("\n", out);
}

static void print_matrix(FILE *out, const bat_analysis *analysis)
{
    const size_t size = analysis->matrix_size;
    if (size > LARGEST_MATRIX)
    {
        fprintf(out, "  %zu x %zu, shown by --json\n", size, size);
        return;
    }
    const double denominator = common_denominator(analysis->matrix, size * size);
    for (size_t row = 0; row < size; ++row)
    {
        fputs("  |", out);
        for (size_t column = 0; column < size; ++column)
        {
            const double entry = analysis->matrix[row * size + column];
            if (denominator > 0.0)
                fprintf(out, " %5.0f", round(entry * denominator) + 0.0);
            else
                fprintf(out, " %11.7f", entry);
        }
        fputs(" |", out);
        if (row == size / 2 && denominator > 1.0)
            fprintf(out, " / %.0f", denominator);
        fputc('\n', out);
    }
}

static void print_vector(FILE *out, const double *vector, size_t size)
{
    double real[BAT_MASK_MAX];
    bool is_complex = false;
    for (size_t i = 0; i < size; ++i)
    {
        real[i] = vector[2 * i];
        is_complex = is_complex || vector[2 * i + 1] != 0.0;
    }
    if (!is_complex)
    {
        print_list(out, real, size);
        return;
    }
    fputc('[', out);
    for (size_t i = 0; i < size; ++i)
        fprintf(out, "%s%.5g%+.5gi", i > 0 ? " " : "", vector[2 * i], vector[2 * i + 1]);
    fputc(']', out);
}

static void print_eigenvalue(FILE *out, const bat_eigenvalue *value)
{
    char text[64];
    if (value->imaginary == 0.0)
    {
        const double denominator = common_denominator(&value->real, 1);
        if (denominator > 1.0)
            (void)snprintf(text, sizeof text, "%.0f/%.0f", round(value->real * denominator), denominator);
        else
            (void)snprintf(text, sizeof text, "%.10g", value->real);
    }
    else
        (void)snprintf(text, sizeof text, "%.8g %c %.8gi", value->real, value->imaginary < 0.0 ? '-' : '+',
                       fabs(value->imaginary));
    fprintf(out, "    %-16s", text);
}

static void report_matrix(FILE *out, const bat_analysis *analysis)
{
    const size_t size = analysis->matrix_size;
    fprintf(out, "\nLocal subdivision matrix\n");
    if (size == 0)
    {
        fputs("  none: no point determines the limit\n", out);
        return;
    }
    fprintf(out, "  of points %d to %d, which determine the limit at parameter 0 (point i at i / 2^level)\n",
            analysis->matrix_first, analysis->matrix_first + (int)size - 1);
    print_matrix(out, analysis);
    fprintf(out, "  eigenvalues%s\n", size <= LARGEST_MATRIX ? " and right eigenvectors" : "");
    for (size_t e = 0; e < analysis->eigenvalue_count; ++e)
    {
        const bat_eigenvalue *value = &analysis->eigenvalues[e];
        print_eigenvalue(out, value);
        for (size_t v = 0; v < value->vector_count && size <= LARGEST_MATRIX; ++v)
        {
            fputs(v > 0 ? "  " : " ", out);
            print_vector(out, analysis->eigenvectors + 2 * size * (value->vector + v), size);
        }
        if (value->multiplicity > 1)
            fprintf(out, "  %zu times", value->multiplicity);
        if (value->vector_count < value->multiplicity)
            fprintf(out, ", eigenvectors only for %zu: defective", value->vector_count);
        fputc('\n', out);
    }
}

static void print_stencil(FILE *out, const char *label, const bat_stencil *stencil)
{
    if (stencil->count == 0)
        return;
    fprintf(out, "  %-42s", label);
    print_list(out, stencil->weights, stencil->count);
    fprintf(out, "  from point %d\n", stencil->first);
}

static void report_stencils(FILE *out, const bat_analysis *analysis)
{
    if (analysis->limit.count == 0)
        return;
    fputs("\nLimit stencils\n", out);
    print_stencil(out, "limit at parameter 0", &analysis->limit);
    print_stencil(out, "derivative at parameter 0", &analysis->tangent);
    print_stencil(out, "limit at the parameter of point 0 (snap)", &analysis->vertex);
}

/// Nine digits, rounded so that a lower bound stays one and an upper one too; upper bounds that exceed their nine digits by less
/// than counts as equality keep them.
static double round_down(double number)
{
    return floor(number * 1e9) * 1e-9;
}
static double round_up(double number)
{
    return ceil((number - BAT_ANALYSIS_EQUALITY) * 1e9) * 1e-9;
}

static void print_bounds(FILE *out, double lower, double upper)
{
    if (lower == upper)
        fprintf(out, "%.9g, both bounds", lower);
    else if (isfinite(upper))
        fprintf(out, "at least %.10g, at most %.10g", round_down(lower), round_up(upper));
    else
        fprintf(out, "at least %.10g", round_down(lower));
}

static void report_convergence(FILE *out, const bat_analysis *analysis)
{
    fprintf(out, "\nConvergence: %s\n",
            analysis->converges == BAT_PROVEN      ? "yes, proven"
            : analysis->converges == BAT_DISPROVEN ? "no, proven"
                                                   : "undecided; try a larger --depth");
    fprintf(out, "  differences of order %zu grow by a factor per level ", analysis->multiplicity);
    if (analysis->radius_lower == analysis->radius_upper)
        fprintf(out, "of %.12g, both bounds\n", analysis->radius_lower);
    else
        fprintf(out, "between %.14g and %.14g\n", analysis->radius_lower, analysis->radius_upper);
    fprintf(out,
            "  (joint spectral radius of the two matrices of that order; products up to length %zu tried,\n"
            "  the fastest growing one is %s)\n",
            analysis->depth, analysis->product);
}

static void print_lipschitz(FILE *out, const bat_analysis *analysis)
{
    if (analysis->lipschitz == BAT_PROVEN)
        fputs(", Lipschitz continuous", out);
    else if (analysis->lipschitz == BAT_DISPROVEN && analysis->exponent_upper >= (double)(analysis->smooth_proven + 1))
        fputs(", for every exponent below 1 but not 1 itself", out);
}

static void report_smoothness(FILE *out, const bat_analysis *analysis)
{
    if (analysis->converges == BAT_DISPROVEN)
        return;
    fputs("\nSmoothness of the limit\n", out);
    if (analysis->smooth_proven >= 0)
        fprintf(out, "  C^%d is proven", analysis->smooth_proven);
    else
        fputs("  no continuity is proven", out);
    if (analysis->smooth_disproven >= 0)
        fprintf(out, ", C^%d is disproven", analysis->smooth_disproven);
    fputs("\n  total Hölder exponent: ", out);
    print_bounds(out, analysis->exponent_lower, analysis->exponent_upper);
    fputc('\n', out);
    for (int order = 0; order <= analysis->smooth_proven; ++order)
    {
        double lower, upper;
        if (!bat_analysis_derivative_exponent(analysis, (size_t)order, &lower, &upper))
            continue;
        fprintf(out, "  derivative of order %d: Hölder exponent ", order);
        print_bounds(out, lower, upper);
        if (order == analysis->smooth_proven)
            print_lipschitz(out, analysis);
        fputc('\n', out);
    }
    if (!analysis->is_stable)
        fputs("  integer shifts of the basic limit function are not proven stable: limits may be smoother than the lower "
              "bounds\n",
              out);
}

void analyze_report(FILE *out, const char *scheme, const bat_analysis *analysis)
{
    fprintf(out, "%s\n\n", scheme);
    report_symbol(out, analysis);
    report_matrix(out, analysis);
    report_stencils(out, analysis);
    report_convergence(out, analysis);
    report_smoothness(out, analysis);
}

void analyze_report_sweep(FILE *out, const char *scheme, const analyze_sweep *sweep)
{
    fprintf(out, "%s: where the limit is C^%zu, by %s\n\n", scheme, sweep->smoothness, sweep->parameter);
    const bat_interval *widest = NULL;
    for (size_t i = 0; i < sweep->count; ++i)
    {
        const bat_interval *interval = &sweep->intervals[i];
        if (interval->begin == interval->end)
            fprintf(out, "  %15.9g %-18s %s\n", interval->begin, "alone", bat_verdict_name(interval->verdict));
        else
            fprintf(out, "  %15.9g to %-15.9g %s\n", interval->begin, interval->end, bat_verdict_name(interval->verdict));
        const bool is_wider = widest == NULL || interval->end - interval->begin > widest->end - widest->begin;
        if (interval->verdict == BAT_PROVEN && is_wider)
            widest = interval;
    }
    if (widest != NULL && widest->begin < widest->end)
        fprintf(out, "\n  the largest proven interval is from %.9g to %.9g\n", widest->begin, widest->end);
}

#include "analyze.h"

#include "report.h"

#include <math.h>
#include <string.h>

enum
{
    /// Matrices larger than this are left to --json.
    LARGEST_MATRIX = 10,
    /// Difference masks up to this order are shown.
    LARGEST_ORDER = 6,
};

/// Numbers are shown over a common denominator up to this, or up to a power of two of 40 binary digits.
#define LARGEST_DENOMINATOR 65536
#define FRACTION_TOLERANCE 2e-13
/// Bounds that are no farther apart are shown as one number.
#define NARROW 1e-9

/// Whether all numbers are multiples of 1 / denominator, to rounding.
static bool fits_denominator(const double *numbers, size_t count, double denominator)
{
    for (size_t i = 0; i < count; i++)
    {
        double multiple = numbers[i] * denominator;
        if (!(fabs(multiple - round(multiple)) <= FRACTION_TOLERANCE * denominator) || fabs(multiple) > 1e15)
            return false;
    }
    return true;
}

/// The smallest common denominator of numbers that have one; 0 for others.
static double common_denominator(const double *numbers, size_t count)
{
    for (double denominator = 1; denominator <= LARGEST_DENOMINATOR; denominator += 1)
    {
        if (fits_denominator(numbers, count, denominator))
            return denominator;
    }
    for (int exponent = 17; exponent <= 40; exponent++)
    {
        double denominator = ldexp(1, exponent);
        bool exact = true;
        for (size_t i = 0; i < count; i++)
            exact = exact && numbers[i] * denominator == round(numbers[i] * denominator);
        if (exact)
            return denominator;
    }
    return 0;
}

static void print_number(FILE *out, double number, double denominator)
{
    if (denominator > 0)
        (void)fprintf(out, "%.0f", round(number * denominator) + 0);
    else
        (void)fprintf(out, "%.10g", number);
}

/// "[1 3 3 1] / 4"
static void print_list(FILE *out, const double *numbers, size_t count)
{
    double denominator = common_denominator(numbers, count);
    (void)fputc('[', out);
    for (size_t i = 0; i < count; i++)
    {
        if (i > 0)
            (void)fputc(' ', out);
        print_number(out, numbers[i], denominator);
    }
    (void)fputc(']', out);
    if (denominator > 1)
        (void)fprintf(out, " / %.0f", denominator);
}

static void print_fraction(FILE *out, double number)
{
    double denominator = common_denominator(&number, 1);
    print_number(out, number, denominator);
    if (denominator > 1)
        (void)fprintf(out, "/%.0f", denominator);
}

/// A polynomial with constant term first: "-1 + 4 z - z^2".
static void print_polynomial(FILE *out, const double *coefficients, size_t count, double denominator)
{
    bool is_first = true;
    for (size_t k = 0; k < count; k++)
    {
        double number = denominator > 0 ? round(coefficients[k] * denominator) : coefficients[k];
        if (number == 0)
            continue;
        if (is_first)
            (void)fputs(number < 0 ? "-" : "", out);
        else
            (void)fputs(number < 0 ? " - " : " + ", out);
        is_first = false;
        if (fabs(number) != 1 || k == 0)
            (void)fprintf(out, denominator > 0 ? "%.0f" : "%.10g", fabs(number));
        if (k > 0)
            (void)fputs(fabs(number) != 1 ? " z" : "z", out);
        if (k > 1)
            (void)fprintf(out, "^%zu", k);
    }
}

/// a(z) = z^-3 (1 + z)^4 (-1 + 4 z - z^2) / 16
static void print_symbol(FILE *out, const bat_analysis *analysis)
{
    const bat_mask *quotient = &analysis->quotient;
    double denominator = common_denominator(quotient->coefficients, quotient->count);
    (void)fputs("  a(z) = ", out);
    if (analysis->mask.first != 0)
        (void)fprintf(out, "z^%d ", analysis->mask.first);
    (void)fputs("(1 + z)", out);
    if (analysis->multiplicity > 1)
        (void)fprintf(out, "^%zu", analysis->multiplicity);
    bool is_unit = quotient->count == 1 && denominator > 0 && round(quotient->coefficients[0] * denominator) == 1;
    if (!is_unit)
    {
        (void)fputs(" (", out);
        print_polynomial(out, quotient->coefficients, quotient->count, denominator);
        (void)fputc(')', out);
    }
    if (denominator > 1)
        (void)fprintf(out, " / %.0f", denominator);
    (void)fputc('\n', out);
}

static void print_differences(FILE *out, const bat_analysis *analysis)
{
    for (size_t order = 1; order <= analysis->multiplicity && order <= LARGEST_ORDER; order++)
    {
        bat_mask difference;
        if (bat_mask_difference(&analysis->mask, order, &difference, NULL) != BAT_OK)
            return;
        (void)fprintf(out, "  differences of order %zu  ", order);
        print_list(out, difference.coefficients, difference.count);
        (void)fputc('\n', out);
    }
}

static void report_symbol(FILE *out, const bat_analysis *analysis)
{
    (void)fputs("Symbol\n", out);
    (void)fprintf(out, "  mask, from index %d:    ", analysis->mask.first);
    print_list(out, analysis->mask.coefficients, analysis->mask.count);
    (void)fputc('\n', out);
    print_symbol(out, analysis);
    print_differences(out, analysis);
    if (analysis->remainder > 0)
        (void)fprintf(out, "  the factors fit the given coefficients to %.1e\n", analysis->remainder);
    (void)fprintf(out, "  %s, %s\n", analysis->is_symmetric ? "symmetric" : "not symmetric",
                  analysis->is_interpolatory ? "interpolatory" : "approximating");
    (void)fputs("\nPolynomials\n", out);
    (void)fprintf(out, "  generates degree %zu, reproduces degree %zu with point i at (i + shift) / 2^level, shift = ",
                  analysis->generation_degree, analysis->reproduction_degree);
    print_fraction(out, analysis->shift);
    (void)fputs("\n", out);
}

static void print_matrix(FILE *out, const bat_analysis *analysis)
{
    size_t size = analysis->matrix_size;
    if (size > LARGEST_MATRIX)
    {
        (void)fprintf(out, "  %zu x %zu, shown by --json\n", size, size);
        return;
    }
    double denominator = common_denominator(analysis->matrix, size * size);
    for (size_t row = 0; row < size; row++)
    {
        (void)fputs("  |", out);
        for (size_t column = 0; column < size; column++)
        {
            double entry = analysis->matrix[row * size + column];
            if (denominator > 0)
                (void)fprintf(out, " %5.0f", round(entry * denominator) + 0);
            else
                (void)fprintf(out, " %11.7f", entry);
        }
        (void)fputs(" |", out);
        if (row == size / 2 && denominator > 1)
            (void)fprintf(out, " / %.0f", denominator);
        (void)fputc('\n', out);
    }
}

static void print_vector(FILE *out, const double *vector, size_t size)
{
    double real[BAT_MASK_MAX];
    bool is_complex = false;
    for (size_t i = 0; i < size; i++)
    {
        real[i] = vector[2 * i];
        is_complex = is_complex || vector[2 * i + 1] != 0;
    }
    if (!is_complex)
    {
        print_list(out, real, size);
        return;
    }
    (void)fputc('[', out);
    for (size_t i = 0; i < size; i++)
        (void)fprintf(out, "%s%.5g%+.5gi", i > 0 ? " " : "", vector[2 * i], vector[2 * i + 1]);
    (void)fputc(']', out);
}

static void print_eigenvalue(FILE *out, const bat_analysis_eigenvalue *value)
{
    char text[64];
    if (value->imaginary == 0)
    {
        double denominator = common_denominator(&value->real, 1);
        if (denominator > 1)
            (void)snprintf(text, sizeof text, "%.0f/%.0f", round(value->real * denominator), denominator);
        else
            (void)snprintf(text, sizeof text, "%.10g", value->real);
    }
    else
        (void)snprintf(text, sizeof text, "%.8g %c %.8gi", value->real, value->imaginary < 0 ? '-' : '+',
                       fabs(value->imaginary));
    (void)fprintf(out, "    %-16s", text);
}

static void report_matrix(FILE *out, const bat_analysis *analysis)
{
    size_t size = analysis->matrix_size;
    (void)fprintf(out, "\nLocal subdivision matrix\n");
    if (size == 0)
    {
        (void)fputs("  none: no point determines the limit\n", out);
        return;
    }
    (void)fprintf(out, "  of points %d to %d, which determine the limit at parameter 0 (point i at i / 2^level)\n",
                  analysis->matrix_first, analysis->matrix_first + (int)size - 1);
    print_matrix(out, analysis);
    (void)fprintf(out, "  eigenvalues%s\n", size <= LARGEST_MATRIX ? " and right eigenvectors" : "");
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        print_eigenvalue(out, value);
        for (size_t v = 0; v < value->vector_count && size <= LARGEST_MATRIX; v++)
        {
            (void)fputs(v > 0 ? "  " : " ", out);
            print_vector(out, analysis->eigenvectors + 2 * size * (value->vector + v), size);
        }
        if (value->multiplicity > 1)
            (void)fprintf(out, "  %zu times", value->multiplicity);
        if (value->vector_count < value->multiplicity)
            (void)fprintf(out, ", eigenvectors only for %zu: defective", value->vector_count);
        (void)fputc('\n', out);
    }
}

static void print_stencil(FILE *out, const char *label, const bat_mask_stencil *stencil)
{
    if (stencil->count == 0)
        return;
    (void)fprintf(out, "  %-42s", label);
    print_list(out, stencil->weights, stencil->count);
    (void)fprintf(out, "  from point %d\n", stencil->first);
}

static void report_stencils(FILE *out, const bat_analysis *analysis)
{
    if (analysis->limit.count == 0)
        return;
    (void)fputs("\nLimit stencils\n", out);
    print_stencil(out, "limit at parameter 0", &analysis->limit);
    print_stencil(out, "derivative at parameter 0", &analysis->tangent);
    print_stencil(out, "limit at the parameter of point 0 (snap)", &analysis->vertex);
}

/// Nine digits, rounded so that a lower bound stays one and an upper one too; upper bounds that exceed their nine digits by
/// less than counts as equality keep them.
static double round_down(double number)
{
    return floor(number * 1e9) * 1e-9;
}
static double round_up(double number)
{
    return ceil((number - BAT_ANALYSIS_EQUALITY) * 1e9) * 1e-9;
}

/// A bound whose other bound is within NARROW of it, rounded to nine decimals.
static void print_narrow(FILE *out, double bound)
{
    (void)fprintf(out, "%.12g, to within %g", round(bound * 1e9) * 1e-9, 2 * NARROW);
}

static void print_bounds(FILE *out, double lower, double upper)
{
    if (lower == upper)
        (void)fprintf(out, "%.9g, both bounds", lower);
    else if (upper - lower <= NARROW)
        print_narrow(out, upper);
    else if (isfinite(upper))
        (void)fprintf(out, "at least %.10g, at most %.10g", round_down(lower), round_up(upper));
    else
        (void)fprintf(out, "at least %.10g", round_down(lower));
}

static void report_convergence(FILE *out, const bat_analysis *analysis)
{
    (void)fprintf(out, "\nConvergence: %s\n",
                  analysis->converges == BAT_ANALYSIS_VERDICT_PROVEN      ? "yes, proven"
                  : analysis->converges == BAT_ANALYSIS_VERDICT_DISPROVEN ? "no, proven"
                                                                          : "undecided; try a larger --depth");
    (void)fprintf(out, "  differences of order %zu grow by a factor per level ", analysis->multiplicity);
    if (analysis->radius_lower == analysis->radius_upper)
        (void)fprintf(out, "of %.12g, both bounds\n", analysis->radius_lower);
    else if (analysis->radius_upper - analysis->radius_lower <= NARROW)
    {
        (void)fputs("of ", out);
        print_narrow(out, analysis->radius_lower);
        (void)fputc('\n', out);
    }
    else
        (void)fprintf(out, "between %.14g and %.14g\n", analysis->radius_lower, analysis->radius_upper);
    (void)fprintf(out,
                  "  (joint spectral radius of the two matrices of that order; products up to length %zu tried,\n"
                  "  the fastest growing one is %s)\n",
                  analysis->depth, analysis->product);
}

static void print_lipschitz(FILE *out, const bat_analysis *analysis)
{
    if (analysis->lipschitz == BAT_ANALYSIS_VERDICT_PROVEN)
        (void)fputs(", Lipschitz continuous", out);
    else if (analysis->lipschitz == BAT_ANALYSIS_VERDICT_DISPROVEN &&
             analysis->exponent_upper >= (double)(analysis->smooth_proven + 1))
        (void)fputs(", for every exponent below 1 but not 1 itself", out);
}

/// The exponents of the derivatives: orders with equal ones on one line, the highest order, of which there is more to say,
/// on its own.
static void print_derivatives(FILE *out, const bat_analysis *analysis)
{
    double lower, upper, next_lower, next_upper;
    size_t last;
    for (size_t first = 0; bat_analysis_derivative_exponent(analysis, first, &lower, &upper); first = last + 1)
    {
        last = first;
        while ((int)last + 1 < analysis->smooth_proven &&
               bat_analysis_derivative_exponent(analysis, last + 1, &next_lower, &next_upper) && next_lower == lower &&
               next_upper == upper)
            last++;
        if (first == last)
            (void)fprintf(out, "  derivative of order %zu: Hölder exponent ", first);
        else
            (void)fprintf(out, "  derivatives of orders %zu to %zu: Hölder exponent ", first, last);
        print_bounds(out, lower, upper);
        if ((int)last == analysis->smooth_proven)
            print_lipschitz(out, analysis);
        (void)fputc('\n', out);
    }
}

static void report_smoothness(FILE *out, const bat_analysis *analysis)
{
    if (analysis->converges == BAT_ANALYSIS_VERDICT_DISPROVEN)
        return;
    (void)fputs("\nSmoothness of the limit\n", out);
    if (analysis->smooth_proven >= 0)
        (void)fprintf(out, "  C^%d is proven", analysis->smooth_proven);
    else
        (void)fputs("  no continuity is proven", out);
    if (analysis->smooth_disproven >= 0)
        (void)fprintf(out, ", C^%d is disproven", analysis->smooth_disproven);
    (void)fputs("\n  total Hölder exponent: ", out);
    print_bounds(out, analysis->exponent_lower, analysis->exponent_upper);
    (void)fputc('\n', out);
    print_derivatives(out, analysis);
    if (!analysis->is_stable)
        (void)fputs(
            "  integer shifts of the basic limit function are not proven stable: limits may be smoother than the lower "
            "bounds\n",
            out);
}

void analyze_report(FILE *out, const char *scheme, const bat_analysis *analysis)
{
    (void)fprintf(out, "%s\n\n", scheme);
    report_symbol(out, analysis);
    report_matrix(out, analysis);
    report_stencils(out, analysis);
    report_convergence(out, analysis);
    report_smoothness(out, analysis);
}

static const char *verdict_name(bat_analysis_verdict verdict)
{
    return bat_choice_name(&bat_analysis_verdict_family, (int)verdict);
}

void analyze_report_sweep(FILE *out, const char *scheme, const analyze_sweep *sweep)
{
    (void)fprintf(out, "%s: where the limit is C^%zu, by %s\n\n", scheme, sweep->smoothness, sweep->parameter);
    const bat_mask_interval *widest = NULL;
    for (size_t i = 0; i < sweep->count; i++)
    {
        const bat_mask_interval *interval = &sweep->intervals[i];
        if (interval->begin == interval->end)
            (void)fprintf(out, "  %15.9g %-18s %s\n", interval->begin, "alone", verdict_name(interval->verdict));
        else
            (void)fprintf(out, "  %15.9g to %-15.9g %s\n", interval->begin, interval->end, verdict_name(interval->verdict));
        bool is_wider = widest == NULL || interval->end - interval->begin > widest->end - widest->begin;
        if (interval->verdict == BAT_ANALYSIS_VERDICT_PROVEN && is_wider)
            widest = interval;
    }
    if (widest != NULL && widest->begin < widest->end)
        (void)fprintf(out, "\n  the largest proven interval is from %.9g to %.9g\n", widest->begin, widest->end);
}

// JSON

// json_array_append_new() and json_object_set_new() of Jansson take over their value and fail on a null one, so that
// `failed` tells of a failed allocation anywhere.

/// An object under construction. Infinite bounds, which stand for none, become null.
typedef struct builder
{
    json_t *object;
    bool failed;
} builder;

static void put(builder *b, const char *key, json_t *value)
{
    b->failed = json_object_set_new(b->object, key, value) != 0 || b->failed;
}

static json_t *numbers(builder *b, const double *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        b->failed = json_array_append_new(array, report_number(values[i])) != 0 || b->failed;
    return array;
}

static json_t *indexed(builder *b, const char *key, const double *values, size_t count, int first)
{
    builder inner = {.object = json_object()};
    put(&inner, "first", json_integer(first));
    put(&inner, key, numbers(&inner, values, count));
    b->failed = b->failed || inner.failed;
    return inner.object;
}

static json_t *stencil(builder *b, const bat_mask_stencil *s)
{
    return s->count > 0 ? indexed(b, "weights", s->weights, s->count, s->first) : json_null();
}

static json_t *smoothness(int order)
{
    return order >= 0 ? json_integer(order) : json_null();
}

static json_t *matrix(builder *b, const bat_analysis *analysis)
{
    json_t *rows = json_array();
    for (size_t row = 0; row < analysis->matrix_size; row++)
    {
        const double *values = analysis->matrix + row * analysis->matrix_size;
        b->failed = json_array_append_new(rows, numbers(b, values, analysis->matrix_size)) != 0 || b->failed;
    }
    return rows;
}

static json_t *eigenvector(builder *b, const double *vector, size_t size)
{
    json_t *entries = json_array();
    for (size_t i = 0; i < size; i++)
        b->failed = json_array_append_new(entries, numbers(b, vector + 2 * i, 2)) != 0 || b->failed;
    return entries;
}

static json_t *eigenvalues(builder *b, const bat_analysis *analysis)
{
    json_t *array = json_array();
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        builder inner = {.object = json_object()};
        put(&inner, "real", report_number(value->real));
        put(&inner, "imaginary", report_number(value->imaginary));
        put(&inner, "multiplicity", json_integer((json_int_t)value->multiplicity));
        json_t *vectors = json_array();
        for (size_t v = 0; v < value->vector_count; v++)
        {
            const double *row = analysis->eigenvectors + 2 * analysis->matrix_size * (value->vector + v);
            inner.failed =
                json_array_append_new(vectors, eigenvector(&inner, row, analysis->matrix_size)) != 0 || inner.failed;
        }
        put(&inner, "eigenvectors", vectors);
        b->failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b->failed;
    }
    return array;
}

static json_t *derivatives(builder *b, const bat_analysis *analysis)
{
    json_t *array = json_array();
    double lower, upper;
    for (size_t order = 0; bat_analysis_derivative_exponent(analysis, order, &lower, &upper); order++)
    {
        builder inner = {.object = json_object()};
        put(&inner, "order", json_integer((json_int_t)order));
        put(&inner, "exponent_lower", report_number(lower));
        put(&inner, "exponent_upper", isfinite(analysis->exponent_upper) ? report_number(upper) : json_null());
        b->failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b->failed;
    }
    return array;
}

/// The object, or null after releasing it when something failed.
static json_t *finish(builder *b)
{
    if (!b->failed)
        return b->object;
    json_decref(b->object);
    return NULL;
}

json_t *analyze_json(const char *scheme, const bat_analysis *analysis)
{
    builder b = {.object = json_object()};
    put(&b, "scheme", json_string(scheme));
    put(&b, "mask", indexed(&b, "coefficients", analysis->mask.coefficients, analysis->mask.count, analysis->mask.first));
    put(&b, "multiplicity", json_integer((json_int_t)analysis->multiplicity));
    put(&b, "quotient",
        indexed(&b, "coefficients", analysis->quotient.coefficients, analysis->quotient.count, analysis->quotient.first));
    put(&b, "remainder", report_number(analysis->remainder));
    put(&b, "interpolatory", json_boolean(analysis->is_interpolatory));
    put(&b, "symmetric", json_boolean(analysis->is_symmetric));
    put(&b, "shift", report_number(analysis->shift));
    put(&b, "generation_degree", json_integer((json_int_t)analysis->generation_degree));
    put(&b, "reproduction_degree", json_integer((json_int_t)analysis->reproduction_degree));
    put(&b, "matrix_first", json_integer(analysis->matrix_first));
    put(&b, "matrix", matrix(&b, analysis));
    put(&b, "eigenvalues", eigenvalues(&b, analysis));
    put(&b, "converges", json_string(verdict_name(analysis->converges)));
    put(&b, "limit_stencil", stencil(&b, &analysis->limit));
    put(&b, "tangent_stencil", stencil(&b, &analysis->tangent));
    put(&b, "vertex_stencil", stencil(&b, &analysis->vertex));
    put(&b, "radius_lower", report_number(analysis->radius_lower));
    put(&b, "radius_upper", report_number(analysis->radius_upper));
    put(&b, "product", json_string(analysis->product));
    put(&b, "depth", json_integer((json_int_t)analysis->depth));
    put(&b, "stable", json_boolean(analysis->is_stable));
    put(&b, "exponent_lower", report_number(analysis->exponent_lower));
    put(&b, "exponent_upper", report_number(analysis->exponent_upper));
    put(&b, "derivatives", derivatives(&b, analysis));
    put(&b, "smooth_proven", smoothness(analysis->smooth_proven));
    put(&b, "smooth_disproven", smoothness(analysis->smooth_disproven));
    put(&b, "lipschitz", json_string(verdict_name(analysis->lipschitz)));
    return finish(&b);
}

json_t *analyze_sweep_json(const char *scheme, const analyze_sweep *sweep)
{
    builder b = {.object = json_object()};
    put(&b, "scheme", json_string(scheme));
    put(&b, "parameter", json_string(sweep->parameter));
    put(&b, "smoothness", json_integer((json_int_t)sweep->smoothness));
    json_t *array = json_array();
    for (size_t i = 0; i < sweep->count; i++)
    {
        builder inner = {.object = json_object()};
        put(&inner, "begin", report_number(sweep->intervals[i].begin));
        put(&inner, "end", report_number(sweep->intervals[i].end));
        put(&inner, "verdict", json_string(verdict_name(sweep->intervals[i].verdict)));
        b.failed = json_array_append_new(array, inner.object) != 0 || inner.failed || b.failed;
    }
    put(&b, "intervals", array);
    return finish(&b);
}

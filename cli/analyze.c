#include "verb.h"

#include "batten/research/chart_picture.h"
#include "batten/research/curve_analysis.h"
#include "batten/research/mask_sweep.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    /// The longest name of a scheme with its settings.
    SCHEME_SIZE = 512,
    PARAMETER_SIZE = 32,
    /// Samples of the basic limit function drawn: 2^DRAWN_LEVEL for each unit.
    DRAWN_LEVEL = 9,
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

/// A family of schemes: a name with settings, and one more setting that varies.
typedef struct named_family
{
    const char *scheme;
    char parameter[PARAMETER_SIZE];
} named_family;

/// The job of `batten analyze`.
typedef struct analyze_job
{
    verb_call call;
    bat_mask_analyze_options options;
    bat_curve_scheme scheme; ///< without --sweep
    bat_analysis analysis;   ///< of it
    bool sweeps;
    named_family family;
    bat_mask_sweep_options sweep;
    bat_mask_interval *intervals; ///< of the sweep
    size_t count;
} analyze_job;

static const option_spec OPTIONS[] = {
    {"depth", "N", METHOD, COMMON, "try products of N difference matrices, 1 to 24; more gives tighter bounds; default: 12",
     WHOLE(analyze_job, options.depth, 1, BAT_ANALYSIS_MAX_DEPTH)},
    {"sweep", "NAME=A:B", METHOD, COMMON, "find where the limit is C^k as the scheme's setting NAME goes from A to B",
     NO_FIELD},
    {"smoothness", "K", METHOD, COMMON, "the k of C^k for --sweep; default: 1", WHOLE(analyze_job, sweep.smoothness, 0, 30)},
    {"resolution", "T", METHOD, COMMON, "the shortest interval of --sweep that is divided; default: (B - A) / 32768",
     NUMBER(analyze_job, sweep.tolerance)},
    {"picture", "FILE", PICTURE, COMMON | IS_DRAWN, "draw the basic limit function to FILE: .svg, .png or .pdf", NO_FIELD},
    END_OF_OPTIONS,
};

static bool check_linear(const arguments *given, const bat_curve_scheme *scheme)
{
    return scheme->kind == BAT_CURVE_SCHEME_KIND_LINEAR ||
           usage_refused(given, "'%s' is not linear: it has no mask", given->positional[0]);
}

static bat_status family_member(const named_family *family, double value, bat_curve_scheme *scheme, bat_error *error)
{
    char name[SCHEME_SIZE];
    char separator = strchr(family->scheme, ':') != NULL ? ',' : ':';
    int length = snprintf(name, sizeof name, "%s%c%s=%.17g", family->scheme, separator, family->parameter, value);
    if (length >= 0 && (size_t)length < sizeof name)
        return bat_curve_scheme_by_name(name, scheme, error);
    if (error != NULL)
        *error = (bat_error){.status = BAT_INVALID_ARGUMENT, .text = "the name of the scheme is too long"};
    return BAT_INVALID_ARGUMENT;
}

/// An empty mask, which the sweep refuses, stands for a member that does not exist.
static bat_mask family_mask(void *context, double value)
{
    bat_curve_scheme scheme;
    return family_member(context, value, &scheme, NULL) == BAT_OK ? scheme.mask : (bat_mask){0};
}

static bool read_number(const char *text, char **end, double *number)
{
    errno = 0;
    *number = strtod(text, end);
    return *end != text && errno == 0 && isfinite(*number);
}

/// NAME=A:B
static bool read_sweep(const char *text, named_family *family, bat_mask_sweep_options *options)
{
    const char *equals = strchr(text, '=');
    if (equals == NULL || equals == text || equals - text >= PARAMETER_SIZE)
        return false;
    memcpy(family->parameter, text, (size_t)(equals - text));
    family->parameter[equals - text] = '\0';
    char *end;
    return read_number(equals + 1, &end, &options->begin) && *end == ':' && read_number(end + 1, &end, &options->end) &&
           *end == '\0';
}

/// The options of a sweep, and both its ends tried. False after a message.
static bool check_sweep(analyze_job *job)
{
    const arguments *given = job->call.given;
    bat_mask_sweep_options *options = &job->sweep;
    options->analysis = job->options;
    job->family.scheme = job->call.input;
    if (!read_sweep(argument(given, "sweep"), &job->family, options))
        return argument_refused(given, "sweep", "NAME=A:B, as in w=0:0.25");
    if (!usage_accepts(given, bat_options_check(&bat_mask_sweep_fields, options, report_error())))
        return false;
    double ends[] = {options->begin, options->end};
    for (size_t i = 0; i < 2; i++)
    {
        bat_curve_scheme scheme = {0};
        if (!usage_accepts(given, family_member(&job->family, ends[i], &scheme, report_error())) ||
            !check_linear(given, &scheme))
            return false;
    }
    return true;
}

/// The basic limit function over its support.
static int draw_basis(const char *path, const char *write_to, const char *name, const bat_mask *mask)
{
    bat_basis basis;
    if (bat_mask_basis(mask, DRAWN_LEVEL, &basis, report_error()) != BAT_OK)
        return report_failure(NULL, report_error());
    double *parameters = calloc(basis.count, sizeof *parameters);
    int code = parameters == NULL ? report_failure(path, &(bat_error){.text = "out of memory"}) : EXIT_DONE;
    for (size_t i = 0; i < basis.count && code == EXIT_DONE; i++)
        parameters[i] = basis.first + ldexp((double)i, -DRAWN_LEVEL);
    if (code == EXIT_DONE)
    {
        bat_chart_series series = {.x = parameters, .y = basis.values, .count = basis.count};
        bat_chart chart = bat_chart_defaults();
        chart.series = &series;
        chart.series_count = 1;
        chart.title = name;
        chart.x_label = "parameter";
        chart.y_label = "basic limit function";
        code = report_status(NULL, path, bat_chart_write(write_to, &chart, 1, NULL, report_error()));
    }
    free(parameters);
    bat_basis_free(&basis);
    return code;
}

// The report

static const char *verdict_name(bat_analysis_verdict verdict)
{
    return bat_choice_name(&bat_analysis_verdict_family, (int)verdict);
}

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
        if (fits_denominator(numbers, count, denominator))
            return denominator;
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

/// "[1 3 3 1] / 4"
static void print_list(const double *numbers, size_t count)
{
    double denominator = common_denominator(numbers, count);
    (void)putchar('[');
    for (size_t i = 0; i < count; i++)
        (void)printf(denominator > 0 ? "%s%.0f" : "%s%.10g", i > 0 ? " " : "",
                     denominator > 0 ? round(numbers[i] * denominator) + 0 : numbers[i]);
    (void)putchar(']');
    if (denominator > 1)
        (void)printf(" / %.0f", denominator);
}

/// "3/4", or a decimal number.
static const char *fraction(double number, char text[64])
{
    double denominator = common_denominator(&number, 1);
    if (denominator > 1)
        (void)snprintf(text, 64, "%.0f/%.0f", round(number * denominator), denominator);
    else
        (void)snprintf(text, 64, "%.10g", number);
    return text;
}

/// A polynomial with constant term first: "-1 + 4 z - z^2".
static void print_polynomial(const double *coefficients, size_t count, double denominator)
{
    bool is_first = true;
    for (size_t k = 0; k < count; k++)
    {
        double number = denominator > 0 ? round(coefficients[k] * denominator) : coefficients[k];
        if (number == 0)
            continue;
        (void)printf("%s", is_first ? number < 0 ? "-" : "" : number < 0 ? " - " : " + ");
        is_first = false;
        if (fabs(number) != 1 || k == 0)
            (void)printf(denominator > 0 ? "%.0f" : "%.10g", fabs(number));
        if (k > 0)
            (void)printf("%s", fabs(number) != 1 ? " z" : "z");
        if (k > 1)
            (void)printf("^%zu", k);
    }
}

/// a(z) = z^-3 (1 + z)^4 (-1 + 4 z - z^2) / 16
static void print_symbol(const bat_analysis *analysis)
{
    const bat_mask *quotient = &analysis->quotient;
    double denominator = common_denominator(quotient->coefficients, quotient->count);
    (void)report_part(false, "  a(z) = [first?z^{first} ](1 + z)[several?^{multiplicity}]",
                      "first:i multiplicity:z several:b", analysis->mask.first, analysis->multiplicity,
                      (int)(analysis->multiplicity > 1));
    bool is_unit = quotient->count == 1 && denominator > 0 && round(quotient->coefficients[0] * denominator) == 1;
    if (!is_unit)
    {
        (void)printf(" (");
        print_polynomial(quotient->coefficients, quotient->count, denominator);
        (void)putchar(')');
    }
    if (denominator > 1)
        (void)printf(" / %.0f", denominator);
    (void)putchar('\n');
}

static void print_differences(const bat_analysis *analysis)
{
    for (size_t order = 1; order <= analysis->multiplicity && order <= LARGEST_ORDER; order++)
    {
        bat_mask difference;
        if (bat_mask_difference(&analysis->mask, order, &difference, NULL) != BAT_OK)
            return;
        (void)printf("  differences of order %zu  ", order);
        print_list(difference.coefficients, difference.count);
        (void)putchar('\n');
    }
}

static void report_symbol(const bat_analysis *analysis)
{
    char shift[64];
    (void)printf("Symbol\n  mask, from index %d:    ", analysis->mask.first);
    print_list(analysis->mask.coefficients, analysis->mask.count);
    (void)putchar('\n');
    print_symbol(analysis);
    print_differences(analysis);
    if (analysis->remainder > 0)
        (void)printf("  the factors fit the given coefficients to %.1e\n", analysis->remainder);
    (void)printf(
        "  %s, %s\n\nPolynomials\n  generates degree %zu, reproduces degree %zu with point i at (i + shift) / 2^level, "
        "shift = %s\n",
        analysis->is_symmetric ? "symmetric" : "not symmetric",
        analysis->is_interpolatory ? "interpolatory" : "approximating", analysis->generation_degree,
        analysis->reproduction_degree, fraction(analysis->shift + 0, shift));
}

static void print_matrix(const bat_analysis *analysis)
{
    size_t size = analysis->matrix_size;
    if (size > LARGEST_MATRIX)
    {
        (void)printf("  %zu x %zu, shown by --json\n", size, size);
        return;
    }
    double denominator = common_denominator(analysis->matrix, size * size);
    for (size_t row = 0; row < size; row++)
    {
        (void)printf("  |");
        for (size_t column = 0; column < size; column++)
        {
            double entry = analysis->matrix[row * size + column];
            if (denominator > 0)
                (void)printf(" %5.0f", round(entry * denominator) + 0);
            else
                (void)printf(" %11.7f", entry);
        }
        (void)printf(" |");
        if (row == size / 2 && denominator > 1)
            (void)printf(" / %.0f", denominator);
        (void)putchar('\n');
    }
}

static void print_vector(const double *vector, size_t size)
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
        print_list(real, size);
        return;
    }
    (void)putchar('[');
    for (size_t i = 0; i < size; i++)
        (void)printf("%s%.5g%+.5gi", i > 0 ? " " : "", vector[2 * i], vector[2 * i + 1]);
    (void)putchar(']');
}

static void report_matrix(const bat_analysis *analysis)
{
    size_t size = analysis->matrix_size;
    (void)printf("\nLocal subdivision matrix\n%s", size == 0 ? "  none: no point determines the limit\n" : "");
    if (size == 0)
        return;
    (void)printf("  of points %d to %d, which determine the limit at parameter 0 (point i at i / 2^level)\n",
                 analysis->matrix_first, analysis->matrix_first + (int)size - 1);
    print_matrix(analysis);
    (void)printf("  eigenvalues%s\n", size <= LARGEST_MATRIX ? " and right eigenvectors" : "");
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        char text[64];
        if (value->imaginary == 0)
            (void)fraction(value->real, text);
        else
            (void)snprintf(text, sizeof text, "%.8g %c %.8gi", value->real, value->imaginary < 0 ? '-' : '+',
                           fabs(value->imaginary));
        (void)printf("    %-16s", text);
        for (size_t v = 0; v < value->vector_count && size <= LARGEST_MATRIX; v++)
        {
            (void)printf("%s", v > 0 ? "  " : " ");
            print_vector(analysis->eigenvectors + 2 * size * (value->vector + v), size);
        }
        if (value->multiplicity > 1)
            (void)printf("  %zu times", value->multiplicity);
        if (value->vector_count < value->multiplicity)
            (void)printf(", eigenvectors only for %zu: defective", value->vector_count);
        (void)putchar('\n');
    }
}

static void report_stencils(const bat_analysis *analysis)
{
    const struct
    {
        const char *label;
        const bat_mask_stencil *stencil;
    } rows[] = {{"limit at parameter 0", &analysis->limit},
                {"derivative at parameter 0", &analysis->tangent},
                {"limit at the parameter of point 0 (snap)", &analysis->vertex}};
    if (analysis->limit.count > 0)
        (void)printf("\nLimit stencils\n");
    for (size_t i = 0; i < sizeof rows / sizeof *rows && analysis->limit.count > 0; i++)
        if (rows[i].stencil->count > 0)
        {
            (void)printf("  %-42s", rows[i].label);
            print_list(rows[i].stencil->weights, rows[i].stencil->count);
            (void)printf("  from point %d\n", rows[i].stencil->first);
        }
}

/// Bounds of nine digits, rounded so that a lower bound stays one and an upper one too; upper bounds that exceed their nine
/// digits by less than counts as equality keep them. Bounds within NARROW of each other are one number.
static void print_bounds(double lower, double upper)
{
    double low = floor(lower * 1e9) * 1e-9, high = ceil((upper - BAT_ANALYSIS_EQUALITY) * 1e9) * 1e-9;
    if (lower == upper)
        (void)printf("%.9g, both bounds", lower);
    else if (upper - lower <= NARROW)
        (void)printf("%.12g, to within %g", round(upper * 1e9) * 1e-9, 2 * NARROW);
    else if (isfinite(upper))
        (void)printf("at least %.10g, at most %.10g", low, high);
    else
        (void)printf("at least %.10g", low);
}

static void report_convergence(const bat_analysis *analysis)
{
    static const char *const ANSWERS[] = {[BAT_ANALYSIS_VERDICT_PROVEN] = "yes, proven",
                                          [BAT_ANALYSIS_VERDICT_DISPROVEN] = "no, proven",
                                          [BAT_ANALYSIS_VERDICT_UNDECIDED] = "undecided; try a larger --depth"};
    double lower = analysis->radius_lower, upper = analysis->radius_upper;
    (void)printf("\nConvergence: %s\n  differences of order %zu grow by a factor per level ", ANSWERS[analysis->converges],
                 analysis->multiplicity);
    if (lower == upper)
        (void)printf("of %.12g, both bounds\n", lower);
    else if (upper - lower <= NARROW)
        (void)printf("of %.12g, to within %g\n", round(lower * 1e9) * 1e-9, 2 * NARROW);
    else
        (void)printf("between %.14g and %.14g\n", lower, upper);
    (void)printf("  (joint spectral radius of the two matrices of that order; products up to length %zu tried,\n"
                 "  the fastest growing one is %s)\n",
                 analysis->depth, analysis->product);
}

/// The exponents of the derivatives: orders with equal ones on one line, the highest order, of which there is more to say,
/// on its own.
static void print_derivatives(const bat_analysis *analysis)
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
        (void)report_part(false, "  derivative[several?s of orders {first} to][!several? of order] {last}: Hölder exponent ",
                          "several:b first:z last:z", (int)(first < last), first, last);
        print_bounds(lower, upper);
        bool is_highest = (int)last == analysis->smooth_proven;
        if (is_highest && analysis->lipschitz == BAT_ANALYSIS_VERDICT_PROVEN)
            (void)printf(", Lipschitz continuous");
        else if (is_highest && analysis->lipschitz == BAT_ANALYSIS_VERDICT_DISPROVEN &&
                 analysis->exponent_upper >= (double)(analysis->smooth_proven + 1))
            (void)printf(", for every exponent below 1 but not 1 itself");
        (void)putchar('\n');
    }
}

static void report_smoothness(const bat_analysis *analysis)
{
    if (analysis->converges == BAT_ANALYSIS_VERDICT_DISPROVEN)
        return;
    int proven = analysis->smooth_proven, disproven = analysis->smooth_disproven;
    (void)report_part(false,
                      "\nSmoothness of the limit\n[some?  C^{proven} is proven][!some?  no continuity is proven][not_all?, "
                      "C^{disproven} is disproven]\n  total Hölder exponent: ",
                      "some:b proven:i not_all:b disproven:i", (int)(proven >= 0), proven, (int)(disproven >= 0), disproven);
    print_bounds(analysis->exponent_lower, analysis->exponent_upper);
    (void)putchar('\n');
    print_derivatives(analysis);
    if (!analysis->is_stable)
        (void)printf(
            "  integer shifts of the basic limit function are not proven stable: limits may be smoother than the lower "
            "bounds\n");
}

/// Rows of numbers as arrays; null where memory ran out.
static json_t *rows_json(const double *values, size_t rows, size_t columns)
{
    report_table table = report_begin(true);
    for (size_t i = 0; i < rows; i++)
        report_gather(&table, report_numbers(values + i * columns, columns));
    return table.rows;
}

static json_t *mask_json(const bat_mask *mask)
{
    return report_object("first:i coefficients:o", mask->first, report_numbers(mask->coefficients, mask->count));
}

static json_t *stencil_json(const bat_mask_stencil *stencil)
{
    if (stencil->count == 0)
        return json_null();
    return report_object("first:i weights:o", stencil->first, report_numbers(stencil->weights, stencil->count));
}

static json_t *smoothness_json(int order)
{
    return order >= 0 ? json_integer(order) : json_null();
}

static json_t *eigenvalues_json(const bat_analysis *analysis)
{
    report_table table = report_begin(true);
    size_t size = analysis->matrix_size;
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        const bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        report_table vectors = report_begin(true);
        for (size_t v = 0; v < value->vector_count; v++)
            report_gather(&vectors, rows_json(analysis->eigenvectors + 2 * size * (value->vector + v), size, 2));
        report_row(&table, "", "real:n imaginary:n multiplicity:z eigenvectors:o", value->real, value->imaginary,
                   value->multiplicity, vectors.rows);
    }
    return table.rows;
}

static json_t *derivatives_json(const bat_analysis *analysis)
{
    report_table table = report_begin(true);
    double lower, upper;
    for (size_t order = 0; bat_analysis_derivative_exponent(analysis, order, &lower, &upper); order++)
        report_row(&table, "", "order:z exponent_lower:n exponent_upper:n", order, lower,
                   isfinite(analysis->exponent_upper) ? upper : INFINITY);
    return table.rows;
}

static int report_analysis(const char *scheme, const bat_analysis *analysis, bool as_json)
{
    if (as_json)
        return report_json(report_object(
            "scheme:s mask:o multiplicity:z quotient:o remainder:n interpolatory:b symmetric:b shift:n generation_degree:z "
            "reproduction_degree:z matrix_first:i matrix:o eigenvalues:o converges:s limit_stencil:o tangent_stencil:o "
            "vertex_stencil:o radius_lower:n radius_upper:n product:s depth:z stable:b exponent_lower:n exponent_upper:n "
            "derivatives:o smooth_proven:o smooth_disproven:o lipschitz:s",
            scheme, mask_json(&analysis->mask), analysis->multiplicity, mask_json(&analysis->quotient), analysis->remainder,
            (int)analysis->is_interpolatory, (int)analysis->is_symmetric, analysis->shift, analysis->generation_degree,
            analysis->reproduction_degree, analysis->matrix_first,
            rows_json(analysis->matrix, analysis->matrix_size, analysis->matrix_size), eigenvalues_json(analysis),
            verdict_name(analysis->converges), stencil_json(&analysis->limit), stencil_json(&analysis->tangent),
            stencil_json(&analysis->vertex), analysis->radius_lower, analysis->radius_upper, analysis->product,
            analysis->depth, (int)analysis->is_stable, analysis->exponent_lower, analysis->exponent_upper,
            derivatives_json(analysis), smoothness_json(analysis->smooth_proven),
            smoothness_json(analysis->smooth_disproven), verdict_name(analysis->lipschitz)));
    (void)printf("%s\n\n", scheme);
    report_symbol(analysis);
    report_matrix(analysis);
    report_stencils(analysis);
    report_convergence(analysis);
    report_smoothness(analysis);
    return EXIT_DONE;
}

static int report_sweep(const analyze_job *job)
{
    const bat_mask_interval *widest = NULL;
    const char *scheme = job->call.input;
    report_table table = report_begin(job->call.json);
    report_head(&table, "%s: where the limit is C^%zu, by %s\n\n", scheme, job->sweep.smoothness, job->family.parameter);
    for (size_t i = 0; i < job->count; i++)
    {
        const bat_mask_interval *interval = &job->intervals[i];
        report_row(&table, "  {begin:15.9g} [alone?alone             ][!alone?to {end:-15.9g}] {verdict}\n",
                   "begin:n end:n verdict:s -alone:b", interval->begin, interval->end, verdict_name(interval->verdict),
                   (int)(interval->begin == interval->end));
        bool is_wider = widest == NULL || interval->end - interval->begin > widest->end - widest->begin;
        if (interval->verdict == BAT_ANALYSIS_VERDICT_PROVEN && is_wider)
            widest = interval;
    }
    bool told = widest != NULL && widest->begin < widest->end;
    return report_print(job->call.json, "[told?\n  the largest proven interval is from {begin:.9g} to {end:.9g}\n]",
                        "scheme:s parameter:s smoothness:z intervals:o -told:b -begin:n -end:n", scheme,
                        job->family.parameter, job->sweep.smoothness, table.rows, (int)told, told ? widest->begin : 0,
                        told ? widest->end : 0);
}

// The verb

static void begin(void *to)
{
    analyze_job *job = to;
    job->options = bat_mask_analyze_defaults();
    job->sweep = bat_mask_sweep_defaults();
}

static bool check(void *of)
{
    static const char *const of_sweep[] = {"smoothness", "resolution", NULL};
    analyze_job *job = of;
    const arguments *given = job->call.given;
    job->sweeps = argument(given, "sweep") != NULL;
    if (job->sweeps && job->call.picture != NULL)
        return usage_refused(given, "--picture does not go with --sweep");
    if (job->sweeps)
        return check_sweep(job);
    if (argument_first(given, of_sweep) != NULL)
        return usage_refused(given, "--smoothness and --resolution go with --sweep");
    return usage_accepts(given, bat_curve_scheme_by_name(job->call.input, &job->scheme, report_error())) &&
           check_linear(given, &job->scheme);
}

static int make(void *of)
{
    analyze_job *job = of;
    const char *name = job->call.input;
    if (job->sweeps)
    {
        bat_mask_sweep_options options = job->sweep;
        options.progress = report_progress("analyze");
        return report_status(
            NULL, NULL, bat_mask_sweep(family_mask, &job->family, &options, &job->intervals, &job->count, report_error()));
    }
    if (bat_mask_analyze(&job->scheme.mask, &job->options, &job->analysis, report_error()) != BAT_OK)
        return report_failure(name, report_error());
    return job->call.picture == NULL
               ? EXIT_DONE
               : draw_basis(job->call.picture, output_path(&job->call.files, "picture"), name, &job->scheme.mask);
}

static int report(void *of)
{
    const analyze_job *job = of;
    return job->sweeps ? report_sweep(job) : report_analysis(job->call.input, &job->analysis, job->call.json);
}

static void end(void *of)
{
    analyze_job *job = of;
    bat_analysis_free(&job->analysis);
    free(job->intervals);
}

const verb VERB_ANALYZE = {
    .name = "analyze",
    .arguments = "SCHEME [options]",
    .summary = "analyze the limit of a linear scheme, with proven bounds",
    .about = "Analyze a linear scheme in the limit: symbol, local matrix and eigenvalues, limit stencils, polynomials, "
             "convergence and smoothness with proven bounds. `batten list schemes` names the schemes.",
    .example = "batten analyze four-point:w=0.05 --picture basis.svg",
    .options = {{OPTIONS, 0}, {JSON_OPTION, 0}},
    .positional = {1, 1},
    .list = "schemes",
    .job_size = sizeof(analyze_job),
    .calls = {begin, check, make, NULL, report, end},
};

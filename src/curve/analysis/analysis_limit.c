#include "curve/analysis/analysis_symbol.h"

#include "base/error.h"
#include "linalg/dense.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void limit_matrix(const bat_mask *mask, double *matrix)
{
    const ptrdiff_t size = (ptrdiff_t)limit_matrix_size(mask);
    const ptrdiff_t first = limit_matrix_first(mask);
    for (ptrdiff_t row = 0; row < size; row++)
    {
        for (ptrdiff_t column = 0; column < size; column++)
        {
            const ptrdiff_t index = (first + row) - 2 * (first + column) - mask->first;
            matrix[row * size + column] = index >= 0 && index < (ptrdiff_t)mask->count ? mask->coefficients[index] : 0.0;
        }
    }
}

/// Rounding of the weights, in units of epsilon, their count and the largest: limit points, and tangents.
#define POINT_ROUNDING 4.0
#define TANGENT_ROUNDING 64.0

/// Set weights at rounding level to zero and leave out those at the ends.
static void clean_stencil(bat_mask_stencil *stencil, double rounding)
{
    double largest = 0.0;
    for (size_t k = 0; k < stencil->count; k++)
        largest = fmax(largest, fabs(stencil->weights[k]));
    const double tolerance = rounding * DBL_EPSILON * (double)stencil->count * largest;
    size_t begin = stencil->count;
    size_t end = 0;
    for (size_t k = 0; k < stencil->count; k++)
    {
        if (fabs(stencil->weights[k]) <= tolerance)
            stencil->weights[k] = 0.0;
        else
        {
            begin = k < begin ? k : begin;
            end = k + 1;
        }
    }
    if (begin >= end)
        return;
    memmove(stencil->weights, stencil->weights + begin, (end - begin) * sizeof *stencil->weights);
    memset(stencil->weights + (end - begin), 0, (BAT_MASK_MAX - (end - begin)) * sizeof *stencil->weights);
    stencil->first += (int)begin;
    stencil->count = end - begin;
}

static void scale_to_sum_one(bat_mask_stencil *stencil)
{
    double sum = 0.0;
    for (size_t k = 0; k < stencil->count; k++)
        sum += stencil->weights[k];
    for (size_t k = 0; k < stencil->count; k++)
        stencil->weights[k] /= sum;
}

/// The left eigenvector of the local matrix, scaled so that its product with the points (index - centre)^power is 1.
static bat_status left_stencil(const bat_mask *mask, double eigenvalue, bool against_index, bat_mask_stencil *stencil,
                               bat_error *error)
{
    const size_t size = limit_matrix_size(mask);
    *stencil = (bat_mask_stencil){.count = size, .first = limit_matrix_first(mask)};
    double *matrix = memory_array(size * size, sizeof *matrix);
    if (matrix == NULL)
        return error_memory(error, size * size * sizeof *matrix);
    limit_matrix(mask, matrix);
    double constraint[BAT_MASK_MAX];
    for (size_t i = 0; i < size; i++)
        constraint[i] = against_index ? (double)i - 0.5 * (double)(size - 1) : 1.0;
    const bat_status status = dense_left_vector(size, matrix, eigenvalue, constraint, stencil->weights, error);
    free(matrix);
    clean_stencil(stencil, against_index ? TANGENT_ROUNDING : POINT_ROUNDING);
    return status;
}

bat_status limit_point(const mask_symbol *symbol, bat_mask_stencil *stencil, bat_error *error)
{
    const bat_status status = left_stencil(&symbol->mask, 1.0, false, stencil, error);
    scale_to_sum_one(stencil);
    return status;
}

bat_status limit_tangent(const mask_symbol *symbol, const bat_analysis *analysis, bat_mask_stencil *stencil,
                         bat_error *error)
{
    *stencil = (bat_mask_stencil){0};
    if (symbol->multiplicity < 2 || analysis->eigenvalue_count < 2)
        return BAT_OK;
    const bat_analysis_eigenvalue *values = analysis->eigenvalues;
    const bool is_half = values[1].real == 0.5 && values[1].imaginary == 0.0 && values[1].multiplicity == 1;
    const bool is_alone =
        analysis->eigenvalue_count < 3 || hypot(values[2].real, values[2].imaginary) < 0.5 * (1.0 - BAT_ANALYSIS_EQUALITY);
    if (values[0].multiplicity != 1 || !is_half || !is_alone)
        return BAT_OK;
    return left_stencil(&symbol->mask, 0.5, true, stencil, error);
}

static double weight_at(const bat_mask_stencil *stencil, int offset)
{
    const int k = offset - stencil->first;
    return k >= 0 && k < (int)stencil->count ? stencil->weights[k] : 0.0;
}

/// values(k) <- sum over l of a(2 k - l + digit) values(l), which takes phi(t + k) to phi((t + digit) / 2 + k).
static void prepend_digit(const bat_mask *mask, unsigned digit, double *values)
{
    const ptrdiff_t size = (ptrdiff_t)mask->count - 1;
    double next[BAT_MASK_MAX];
    for (ptrdiff_t k = 0; k < size; k++)
    {
        next[k] = 0.0;
        for (ptrdiff_t l = 0; l < size; l++)
        {
            const ptrdiff_t index = 2 * k - l + (ptrdiff_t)digit;
            if (index >= 0 && index <= size)
                next[k] += mask->coefficients[index] * values[l];
        }
    }
    memcpy(values, next, (size_t)size * sizeof *values);
}

void limit_vertex(const mask_symbol *symbol, const bat_mask_stencil *point, bat_mask_stencil *stencil)
{
    static const int DIGITS = 40;
    const bat_mask *mask = &symbol->mask;
    const size_t size = mask->count - 1;
    double whole = floor(symbol->shift);
    uint64_t fraction = (uint64_t)llround(ldexp(symbol->shift - whole, DIGITS));
    if (fraction == (uint64_t)1 << DIGITS)
    {
        whole += 1.0;
        fraction = 0;
    }

    // phi(t + k) for k = first … last - 1 and t = 0, then t with the binary digits of the fraction, the last digit first.
    double values[BAT_MASK_MAX];
    for (size_t k = 0; k < size; k++)
        values[k] = weight_at(point, -(mask->first + (int)k));
    for (size_t digit = 0; digit < DIGITS && fraction != 0; digit++)
    {
        const uint64_t low = fraction & (((uint64_t)1 << (digit + 1)) - 1);
        if (low != 0)
            prepend_digit(mask, (unsigned)(fraction >> digit) & 1u, values);
    }

    // The limit at i + shift weighs point i + m by phi(shift - m), and shift - m = t + k for m = whole - k.
    *stencil = (bat_mask_stencil){.count = size, .first = (int)whole - symbol->last + 1};
    for (size_t m = 0; m < size; m++)
        stencil->weights[m] = values[size - 1 - m];
    clean_stencil(stencil, POINT_ROUNDING);
    scale_to_sum_one(stencil);
}

/// Check a mask and prove that its scheme converges, then find the limit stencil at the integers.
static bat_status convergent_point(const bat_mask *mask, mask_symbol *symbol, bat_mask_stencil *point, bat_error *error)
{
    bat_status status = symbol_make(mask, symbol, error);
    if (status != BAT_OK)
        return status;
    const bat_mask_analyze_options options = bat_mask_analyze_defaults();
    joint_radius radius;
    status = smoothness_radius(&symbol->quotient, &options, 1.0, &radius, error);
    if (status != BAT_OK)
        return status;
    if (!(radius.upper < 1.0))
        return error_set(
            error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
            "the scheme is not known to converge, so it has no limit points (growth of differences between %.6g and %.6g)",
            radius.lower, radius.upper);
    return limit_point(symbol, point, error);
}

bat_status bat_mask_limit_stencil(const bat_mask *mask, bat_mask_stencil *stencil, bat_error *error)
{
    mask_symbol symbol;
    bat_mask_stencil point;
    const bat_status status = convergent_point(mask, &symbol, &point, error);
    if (status == BAT_OK)
        limit_vertex(&symbol, &point, stencil);
    return status;
}

/// values at level + 1 from those at `level`: phi(x) = sum over k of a(k) phi(2 x - k).
static void refine_basis(const bat_mask *mask, size_t level, const double *values, double *finer)
{
    const size_t step = (size_t)1 << level;
    const size_t count = (mask->count - 1) * step + 1;
    const size_t finer_count = 2 * count - 1;
    for (size_t g = 0; g < finer_count; g++)
    {
        if (g % 2 == 0)
        {
            finer[g] = values[g / 2];
            continue;
        }
        double sum = 0.0;
        for (size_t k = 0; k < mask->count && k * step <= g; k++)
            if (g - k * step < count)
                sum += mask->coefficients[k] * values[g - k * step];
        finer[g] = sum;
    }
}

bat_status bat_mask_basis(const bat_mask *mask, size_t level, bat_basis *basis, bat_error *error)
{
    mask_symbol symbol;
    bat_mask_stencil point;
    bat_status status = convergent_point(mask, &symbol, &point, error);
    if (status != BAT_OK)
        return status;
    const size_t degree = symbol.mask.count - 1;
    if (level >= 8 * sizeof(size_t) - 12)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%zu levels of the basic limit function do not fit memory",
                         level);
    const size_t count = (degree << level) + 1;
    double *values = memory_array(count, sizeof *values);
    double *finer = memory_array(count, sizeof *finer);
    if (values == NULL || finer == NULL)
    {
        free(values);
        free(finer);
        return error_memory(error, 2 * count * sizeof *values);
    }
    for (size_t k = 0; k <= degree; k++)
        values[k] = weight_at(&point, -(symbol.mask.first + (int)k));
    for (size_t done = 0; done < level; done++)
    {
        refine_basis(&symbol.mask, done, values, finer);
        double *swap = values;
        values = finer;
        finer = swap;
    }
    free(finer);
    *basis = (bat_basis){.values = values, .count = count, .level = level, .first = symbol.mask.first, .last = symbol.last};
    return BAT_OK;
}

void bat_basis_free(bat_basis *basis)
{
    free(basis->values);
    *basis = (bat_basis){0};
}

/// Singular values up to this share of the matrix norm count as zero where eigenvectors of a multiple eigenvalue count.
#define NULL_TOLERANCE 1e-10

/// An eigenvalue as computed: one disc that holds it, and the number of the group of discs that hang together.
typedef struct disc
{
    double real;
    double imaginary;
    double radius;
    bool exact;
    size_t group;
} disc;

/// The eigenvalues of the local matrix: powers of 1/2 from the factor 1 + z, the rest from the quotient's matrix.
static bat_status collect_discs(const mask_symbol *symbol, size_t size, disc *discs, bat_error *error)
{
    const size_t known = symbol->multiplicity < size ? symbol->multiplicity : size;
    for (size_t i = 0; i < known; i++)
        discs[i] = (disc){.real = exp2(-(double)i), .exact = true, .group = i};
    const size_t rest = size - known;
    if (rest == 0)
        return BAT_OK;
    double *memory = memory_array(rest * (rest + 3), sizeof *memory);
    if (memory == NULL)
        return error_memory(error, rest * (rest + 3) * sizeof *memory);
    double *real = memory + rest * rest;
    double *imaginary = real + rest;
    double *radius = imaginary + rest;
    limit_matrix(&symbol->quotient, memory);
    const bat_status status = dense_eigenvalues(rest, memory, real, imaginary, radius, error);
    for (size_t i = 0; i < rest && status == BAT_OK; i++)
        discs[known + i] = (disc){real[i], imaginary[i], radius[i], false, known + i};
    free(memory);
    return status;
}

/// Give discs that hang together the same group number: the smallest index among them.
static void group_discs(disc *discs, size_t count)
{
    for (bool changed = true; changed;)
    {
        changed = false;
        for (size_t i = 0; i < count; i++)
        {
            for (size_t j = 0; j < count; j++)
            {
                const double gap = hypot(discs[i].real - discs[j].real, discs[i].imaginary - discs[j].imaginary);
                const bool touch = gap <= discs[i].radius + discs[j].radius;
                if (touch && discs[j].group < discs[i].group)
                {
                    discs[i].group = discs[j].group;
                    changed = true;
                }
            }
        }
    }
}

/// One eigenvalue for a group: its only exact member, else the mean, which rounding moves little in defective matrices.
static bat_analysis_eigenvalue eigenvalue_of_group(const disc *discs, size_t count, size_t group)
{
    bat_analysis_eigenvalue value = {0};
    double radius = 0.0;
    size_t exact_count = 0;
    size_t exact = 0;
    for (size_t i = 0; i < count; i++)
    {
        if (discs[i].group != group)
            continue;
        value.real += discs[i].real;
        value.imaginary += discs[i].imaginary;
        radius = fmax(radius, discs[i].radius);
        ++value.multiplicity;
        if (discs[i].exact)
        {
            ++exact_count;
            exact = i;
        }
    }
    value.real /= (double)value.multiplicity;
    value.imaginary /= (double)value.multiplicity;
    if (fabs(value.imaginary) <= radius)
        value.imaginary = 0.0;
    if (fabs(value.real) <= radius)
        value.real = 0.0;
    if (exact_count == 1)
    {
        value.real = discs[exact].real;
        value.imaginary = 0.0;
    }
    return value;
}

static int compare_eigenvalues(const void *left, const void *right)
{
    const bat_analysis_eigenvalue *a = left;
    const bat_analysis_eigenvalue *b = right;
    const double difference = hypot(b->real, b->imaginary) - hypot(a->real, a->imaginary);
    if (fabs(difference) > 1e-13)
        return difference > 0.0 ? 1 : -1;
    if (a->real != b->real)
        return a->real < b->real ? 1 : -1;
    return a->imaginary < b->imaginary ? 1 : a->imaginary > b->imaginary ? -1 : 0;
}

/// Divide a vector of complex numbers by its entry of largest modulus; of several, by the last.
static void normalize(double *vector, size_t size)
{
    size_t largest = 0;
    double modulus = 0.0;
    for (size_t i = 0; i < size; i++)
    {
        const double candidate = hypot(vector[2 * i], vector[2 * i + 1]);
        if (candidate >= modulus * (1.0 - 1e-9))
        {
            largest = i;
            modulus = fmax(modulus, candidate);
        }
    }
    const double cosine = vector[2 * largest] / (modulus * modulus);
    const double sine = -vector[2 * largest + 1] / (modulus * modulus);
    for (size_t i = 0; i < size; i++)
    {
        const double real = vector[2 * i];
        const double imaginary = vector[2 * i + 1];
        const double rounding = 8.0 * DBL_EPSILON;
        const double new_real = cosine * real - sine * imaginary;
        const double new_imaginary = cosine * imaginary + sine * real;
        vector[2 * i] = fabs(new_real) <= rounding ? 0.0 : new_real;
        vector[2 * i + 1] = fabs(new_imaginary) <= rounding ? 0.0 : new_imaginary;
    }
}

static bat_status find_vectors(bat_analysis *analysis, bat_error *error)
{
    const size_t size = analysis->matrix_size;
    const double tolerance = NULL_TOLERANCE * dense_norm(size, analysis->matrix);
    size_t row = 0;
    for (size_t e = 0; e < analysis->eigenvalue_count; e++)
    {
        bat_analysis_eigenvalue *value = &analysis->eigenvalues[e];
        value->vector = row;
        const bat_status status =
            dense_null_space(size, analysis->matrix, value->real, value->imaginary, tolerance, value->multiplicity,
                             analysis->eigenvectors + 2 * size * row, &value->vector_count, error);
        if (status != BAT_OK)
            return status;
        for (size_t v = 0; v < value->vector_count; v++)
            normalize(analysis->eigenvectors + 2 * size * row++, size);
    }
    return BAT_OK;
}

bat_status limit_eigenvalues(const mask_symbol *symbol, bat_analysis *analysis, bat_error *error)
{
    const size_t size = analysis->matrix_size;
    analysis->eigenvalues = memory_array(size, sizeof *analysis->eigenvalues);
    analysis->eigenvectors = memory_array(2 * size * size, sizeof *analysis->eigenvectors);
    if (analysis->eigenvalues == NULL || analysis->eigenvectors == NULL)
        return error_memory(error, 2 * size * size * sizeof *analysis->eigenvectors);
    disc discs[BAT_MASK_MAX];
    const bat_status status = collect_discs(symbol, size, discs, error);
    if (status != BAT_OK)
        return status;
    group_discs(discs, size);
    analysis->eigenvalue_count = 0;
    for (size_t group = 0; group < size; group++)
        if (discs[group].group == group)
            analysis->eigenvalues[analysis->eigenvalue_count++] = eigenvalue_of_group(discs, size, group);
    qsort(analysis->eigenvalues, analysis->eigenvalue_count, sizeof *analysis->eigenvalues, compare_eigenvalues);
    return find_vectors(analysis, error);
}

#include "research/analysis/analysis_symbol.h"

#include "base/error.h"
#include "research/analysis/eigen.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    return limit_left(&symbol->mask, 0.5, true, stencil, error);
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
        values[k] = limit_weight(&point, -(symbol.mask.first + (int)k));
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
    size_t exact_count = 0, exact = 0;
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

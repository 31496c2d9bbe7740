#include "curve/analysis/analysis_limit.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/dense.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Singular values up to this share of the matrix norm count as zero when the eigenvectors of a multiple eigenvalue are
/// counted.
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

/// One eigenvalue for a group: its exact member if there is just one, else the mean, which rounding moves little even where
/// the members scatter because the matrix is defective.
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
    {
        if (discs[group].group == group)
            analysis->eigenvalues[analysis->eigenvalue_count++] = eigenvalue_of_group(discs, size, group);
    }
    qsort(analysis->eigenvalues, analysis->eigenvalue_count, sizeof *analysis->eigenvalues, compare_eigenvalues);
    return find_vectors(analysis, error);
}

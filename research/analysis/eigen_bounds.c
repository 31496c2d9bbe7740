#include "research/analysis/eigen.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/blas.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The backward error of eigenvalues is a small multiple of n times rounding: this multiple, on the safe side.
#define BACKWARD_ERROR 4.0

void dense_multiply(size_t n, const double *a, const double *b, double *product)
{
    const int side = (int)n;
    cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, side, side, side, 1.0, a, side, b, side, 0.0, product, side);
}

void dense_apply(size_t n, const double *a, const double *x, double *result)
{
    const int side = (int)n;
    cblas_dgemv(CblasRowMajor, CblasNoTrans, side, side, 1.0, a, side, x, 1, 0.0, result, 1);
}

double dense_norm(size_t n, const double *a)
{
    return cblas_dnrm2((int)(n * n), a, 1);
}

bat_status dense_spectral_radius(size_t n, const double *a, double *scratch, double *radius, bat_error *error)
{
    double *copy = scratch;
    double *real = copy + n * n;
    double *imaginary = real + n;
    memcpy(copy, a, n * n * sizeof *copy);
    const bat_status status = decompose_eigenvalues(n, copy, real, imaginary, error);
    if (status != BAT_OK)
        return status;
    *radius = 0.0;
    for (size_t i = 0; i < n; i++)
        *radius = fmax(*radius, hypot(real[i], imaginary[i]));
    return BAT_OK;
}

/// Eigenvalues and right eigenvectors, in one block of memory.
typedef struct eigen_system
{
    double *memory;
    double *real;
    double *imaginary;
    double *cosine; ///< between the left and the right eigenvector
    double *right;  ///< packed: a complex pair shares two columns
} eigen_system;

static bat_status eigen_system_make(size_t n, const double *a, eigen_system *system, bat_error *error)
{
    const size_t numbers = 2 * n * n + 3 * n;
    double *memory = memory_array(numbers, sizeof *memory);
    if (memory == NULL)
        return error_memory(error, numbers * sizeof *memory);
    double *copy = memory;
    *system = (eigen_system){.memory = memory,
                             .right = memory + n * n,
                             .real = memory + 2 * n * n,
                             .imaginary = memory + 2 * n * n + n,
                             .cosine = memory + 2 * n * n + 2 * n};
    memcpy(copy, a, n * n * sizeof *copy);
    const bat_status status =
        decompose_eigenvectors(n, copy, system->real, system->imaginary, system->right, system->cosine, error);
    if (status != BAT_OK)
        free(memory);
    return status;
}

/// Distance of the computed eigenvalues' matrix from `a`, rounding only.
static double rounding_distance(size_t n, const double *a)
{
    return BACKWARD_ERROR * (double)n * DBL_EPSILON * dense_norm(n, a);
}

static double disc_radius(size_t n, double distance, double cosine)
{
    return cosine > 0.0 ? (double)n * distance / cosine : (distance > 0.0 ? HUGE_VAL : 0.0);
}

bat_status dense_spectral_radius_below(size_t n, const double *a, double distance, double *bound, bat_error *error)
{
    eigen_system system;
    const bat_status status = eigen_system_make(n, a, &system, error);
    if (status != BAT_OK)
        return status;

    // least[i] becomes the least modulus over the connected set of discs that disc i belongs to.
    double *radius = system.cosine;
    double *least = system.right;
    const double total = distance + rounding_distance(n, a);
    for (size_t i = 0; i < n; i++)
    {
        radius[i] = disc_radius(n, total, radius[i]);
        least[i] = fmax(0.0, hypot(system.real[i], system.imaginary[i]) - radius[i]);
    }
    for (bool changed = true; changed;)
    {
        changed = false;
        for (size_t i = 0; i < n; i++)
        {
            for (size_t j = 0; j < n; j++)
            {
                const double gap = hypot(system.real[i] - system.real[j], system.imaginary[i] - system.imaginary[j]);
                if (least[j] < least[i] && gap <= radius[i] + radius[j])
                {
                    least[i] = least[j];
                    changed = true;
                }
            }
        }
    }
    *bound = 0.0;
    for (size_t i = 0; i < n; i++)
        *bound = fmax(*bound, least[i]);
    free(system.memory);
    return BAT_OK;
}

/// Divide a complex vector by its entry of largest modulus; of several, by the last.
static void normalize_complex(size_t n, double *real, double *imaginary)
{
    size_t largest = 0;
    double modulus = 0.0;
    for (size_t i = 0; i < n; i++)
    {
        const double candidate = hypot(real[i], imaginary[i]);
        if (candidate >= modulus * (1.0 - 1e-9))
        {
            largest = i;
            modulus = fmax(modulus, candidate);
        }
    }
    const double square = real[largest] * real[largest] + imaginary[largest] * imaginary[largest];
    if (square == 0.0)
        return;
    const double cosine = real[largest] / square;
    const double sine = -imaginary[largest] / square;
    for (size_t i = 0; i < n; i++)
    {
        const double x = real[i];
        real[i] = cosine * x - sine * imaginary[i];
        imaginary[i] = cosine * imaginary[i] + sine * x;
    }
}

bat_status dense_leading_vector(size_t n, const double *a, double *real, double *imaginary, bat_error *error)
{
    eigen_system system;
    const bat_status status = eigen_system_make(n, a, &system, error);
    if (status != BAT_OK)
        return status;
    size_t leading = 0;
    for (size_t i = 1; i < n; i++)
        if (hypot(system.real[i], system.imaginary[i]) > hypot(system.real[leading], system.imaginary[leading]))
            leading = i;
    const bool is_complex = system.imaginary[leading] != 0.0;
    for (size_t i = 0; i < n; i++)
    {
        real[i] = system.right[i * n + leading];
        imaginary[i] = is_complex ? system.right[i * n + leading + 1] : 0.0;
    }
    normalize_complex(n, real, imaginary);
    free(system.memory);
    return BAT_OK;
}

bat_status dense_eigenvalues(size_t n, const double *a, double *real, double *imaginary, double *radius, bat_error *error)
{
    eigen_system system;
    const bat_status status = eigen_system_make(n, a, &system, error);
    if (status != BAT_OK)
        return status;
    const double distance = rounding_distance(n, a);
    for (size_t i = 0; i < n; i++)
    {
        real[i] = system.real[i];
        imaginary[i] = system.imaginary[i];
        radius[i] = disc_radius(n, distance, system.cosine[i]);
    }
    free(system.memory);
    return BAT_OK;
}

bat_status dense_null_space(size_t n, const double *a, double real, double imaginary, double tolerance, size_t limit,
                            double *vectors, size_t *count, bat_error *error)
{
    // The complex shifted matrix, V^H and the singular values.
    const size_t numbers = 4 * n * n + n;
    double *memory = memory_array(numbers, sizeof *memory);
    if (memory == NULL)
        return error_memory(error, numbers * sizeof *memory);
    double *shifted = memory;
    double *adjoint = shifted + 2 * n * n;
    double *singular = adjoint + 2 * n * n;
    for (size_t i = 0; i < n * n; i++)
    {
        const bool diagonal = i % (n + 1) == 0;
        shifted[2 * i] = a[i] - (diagonal ? real : 0.0);
        shifted[2 * i + 1] = diagonal ? -imaginary : 0.0;
    }
    const bat_status status = decompose_singular(n, shifted, singular, adjoint, error);
    *count = 0;
    while (status == BAT_OK && *count < limit && *count < n && (*count == 0 || singular[n - 1 - *count] <= tolerance))
    {
        const double *row = adjoint + 2 * n * (n - 1 - *count);
        double *vector = vectors + 2 * n * *count;
        for (size_t i = 0; i < n; i++)
        {
            vector[2 * i] = row[2 * i];
            vector[2 * i + 1] = -row[2 * i + 1];
        }
        ++*count;
    }
    free(memory);
    return status;
}

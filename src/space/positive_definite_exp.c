#include "linalg/symmetric.h"
#include "space/builtin.h"

#include <string.h>

/// @file
/// The derivative of the matrix exponential, between tensors and their logarithms.

enum
{
    SIDE = BAT_POSITIVE_DEFINITE_MAX_SIDE,
    AREA = SIDE * SIDE,
    DIM = BAT_SPACE_MAX_DIM
};

static void unpack(size_t n, const double *packed, double scale, double *a)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++, packed++)
            a[i * n + j] = a[j * n + i] = i == j ? *packed : scale * *packed;
}

static void pack(size_t n, const double *a, double scale, double *packed)
{
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            *packed++ = i == j ? a[i * n + i] : scale * a[i * n + j];
}

/// Q A Q^T of a symmetric matrix, or Q^T A Q.
static void turn(size_t n, const double *q, bool back, double *a)
{
    double once[AREA];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            once[i * n + j] = 0;
            for (size_t k = 0; k < n; k++)
                once[i * n + j] += (back ? q[k * n + i] : q[i * n + k]) * a[k * n + j];
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            a[i * n + j] = 0;
            for (size_t k = 0; k < n; k++)
                a[i * n + j] += once[i * n + k] * (back ? q[k * n + j] : q[j * n + k]);
        }
}

/// The derivative of the matrix exponential at a symmetric matrix, of a symmetric matrix, or its inverse: in the basis of
/// eigenvectors divided differences of exp (Higham, Functions of matrices, 2008, theorem 3.11).
static void differentiate_exp(size_t n, const double *at, bool inverse, double *vector)
{
    double a[AREA], basis[AREA];
    memcpy(a, at, n * n * sizeof *a);
    symmetric_eigen(n, a, basis, SYMMETRIC_BY_NORM);
    turn(n, basis, false, vector);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
        {
            double x = a[i * n + i], y = a[j * n + j], half = (x - y) / 2;
            double factor = exp((x + y) / 2) * (fabs(half) > 1e-6 ? sinh(half) / half : 1);
            vector[i * n + j] *= inverse ? 1 / factor : factor;
        }
    turn(n, basis, true, vector);
}

bat_status positive_definite_convert(const bat_space *space, const double *log, const double *point, const double *vector,
                                     bool to_log, double *result)
{
    double at[AREA] = {0}, a[AREA] = {0}, velocity[DIM];
    size_t n = (size_t)sqrt(2 * (double)space->point_dim);
    bat_status status = to_log ? bat_positive_definite_velocity(space, point, vector, velocity) : BAT_OK;
    unpack(n, log, sqrt(0.5), at);
    unpack(n, to_log ? velocity : vector, to_log ? 1 : sqrt(0.5), a);
    differentiate_exp(n, at, to_log, a);
    pack(n, a, to_log ? sqrt(2) : 1, to_log ? result : velocity);
    return to_log ? status : bat_positive_definite_tangent(space, point, velocity, result);
}

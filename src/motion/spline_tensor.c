#include "motion/spline_system.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/symmetric.h"
#include "space/builtin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Motions of tensors: a spline of logarithms, and velocities by the derivative of the matrix exponential.

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

bat_status spline_tensor_convert(const bat_space *space, const double *log, const double *point, const double *vector,
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

/// The logarithms of all keys at the identity, and the velocities that are given.
static bat_status take_logarithms(const spline_system *system, const double *identity, double *logs, spline_system *flat,
                                  bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    for (size_t k = 0; k < system->count; k++)
    {
        const double *point = system->points + k * n;
        bat_status status = space->log(space, identity, point, logs + k * n);
        flat->fixed[k] = system->fixed[k];
        if (status == BAT_OK && system->fixed[k] == KEY_GIVEN)
            status = spline_tensor_convert(space, logs + k * n, point, system->velocities + k * n, true,
                                           flat->velocities + k * n);
        if (status != BAT_OK)
            return error_set(error, status, k, 0, "the tensor of point %zu has no logarithm", k);
    }
    return BAT_OK;
}

/// Velocities of keys that are not given.
static bat_status give_velocities(const spline_system *flat, spline_system *system, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    bat_status status = BAT_OK;
    for (size_t k = 0; k < system->count && status == BAT_OK; k++)
        if (system->fixed[k] != KEY_GIVEN)
        {
            status = spline_tensor_convert(space, flat->points + k * n, system->points + k * n, flat->velocities + k * n,
                                           false, system->velocities + k * n);
            if (status != BAT_OK)
                return error_set(error, status, k, 0, "the tensor of point %zu is too near to a singular one", k);
        }
    return status;
}

/// The velocity of an end, as the derivative of its logarithm; null for none.
static const double *convert_end(const spline_system *system, const spline_system *flat, size_t key, const double *velocity,
                                 double *converted)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    if (velocity == NULL)
        return NULL;
    (void)spline_tensor_convert(space, flat->points + key * n, system->points + key * n, velocity, true, converted);
    memcpy(system->velocities + key * n, velocity, n * sizeof *velocity);
    system->fixed[key] = KEY_GIVEN;
    return converted;
}

bat_status spline_tensor_prepare(spline_system *system, bat_motion_ends ends, bat_motion_shape shape,
                                 const double *begin_velocity, const double *end_velocity, double *records,
                                 size_t record_size, bat_error *error)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, given = 0;
    const spline_factor linear = {.kind = FACTOR_FLAT, .space = bat_euclidean(n)};
    spline_system flat = {.factor = &linear,
                          .count = system->count,
                          .intervals = system->intervals,
                          .lengths = system->lengths,
                          .rough = true};
    double identity[DIM], end[2][DIM], *logs = memory_array(system->count, n * sizeof *logs);
    flat.velocities = calloc(system->count, n * sizeof *logs);
    flat.points = logs;
    positive_definite_identity(space, identity);
    bool allocated = spline_system_allocate(&flat) && logs != NULL && flat.velocities != NULL;
    bat_status status = allocated ? take_logarithms(system, identity, logs, &flat, error)
                                  : error_memory(error, system->count * n * sizeof *logs);
    while (status == BAT_OK && given < flat.count && flat.fixed[given] == KEY_GIVEN)
        given++;
    if (status == BAT_OK)
        status = spline_system_measure(&flat, error);
    if (status == BAT_OK && given < flat.count)
        status = spline_system_solve(&flat, ends, shape, convert_end(system, &flat, 0, begin_velocity, end[0]),
                                     convert_end(system, &flat, flat.count - 1, end_velocity, end[1]), error);
    if (status == BAT_OK)
        status = spline_system_finish(&flat, error);
    if (status == BAT_OK)
        status = give_velocities(&flat, system, error);
    for (size_t i = 0; i < flat.intervals && status == BAT_OK; i++)
    {
        memcpy(records + i * record_size, identity, n * sizeof *identity);
        spline_system_record(&flat, i, records + i * record_size + n);
    }
    system->held = flat.held;
    spline_system_free(&flat);
    free(logs);
    free(flat.velocities);
    return status;
}

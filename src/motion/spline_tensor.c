#include "motion/spline_system.h"

#include "base/error.h"
#include "space/builtin.h"

#include <string.h>

/// @file
/// Motions of tensors: a spline of logarithms, and velocities by the derivative of the matrix exponential.

#define DIM BAT_SPACE_MAX_DIM

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
            status = positive_definite_convert(space, logs + k * n, point, system->velocities + k * n, true,
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
            status = positive_definite_convert(space, flat->points + k * n, system->points + k * n, flat->velocities + k * n,
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
    (void)positive_definite_convert(space, flat->points + key * n, system->points + key * n, velocity, true, converted);
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
    spline_system flat = {
        .factor = &linear, .count = system->count, .intervals = system->intervals, .lengths = system->lengths};
    double identity[DIM], end[2][DIM], *logs = memory_pool_array(&flat.pool, system->count, n * sizeof *logs);
    flat.points = logs;
    positive_definite_identity(space, identity);
    bat_status status = spline_system_allocate(&flat, error);
    if (status == BAT_OK)
        status = take_logarithms(system, identity, logs, &flat, error);
    while (status == BAT_OK && given < flat.count && flat.fixed[given] == KEY_GIVEN)
        given++;
    bool all = given == flat.count;
    if (status == BAT_OK)
        status = spline_system_solve(&flat, ends, shape, all ? NULL : convert_end(system, &flat, 0, begin_velocity, end[0]),
                                     all ? NULL : convert_end(system, &flat, flat.count - 1, end_velocity, end[1]), error);
    if (status == BAT_OK)
        status = give_velocities(&flat, system, error);
    for (size_t i = 0; i < flat.intervals && status == BAT_OK; i++)
    {
        memcpy(records + i * record_size, identity, n * sizeof *identity);
        spline_system_record(&flat, i, records + i * record_size + n);
    }
    system->held = flat.held;
    memory_pool_free(&flat.pool);
    return status;
}

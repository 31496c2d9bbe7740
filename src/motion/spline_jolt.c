#include "motion/spline_system.h"

#include <math.h>

/// @file
/// Keys so near in time that their step says nothing of the velocity: an accelerated spline through them would leave the
/// data on both sides, since a small error of a point is a large one of the velocity.

enum
{
    DIM = BAT_SPACE_MAX_DIM
};

/// An interval is a jolt if it is this many times shorter than both neighbours, and its speed so many times theirs or so
/// many times less.
static const double SHORTER = 4, RATIO = 4;

static size_t interval_beside(const spline_system *system, size_t interval, int side)
{
    size_t n = system->intervals;
    return side < 0 ? (interval > 0 ? interval - 1 : n - 1) : (interval + 1 < n ? interval + 1 : 0);
}

/// The mean speed of an interval.
static double speed_of(const spline_system *system, size_t interval)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim;
    const double *b = system->logs + 2 * interval * n, *a = b + n;
    double chord[DIM];
    for (size_t c = 0; c < n; c++)
        chord[c] = a[c] - b[c];
    double squared = space->inner(space, system->middles + interval * space->point_dim, chord, chord);
    return sqrt(fmax(squared, 0)) / system->lengths[interval];
}

static bool is_jolt(const spline_system *system, size_t interval)
{
    bool closed = system->intervals == system->count;
    if (!closed && (interval == 0 || interval + 1 == system->intervals))
        return false;
    size_t before = interval_beside(system, interval, -1), after = interval_beside(system, interval, 1);
    const double *h = system->lengths;
    if (before == after)
        return false;
    bool is_short = SHORTER * h[interval] <= fmin(h[before], h[after]);
    double speed = speed_of(system, interval), left = speed_of(system, before), right = speed_of(system, after);
    return speed > RATIO * fmax(left, right) || (is_short && RATIO * speed < fmin(left, right));
}

/// Give both keys of a jolt the velocity of the parabola through the keys around it, as if they were one.
static bat_status set_velocities(spline_system *system, size_t interval)
{
    const bat_space *space = &system->factor->space;
    size_t n = space->tangent_dim, dim = space->point_dim;
    size_t before = interval_beside(system, interval, -1), after = interval_beside(system, interval, 1);
    size_t first = interval, second = (interval + 1) % system->count, beyond = (after + 1) % system->count;
    const double *p = system->points + first * dim, *q = system->points + second * dim;
    double h = system->lengths[before], next = system->lengths[after], back[DIM], forth[DIM], moved[DIM];
    bat_status status = space->log(space, p, system->points + before * dim, back);
    if (status == BAT_OK)
        status = space->log(space, q, system->points + beyond * dim, forth);
    if (status == BAT_OK)
        status = spline_transport(system, q, p, forth, moved);
    if (status != BAT_OK)
        return status;
    double *velocity = system->velocities + first * n;
    for (size_t c = 0; c < n; c++)
        velocity[c] = (moved[c] * h / next - back[c] * next / h) / (h + next);
    system->fixed[first] = system->fixed[second] = KEY_GIVEN;
    return spline_transport(system, p, q, velocity, system->velocities + second * n);
}

bat_status spline_system_hold(spline_system *system, size_t *held)
{
    bat_status status = BAT_OK;
    *held = 0;
    for (size_t i = 0; i < system->intervals && status == BAT_OK; i++)
        if (is_jolt(system, i) && !(system->fixed[i] == KEY_GIVEN && system->fixed[(i + 1) % system->count] == KEY_GIVEN))
        {
            status = set_velocities(system, i);
            ++*held;
        }
    return status;
}

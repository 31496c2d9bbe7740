#include "motion/hermite_average.h"

#include "batten/research/motion_study.h"
#include "space/builtin.h"

#include <math.h>
#include <string.h>

static bool are_equal(size_t n, const double *u, const double *v)
{
    for (size_t i = 0; i < n; i++)
        if (u[i] != v[i])
            return false;
    return true;
}

static void copy_pair(const bat_space *space, const double *p, const double *v, double *point, double *direction)
{
    memcpy(point, p, space->point_dim * sizeof *point);
    memcpy(direction, v, space->tangent_dim * sizeof *direction);
}

static bool is_unit(const bat_space *space, const double *point, const double *direction)
{
    double length = sqrt(space->inner(space, point, direction, direction));
    return fabs(length - 1) <= BAT_HERMITE_TANGENT_TOLERANCE;
}

bat_status bat_hermite_average(const bat_space *space, const double *p0, const double *v0, const double *p1,
                               const double *v1, double weight, double *point, double *direction)
{
    hermite_edge edge;
    if (space_lack(space) != NULL)
        return BAT_INVALID_ARGUMENT;
    if (!is_unit(space, p0, v0) || !is_unit(space, p1, v1))
        return BAT_INVALID_POINT;
    bool coincide = space->distance(space, p0, p1) == 0 && are_equal(space->tangent_dim, v0, v1);
    if (weight != 0 && weight != 1 && !coincide)
        return hermite_average(space, p0, v0, p1, v1, weight, point, direction);
    bat_status status = coincide ? BAT_OK : hermite_edge_measure(space, p0, v0, p1, v1, &edge);
    if (status == BAT_OK)
        copy_pair(space, weight == 1 ? p1 : p0, weight == 1 ? v1 : v0, point, direction);
    return status;
}

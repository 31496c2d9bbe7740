#include "space/builtin.h"

#include <string.h>

const char *space_not_finite(const bat_space *space, const double *point)
{
    return vector_is_finite(space->point_dim, point) ? NULL : "not finite";
}

bat_status space_project_valid(const bat_space *space, const double *coordinates, double *point)
{
    if (space->fault(space, coordinates) != NULL)
        return BAT_INVALID_POINT;
    memmove(point, coordinates, space->point_dim * sizeof *point);
    return BAT_OK;
}

bool space_scale(size_t n, const double *coordinates, double *scaled)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, isfinite(coordinates[i]) ? fabs(coordinates[i]) : INFINITY);
    if (largest == 0 || isinf(largest))
        return false;
    for (size_t i = 0; i < n; i++)
        scaled[i] = coordinates[i] / largest;
    return true;
}

bat_status space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    double tangent[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, q, tangent);
    if (status != BAT_OK)
        return status;
    vector_scale(space->tangent_dim, t, tangent);
    return space->exp(space, p, tangent, point);
}

double space_inner(const bat_space *space, const double *p BAT_UNUSED, const double *u, const double *v)
{
    return vector_dot(space->tangent_dim, u, v);
}

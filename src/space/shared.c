#include "space/builtin.h"

#include <string.h>

const char *space_not_finite(const bat_space *space, const double *point)
{
    for (size_t i = 0; i < space->point_dim; i++)
        if (!isfinite(point[i]))
            return "not finite";
    return NULL;
}

bat_status space_project_valid(const bat_space *space, const double *coordinates, double *point)
{
    if (space->fault(space, coordinates) != NULL)
        return BAT_INVALID_POINT;
    memmove(point, coordinates, space->point_dim * sizeof *point);
    return BAT_OK;
}

double space_inner(const bat_space *space, const double *p BAT_UNUSED, const double *u, const double *v)
{
    double sum = 0;
    for (size_t i = 0; i < space->tangent_dim; i++)
        sum += u[i] * v[i];
    return sum;
}

#include "batten/space.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

bat_status bat_space_by_name(const char *name, size_t point_dim, bat_space *space, bat_error *error)
{
    bat_space found;
    if (strcmp(name, "plane") == 0)
        found = bat_euclidean(2);
    else if (strcmp(name, "disk") == 0)
        found = bat_disk();
    else if (strcmp(name, "euclidean") == 0)
        found = bat_euclidean(point_dim == 0 ? 3 : point_dim);
    else if (strcmp(name, "sphere") == 0)
        found = bat_sphere(point_dim == 0 ? 2 : point_dim - 1);
    else if (strcmp(name, "rotation") == 0)
        found = bat_rotation();
    else if (strcmp(name, "rigid") == 0)
        (void)bat_rigid(1, &found, NULL);
    else if (strcmp(name, "spd") == 0)
        found = bat_positive_definite(point_dim == 0 ? 3 : (size_t)sqrt(2 * (double)point_dim));
    else if (strcmp(name, "hyperbolic") == 0)
        found = bat_hyperbolic(point_dim == 0 ? 2 : point_dim - 1);
    else
        return error_set(
            error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
            "there is no space '%s'; the spaces are plane, euclidean, sphere, disk, rotation, rigid, spd, hyperbolic", name);
    if (point_dim != 0 && found.point_dim != point_dim)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a point of the %s has %zu coordinates, not %zu",
                         name, found.point_dim, point_dim);
    *space = found;
    return BAT_OK;
}

bat_status bat_space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    if (space->geodesic != NULL)
        return space->geodesic(space, p, q, t, point);
    double tangent[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, q, tangent);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] *= t;
    return space->exp(space, p, tangent, point);
}

static bat_status row_failed(bat_error *error, bat_status status, size_t row)
{
    return error_set(error, status, row, 0,
                     status == BAT_CUT_LOCUS ? "no unique geodesic in row %zu" : "no valid point in row %zu", row);
}

bat_status bat_space_check(const bat_space *space, const double *points, size_t count, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        const char *fault = space->fault(space, points + i * space->point_dim);
        if (fault != NULL)
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu is %s", i, fault);
    }
    return BAT_OK;
}

bat_status bat_space_project(const bat_space *space, const double *coordinates, size_t count, double *points,
                             bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i * space->point_dim;
        if (space->project(space, coordinates + row, points + row) != BAT_OK)
            return error_set(error, BAT_INVALID_POINT, i, 0, "point %zu has no nearest point on the %s", i, space->name);
    }
    return BAT_OK;
}

void bat_space_distances(const bat_space *space, const double *p, const double *q, size_t count, double *distances)
{
    for (size_t i = 0; i < count; i++)
        distances[i] = space->distance(space, p + i * space->point_dim, q + i * space->point_dim);
}

bat_status bat_space_logs(const bat_space *space, const double *p, const double *q, size_t count, double *tangents,
                          bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i * space->point_dim;
        bat_status status = space->log(space, p + row, q + row, tangents + i * space->tangent_dim);
        if (status != BAT_OK)
            return row_failed(error, status, i);
    }
    return BAT_OK;
}

bat_status bat_space_exps(const bat_space *space, const double *p, const double *tangents, size_t count, double *q,
                          bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i * space->point_dim;
        bat_status status = space->exp(space, p + row, tangents + i * space->tangent_dim, q + row);
        if (status != BAT_OK)
            return row_failed(error, status, i);
    }
    return BAT_OK;
}

bat_status bat_space_transports(const bat_space *space, const double *p, const double *q, const double *tangents,
                                size_t count, double *transported, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i * space->point_dim, tangent_row = i * space->tangent_dim;
        bat_status status = space->transport(space, p + row, q + row, tangents + tangent_row, transported + tangent_row);
        if (status != BAT_OK)
            return row_failed(error, status, i);
    }
    return BAT_OK;
}

bat_status bat_space_geodesics(const bat_space *space, const double *p, const double *q, const double *shares, size_t count,
                               double *points, bat_error *error)
{
    for (size_t i = 0; i < count; i++)
    {
        size_t row = i * space->point_dim;
        bat_status status = bat_space_geodesic(space, p + row, q + row, shares[i], points + row);
        if (status != BAT_OK)
            return row_failed(error, status, i);
    }
    return BAT_OK;
}

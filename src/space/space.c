#include "base/choice.h"
#include "base/error.h"
#include "space/builtin.h"

/// A space by name: how it is made for points of `point_dim` numbers, 0 for the usual number.
typedef struct space_row
{
    bat_choice choice;
    bat_space (*make)(size_t point_dim);
} space_row;

static bat_space make_plane(size_t point_dim BAT_UNUSED)
{
    return bat_euclidean(2);
}

static bat_space make_euclidean(size_t point_dim)
{
    return bat_euclidean(point_dim == 0 ? 3 : point_dim);
}

static bat_space make_sphere(size_t point_dim)
{
    return bat_sphere(point_dim == 0 ? 2 : point_dim - 1);
}

static bat_space make_disk(size_t point_dim BAT_UNUSED)
{
    return bat_disk();
}

static bat_space make_rotation(size_t point_dim BAT_UNUSED)
{
    return bat_rotation();
}

static bat_space make_rigid(size_t point_dim BAT_UNUSED)
{
    bat_space space;
    (void)bat_rigid(1, &space, NULL);
    return space;
}

static bat_space make_positive_definite(size_t point_dim)
{
    return bat_positive_definite(point_dim == 0 ? 3 : (size_t)sqrt(2 * (double)point_dim));
}

static bat_space make_hyperbolic(size_t point_dim)
{
    return bat_hyperbolic(point_dim == 0 ? 2 : point_dim - 1);
}

static const space_row SPACES[] = {
    {{.name = "plane", .summary = "R^2"}, make_plane},
    {{.name = "euclidean", .summary = "R^n, n from the file"}, make_euclidean},
    {{.name = "sphere", .summary = "unit vectors, or longitude and latitude in degrees; S^2, or S^n from the file"},
     make_sphere},
    {{.name = "disk", .summary = "the hyperbolic plane as the Poincaré disk, points of length below 1"}, make_disk},
    {{.name = "rotation",
      .summary = "rotations of R^3: quaternions, matrices or rotation vectors by the names of the columns; else w, x, y, z"},
     make_rotation},
    {{.name = "rigid", .summary = "poses: translation and rotation, or timestamp tx ty tz qx qy qz qw as in the TUM format"},
     make_rigid},
    {{.name = "spd",
      .summary = "symmetric positive-definite matrices (tensors), the upper triangle row by row: xx, xy, xz, yy, yz, zz"},
     make_positive_definite},
    {{.name = "hyperbolic", .summary = "the hyperboloid in R^(n+1), n from the file: x0, then x"}, make_hyperbolic},
};
const bat_family bat_space_family = FAMILY("space", SPACES);

bat_status bat_space_by_name(const char *name, size_t point_dim, bat_space *space, bat_error *error)
{
    const bat_choice *row;
    bat_status status = bat_choice_find(&bat_space_family, name, &row, error);
    if (status != BAT_OK)
        return status;
    bat_space found = ((const space_row *)(const void *)row)->make(point_dim);
    if (point_dim != 0 && found.point_dim != point_dim)
        return ERROR_ARGUMENT(error, "a point of the %s has %zu coordinates, not %zu", name, found.point_dim, point_dim);
    *space = found;
    return BAT_OK;
}

bat_status bat_space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    return (space->geodesic != NULL ? space->geodesic : space_geodesic)(space, p, q, t, point);
}

static bat_status row_failed(bat_error *error, bat_status status, size_t row)
{
    return error_set(error, status, row, 0,
                     status == BAT_CUT_LOCUS ? "no unique geodesic in row %zu" : "no valid point in row %zu", row);
}

const char *space_lack(const bat_space *space)
{
    const struct
    {
        bool missing;
        const char *name;
    } functions[] = {{space->fault == NULL, "function fault"},
                     {space->project == NULL, "function project"},
                     {space->distance == NULL, "function distance"},
                     {space->log == NULL, "function log"},
                     {space->exp == NULL, "function exp"},
                     {space->transport == NULL, "function transport"},
                     {space->inner == NULL, "function inner"},
                     {space->name == NULL, "name"},
                     {space->dimension == 0, "positive dimension"},
                     {space->point_dim == 0, "positive point_dim"},
                     {space->tangent_dim == 0, "positive tangent_dim"}};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
        if (functions[i].missing)
            return functions[i].name;
    // Written so that a NaN lacks it, too.
    return space->injectivity > 0 ? NULL : "positive injectivity radius (INFINITY where geodesics never meet again)";
}

bat_status space_check_complete(const bat_space *space, bat_error *error)
{
    const char *lack = space != NULL ? space_lack(space) : "definition";
    const char *name = space != NULL && space->name != NULL ? space->name : "without a name";
    if (lack != NULL)
        return ERROR_ARGUMENT(error, "the space %s has no %s", name, lack);
    if (space->point_dim > BAT_SPACE_MAX_DIM || space->tangent_dim > BAT_SPACE_MAX_DIM)
        return ERROR_ARGUMENT(error, "the space %s stores %zu numbers a point and %zu a tangent vector, more than %d", name,
                              space->point_dim, space->tangent_dim, BAT_SPACE_MAX_DIM);
    return BAT_OK;
}

bat_status bat_space_check(const bat_space *space, const double *points, size_t count, bat_error *error)
{
    bat_status status = space_check_complete(space, error);
    if (status != BAT_OK)
        return status;
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
    if (space->log_rows != NULL && space->log_rows(space, p, q, count, tangents) == BAT_OK)
        return BAT_OK;
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
    if (space->exp_rows != NULL && space->exp_rows(space, p, tangents, count, q) == BAT_OK)
        return BAT_OK;
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
    if (space->transport_rows != NULL && space->transport_rows(space, p, q, tangents, count, transported) == BAT_OK)
        return BAT_OK;
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

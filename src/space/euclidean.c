#include "space/builtin.h"

#include <string.h>

static double distance(const bat_space *space, const double *p, const double *q)
{
    if (space->point_dim == 2)
        return hypot(q[0] - p[0], q[1] - p[1]);
    double largest = 0;
    for (size_t i = 0; i < space->point_dim; i++)
        largest = fmax(largest, fabs(q[i] - p[i]));
    if (largest == 0)
        return 0;
    // Divided by the largest difference, no square overflows or underflows.
    double sum = 0;
    for (size_t i = 0; i < space->point_dim; i++)
    {
        double share = (q[i] - p[i]) / largest;
        sum += share * share;
    }
    return largest * sqrt(sum);
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    vector_subtract(space->point_dim, q, p, tangent);
    return BAT_OK;
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    for (size_t i = 0; i < space->point_dim; i++)
        q[i] = p[i] + tangent[i];
    return space_not_finite(space, q) == NULL ? BAT_OK : BAT_INVALID_POINT;
}

static bat_status transport(const bat_space *space, const double *p BAT_UNUSED, const double *q BAT_UNUSED,
                            const double *tangent, double *transported)
{
    memcpy(transported, tangent, space->tangent_dim * sizeof *tangent);
    return BAT_OK;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    for (size_t i = 0; i < space->point_dim; i++)
        point[i] = bat_random_normal(random);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    for (size_t i = 0; i < space->point_dim; i++)
        point[i] = (1 - t) * p[i] + t * q[i];
    return space_not_finite(space, point) == NULL ? BAT_OK : BAT_INVALID_POINT;
}

static double plane_exterior_angle(const bat_space *space BAT_UNUSED, const double *before, const double *p,
                                   const double *after)
{
    double in[2] = {p[0] - before[0], p[1] - before[1]};
    double out[2] = {after[0] - p[0], after[1] - p[1]};
    return atan2(in[0] * out[1] - in[1] * out[0], in[0] * out[0] + in[1] * out[1]);
}

static bat_status plane_apex(const bat_space *space BAT_UNUSED, const double *p, const double *q, double angle,
                             double *point)
{
    double half_tangent = 0.5 * tan(angle);
    double edge[2] = {q[0] - p[0], q[1] - p[1]};
    point[0] = p[0] + 0.5 * edge[0] - half_tangent * edge[1];
    point[1] = p[1] + 0.5 * edge[1] + half_tangent * edge[0];
    return BAT_OK;
}

bat_space bat_euclidean(size_t n)
{
    n = n < 1 ? 1 : n > BAT_SPACE_MAX_DIM ? BAT_SPACE_MAX_DIM : n;
    bool plane = n == 2;
    return (bat_space){
        .name = plane ? "plane" : "euclidean",
        .dimension = n,
        .point_dim = n,
        .tangent_dim = n,
        .injectivity = INFINITY,
        .fault = space_not_finite,
        .project = space_project_valid,
        SPACE_FUNCTIONS,
        .inner = space_inner,
        .geodesic = geodesic,
        .exterior_angle = plane ? plane_exterior_angle : NULL,
        .apex = plane ? plane_apex : NULL,
    };
}

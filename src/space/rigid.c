#include "base/error.h"
#include "space/builtin.h"

// Points are a translation and a quaternion, tangents a velocity in the fixed frame and a rotation vector in the body's.

static const int TRANSLATION = 3;

static const char *fault(const bat_space *space, const double *point)
{
    return vector_is_finite(3, point) ? rotation_fault(space, point + TRANSLATION) : "not finite";
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    if (!vector_is_finite(3, coordinates))
        return BAT_INVALID_POINT;
    for (int i = 0; i < TRANSLATION; i++)
        point[i] = coordinates[i];
    return rotation_project(space, coordinates + TRANSLATION, point + TRANSLATION);
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    double moved = hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]);
    return hypot(space->weight * moved, rotation_distance(space, p + TRANSLATION, q + TRANSLATION));
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    vector_subtract(TRANSLATION, q, p, tangent);
    return rotation_log(space, p + TRANSLATION, q + TRANSLATION, tangent + TRANSLATION);
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    for (int i = 0; i < TRANSLATION; i++)
        q[i] = p[i] + tangent[i];
    return vector_is_finite(3, q) ? rotation_exp(space, p + TRANSLATION, tangent + TRANSLATION, q + TRANSLATION)
                                  : BAT_INVALID_POINT;
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    for (int i = 0; i < TRANSLATION; i++)
        transported[i] = tangent[i];
    return rotation_transport(space, p + TRANSLATION, q + TRANSLATION, tangent + TRANSLATION, transported + TRANSLATION);
}

static double inner(const bat_space *space, const double *p BAT_UNUSED, const double *u, const double *v)
{
    double translations = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    double rotations = u[3] * v[3] + u[4] * v[4] + u[5] * v[5];
    return space->weight * space->weight * translations + rotations;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    for (int i = 0; i < TRANSLATION; i++)
        point[i] = bat_random_normal(random);
    rotation_random(space, random, point + TRANSLATION);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    for (int i = 0; i < TRANSLATION; i++)
        point[i] = (1 - t) * p[i] + t * q[i];
    return vector_is_finite(3, point) ? rotation_geodesic(space, p + TRANSLATION, q + TRANSLATION, t, point + TRANSLATION)
                                      : BAT_INVALID_POINT;
}

bat_status bat_rigid(double translation_weight, bat_space *space, bat_error *error)
{
    if (!(translation_weight > 0 && isfinite(translation_weight)))
        return ERROR_ARGUMENT(error, "the weight of translations is not a positive number");
    *space = (bat_space){
        .name = "rigid",
        .dimension = 6,
        .point_dim = 7,
        .tangent_dim = 6,
        .injectivity = ANGLE_PI,
        .weight = translation_weight,
        .fault = fault,
        .project = project,
        SPACE_FUNCTIONS,
        .inner = inner,
        .geodesic = geodesic,
    };
    return BAT_OK;
}

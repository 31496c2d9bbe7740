#include "space/rotation.h"

#include "space/quaternion.h"

#include <math.h>

/// How far the squared length of a stored quaternion may be from 1.
static const double SQUARED_LENGTH_TOLERANCE = 2e-9;

const char *rotation_fault(const double *point)
{
    double squared_length = quaternion_dot(point, point);
    if (!isfinite(squared_length))
        return "not finite";
    return fabs(squared_length - 1) <= SQUARED_LENGTH_TOLERANCE ? NULL : "not a quaternion of unit length";
}

bat_status rotation_project(const double *coordinates, double *point)
{
    double largest = 0;
    for (int i = 0; i < 4; i++)
    {
        if (!isfinite(coordinates[i]))
            return BAT_INVALID_POINT;
        largest = fmax(largest, fabs(coordinates[i]));
    }
    if (largest == 0)
        return BAT_INVALID_POINT;
    for (int i = 0; i < 4; i++)
        point[i] = coordinates[i] / largest;
    quaternion_normalize(point);
    return BAT_OK;
}

double rotation_distance(const double *p, const double *q)
{
    quaternion_step step = quaternion_step_between(p, q);
    return 2 * atan2(sqrt(step.squared_sine), step.cosine);
}

bat_status rotation_log(const double *p, const double *q, double *tangent)
{
    quaternion_step step = quaternion_step_between(p, q);
    if (step.cosine < QUATERNION_HALF_TURN)
        return BAT_CUT_LOCUS;
    double scale = 2 * quaternion_angle_over_sine(step.squared_sine, step.cosine);
    tangent[0] = scale * step.x;
    tangent[1] = scale * step.y;
    tangent[2] = scale * step.z;
    return BAT_OK;
}

bat_status rotation_exp(const double *p, const double *tangent, double *q)
{
    if (!isfinite(vector_dot(tangent, tangent)))
        return BAT_INVALID_POINT;
    quaternion_turn(p, tangent[0], tangent[1], tangent[2], q);
    return BAT_OK;
}

/// Along exp_p(t v) the coordinates in the body's frame obey u' = -v x u / 2 (half the Lie bracket): the frame turns by the
/// rotation from p to q, the vector back by half of it.
bat_status rotation_transport(const double *p, const double *q, const double *tangent, double *transported)
{
    quaternion_step step = quaternion_step_between(p, q);
    if (step.cosine < QUATERNION_HALF_TURN)
        return BAT_CUT_LOCUS;
    double inverse = 1 / sqrt(step.cosine * step.cosine + step.squared_sine);
    double cosine = step.cosine * inverse, x = step.x * inverse, y = step.y * inverse, z = step.z * inverse;
    double along = (x * tangent[0] + y * tangent[1] + z * tangent[2]) / (1 + cosine);
    transported[0] = cosine * tangent[0] + along * x - (y * tangent[2] - z * tangent[1]);
    transported[1] = cosine * tangent[1] + along * y - (z * tangent[0] - x * tangent[2]);
    transported[2] = cosine * tangent[2] + along * z - (x * tangent[1] - y * tangent[0]);
    return BAT_OK;
}

void rotation_random(bat_random *random, double *point)
{
    do
    {
        for (int i = 0; i < 4; i++)
            point[i] = bat_random_normal(random);
    } while (rotation_project(point, point) != BAT_OK);
}

/// The great circle of quaternions from p to q or -q. Its middle needs no angle.
bat_status rotation_geodesic(const double *p, const double *q, double t, double *point)
{
    quaternion_step step = quaternion_step_between(p, q);
    if (step.cosine < QUATERNION_HALF_TURN)
        return BAT_CUT_LOCUS;
    if (t == 0.5)
    {
        double sign = quaternion_dot(p, q) < 0 ? -1 : 1;
        for (int i = 0; i < 4; i++)
            point[i] = p[i] + sign * q[i];
        quaternion_normalize(point);
        return BAT_OK;
    }
    if (!isfinite(t))
        return BAT_INVALID_POINT;
    double scale = 2 * t * quaternion_angle_over_sine(step.squared_sine, step.cosine);
    quaternion_turn(p, scale * step.x, scale * step.y, scale * step.z, point);
    return BAT_OK;
}

static const char *fault(const bat_space *space, const double *point)
{
    (void)space;
    return rotation_fault(point);
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    (void)space;
    return rotation_project(coordinates, point);
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    (void)space;
    return rotation_distance(p, q);
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    (void)space;
    return rotation_log(p, q, tangent);
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    (void)space;
    return rotation_exp(p, tangent, q);
}

static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    (void)space;
    return rotation_transport(p, q, tangent, transported);
}

static double inner(const bat_space *space, const double *p, const double *u, const double *v)
{
    (void)space;
    (void)p;
    return vector_dot(u, v);
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    (void)space;
    rotation_random(random, point);
}

static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    (void)space;
    return rotation_geodesic(p, q, t, point);
}

bat_space bat_rotation(void)
{
    return (bat_space){
        .name = "rotation",
        .dimension = 3,
        .point_dim = 4,
        .tangent_dim = 3,
        .injectivity = 3.14159265358979323846,
        .fault = fault,
        .project = project,
        .distance = distance,
        .log = logarithm,
        .exp = exponential,
        .transport = transport,
        .inner = inner,
        .random_point = random_point,
        .geodesic = geodesic,
    };
}

#include "space/builtin.h"

/// How far the squared length of a stored point may be from 1.
static const double SQUARED_LENGTH_TOLERANCE = 2e-9;

/// |p + sign q|
static double length_of_sum(size_t n, const double *p, const double *q, double sign)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
    {
        double c = p[i] + sign * q[i];
        sum += c * c;
    }
    return sqrt(sum);
}

static const char *fault(const bat_space *space, const double *point)
{
    if (space_not_finite(space, point) != NULL)
        return space_not_finite(space, point);
    double squared_length = vector_dot(space->point_dim, point, point);
    return fabs(squared_length - 1) <= SQUARED_LENGTH_TOLERANCE ? NULL : "not of unit length";
}

static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    size_t n = space->point_dim;
    if (!space_scale(n, coordinates, point))
        return BAT_INVALID_POINT;
    double length = sqrt(vector_dot(n, point, point));
    for (size_t i = 0; i < n; i++)
        point[i] /= length;
    return BAT_OK;
}

/// The half-angle form (Kahan): exact differences for near points, exact sums for near antipodes.
static double distance(const bat_space *space, const double *p, const double *q)
{
    size_t n = space->point_dim;
    return 2 * atan2(length_of_sum(n, q, p, -1), length_of_sum(n, q, p, 1));
}

/// log_p(q) = theta w / |w|, where w is the part of q orthogonal to p. It equals that of q - p and that of q + p; the
/// shorter of the two loses nothing to cancellation.
static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    size_t n = space->point_dim;
    double difference = length_of_sum(n, q, p, -1);
    double sum = length_of_sum(n, q, p, 1);
    if (sum < SPHERE_ANTIPODAL_LENGTH)
        return BAT_CUT_LOCUS;
    double sign = difference < sum ? -1 : 1;
    for (size_t i = 0; i < n; i++)
        tangent[i] = q[i] + sign * p[i];
    double along = vector_dot(n, tangent, p) / vector_dot(n, p, p);
    vector_add(n, -along, p, tangent);
    double length = sqrt(vector_dot(n, tangent, tangent));
    double scale = length > 0 ? 2 * atan2(difference, sum) / length : 1;
    vector_scale(n, scale, tangent);
    return BAT_OK;
}

/// exp_p(v) = cos|v| p + sin|v| v / |v|, then back to unit length so that rounding does not add up over many steps.
static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    size_t n = space->point_dim;
    double length = sqrt(vector_dot(n, tangent, tangent));
    if (!isfinite(length))
        return BAT_INVALID_POINT;
    double cosine = cos(length);
    double ratio = length > 0 ? sin(length) / length : 1;
    for (size_t i = 0; i < n; i++)
        q[i] = cosine * p[i] + ratio * tangent[i];
    double inverse = 1 / sqrt(vector_dot(n, q, q));
    vector_scale(n, inverse, q);
    return BAT_OK;
}

/// u - 2 <p + q, u> (p + q) / |p + q|^2, which takes log_p(q) to -log_q(p) and keeps what is orthogonal to both points.
static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    size_t n = space->point_dim;
    double sum = length_of_sum(n, q, p, 1);
    if (sum < SPHERE_ANTIPODAL_LENGTH)
        return BAT_CUT_LOCUS;
    double along = 0;
    for (size_t i = 0; i < n; i++)
        along += (p[i] + q[i]) * tangent[i];
    along *= 2 / (sum * sum);
    for (size_t i = 0; i < n; i++)
        transported[i] = tangent[i] - along * (p[i] + q[i]);
    return BAT_OK;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    do
    {
        for (size_t i = 0; i < space->point_dim; i++)
            point[i] = bat_random_normal(random);
    } while (project(space, point, point) != BAT_OK);
}

/// With the chords a = p - before and b = after - p, whose parts orthogonal to p are the two tangent directions:
/// the sine is det(p, a, b), the cosine <a, b> - <a, p> <b, p>, both over the product of the parts' lengths.
static double exterior_angle(const bat_space *space BAT_UNUSED, const double *before, const double *p, const double *after)
{
    double a[3], b[3], normal[3];
    for (int i = 0; i < 3; i++)
    {
        a[i] = p[i] - before[i];
        b[i] = after[i] - p[i];
    }
    vector3_cross(a, b, normal);
    return atan2(vector_dot(3, p, normal), vector_dot(3, a, b) - vector_dot(3, a, p) * vector_dot(3, b, p));
}

/// Eq. (7) of Ugail and Howard in closed form: the direction of p + q + tan(angle) p x q. (In their terms p + tan(e/2) T is
/// a multiple of p + q, and tan(e/2) N the same multiple of p x q.)
static bat_status apex(const bat_space *space, const double *p, const double *q, double angle, double *point)
{
    double chord[3], normal[3];
    if (length_of_sum(3, p, q, 1) < SPHERE_ANTIPODAL_LENGTH)
        return BAT_CUT_LOCUS;
    vector_subtract(3, q, p, chord);
    vector3_cross(p, chord, normal);
    double slope = tan(angle);
    for (int i = 0; i < 3; i++)
        point[i] = p[i] + q[i] + slope * normal[i];
    return project(space, point, point);
}

bat_space bat_sphere(size_t n)
{
    n = n < 1 ? 1 : n >= BAT_SPACE_MAX_DIM ? BAT_SPACE_MAX_DIM - 1 : n;
    bool oriented = n == 2;
    return (bat_space){
        .name = "sphere",
        .dimension = n,
        .point_dim = n + 1,
        .tangent_dim = n + 1,
        .injectivity = ANGLE_PI,
        .fault = fault,
        .project = project,
        SPACE_FUNCTIONS,
        .inner = space_inner,
        .exterior_angle = oriented ? exterior_angle : NULL,
        .apex = oriented ? apex : NULL,
    };
}

#include "space/builtin.h"

#include "base/error.h"
#include "linalg/symmetric.h"
#include "space/quaternion.h"

#include <string.h>

/// How far the squared length of a stored quaternion may be from 1.
static const double SQUARED_LENGTH_TOLERANCE = 2e-9;

const char *rotation_fault(const bat_space *space BAT_UNUSED, const double *point)
{
    double squared_length = quaternion_dot(point, point);
    if (!isfinite(squared_length))
        return "not finite";
    return fabs(squared_length - 1) <= SQUARED_LENGTH_TOLERANCE ? NULL : "not a quaternion of unit length";
}

bat_status rotation_project(const bat_space *space BAT_UNUSED, const double *coordinates, double *point)
{
    if (!space_scale(4, coordinates, point))
        return BAT_INVALID_POINT;
    quaternion_normalize(point);
    return BAT_OK;
}

double rotation_distance(const bat_space *space BAT_UNUSED, const double *p, const double *q)
{
    quaternion_step step = quaternion_step_between(p, q);
    return 2 * atan2(sqrt(step.squared_sine), step.cosine);
}

bat_status rotation_log(const bat_space *space BAT_UNUSED, const double *p, const double *q, double *tangent)
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

bat_status rotation_exp(const bat_space *space BAT_UNUSED, const double *p, const double *tangent, double *q)
{
    if (!isfinite(vector3_dot(tangent, tangent)))
        return BAT_INVALID_POINT;
    quaternion_turn(p, tangent[0], tangent[1], tangent[2], q);
    return BAT_OK;
}

/// Along exp_p(t v) the coordinates in the body's frame obey u' = -v x u / 2 (half the Lie bracket): the frame turns by the
/// rotation from p to q, the vector back by half of it.
bat_status rotation_transport(const bat_space *space BAT_UNUSED, const double *p, const double *q, const double *tangent,
                              double *transported)
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

void rotation_random(const bat_space *space, bat_random *random, double *point)
{
    do
    {
        for (int i = 0; i < 4; i++)
            point[i] = bat_random_normal(random);
    } while (rotation_project(space, point, point) != BAT_OK);
}

/// The great circle of quaternions from p to q or -q. Its middle needs no angle.
bat_status rotation_geodesic(const bat_space *space BAT_UNUSED, const double *p, const double *q, double t, double *point)
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

bat_space bat_rotation(void)
{
    return (bat_space){
        .name = "rotation",
        .dimension = 3,
        .point_dim = 4,
        .tangent_dim = 3,
        .injectivity = ANGLE_PI,
        .fault = rotation_fault,
        .project = rotation_project,
        .distance = rotation_distance,
        .log = rotation_log,
        .exp = rotation_exp,
        .transport = rotation_transport,
        .inner = space_inner,
        .random_point = rotation_random,
        .geodesic = rotation_geodesic,
    };
}

// Rotations as matrices and as rotation vectors.

/// How far R^T R may be from the identity, in any entry.
static const double ORTHOGONALITY_TOLERANCE = 1e-9;
/// The two largest eigenvalues of Davenport's matrix, nearer than this to each other (relative to the largest entry), leave
/// the nearest rotation to rounding.
static const double MIN_GAP = 1e-13;

static bat_status matrix_fault(bat_error *error, const char *what)
{
    return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "the matrix is %s", what);
}

static double largest_off_orthogonal(const double *m)
{
    double largest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++)
        {
            double product = m[i] * m[j] + m[3 + i] * m[3 + j] + m[6 + i] * m[6 + j];
            largest = fmax(largest, fabs(product - (i == j ? 1 : 0)));
        }
    return largest;
}

/// Of length 1, its scalar part positive.
static void take_quaternion(const double *from, double *quaternion)
{
    memcpy(quaternion, from, 4 * sizeof *from);
    quaternion_normalize(quaternion);
    double sign = quaternion[0] < 0 ? -1 : 1;
    vector_scale(4, sign, quaternion);
}

/// 4 q q^T of a rotation matrix has, in each column, a multiple of q; the longest column loses nothing (Shepperd 1978).
bat_status bat_rotation_from_matrix(const double *m, double *quaternion, bat_error *error)
{
    if (!vector_is_finite(9, m))
        return matrix_fault(error, "not finite");
    if (!(largest_off_orthogonal(m) <= ORTHOGONALITY_TOLERANCE))
        return matrix_fault(error, "not orthogonal");
    if (vector3_determinant(m, m + 3, m + 6) < 0)
        return matrix_fault(error, "a reflection: its determinant is -1");
    double outer[4][4] = {{1 + m[0] + m[4] + m[8], m[7] - m[5], m[2] - m[6], m[3] - m[1]},
                          {m[7] - m[5], 1 + m[0] - m[4] - m[8], m[1] + m[3], m[2] + m[6]},
                          {m[2] - m[6], m[1] + m[3], 1 - m[0] + m[4] - m[8], m[5] + m[7]},
                          {m[3] - m[1], m[2] + m[6], m[5] + m[7], 1 - m[0] - m[4] + m[8]}};
    int longest = 0;
    for (int i = 1; i < 4; i++)
        if (outer[i][i] > outer[longest][longest])
            longest = i;
    take_quaternion(outer[longest], quaternion);
    return BAT_OK;
}

/// The quaternion q that makes trace(R(q)^T m) = q^T K q largest.
bat_status bat_rotation_nearest(const double *matrix, double *quaternion, bat_error *error)
{
    if (!vector_is_finite(9, matrix))
        return matrix_fault(error, "not finite");
    double largest = vector_largest(9, matrix), m[9], vectors[16];
    for (int i = 0; i < 9; i++)
        m[i] = largest > 0 ? matrix[i] / largest : 0;
    double k[16] = {m[0] + m[4] + m[8], m[7] - m[5],        m[2] - m[6],         m[3] - m[1],
                    m[7] - m[5],        m[0] - m[4] - m[8], m[1] + m[3],         m[2] + m[6],
                    m[2] - m[6],        m[1] + m[3],        -m[0] + m[4] - m[8], m[5] + m[7],
                    m[3] - m[1],        m[2] + m[6],        m[5] + m[7],         -m[0] - m[4] + m[8]};
    symmetric_eigen(4, k, vectors, SYMMETRIC_BY_NORM);
    int first = 0;
    double second = -INFINITY;
    for (int i = 1; i < 4; i++)
        if (k[5 * i] > k[5 * first])
            first = i;
    for (int i = 0; i < 4; i++)
        if (i != first)
            second = fmax(second, k[5 * i]);
    if (!(k[5 * first] - second > MIN_GAP))
        return matrix_fault(error, "equally near to several rotations");
    take_quaternion(vectors + 4 * (size_t)first, quaternion);
    return BAT_OK;
}

void bat_rotation_to_matrix(const double *q, double *m)
{
    double scale = 2 / quaternion_dot(q, q);
    double x = scale * q[1], y = scale * q[2], z = scale * q[3];
    m[0] = 1 - (y * q[2] + z * q[3]);
    m[1] = x * q[2] - z * q[0];
    m[2] = x * q[3] + y * q[0];
    m[3] = x * q[2] + z * q[0];
    m[4] = 1 - (x * q[1] + z * q[3]);
    m[5] = y * q[3] - x * q[0];
    m[6] = x * q[3] - y * q[0];
    m[7] = y * q[3] + x * q[0];
    m[8] = 1 - (x * q[1] + y * q[2]);
}

bat_status bat_rotation_from_vector(const double *vector, double *quaternion, bat_error *error)
{
    const double identity[4] = {1, 0, 0, 0};
    if (rotation_exp(NULL, identity, vector, quaternion) != BAT_OK)
        return error_set(error, BAT_INVALID_POINT, BAT_NO_INDEX, 0, "the rotation vector is not finite or too long");
    return BAT_OK;
}

void bat_rotation_to_vector(const double *quaternion, double *vector)
{
    double sign = quaternion[0] < 0 ? -1 : 1;
    double sine = sqrt(vector3_dot(quaternion + 1, quaternion + 1));
    double scale = sine > 0 ? sign * 2 * atan2(sine, fabs(quaternion[0])) / sine : 0;
    for (int i = 0; i < 3; i++)
        vector[i] = scale * quaternion[i + 1];
}

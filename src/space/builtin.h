#pragma once

#include "batten/space.h"
#include "linalg/vector.h"

/// Whether a space is the library's, so that closed forms apply; not a user's, even with some of our functions.
bool space_is_euclidean(const bat_space *space);
bool space_is_plane(const bat_space *space);
bool space_is_sphere(const bat_space *space); ///< S^2
bool space_is_disk(const bat_space *space);
bool space_is_rotation(const bat_space *space);
bool space_is_rigid(const bat_space *space);
bool space_is_positive_definite(const bat_space *space);
bool space_is_product(const bat_space *space); ///< its parameters are bat_product_factors

/// Whether a space is of constant curvature with orthonormal tangents: a sphere, the disk or a hyperbolic space.
/// @param curvature receives 1 or -1 where it is
bool space_is_curved(const bat_space *space, double *curvature);

/// Whether a space is one of the three oriented surfaces: plane, S^2 or disk.
/// @param curvature receives 0, 1 or -1 where it is
bool space_is_surface(const bat_space *space, int *curvature);

/// What a space lacks that every space has, in a few words ("function log"); null for nothing.
const char *space_lack(const bat_space *space);

/// Whether a space has all required functions, dimensions within bounds and an injectivity radius. Null is no space.
/// @return BAT_OK, or BAT_INVALID_ARGUMENT with a text that names what is missing
bat_status space_check_complete(const bat_space *space, bat_error *error);

/// Functions of a space that every file of a space names alike.
#define SPACE_FUNCTIONS                                                                                                     \
    .distance = distance, .log = logarithm, .exp = exponential, .transport = transport, .random_point = random_point

// Functions that spaces share.

/// "not finite" where a point has such a coordinate, else null.
const char *space_not_finite(const bat_space *space, const double *point);
/// bat_space::project where every valid point is its own nearest one, and others have none.
bat_status space_project_valid(const bat_space *space, const double *coordinates, double *point);
/// Divide the coordinates by the largest one. False where one is not finite, or all are 0.
bool space_scale(size_t n, const double *coordinates, double *scaled);
/// bat_space::geodesic by the logarithm and the exponential.
bat_status space_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point);
/// bat_space::inner of orthonormal coordinates.
double space_inner(const bat_space *space, const double *p, const double *u, const double *v);

/// The identity matrix as a point of bat_positive_definite().
void positive_definite_identity(const bat_space *space, double *point);

/// A tangent vector at a tensor with this logarithm at the identity as the logarithm's derivative, or the reverse.
bat_status positive_definite_convert(const bat_space *space, const double *log, const double *point, const double *vector,
                                     bool to_log, double *result);

// The functions of the rotation group, which do not read `space`. Tangents are rotation vectors in the body's frame.

const char *rotation_fault(const bat_space *space, const double *point);
bat_status rotation_project(const bat_space *space, const double *coordinates, double *point);
double rotation_distance(const bat_space *space, const double *p, const double *q);
bat_status rotation_log(const bat_space *space, const double *p, const double *q, double *tangent);
bat_status rotation_exp(const bat_space *space, const double *p, const double *tangent, double *q);
bat_status rotation_transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                              double *transported);
void rotation_random(const bat_space *space, bat_random *random, double *point);
bat_status rotation_geodesic(const bat_space *space, const double *p, const double *q, double t, double *point);

/// Two points of a sphere whose sum is shorter than this are antipodal: the direction between them is lost in rounding.
#define SPHERE_ANTIPODAL_LENGTH 1e-14
#define SPHERE_ANTIPODAL_SQUARED_LENGTH (SPHERE_ANTIPODAL_LENGTH * SPHERE_ANTIPODAL_LENGTH)

/// 1 - |z|^2 with one rounding of the order of the result, however close to the rim.
static inline double disk_complement(const double *z)
{
    // The squares as unevaluated sums: xx + x_low and yy + y_low are exact.
    double xx = z[0] * z[0], yy = z[1] * z[1];
    double x_low = fma(z[0], z[0], -xx), y_low = fma(z[1], z[1], -yy);
    double larger = xx > yy ? xx : yy, smaller = xx > yy ? yy : xx;
    return ((1 - larger) - smaller) - (x_low + y_low);
}

/// w = (-p) + q, the Möbius translation that takes p to the origin: (q - p) / D with D = 1 - conj(p) q, written as
/// (1 - |p|^2) - conj(p) (q - p) so that near points lose nothing. `denominator` receives D.
static inline void disk_centre(const double *p, const double *q, double *w, double *denominator)
{
    double x = q[0] - p[0], y = q[1] - p[1];
    double re = disk_complement(p) - (p[0] * x + p[1] * y);
    double im = -(p[0] * y - p[1] * x);
    double inverse = 1 / (re * re + im * im);
    w[0] = (x * re + y * im) * inverse;
    w[1] = (y * re - x * im) * inverse;
    denominator[0] = re;
    denominator[1] = im;
}

/// The Möbius sum p + z = (p + z) / (1 + conj(p) z), written as p + (1 - |p|^2) z / (1 + conj(p) z).
static inline void disk_translate(const double *p, const double *z, double *q)
{
    double re = 1 + (p[0] * z[0] + p[1] * z[1]);
    double im = p[0] * z[1] - p[1] * z[0];
    double scale = disk_complement(p) / (re * re + im * im);
    q[0] = p[0] + scale * (z[0] * re + z[1] * im);
    q[1] = p[1] + scale * (z[1] * re - z[0] * im);
}

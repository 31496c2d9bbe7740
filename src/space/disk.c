#include "space/builtin.h"

// Points are z = x + i y. Tangents at p are in the frame that z -> (z + p) / (1 + conj(p) z) brings from the origin.

/// Random points lie in the disk of this hyperbolic radius.
static const double RANDOM_RADIUS = 3;

static const char *fault(const bat_space *space BAT_UNUSED, const double *point)
{
    if (!isfinite(point[0]) || !isfinite(point[1]))
        return "not finite";
    return fabs(point[0]) < 1 && fabs(point[1]) < 1 && disk_complement(point) > 0 ? NULL : "not inside the unit disk";
}

/// sinh(d/2) = |q - p| / sqrt((1 - |p|^2) (1 - |q|^2))
static double distance(const bat_space *space BAT_UNUSED, const double *p, const double *q)
{
    return 2 * asinh(hypot(q[0] - p[0], q[1] - p[1]) / sqrt(disk_complement(p) * disk_complement(q)));
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    double w[2], denominator[2];
    disk_centre(p, q, w, denominator);
    double length = hypot(w[0], w[1]);
    double scale = length > 0 ? distance(space, p, q) / length : 0;
    tangent[0] = scale * w[0];
    tangent[1] = scale * w[1];
    return BAT_OK;
}

/// Steps up to this length go by the Möbius sum, which loses nothing to cancellation when they are short.
static const double SHORT_STEP = 1;

/// A long step, with the unit tangent u, s = 1 - tanh(r/2) = 2 / (e^r + 1) and A = p + u: the Möbius sum p + (1 - s) u is
/// (A - s u) / (u conj(A) - s conj(p) u), in which the distance from the rim is kept to full relative accuracy.
static void long_step(const double *p, const double *u, double length, double *q)
{
    double s = 2 / (exp(length) + 1);
    double a[2] = {p[0] + u[0], p[1] + u[1]};
    double numerator[2] = {a[0] - s * u[0], a[1] - s * u[1]};
    double re = (u[0] * a[0] + u[1] * a[1]) - s * (p[0] * u[0] + p[1] * u[1]);
    double im = (u[1] * a[0] - u[0] * a[1]) - s * (p[0] * u[1] - p[1] * u[0]);
    double norm = re * re + im * im;
    q[0] = (numerator[0] * re + numerator[1] * im) / norm;
    q[1] = (numerator[1] * re - numerator[0] * im) / norm;
}

static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    double length = hypot(tangent[0], tangent[1]);
    double unit[2] = {length > 0 ? tangent[0] / length : 0, length > 0 ? tangent[1] / length : 0};
    if (length > SHORT_STEP)
        long_step(p, unit, length, q);
    else
    {
        double scale = tanh(0.5 * length);
        double z[2] = {scale * unit[0], scale * unit[1]};
        disk_translate(p, z, q);
    }
    return fault(space, q) == NULL ? BAT_OK : BAT_INVALID_POINT;
}

/// From the nearer end: an error of the direction grows like the exponential of the distance gone.
static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    bool from_q = t > 0.5;
    return space_geodesic(space, from_q ? q : p, from_q ? p : q, from_q ? 1 - t : t, point);
}

/// Seen from p at the origin the geodesic is a diameter and transport along it keeps coordinates; going back turns them by
/// the argument of the translation's derivative, which is that of D^2 with D = 1 - conj(p) q.
static bat_status transport(const bat_space *space BAT_UNUSED, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    double w[2], denominator[2];
    disk_centre(p, q, w, denominator);
    double x = denominator[0], y = denominator[1];
    double norm = x * x + y * y;
    double cosine = (x * x - y * y) / norm, sine = 2 * x * y / norm;
    transported[0] = cosine * tangent[0] - sine * tangent[1];
    transported[1] = sine * tangent[0] + cosine * tangent[1];
    return BAT_OK;
}

static void random_point(const bat_space *space BAT_UNUSED, bat_random *random, double *point)
{
    // The area within radius r is proportional to cosh(r) - 1 = 2 sinh(r/2)^2.
    double sinh_half = sinh(0.5 * RANDOM_RADIUS) * sqrt(bat_random_uniform(random));
    double radius = sinh_half / sqrt(1 + sinh_half * sinh_half);
    double angle = ANGLE_TURN * bat_random_uniform(random);
    point[0] = radius * cos(angle);
    point[1] = radius * sin(angle);
}

static double exterior_angle(const bat_space *space BAT_UNUSED, const double *before, const double *p, const double *after)
{
    double back[2], out[2], denominator[2];
    disk_centre(p, before, back, denominator);
    disk_centre(p, after, out, denominator);
    return atan2(back[1] * out[0] - back[0] * out[1], -back[0] * out[0] - back[1] * out[1]);
}

/// The right-angled half of the triangle gives tanh(leg) = tanh(e/2) / cos(angle) (the paper's eq. (8) has the leg wrong).
/// With w = (-p) + q, |w| = tanh(e/2), and the half-argument formula of tanh, the apex is
/// p + (1 + i t) w / (1 + sqrt(1 - |w|^2 (1 + t^2))), t = tan(angle), the sums being Möbius sums.
static bat_status apex(const bat_space *space, const double *p, const double *q, double angle, double *point)
{
    double w[2], denominator[2];
    disk_centre(p, q, w, denominator);
    double slope = tan(angle);
    double complement_w =
        disk_complement(p) * disk_complement(q) / (denominator[0] * denominator[0] + denominator[1] * denominator[1]);
    double discriminant = complement_w - (w[0] * w[0] + w[1] * w[1]) * slope * slope;
    if (!(discriminant > 0))
        return BAT_INVALID_POINT;
    double scale = 1 / (1 + sqrt(discriminant));
    double z[2] = {scale * (w[0] - slope * w[1]), scale * (w[1] + slope * w[0])};
    disk_translate(p, z, point);
    return fault(space, point) == NULL ? BAT_OK : BAT_INVALID_POINT;
}

bat_space bat_disk(void)
{
    return (bat_space){
        .name = "disk",
        .dimension = 2,
        .point_dim = 2,
        .tangent_dim = 2,
        .injectivity = INFINITY,
        .fault = fault,
        .project = space_project_valid,
        SPACE_FUNCTIONS,
        .inner = space_inner,
        .geodesic = geodesic,
        .exterior_angle = exterior_angle,
        .apex = apex,
    };
}

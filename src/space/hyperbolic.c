#include "space/builtin.h"

#include <float.h>

// A point is (x0, x) with x0 = sqrt(1 + |x|^2); x alone says where it is, and x0 is never used for more than a check. Seen
// from a point p at radius r (sinh r = |x|), space is turned about the axis from the apex through p: everything is split
// into the part along the axis and the part across, and written so that only positive terms are added, or exact differences
// of near points.

/// How far x0 may be from sqrt(1 + |x|^2), relative to it.
static const double TOLERANCE = 1e-9;
/// Points farther out than this x0 (at distance 346 from the apex) would overflow in products of two.
static const double FARTHEST = 1e150;

static double height(double norm)
{
    return sqrt(1 + norm * norm);
}

static const char *fault(const bat_space *space, const double *point)
{
    double norm = sqrt(vector_dot(space->dimension, point + 1, point + 1)), expected = height(norm);
    if (space_not_finite(space, point) != NULL)
        return space_not_finite(space, point);
    if (!(expected <= FARTHEST))
        return "too far from the apex";
    return fabs(point[0] - expected) <= TOLERANCE * expected ? NULL : "not on the hyperboloid";
}

/// The nearest point is (sqrt(1 + s^2), s u), u being the direction of x, where 2 s - a s / sqrt(1 + s^2) = |x| with a = x0.
/// Newton's method starts on the side from which it is monotone.
static bat_status project(const bat_space *space, const double *coordinates, double *point)
{
    size_t n = space->dimension;
    double a = coordinates[0], b = sqrt(vector_dot(n, coordinates + 1, coordinates + 1));
    if (!(fabs(a) <= FARTHEST && b <= FARTHEST) || (b == 0 && a > 2))
        return BAT_INVALID_POINT;
    double s = a > 0 ? 0.5 * (a + b) : 0;
    for (int step = 0; step < 100 && b > 0; step++)
    {
        double h = height(s), slope = 2 - a / (h * h * h);
        double next = s - (s * (2 - a / h) - b) / slope;
        bool settled = fabs(next - s) <= DBL_EPSILON * s;
        s = next;
        if (settled)
            break;
    }
    for (size_t i = 0; i < n; i++)
        point[i + 1] = b > 0 ? coordinates[i + 1] * (s / b) : 0;
    point[0] = height(b > 0 ? s : 0);
    return BAT_OK;
}

/// A point q seen from p.
typedef struct sight
{
    double norm_p, norm_q;           ///< |x| of p and q
    double across;                   ///< length of the part of q across the axis
    double along;                    ///< of q's direction in p's frame, times sinh d
    double half_squared;             ///< sinh(d / 2)^2
    double axis[BAT_SPACE_MAX_DIM];  ///< unit, from the apex through p; through q where p is the apex
    double cross[BAT_SPACE_MAX_DIM]; ///< the part of q across the axis
} sight;

static void set_axis(size_t n, const double *vector, double norm, double *axis)
{
    for (size_t i = 0; i < n; i++)
        axis[i] = norm > 0 ? vector[i] / norm : 0;
}

/// With rho the difference of the radii and alpha the angle between p and q at the apex,
///   sinh(d/2)^2 = sinh(rho/2)^2 + |x_p| |x_q| (1 - cos alpha) / 2,
///   along = sinh(rho) - x0_p |x_q| (1 - cos alpha).
static void see(size_t n, const double *p, const double *q, sight *s)
{
    s->norm_p = sqrt(vector_dot(n, p, p));
    s->norm_q = sqrt(vector_dot(n, q, q));
    set_axis(n, s->norm_p > 0 ? p : q, s->norm_p > 0 ? s->norm_p : s->norm_q, s->axis);
    double difference_squared = 0, growth = 0;
    for (size_t i = 0; i < n; i++)
    {
        double difference = q[i] - p[i];
        difference_squared += difference * difference;
        growth += difference * (q[i] + p[i]);
    }
    bool near = difference_squared < s->norm_q * s->norm_q;
    for (size_t i = 0; i < n; i++)
        s->cross[i] = near ? q[i] - p[i] : q[i];
    double parallel = vector_dot(n, s->cross, s->axis);
    vector_add(n, -parallel, s->axis, s->cross);
    double across_squared = vector_dot(n, s->cross, s->cross);
    s->across = sqrt(across_squared);
    double on_axis = near ? s->norm_p + parallel : parallel, sum = s->norm_p + s->norm_q;
    // |x_q| (1 - cos alpha)
    double drop = on_axis > 0 ? across_squared / (s->norm_q + on_axis) : s->norm_q - on_axis;
    double norm_growth = near ? growth / sum : s->norm_q - s->norm_p;
    double height_p = height(s->norm_p);
    double weighted = s->norm_q * height_p + s->norm_p * height(s->norm_q);
    double sinh_rho = sum > 0 ? norm_growth * (sum / weighted) : 0;
    s->half_squared = sinh_rho * (0.5 * sinh_rho / (hypot(1, sinh_rho) + 1)) + 0.5 * s->norm_p * drop;
    s->along = sinh_rho - height_p * drop;
}

static double distance_seen(const sight *s)
{
    return 2 * asinh(sqrt(s->half_squared));
}

static double distance(const bat_space *space, const double *p, const double *q)
{
    sight s;
    see(space->dimension, p + 1, q + 1, &s);
    return distance_seen(&s);
}

static bat_status logarithm(const bat_space *space, const double *p, const double *q, double *tangent)
{
    sight s;
    see(space->dimension, p + 1, q + 1, &s);
    double length = hypot(s.along, s.across);
    double scale = length > 0 ? distance_seen(&s) / length : 0;
    for (size_t i = 0; i < space->dimension; i++)
        tangent[i] = scale * (s.along * s.axis[i] + s.cross[i]);
    return BAT_OK;
}

static bat_status finish(const bat_space *space, double *point)
{
    point[0] = height(sqrt(vector_dot(space->dimension, point + 1, point + 1)));
    return point[0] <= FARTHEST ? BAT_OK : BAT_INVALID_POINT;
}

/// Steps towards the apex that are longer than this are taken by the difference of radii.
static const double SHORT_STEP = 1;

/// The boost of p applied to (cosh d, sinh d u): along the axis |x| cosh d + x0 sinh d a, where a = <u, axis>; across, sinh
/// d u. Far towards the apex the sum cancels and becomes sinh(r - d) + x0 sinh d (1 + a).
static bat_status exponential(const bat_space *space, const double *p, const double *tangent, double *q)
{
    size_t n = space->dimension;
    double norm = sqrt(vector_dot(n, p + 1, p + 1)), length = sqrt(vector_dot(n, tangent, tangent));
    if (!isfinite(length))
        return BAT_INVALID_POINT;
    double axis[BAT_SPACE_MAX_DIM], cross[BAT_SPACE_MAX_DIM];
    set_axis(n, norm > 0 ? p + 1 : tangent, norm > 0 ? norm : length, axis);
    set_axis(n, tangent, length, cross);
    double a = vector_dot(n, cross, axis);
    vector_add(n, -a, axis, cross);
    double sinh_length = sinh(length), along;
    along = a >= 0 || length < SHORT_STEP
                ? norm * cosh(length) + height(norm) * sinh_length * a
                : sinh(asinh(norm) - length) + height(norm) * sinh_length * (vector_dot(n, cross, cross) / (1 - a));
    for (size_t i = 0; i < n; i++)
        q[i + 1] = along * axis[i] + sinh_length * cross[i];
    return finish(space, q);
}

/// The frames are those that boosts bring from the apex, so what transport turns is the area of the triangle with the apex,
/// in the plane of the three: tan(area / 2) = |x_p| across / (1 + x0_p + x0_q + cosh d).
static bat_status transport(const bat_space *space, const double *p, const double *q, const double *tangent,
                            double *transported)
{
    size_t n = space->dimension;
    sight s;
    see(n, p + 1, q + 1, &s);
    double half = s.norm_p * s.across / (2 + height(s.norm_p) + height(s.norm_q) + 2 * s.half_squared);
    double unit[BAT_SPACE_MAX_DIM];
    set_axis(n, s.cross, s.across, unit);
    // Once more at right angles: the part across may itself be mostly rounding.
    double slip = vector_dot(n, unit, s.axis);
    vector_add(n, -slip, s.axis, unit);
    double length = sqrt(vector_dot(n, unit, unit));
    set_axis(n, unit, length, unit);
    double versine = 2 * half * half / (1 + half * half), sine = 2 * half / (1 + half * half);
    double along = vector_dot(n, tangent, s.axis), across = vector_dot(n, tangent, unit);
    double change_along = sine * across - versine * along, change_across = -sine * along - versine * across;
    for (size_t i = 0; i < n; i++)
        transported[i] = tangent[i] + change_along * s.axis[i] + change_across * unit[i];
    return BAT_OK;
}

static void random_point(const bat_space *space, bat_random *random, double *point)
{
    double apex[BAT_SPACE_MAX_DIM] = {1}, tangent[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->dimension; i++)
        tangent[i] = bat_random_normal(random) / sqrt((double)space->dimension);
    (void)exponential(space, apex, tangent, point);
}

/// (sinh((1 - t) d) p + sinh(t d) q) / sinh d, all of it positive between the ends; beyond an end from that end.
static bat_status geodesic(const bat_space *space, const double *p, const double *q, double t, double *point)
{
    if (!(t >= 0 && t <= 1))
        return t < 0 ? space_geodesic(space, p, q, t, point) : space_geodesic(space, q, p, 1 - t, point);
    sight s;
    see(space->dimension, p + 1, q + 1, &s);
    double of_p = 1 - t, of_q = t;
    if (t == 0.5)
        of_p = of_q = 0.5 / sqrt(1 + s.half_squared);
    else if (s.half_squared > 0)
    {
        double d = distance_seen(&s), inverse = 1 / sinh(d);
        of_p = sinh((1 - t) * d) * inverse;
        of_q = sinh(t * d) * inverse;
    }
    for (size_t i = 1; i <= space->dimension; i++)
        point[i] = of_p * p[i] + of_q * q[i];
    return finish(space, point);
}

bat_space bat_hyperbolic(size_t n)
{
    n = n < 1 ? 1 : n >= BAT_SPACE_MAX_DIM ? BAT_SPACE_MAX_DIM - 1 : n;
    return (bat_space){
        .name = "hyperbolic",
        .dimension = n,
        .point_dim = n + 1,
        .tangent_dim = n,
        .injectivity = INFINITY,
        .fault = fault,
        .project = project,
        SPACE_FUNCTIONS,
        .inner = space_inner,
        .geodesic = geodesic,
    };
}

#include "curve/spline.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// The Catmull-Rom, the cubic and the quintic spline: the derivatives at the points.

enum
{
    /// A closed curve is continued by this many points on either side to solve for the velocities. The equations are
    /// diagonally dominant by a factor of 2, so what lies beyond changes a velocity by less than 2^-64 of itself.
    WRAP = 64
};

/// The share of the increment before point i in the sum of both.
static double share_before(const spline *s, ptrdiff_t i)
{
    double before = spline_increment(s, i - 1), after = spline_increment(s, i);
    return before / (before + after);
}

static double share_after(const spline *s, ptrdiff_t i)
{
    double before = spline_increment(s, i - 1), after = spline_increment(s, i);
    return after / (before + after);
}

/// The velocity at point i of the geodesic to the next point.
static bat_status slope_after(const spline *s, ptrdiff_t i, double *slope)
{
    bat_status status = s->space->log(s->space, spline_row_at(s, i), spline_row_at(s, i + 1), slope);
    double increment = spline_increment(s, i);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        slope[c] /= increment;
    return status;
}

/// The velocity at point i of the geodesic from the point before.
static bat_status slope_before(const spline *s, ptrdiff_t i, double *slope)
{
    bat_status status = s->space->log(s->space, spline_row_at(s, i), spline_row_at(s, i - 1), slope);
    double increment = spline_increment(s, i - 1);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        slope[c] /= -increment;
    return status;
}

/// sum = before times the slope before point i + after times the slope after it.
static bat_status weighted_slopes(const spline *s, ptrdiff_t i, double before, double after, double *sum)
{
    double slope[BAT_SPACE_MAX_DIM];
    bat_status status = slope_before(s, i, sum);
    if (status == BAT_OK)
        status = slope_after(s, i, slope);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        sum[c] = before * sum[c] + after * slope[c];
    return status;
}

/// Add `factor` times a tangent vector at point `from`, brought to its neighbour `to`.
static bat_status add_transported(const spline *s, ptrdiff_t from, ptrdiff_t to, double factor, const double *tangent,
                                  double *sum)
{
    double moved[BAT_SPACE_MAX_DIM];
    bat_status status = s->space->transport(s->space, spline_row_at(s, from), spline_row_at(s, to), tangent, moved);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        sum[c] += factor * moved[c];
    return status;
}

static double *velocity_of(const spline *s, size_t i)
{
    return spline_derivative(s, i, 1);
}

/// The slope of the only edge at an end of an open curve; `end` is 0 or count - 1.
static bat_status end_slope(const spline *s, ptrdiff_t end, double *slope)
{
    return end == 0 ? slope_after(s, 0, slope) : slope_before(s, end, slope);
}

/// Replace the velocity of an end by factor * slope - share * the velocity of the point beside it.
static bat_status end_velocity(const spline *s, ptrdiff_t end, double factor, double share)
{
    double *velocity = velocity_of(s, (size_t)end);
    ptrdiff_t beside = end == 0 ? 1 : end - 1;
    bat_status status = end_slope(s, end, velocity);
    for (size_t c = 0; c < s->tangent_dim; c++)
        velocity[c] *= factor;
    return status == BAT_OK ? add_transported(s, beside, end, -share, velocity_of(s, (size_t)beside), velocity) : status;
}

// Catmull-Rom

/// The velocity of the parabola through each point and its neighbours. At the ends of an open curve it is that of the edge,
/// as if the curve went on by point reflection, or with `parabola` that of the parabola through the last three points.
static bat_status catmull_rom(const spline *s, bool parabola, size_t *fault)
{
    bat_status status = BAT_OK;
    size_t inner = s->coarse->closed ? 0 : 1;
    for (size_t i = inner; i + inner < s->count && status == BAT_OK; i++)
    {
        *fault = i;
        ptrdiff_t at = (ptrdiff_t)i;
        status = weighted_slopes(s, at, share_after(s, at), share_before(s, at), velocity_of(s, i));
    }
    for (size_t k = 0; k < 2 && !s->coarse->closed && status == BAT_OK; k++)
    {
        *fault = k == 0 ? 0 : s->count - 1;
        ptrdiff_t end = (ptrdiff_t)*fault;
        status = parabola && s->count > 2 ? end_velocity(s, end, 2, 1) : end_slope(s, end, velocity_of(s, *fault));
    }
    return status;
}

// The cubic spline

/// The tridiagonal system of the velocities m_i at the points begin … end - 1. With a = share_after(i), b = share_before(i):
///
///     a m_(i-1) + g m_i + b m_(i+1) = right side,
///
/// where the neighbours' velocities are brought to point i by parallel transport. Inside, g = 2 and the right side is 3 (a
/// slope before + b slope after), which makes second derivatives continuous. In the first and the last equation the velocity
/// outside is 0 or eliminated.
typedef struct velocity_system
{
    ptrdiff_t begin, end;
    bool not_a_knot; ///< the first and the last equation are those of not-a-knot ends
    double *upper;   ///< end - begin coefficients of the next velocity, after elimination
    double *right;   ///< end - begin tangent vectors
} velocity_system;

/// The coefficient g and the right side of equation i. At a not-a-knot end, where the first two cubics are one, the velocity
/// of the end point is eliminated: m_1 + b m_2 = a^2 slope before + (3 - b) b slope after, and likewise at the other end.
static bat_status equation(const spline *s, const velocity_system *system, ptrdiff_t i, double *diagonal, double *right)
{
    double a = share_after(s, i), b = share_before(s, i);
    bool first = system->not_a_knot && i == system->begin, last = system->not_a_knot && i == system->end - 1;
    *diagonal = first || last ? 1 : 2;
    double before = first ? a * a : last ? (3 - a) * a : 3 * a;
    double after = first ? (3 - b) * b : last ? b * b : 3 * b;
    return weighted_slopes(s, i, before, after, right);
}

static bat_status eliminate(const spline *s, const velocity_system *system, size_t *fault)
{
    bat_status status = BAT_OK;
    for (ptrdiff_t i = system->begin; i < system->end && status == BAT_OK; i++)
    {
        *fault = spline_wrapped(s, i);
        size_t at = (size_t)(i - system->begin);
        double *right = system->right + at * s->tangent_dim, pivot;
        status = equation(s, system, i, &pivot, right);
        if (status == BAT_OK && at > 0)
        {
            double lower = share_after(s, i);
            pivot -= lower * system->upper[at - 1];
            status = add_transported(s, i - 1, i, -lower, right - s->tangent_dim, right);
        }
        system->upper[at] = share_before(s, i) / pivot;
        for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
            right[c] /= pivot;
    }
    return status;
}

/// The solution takes the place of the right sides.
static bat_status substitute(const spline *s, const velocity_system *system, size_t *fault)
{
    bat_status status = BAT_OK;
    for (ptrdiff_t i = system->end - 2; i >= system->begin && status == BAT_OK; i--)
    {
        *fault = spline_wrapped(s, i);
        size_t at = (size_t)(i - system->begin);
        double *right = system->right + at * s->tangent_dim;
        status = add_transported(s, i + 1, i, -system->upper[at], right + s->tangent_dim, right);
    }
    return status;
}

static bat_status solve(const spline *s, ptrdiff_t begin, ptrdiff_t end, size_t *fault)
{
    size_t count = (size_t)(end - begin), first = begin < 0 ? (size_t)-begin : 0;
    velocity_system system = {.begin = begin, .end = end, .not_a_knot = !s->coarse->closed};
    system.upper = memory_array(count, sizeof *system.upper);
    system.right = memory_array(count * s->tangent_dim, sizeof *system.right);
    bat_status status = system.upper != NULL && system.right != NULL ? BAT_OK : BAT_NO_MEMORY;
    if (status == BAT_OK)
        status = eliminate(s, &system, fault);
    if (status == BAT_OK)
        status = substitute(s, &system, fault);
    size_t wanted = s->coarse->closed ? s->count : count;
    if (status == BAT_OK)
        memcpy(velocity_of(s, s->coarse->closed ? 0 : (size_t)begin), system.right + first * s->tangent_dim,
               wanted * s->tangent_dim * sizeof *system.right);
    free(system.upper);
    free(system.right);
    return status;
}

/// The velocity of an end whose first two cubics are one: (2 + b) slope + (b^2 next slope - m_1) / a, as at point 1.
static bat_status not_a_knot_end(const spline *s, ptrdiff_t end)
{
    double next[BAT_SPACE_MAX_DIM], *velocity = velocity_of(s, (size_t)end);
    ptrdiff_t beside = end == 0 ? 1 : end - 1;
    double near = end == 0 ? share_before(s, beside) : share_after(s, beside);
    double far = end == 0 ? share_after(s, beside) : share_before(s, beside);
    bat_status status = end == 0 ? slope_after(s, beside, next) : slope_before(s, beside, next);
    if (status == BAT_OK)
        status = end_slope(s, end, velocity);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
    {
        velocity[c] *= 2 + near;
        next[c] = near * near * next[c] - velocity_of(s, (size_t)beside)[c];
    }
    return status == BAT_OK ? add_transported(s, beside, end, 1 / far, next, velocity) : status;
}

/// Natural ends: the second derivative is 0 there. Two points give a straight edge, three one equation for the middle.
static bat_status natural(const spline *s, size_t *fault)
{
    bat_status status = BAT_OK;
    *fault = 1;
    if (s->count == 3)
        status = weighted_slopes(s, 1, share_after(s, 1), share_before(s, 1), velocity_of(s, 1));
    for (size_t k = 0; k < 2 && status == BAT_OK; k++)
    {
        *fault = k == 0 ? 0 : s->count - 1;
        status = s->count == 3 ? end_velocity(s, (ptrdiff_t)*fault, 1.5, 0.5)
                               : end_slope(s, (ptrdiff_t)*fault, velocity_of(s, *fault));
    }
    return status;
}

static bat_status cubic(const spline *s, size_t *fault)
{
    ptrdiff_t count = (ptrdiff_t)s->count;
    if (s->coarse->closed)
        return solve(s, -WRAP, count + WRAP, fault);
    if (s->count < 4)
        return natural(s, fault);
    bat_status status = solve(s, 1, count - 1, fault);
    for (size_t k = 0; k < 2 && status == BAT_OK; k++)
    {
        *fault = k == 0 ? 0 : s->count - 1;
        status = not_a_knot_end(s, (ptrdiff_t)*fault);
    }
    return status;
}

static bat_status find_cubic(const spline *s, const bat_curve_refine_options *options, size_t *fault)
{
    (void)options;
    return cubic(s, fault);
}

static bat_status find_catmull_rom(const spline *s, const bat_curve_refine_options *options, size_t *fault)
{
    return catmull_rom(s, options->ends == BAT_CURVE_END_RULE_EXTRAPOLATE, fault);
}

static void cubic_weights(double t, double *weights)
{
    double r = 1 - t;
    weights[0] = r * r * r;
    weights[1] = 3 * r * t * r;
    weights[2] = 3 * r * t * t;
    weights[3] = t * t * t;
}

bat_status spline_catmull_rom(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels,
                              bat_error *error)
{
    static const spline_form FORM = {3, cubic_weights, find_catmull_rom};
    return spline_make(&FORM, coarse, plan, points, channels, error);
}

bat_status spline_cubic(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels, bat_error *error)
{
    static const spline_form FORM = {3, cubic_weights, find_cubic};
    return spline_make(&FORM, coarse, plan, points, channels, error);
}

// The quintic Hermite spline: Bezier curves of degree 5 from velocities and accelerations at the points, which are the
// derivatives of the polynomial through five neighbouring points (Fornberg 1988). In R^n it is C2 and reproduces
// polynomials of degree 4 at their parameters.

enum
{
    WINDOW = 5 ///< points of a polynomial, where there are so many
};

/// The velocity and the acceleration at point i of the polynomial through the points `first` … first + width - 1, point i
/// among them, in the tangent space of point i. With t_k for the parameter of point k less that of point i, and
/// g_k = prod_m t_m / (t_m - t_k) over the other points m, the weight of point k is g_k / t_k for the velocity and
/// -2 g_k / t_k sum_m 1 / t_m for the acceleration.
static bat_status find_at(const spline *s, ptrdiff_t i, ptrdiff_t first, ptrdiff_t width)
{
    double knots[WINDOW], *velocity = spline_derivative(s, (size_t)i, 1), *acceleration = spline_derivative(s, (size_t)i, 2);
    ptrdiff_t own = i - first;
    knots[own] = 0;
    for (ptrdiff_t k = own + 1; k < width; k++)
        knots[k] = knots[k - 1] + spline_increment(s, first + k - 1);
    for (ptrdiff_t k = own - 1; k >= 0; k--)
        knots[k] = knots[k + 1] - spline_increment(s, first + k);
    for (size_t c = 0; c < s->tangent_dim; c++)
        velocity[c] = acceleration[c] = 0;
    bat_status status = BAT_OK;
    for (ptrdiff_t k = 0; k < width && status == BAT_OK; k++)
    {
        double tangent[BAT_SPACE_MAX_DIM], weight = 1 / knots[k], sum = 0;
        if (k == own)
            continue;
        for (ptrdiff_t m = 0; m < width; m++)
            if (m != k && m != own)
            {
                weight *= knots[m] / (knots[m] - knots[k]);
                sum += 1 / knots[m];
            }
        status = s->space->log(s->space, spline_row_at(s, i), spline_row_at(s, first + k), tangent);
        for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        {
            velocity[c] += weight * tangent[c];
            acceleration[c] -= 2 * weight * sum * tangent[c];
        }
    }
    return status;
}

/// Where a logarithm of a farther point does not exist, fewer points serve.
static bat_status find(const spline *s, const bat_curve_refine_options *options, size_t *fault)
{
    (void)options;
    ptrdiff_t count = (ptrdiff_t)s->count, widest = count < WINDOW ? count : WINDOW;
    if (s->coarse->closed && widest % 2 == 0)
        widest--;
    bat_status status = BAT_OK;
    for (ptrdiff_t i = 0; i < count && status == BAT_OK; i++)
    {
        *fault = (size_t)i;
        for (ptrdiff_t width = widest; width > 1; width--)
        {
            ptrdiff_t first = i - width / 2, last = count - width;
            if (!s->coarse->closed)
                first = first < 0 ? 0 : first > last ? last : first;
            status = find_at(s, i, first, width);
            if (status == BAT_OK)
                break;
        }
    }
    return status;
}

static void quintic_weights(double t, double *weights)
{
    double r = 1 - t;
    weights[0] = r * r * r * r * r;
    weights[1] = 5 * r * r * r * r * t;
    weights[2] = 10 * r * r * r * t * t;
    weights[3] = 10 * r * r * t * t * t;
    weights[4] = 5 * r * t * t * t * t;
    weights[5] = t * t * t * t * t;
}

bat_status spline_quintic(const bat_curve *coarse, const refine_plan *plan, double *points, double *channels,
                          bat_error *error)
{
    static const spline_form FORM = {5, quintic_weights, find};
    return spline_make(&FORM, coarse, plan, points, channels, error);
}

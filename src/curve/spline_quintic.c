#include "curve/spline.h"

/// @file
/// The quintic Hermite spline: Bezier curves of degree 5 from velocities and accelerations at the points, which are the
/// derivatives of the polynomial through five neighbouring points (Fornberg 1988). In R^n it is C2 and reproduces
/// polynomials of degree 4 at their parameters.

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

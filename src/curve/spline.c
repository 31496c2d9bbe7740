
#include "base/error.h"
#include "base/memory.h"
#include "base/shared_work.h"
#include "base/threads.h"
#include "curve/parametric.h"
#include "curve/scheme_kind.h"
#include "space/builtin.h"

#include <string.h>

// Splines of Bezier curves through the points of a curve. A Bezier curve over an edge has an odd degree d. Its inner
// control points follow from the first (d - 1) / 2 derivatives by the parameter at both ends. Between points of a space
// other than R^n, de Casteljau's algorithm takes points of geodesics (Park and Ravani 1995). Two such curves with the same
// velocity at their common point are C1; in R^n those of degree 5 with the same acceleration are C2.

#define SPLINE_MAX_DEGREE 5

typedef struct spline spline;

struct spline_form
{
    size_t degree;                              ///< 3 or 5
    void (*weights)(double t, double *weights); ///< the degree + 1 Bernstein polynomials
    /// Find the derivatives at all points.
    /// @param fault receives the point at fault
    bat_status (*find)(const spline *s, const bat_curve_refine_options *options, size_t *fault);
};

struct spline
{
    const bat_curve *coarse;
    const bat_curve_scheme *scheme;
    const spline_form *form;
    const bat_space *space; ///< of the rows
    size_t channel_count, dim, tangent_dim, count, edges;
    bool euclidean;
    double *rows;        ///< count x dim
    double *increments;  ///< of the parameter over each edge
    double *derivatives; ///< count x (degree - 1) / 2 x tangent_dim, by the parameter: velocities, accelerations
};

static inline size_t spline_wrapped(const spline *s, ptrdiff_t i)
{
    ptrdiff_t count = (ptrdiff_t)s->count;
    return (size_t)((i % count + count) % count);
}

static inline const double *spline_row_at(const spline *s, ptrdiff_t i)
{
    return s->rows + spline_wrapped(s, i) * s->dim;
}

/// The increment over the edge that begins at point i.
static inline double spline_increment(const spline *s, ptrdiff_t i)
{
    return s->increments[spline_wrapped(s, i)];
}

/// Derivative `order`, from 1 on, at point i.
static inline double *spline_derivative(const spline *s, size_t i, size_t order)
{
    return s->derivatives + (i * (s->form->degree / 2) + order - 1) * s->tangent_dim;
}

/// New points computed at a time.
static const size_t PIECE = 1024;

/// Lengths are divided by a power of two near the longest, which changes no digit of the curve.
static bat_status measure_increments(const spline *s, bat_error *error)
{
    const bat_space *points = s->coarse->space;
    double longest = 0;
    for (size_t i = 0; i < s->edges; i++)
    {
        s->increments[i] = points->distance(points, spline_row_at(s, (ptrdiff_t)i), spline_row_at(s, (ptrdiff_t)i + 1));
        longest = fmax(longest, s->increments[i]);
    }
    int exponent = longest > 0 && isfinite(longest) ? ilogb(longest) : 0;
    for (size_t i = 0; i < s->edges; i++)
    {
        s->increments[i] = parametric_increment(s->scheme->parameters, ldexp(s->increments[i], -exponent));
        if (!(s->increments[i] > 0 && isfinite(s->increments[i])))
            return error_point(error, BAT_INVALID_POINT, i, "the edge after point", " is too %s beside the others",
                               s->increments[i] > 0 ? "long" : "short");
    }
    return BAT_OK;
}

static bat_status find_derivatives(const spline *s, const bat_curve_refine_options *options, bat_error *error)
{
    size_t fault = 0;
    bat_status status = s->form->find(s, options, &fault);
    if (status == BAT_NO_MEMORY)
        return error_memory(error, s->count * (s->tangent_dim + 1) * sizeof(double));
    if (status != BAT_OK)
        return error_point(error, status, fault, "the spline has no velocity at point", " (%s)", bat_status_name(status));
    return BAT_OK;
}

/// The control points of an edge.
typedef struct bezier
{
    double points[SPLINE_MAX_DEGREE + 1][BAT_SPACE_MAX_DIM];
} bezier;

/// Inner control point k, from 1 on, counted from point i. `increment` is that of the edge, negative for one that ends at i:
/// with h for it, k h / d times the velocity, and for the second one h^2 / (d (d - 1)) times the acceleration.
static bat_status control_point(const spline *s, size_t i, size_t k, double increment, double *control)
{
    double tangent[BAT_SPACE_MAX_DIM], part = increment / (double)s->form->degree;
    double square = increment * part / (double)(s->form->degree - 1);
    for (size_t c = 0; c < s->tangent_dim; c++)
    {
        tangent[c] = (double)k * part * spline_derivative(s, i, 1)[c];
        if (k == 2)
            tangent[c] += square * spline_derivative(s, i, 2)[c];
    }
    return s->space->exp(s->space, s->rows + i * s->dim, tangent, control);
}

static bat_status bezier_make(const spline *s, size_t i, bezier *edge)
{
    size_t next = i + 1 == s->count ? 0 : i + 1, degree = s->form->degree;
    memcpy(edge->points[0], s->rows + i * s->dim, s->dim * sizeof *s->rows);
    memcpy(edge->points[degree], s->rows + next * s->dim, s->dim * sizeof *s->rows);
    bat_status status = BAT_OK;
    for (size_t k = 1; k <= degree / 2 && status == BAT_OK; k++)
    {
        status = control_point(s, i, k, s->increments[i], edge->points[k]);
        if (status == BAT_OK)
            status = control_point(s, next, k, -s->increments[i], edge->points[degree - k]);
    }
    return status;
}

/// Bernstein's form. The sums are symmetric, so that reversal changes no bit.
static bat_status euclidean_value(const spline *s, const bezier *edge, double t, double *row)
{
    size_t degree = s->form->degree;
    double weights[SPLINE_MAX_DEGREE + 1];
    bool finite = true;
    s->form->weights(t, weights);
    for (size_t c = 0; c < s->dim; c++)
    {
        row[c] = weights[0] * edge->points[0][c] + weights[degree] * edge->points[degree][c];
        for (size_t k = 1; k <= degree / 2; k++)
            row[c] += weights[k] * edge->points[k][c] + weights[degree - k] * edge->points[degree - k][c];
        finite = finite && isfinite(row[c]);
    }
    return finite ? BAT_OK : BAT_INVALID_POINT;
}

/// De Casteljau's algorithm with geodesics.
static bat_status geodesic_value(const spline *s, const bezier *edge, double t, double *row)
{
    bezier now = *edge;
    bat_status status = BAT_OK;
    for (size_t left = s->form->degree; left > 0; left--)
        for (size_t k = 0; k < left && status == BAT_OK; k++)
        {
            double point[BAT_SPACE_MAX_DIM];
            status = bat_space_geodesic(s->space, now.points[k], now.points[k + 1], t, point);
            memcpy(now.points[k], point, s->dim * sizeof *point);
        }
    memcpy(row, now.points[0], s->dim * sizeof *row);
    return status;
}

static void store(const spline *s, const double *row, size_t at, double *points, double *channels)
{
    size_t point_dim = s->dim - s->channel_count;
    memcpy(points + at * point_dim, row, point_dim * sizeof *row);
    if (channels != NULL)
        memcpy(channels + at * s->channel_count, row + point_dim, s->channel_count * sizeof *row);
}

/// New points begin … end - 1. On failure *fault is the edge.
static bat_status run_piece(const spline *s, size_t levels, size_t begin, size_t end, double *points, double *channels,
                            size_t *fault)
{
    bezier edge;
    size_t mask = ((size_t)1 << levels) - 1;
    bool made = false;
    for (size_t at = begin; at < end; at++)
    {
        size_t i = at >> levels, k = at & mask;
        *fault = i;
        if (k == 0)
            store(s, s->rows + i * s->dim, at, points, channels);
        made = made && k != 0;
        if (k == 0)
            continue;
        double row[BAT_SPACE_MAX_DIM], t = ldexp((double)k, -(int)levels);
        bat_status status = made ? BAT_OK : bezier_make(s, i, &edge);
        made = true;
        if (status == BAT_OK)
            status = s->euclidean ? euclidean_value(s, &edge, t, row) : geodesic_value(s, &edge, t, row);
        if (status != BAT_OK)
            return status;
        store(s, row, at, points, channels);
    }
    return BAT_OK;
}

static bat_status evaluate(const spline *s, const refine_plan *plan, double *points, double *channels, bat_error *error)
{
    const bat_curve_refine_options *options = &plan->options;
    shared_work work = shared_work_make((plan->count + PIECE - 1) / PIECE, options->progress);
    int threads = threads_for(options->threads, work.total);
#pragma omp parallel for schedule(dynamic) num_threads(threads) if (threads > 1)
    for (size_t i = 0; i < work.total; i++)
    {
        if (!shared_work_wants(&work, i))
            continue;
        bat_error own;
        size_t end = (i + 1) * PIECE < plan->count ? (i + 1) * PIECE : plan->count, fault = 0;
        bat_status status = run_piece(s, options->levels, i * PIECE, end, points, channels, &fault);
        if (status != BAT_OK)
            (void)error_point(&own, status, fault, "there is no new point after point", " (%s)", bat_status_name(status));
        shared_work_finish(&work, i, status, &own);
    }
    return shared_work_end(&work, error);
}

bat_status spline_refine(const spline_form *form, const bat_curve *coarse, const refine_plan *plan, double *points,
                         double *channels, bat_error *error)
{
    spline s = {.coarse = coarse, .scheme = &plan->options.scheme, .count = coarse->count, .form = form};
    s.channel_count = channels != NULL ? coarse->channel_count : 0;
    row_space rows;
    bat_status status = row_space_make(coarse->space, s.channel_count, &rows, error);
    if (status != BAT_OK)
        return status;
    s.space = &rows.space;
    s.euclidean = space_is_euclidean(coarse->space);
    s.dim = rows.space.point_dim;
    s.tangent_dim = rows.space.tangent_dim;
    s.edges = polygon_edges(s.count, coarse->closed);
    memory_pool pool = {0};
    s.rows = memory_pool_array(&pool, s.count, s.dim * sizeof *s.rows);
    s.derivatives = memory_pool_array(&pool, s.count, (form->degree / 2) * s.tangent_dim * sizeof *s.derivatives);
    s.increments = memory_pool_array(&pool, s.count, sizeof *s.increments);
    status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        rows_join(coarse, s.channel_count, s.rows);
        status = measure_increments(&s, error);
    }
    if (status == BAT_OK)
        status = find_derivatives(&s, &plan->options, error);
    if (status == BAT_OK)
        status = evaluate(&s, plan, points, channels, error);
    memory_pool_free(&pool);
    return status;
}

// The Catmull-Rom, the cubic and the quintic spline: the derivatives at the points.

/// A closed curve is continued by this many points on either side to solve for the velocities. The equations are
/// diagonally dominant by a factor of 2, so what lies beyond changes a velocity by less than 2^-64 of itself.
#define WRAP 64

/// The share of the increment before (side -1) or after (side 1) point i in the sum of both.
static double share(const spline *s, ptrdiff_t i, int side)
{
    double before = spline_increment(s, i - 1), after = spline_increment(s, i);
    return (side < 0 ? before : after) / (before + after);
}

/// The velocity at point i of the geodesic from the point before (side -1), or to the next point (side 1).
static bat_status slope_of(const spline *s, ptrdiff_t i, int side, double *slope)
{
    bat_status status = s->space->log(s->space, spline_row_at(s, i), spline_row_at(s, i + side), slope);
    double increment = side < 0 ? -spline_increment(s, i - 1) : spline_increment(s, i);
    for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
        slope[c] /= increment;
    return status;
}

/// sum = before times the slope before point i + after times the slope after it.
static bat_status weighted_slopes(const spline *s, ptrdiff_t i, double before, double after, double *sum)
{
    double slope[BAT_SPACE_MAX_DIM];
    bat_status status = slope_of(s, i, -1, sum);
    if (status == BAT_OK)
        status = slope_of(s, i, 1, slope);
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

/// The side of the only edge at an end of an open curve; `end` is 0 or count - 1.
static int inner_side(ptrdiff_t end)
{
    return end == 0 ? 1 : -1;
}

/// The slope of that edge.
static bat_status end_slope(const spline *s, ptrdiff_t end, double *slope)
{
    return slope_of(s, end, inner_side(end), slope);
}

/// Replace the velocity of an end by factor * slope - share * the velocity of the point beside it.
static bat_status end_velocity(const spline *s, ptrdiff_t end, double factor, double share)
{
    double *velocity = velocity_of(s, (size_t)end);
    ptrdiff_t beside = end + inner_side(end);
    bat_status status = end_slope(s, end, velocity);
    vector_scale(s->tangent_dim, factor, velocity);
    return status == BAT_OK ? add_transported(s, beside, end, -share, velocity_of(s, (size_t)beside), velocity) : status;
}

// Catmull-Rom

/// The velocity of the parabola through each point and its neighbours. At the ends of an open curve it is that of the edge,
/// as if the curve went on by point reflection, or, to extrapolate, that of the parabola through the last three points.
static bat_status find_catmull_rom(const spline *s, const bat_curve_refine_options *options, size_t *fault)
{
    bool parabola = options->ends == BAT_CURVE_END_RULE_EXTRAPOLATE;
    bat_status status = BAT_OK;
    size_t inner = s->coarse->closed ? 0 : 1;
    for (size_t i = inner; i + inner < s->count && status == BAT_OK; i++)
    {
        *fault = i;
        ptrdiff_t at = (ptrdiff_t)i;
        status = weighted_slopes(s, at, share(s, at, 1), share(s, at, -1), velocity_of(s, i));
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

/// The tridiagonal system of the velocities m_i at the points begin … end - 1. With a = share(i, 1), b = share(i, -1):
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
    double a = share(s, i, 1), b = share(s, i, -1);
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
            double lower = share(s, i, 1);
            pivot -= lower * system->upper[at - 1];
            status = add_transported(s, i - 1, i, -lower, right - s->tangent_dim, right);
        }
        system->upper[at] = share(s, i, -1) / pivot;
        for (size_t c = 0; c < s->tangent_dim && status == BAT_OK; c++)
            right[c] /= pivot;
    }
    return status;
}

static bat_status solve(const spline *s, ptrdiff_t begin, ptrdiff_t end, size_t *fault)
{
    size_t count = (size_t)(end - begin), first = begin < 0 ? (size_t)-begin : 0;
    memory_pool pool = {0};
    velocity_system system = {.begin = begin, .end = end, .not_a_knot = !s->coarse->closed};
    system.upper = memory_pool_array(&pool, count, sizeof *system.upper);
    system.right = memory_pool_array(&pool, count * s->tangent_dim, sizeof *system.right);
    bat_status status = memory_pool_check(&pool, NULL);
    if (status == BAT_OK)
        status = eliminate(s, &system, fault);
    for (ptrdiff_t i = end - 2; i >= begin && status == BAT_OK; i--) // the solution takes the place of the right sides
    {
        *fault = spline_wrapped(s, i);
        double *right = system.right + (size_t)(i - begin) * s->tangent_dim;
        status = add_transported(s, i + 1, i, -system.upper[i - begin], right + s->tangent_dim, right);
    }
    size_t wanted = s->coarse->closed ? s->count : count;
    if (status == BAT_OK)
        memcpy(velocity_of(s, s->coarse->closed ? 0 : (size_t)begin), system.right + first * s->tangent_dim,
               wanted * s->tangent_dim * sizeof *system.right);
    memory_pool_free(&pool);
    return status;
}

/// The velocity of an end whose first two cubics are one: (2 + b) slope + (b^2 next slope - m_1) / a, as at point 1.
static bat_status not_a_knot_end(const spline *s, ptrdiff_t end)
{
    double next[BAT_SPACE_MAX_DIM], *velocity = velocity_of(s, (size_t)end);
    int side = inner_side(end);
    ptrdiff_t beside = end + side;
    double near = share(s, beside, -side), far = share(s, beside, side);
    bat_status status = slope_of(s, beside, side, next);
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
        status = weighted_slopes(s, 1, share(s, 1, 1), share(s, 1, -1), velocity_of(s, 1));
    for (size_t k = 0; k < 2 && status == BAT_OK; k++)
    {
        *fault = k == 0 ? 0 : s->count - 1;
        status = s->count == 3 ? end_velocity(s, (ptrdiff_t)*fault, 1.5, 0.5)
                               : end_slope(s, (ptrdiff_t)*fault, velocity_of(s, *fault));
    }
    return status;
}

static bat_status find_cubic(const spline *s, const bat_curve_refine_options *options BAT_UNUSED, size_t *fault)
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

static void cubic_weights(double t, double *weights)
{
    double r = 1 - t;
    weights[0] = r * r * r;
    weights[1] = 3 * r * t * r;
    weights[2] = 3 * r * t * t;
    weights[3] = t * t * t;
}

const spline_form spline_catmull_rom = {3, cubic_weights, find_catmull_rom};
const spline_form spline_cubic = {3, cubic_weights, find_cubic};

// The quintic Hermite spline: Bezier curves of degree 5 from velocities and accelerations at the points, which are the
// derivatives of the polynomial through five neighbouring points (Fornberg 1988). In R^n it is C2 and reproduces
// polynomials of degree 4 at their parameters.

#define WINDOW 5 ///< points of a polynomial, where there are so many

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
static bat_status find(const spline *s, const bat_curve_refine_options *options BAT_UNUSED, size_t *fault)
{
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

const spline_form spline_quintic = {5, quintic_weights, find};

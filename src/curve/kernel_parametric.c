#include "curve/kernel.h"

#include "curve/parametric.h"
#include "space/builtin.h"

#include <string.h>

/// The four-point step of Dyn, Floater and Hormann (2009). Over the edge from p_1 to p_2, with increments d_0, d_1, d_2 of
/// the parameter between p_0, p_1, p_2, p_3, the cubic interpolant at the middle of its interval is, in Newton's form,
///
///     (p_1 + p_2) / 2 - d_1^2 / 4 [A (d_1 / 2 + d_2) + B (d_1 / 2 + d_0)] / (d_0 + d_1 + d_2)
///
/// where A and B are the second divided differences of the first and of the last three points.

typedef struct four_point_data
{
    bat_curve_parameters parameters;
    bat_curve_base base;
    double scale; ///< of the displacement: w over that of the cubic
    bool euclidean;
} four_point_data;
_Static_assert(sizeof(four_point_data) <= KERNEL_DATA, "a kernel has room for its data");

/// The displacement from the middle of the edge is (inverse[0] u_0 - u_1) weight[0] + (u_1 - inverse[1] u_2) weight[1],
/// where u_k = p_(k+1) - p_k.
typedef struct displacement
{
    double inverse[2], weight[2];
} displacement;

/// A ratio of increments within bounds whose squares and reciprocals are finite. Beyond them the interpolant is its limit up
/// to rounding, as coordinates have 53 binary digits.
static double increment_ratio(bat_curve_parameters parameters, double length, double edge)
{
    const double bound = 0x1p300;
    return fmin(fmax(parametric_increment(parameters, length / edge), 1 / bound), bound);
}

/// Of lengths l_0, l_1, l_2. Where p_0 = p_1 or p_2 = p_3, the parabola through the other three points; where p_1 = p_2,
/// none. All operations are symmetric, so that reversal changes no bit.
static displacement displacement_of(const four_point_data *data, const double *lengths)
{
    displacement d = {{0, 0}, {0, 0}};
    bool uniform = data->parameters == BAT_CURVE_PARAMETERS_UNIFORM;
    if (!uniform && !(lengths[1] > 0))
        return d;
    bool has_left = uniform || lengths[0] > 0, has_right = uniform || lengths[2] > 0;
    double a = has_left ? increment_ratio(data->parameters, lengths[0], lengths[1]) : 0;
    double b = has_right ? increment_ratio(data->parameters, lengths[2], lengths[1]) : 0;
    double factor = 0.25 * data->scale, whole = 1 + (a + b);
    if (has_left)
    {
        d.inverse[0] = 1 / a;
        d.weight[0] = factor / (1 + a) * (has_right ? (0.5 + b) / whole : 1);
    }
    if (has_right)
    {
        d.inverse[1] = 1 / b;
        d.weight[1] = factor / (1 + b) * (has_left ? (0.5 + a) / whole : 1);
    }
    return d;
}

/// The value over the edge of numbers at the four points.
static inline double value_over_edge(const displacement *d, double v0, double v1, double v2, double v3)
{
    double u0 = v1 - v0, u1 = v2 - v1, u2 = v3 - v2;
    double left = d->weight[0] * (u0 * d->inverse[0] - u1), right = d->weight[1] * (u1 - u2 * d->inverse[1]);
    return (0.5 * v1 + 0.5 * v2) + (left + right);
}

/// `count` coordinates of rows that lie `stride` numbers apart; p is that of p_1.
static bat_status insert_numbers(const displacement *d, const double *p, size_t stride, size_t count, double *fine)
{
    const double *before = p - stride, *next = p + stride, *last = p + 2 * stride;
    bool finite = true;
    for (size_t c = 0; c < count; c++)
    {
        fine[c] = value_over_edge(d, before[c], p[c], next[c], last[c]);
        finite = finite && isfinite(fine[c]);
    }
    return finite ? BAT_OK : BAT_INVALID_POINT;
}

/// The same of the logarithms of four points, which lie `stride` numbers apart.
static bat_status insert_point(const bat_space *space, const displacement *d, bat_curve_base where, const double *p,
                               size_t stride, double *fine)
{
    double middle[BAT_SPACE_MAX_DIM], tangents[4][BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    const double *base = p;
    bat_status status = BAT_OK;
    if (where == BAT_CURVE_BASE_MIDPOINT)
    {
        status = bat_space_geodesic(space, p, p + stride, 0.5, middle);
        base = middle;
    }
    for (size_t k = 0; k < 4 && status == BAT_OK; k++)
        if (k == 1 && base == p)
            memset(tangents[k], 0, space->tangent_dim * sizeof tangents[k][0]);
        else
            status = space->log(space, base, p + ((ptrdiff_t)k - 1) * (ptrdiff_t)stride, tangents[k]);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < space->tangent_dim; i++)
        sum[i] = value_over_edge(d, tangents[0][i], tangents[1][i], tangents[2][i], tangents[3][i]);
    return space->exp(space, base, sum, fine);
}

static bat_status run(const refine_kernel *kernel, const double *points, size_t pairs, double *fine,
                      void *scratch BAT_UNUSED, size_t *fault)
{
    const four_point_data *data = kernel_data_of(kernel);
    const bat_space *space = kernel->space;
    bool uniform = data->parameters == BAT_CURVE_PARAMETERS_UNIFORM;
    size_t dim = kernel->dim, point_dim = space->point_dim;
    double lengths[3] = {0, 0, 0};
    if (!uniform && pairs > 0)
    {
        lengths[1] = space->distance(space, points - dim, points);
        lengths[2] = space->distance(space, points, points + dim);
    }
    bat_status status = BAT_OK;
    for (size_t j = 0; j < pairs && status == BAT_OK; j++)
    {
        const double *p = points + j * dim;
        double *made = fine + (2 * j + 1) * dim;
        *fault = j;
        lengths[0] = lengths[1];
        lengths[1] = lengths[2];
        lengths[2] = uniform ? 0 : space->distance(space, p + dim, p + 2 * dim);
        displacement d = displacement_of(data, lengths);
        memcpy(fine + 2 * j * dim, p, dim * sizeof *p);
        status = data->euclidean ? insert_numbers(&d, p, dim, dim, made) : insert_point(space, &d, data->base, p, dim, made);
        if (status == BAT_OK && !data->euclidean && dim > point_dim)
            status = insert_numbers(&d, p + point_dim, dim, dim - point_dim, made + point_dim);
    }
    return status;
}

refine_kernel kernel_four_point(const bat_space *space, size_t channel_count, const bat_curve_scheme *scheme)
{
    refine_kernel kernel = {.space = space, .dim = space->point_dim + channel_count, .first = -3, .last = 3, .run = run};
    four_point_data *data = kernel_data(&kernel);
    *data = (four_point_data){
        .parameters = scheme->parameters,
        .base = scheme->base,
        .scale = scheme->tension / BAT_MASK_FOUR_POINT_WEIGHT,
        .euclidean = space_is_euclidean(space),
    };
    return kernel;
}

#include "motion/hermite_average.h"

#include "space/builtin.h"

#include <string.h>

static void scale_into(size_t n, double factor, const double *vector, double *scaled)
{
    for (size_t i = 0; i < n; i++)
        scaled[i] = factor * vector[i];
}

/// Divide one block into vectors of n numbers. Separate arrays of the maximum length would share lines of the cache.
static void lay_out(double *block, size_t n, size_t count, double **vectors)
{
    for (size_t i = 0; i < count; i++)
        vectors[i] = block + i * n;
}

static size_t widest(const bat_space *space)
{
    return space->point_dim > space->tangent_dim ? space->point_dim : space->tangent_dim;
}

/// The length of a tangent vector at p, which leads to q. Where its square loses digits, their distance is more accurate.
static double length_of_log(const bat_space *space, const double *p, const double *q, const double *log)
{
    const double minimum = 1e-280, maximum = 1e280;
    double squared = space->inner(space, p, log, log);
    return squared > minimum && squared < maximum ? sqrt(squared) : space->distance(space, p, q);
}

/// |u + sign v| for tangent vectors at p.
static double length_of_sum(const bat_space *space, const double *p, const double *u, const double *v, double sign)
{
    double sum[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
        sum[i] = u[i] + sign * v[i];
    return sqrt(fmax(space->inner(space, p, sum, sum), 0));
}

/// Sine and cosine of half the angle between two unit vectors, by the lengths of difference and sum, accurately.
static void half_angle(const bat_space *space, const double *point, const double *u, const double *v, double *sine,
                       double *cosine)
{
    *sine = 0.5 * length_of_sum(space, point, u, v, -1);
    *cosine = 0.5 * length_of_sum(space, point, u, v, 1);
}

bat_status hermite_edge_measure(const bat_space *space, const double *p0, const double *v0, const double *p1,
                                const double *v1, hermite_edge *edge)
{
    const double min_cosine = cos(0.5 * BAT_HERMITE_ANGLE_LIMIT);
    double block[2 * BAT_SPACE_MAX_DIM], *along[2], sine[2], cosine[2];
    size_t n = space->tangent_dim;
    lay_out(block, n, 2, along);
    *edge = (hermite_edge){0};
    bat_status status = space->log(space, p0, p1, along[0]);
    if (status == BAT_OK)
        status = space->log(space, p1, p0, along[1]);
    if (status != BAT_OK)
        return status;
    edge->length = length_of_log(space, p0, p1, along[0]);
    if (!(edge->length > 0))
        return BAT_INVALID_POINT;
    scale_into(n, 1 / edge->length, along[0], along[0]);
    scale_into(n, -1 / edge->length, along[1], along[1]);
    half_angle(space, p0, v0, along[0], &sine[0], &cosine[0]);
    half_angle(space, p1, v1, along[1], &sine[1], &cosine[1]);
    edge->half_turn_cosine = cosine[0] * cosine[1] - sine[0] * sine[1];
    // 3 cos^2(x / 4) = 3 (1 + cos(x / 2)) / 2
    edge->reach = 2 * edge->length / (3 * (1 + edge->half_turn_cosine));
    return edge->half_turn_cosine >= min_cosine ? BAT_OK : BAT_INVALID_POINT;
}

/// Whether the tangents that lead to the inner control points may pass the cut locus.
typedef enum legs_kind
{
    LEGS_ANY,   ///< the control points are joined by shortest geodesics, as algorithm 3 says
    LEGS_WITHIN ///< they do not: exponentials of parts of them lie on the shortest geodesics, and cost less
} legs_kind;

/// The point at share `weight` of a leg from p to the control point exp(p, u).
static bat_status leg_point(const bat_space *space, const double *p, const double *u, const double *control, double weight,
                            legs_kind legs, double *tangent, double *point)
{
    if (legs == LEGS_ANY)
        return bat_space_geodesic(space, p, control, weight, point);
    scale_into(space->tangent_dim, weight, u, tangent);
    return space->exp(space, p, tangent, point);
}

/// Algorithm 3, steps 2 to 4: the points between which the last geodesic runs, of the De Casteljau cubic with inner control
/// points exp(p0, u0) and exp(p1, -u1). Within the cut locus only the middle point of the first round needs a logarithm.
/// @return BAT_OK, BAT_CUT_LOCUS or BAT_INVALID_POINT
static bat_status cubic_ends(const bat_space *space, const double *p0, const double *u0, const double *p1, const double *u1,
                             double weight, legs_kind legs, double *before, double *after)
{
    double block[7 * BAT_SPACE_MAX_DIM], *vectors[7];
    lay_out(block, widest(space), 7, vectors);
    double *tangent = vectors[0], *back = vectors[1], **control = vectors + 2, **first = vectors + 4;
    scale_into(space->tangent_dim, -1, u1, back);
    bat_status status = space->exp(space, p0, u0, control[0]);
    if (status == BAT_OK)
        status = space->exp(space, p1, back, control[1]);
    if (status == BAT_OK)
        status = leg_point(space, p0, u0, control[0], weight, legs, tangent, first[0]);
    if (status == BAT_OK)
        status = leg_point(space, p1, back, control[1], 1 - weight, legs, tangent, first[2]);
    if (status == BAT_OK)
        status = bat_space_geodesic(space, control[0], control[1], weight, first[1]);
    if (status == BAT_OK)
        status = bat_space_geodesic(space, first[0], first[1], weight, before);
    return status == BAT_OK ? bat_space_geodesic(space, first[1], first[2], weight, after) : status;
}

/// The point at share `weight` of the geodesic from a to b, and the unit velocity there: the way on to b, or back to a where
/// that is farther. Step 7 of algorithm 3 always takes the direction to b and loses digits near b.
static bat_status last_geodesic(const bat_space *space, const double *a, const double *b, double weight, double *point,
                                double *direction)
{
    bool onward = weight <= 0.5;
    const double *end = onward ? b : a;
    bat_status status = bat_space_geodesic(space, a, b, weight, point);
    if (status == BAT_OK)
        status = space->log(space, point, end, direction);
    if (status != BAT_OK)
        return status;
    double length = length_of_log(space, point, end, direction);
    scale_into(space->tangent_dim, (onward ? 1 : -1) / length, direction, direction);
    // Where squares lose digits the length was the distance; make the vector's own length 1.
    double unit = sqrt(space->inner(space, point, direction, direction));
    scale_into(space->tangent_dim, 1 / unit, direction, direction);
    return isfinite(unit) && unit > 0 ? BAT_OK : BAT_INVALID_POINT;
}

bat_status hermite_average(const bat_space *space, const double *p0, const double *v0, const double *p1, const double *v1,
                           double weight, double *point, double *direction)
{
    double block[4 * BAT_SPACE_MAX_DIM], *vectors[4];
    hermite_edge edge;
    bat_status status = hermite_edge_measure(space, p0, v0, p1, v1, &edge);
    if (status != BAT_OK)
        return status;
    lay_out(block, widest(space), 4, vectors);
    double **u = vectors, **ends = vectors + 2;
    scale_into(space->tangent_dim, edge.reach, v0, u[0]);
    scale_into(space->tangent_dim, edge.reach, v1, u[1]);
    legs_kind legs = edge.reach < space->injectivity ? LEGS_WITHIN : LEGS_ANY;
    status = cubic_ends(space, p0, u[0], p1, u[1], weight, legs, ends[0], ends[1]);
    return status == BAT_OK ? last_geodesic(space, ends[0], ends[1], weight, point, direction) : status;
}

/// The average of two rows at 1/2, with the mean of their times.
static bat_status average_row(const refine_kernel *kernel, const double *a, const double *b, double *average)
{
    const bat_space *space = kernel->space;
    size_t n = space->point_dim, width = n + space->tangent_dim;
    double made[2 * BAT_SPACE_MAX_DIM];
    bat_status status = hermite_average(space, a, a + n, b, b + n, 0.5, made, made + n);
    if (width < kernel->dim)
        average[width] = 0.5 * (a[width] + b[width]);
    memcpy(average, made, width * sizeof *average);
    return status;
}

bat_status hermite_row_average(const refine_kernel *kernel, const double *rows, size_t count, double *averages,
                               size_t stride, size_t *fault)
{
    for (size_t i = 0; i < count; i++)
    {
        const double *row = rows + i * kernel->dim;
        bat_status status = average_row(kernel, row, row + kernel->dim, averages + i * stride);
        if (status != BAT_OK)
        {
            *fault = i;
            return status;
        }
    }
    return BAT_OK;
}

#include "base/error.h"
#include "base/memory.h"
#include "motion/hermite_average.h"
#include "space/builtin.h"

#include <string.h>

#define HIGHEST_ORDER 4

/// The data that the estimates at all points share.
typedef struct estimate
{
    bat_hermite_curve *curve;
    size_t degree;   ///< of the polynomials
    double *lengths; ///< of the edges, in the curve's parameter; a closed curve's last edge ends at point 0
    size_t edges;
} estimate;

static size_t end_of_edge(const bat_hermite_curve *curve, size_t edge)
{
    return edge + 1 == curve->count ? 0 : edge + 1;
}

/// The parameter of the point `offset` steps away, relative to point `index`; negative before it.
static double parameter_of(const estimate *e, size_t index, ptrdiff_t offset)
{
    double sum = 0;
    for (ptrdiff_t step = 0; step < offset; step++)
        sum += e->lengths[(index + (size_t)step) % e->edges];
    for (ptrdiff_t step = offset; step < 0; step++)
        sum -= e->lengths[(index + e->edges - (size_t)-step) % e->edges];
    return sum;
}

/// The first of degree + 1 consecutive points about one, as an offset from it.
static ptrdiff_t window_begin(const estimate *e, size_t index)
{
    size_t before = e->degree / 2, count = e->curve->count;
    if (e->curve->closed)
        return -(ptrdiff_t)before;
    before = before > index ? index : before;
    size_t after = e->degree - before, room = count - 1 - index;
    return after > room ? -(ptrdiff_t)(e->degree - room) : -(ptrdiff_t)before;
}

static size_t neighbour_of(const bat_hermite_curve *curve, size_t index, ptrdiff_t offset)
{
    return (size_t)((ptrdiff_t)index + offset + (ptrdiff_t)curve->count) % curve->count;
}

/// Sum the logarithms from point to point, each transported back to point `index`: an approximation of the logarithm where
/// the points wind around the space.
static bat_status add_ways(const bat_hermite_curve *curve, size_t index, ptrdiff_t offset, double *sum)
{
    const bat_space *space = curve->space;
    double step[BAT_SPACE_MAX_DIM], brought[BAT_SPACE_MAX_DIM];
    ptrdiff_t direction = offset < 0 ? -1 : 1;
    memset(sum, 0, space->tangent_dim * sizeof *sum);
    for (ptrdiff_t at = offset; at != 0; at -= direction)
    {
        const double *here = hermite_point(curve, neighbour_of(curve, index, at));
        const double *before = hermite_point(curve, neighbour_of(curve, index, at - direction));
        bat_status status = space->log(space, before, here, step);
        if (status == BAT_OK)
            status = space->transport(space, here, before, sum, brought);
        if (status != BAT_OK)
            return status;
        for (size_t i = 0; i < space->tangent_dim; i++)
            sum[i] = step[i] + brought[i];
    }
    return BAT_OK;
}

/// The logarithm of a neighbour, or the sum of the logarithms on the path to it where the points do not follow the shortest
/// geodesic: two turns by 100 degrees are not one by -160.
static bat_status way_to(const bat_hermite_curve *curve, size_t index, ptrdiff_t offset, double *way)
{
    const bat_space *space = curve->space;
    const double *p = hermite_point(curve, index);
    double direct[BAT_SPACE_MAX_DIM], difference[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, hermite_point(curve, neighbour_of(curve, index, offset)), direct);
    bool far_off = offset > 1 || offset < -1;
    if (far_off && isfinite(space->injectivity))
    {
        bat_status summed = add_ways(curve, index, offset, way);
        for (size_t i = 0; i < space->tangent_dim; i++)
            difference[i] = summed == BAT_OK && status == BAT_OK ? direct[i] - way[i] : 0;
        double half = space->injectivity / 2;
        if (summed == BAT_OK && (status != BAT_OK || space->inner(space, p, difference, difference) > half * half))
            return BAT_OK;
    }
    if (status == BAT_OK)
        memcpy(way, direct, space->tangent_dim * sizeof *way);
    return status;
}

/// The derivative at 0 of the polynomial that is 0 there and takes the neighbours' logarithms at their parameters: that of
/// the Lagrange polynomial of neighbour j is prod t_k / (t_k - t_j) / t_j over the others k.
static bat_status estimate_at(const estimate *e, size_t index, bat_error *error)
{
    const bat_hermite_curve *curve = e->curve;
    const bat_space *space = curve->space;
    double parameters[HIGHEST_ORDER + 1], log[BAT_SPACE_MAX_DIM], *tangent = hermite_tangent(curve, index);
    ptrdiff_t begin = window_begin(e, index);
    for (size_t j = 0; j <= e->degree; j++)
        parameters[j] = parameter_of(e, index, begin + (ptrdiff_t)j);
    memset(tangent, 0, space->tangent_dim * sizeof *tangent);
    for (size_t j = 0; j <= e->degree; j++)
    {
        ptrdiff_t offset = begin + (ptrdiff_t)j;
        if (offset == 0)
            continue;
        double weight = 1 / parameters[j];
        for (size_t k = 0; k <= e->degree; k++)
            if (k != j && begin + (ptrdiff_t)k != 0)
                weight *= parameters[k] / (parameters[k] - parameters[j]);
        bat_status status = way_to(curve, index, offset, log);
        if (status != BAT_OK)
            return error_set(error, status, index, 0, "no tangent at point %zu: its way to point %zu is not unique", index,
                             neighbour_of(curve, index, offset));
        vector_add(space->tangent_dim, weight, log, tangent);
    }
    if (!vector_is_finite(space->tangent_dim, tangent))
        return error_set(error, BAT_INVALID_POINT, index, 0, "the tangent at point %zu is too large for doubles", index);
    return BAT_OK;
}

static bat_status estimate_all(const estimate *e, bool directions, bat_error *error)
{
    bat_status status = BAT_OK;
    for (size_t i = 0; i < e->curve->count && status == BAT_OK; i++)
        status = estimate_at(e, i, error);
    return directions && status == BAT_OK ? bat_hermite_normalize(e->curve, error) : status;
}

/// The lengths of edges in time, or without times the chords.
static bat_status measure_edges(estimate *e, bat_error *error)
{
    const bat_hermite_curve *curve = e->curve;
    for (size_t i = 0; i < e->edges; i++)
    {
        size_t next = end_of_edge(curve, i);
        e->lengths[i] = curve->times == NULL
                            ? curve->space->distance(curve->space, hermite_point(curve, i), hermite_point(curve, next))
                        : next == 0 ? curve->closing_time
                                    : curve->times[next] - curve->times[i];
        if (isfinite(e->lengths[i]) && e->lengths[i] > 0)
            continue;
        return curve->times == NULL ? error_set(error, BAT_INVALID_POINT, next, 0, "point %zu repeats point %zu", next, i)
                                    : error_set(error, BAT_INVALID_POINT, i, 0, "no time passes after point %zu", i);
    }
    return BAT_OK;
}

/// From chords to arcs. An arc whose tangents make the angle x with its chord is 1 + x^2 / 6 times as long, up to higher
/// powers of x; so is 1 + (1 - cos x) / 3, which stays small at corners.
static bat_status lengthen_chords(estimate *e, bat_error *error)
{
    const bat_hermite_curve *curve = e->curve;
    for (size_t i = 0; i < e->edges; i++)
    {
        size_t next = end_of_edge(curve, i);
        hermite_edge edge;
        bat_status status = hermite_edge_measure(curve->space, hermite_point(curve, i), hermite_tangent(curve, i),
                                                 hermite_point(curve, next), hermite_tangent(curve, next), &edge);
        if (status == BAT_CUT_LOCUS)
            return error_set(error, status, next, 0, "points %zu and %zu have no unique shortest geodesic", i, next);
        e->lengths[i] *= 1 + (1 - edge.half_turn_cosine) / 3;
    }
    return BAT_OK;
}

/// The degree that the points allow. Around a closed curve as many neighbours lie before a point as after it.
static size_t degree_for(const bat_hermite_curve *curve, size_t order)
{
    size_t most = curve->count - 1;
    if (curve->closed)
        most -= most % 2;
    return order < most ? order : most;
}

/// Directions of order 4 begin with those of order 2, which tell the lengths of arcs.
static bat_status estimate_tangents(estimate *e, size_t order, bat_error *error)
{
    bool timed = e->curve->times != NULL;
    e->degree = degree_for(e->curve, timed ? order : 2);
    bat_status status = measure_edges(e, error);
    if (status == BAT_OK)
        status = estimate_all(e, !timed, error);
    if (timed || order == 2 || status != BAT_OK)
        return status;
    e->degree = degree_for(e->curve, order);
    status = lengthen_chords(e, error);
    return status == BAT_OK ? estimate_all(e, true, error) : status;
}

bat_status bat_hermite_estimate_tangents(bat_hermite_curve *curve, size_t order, bat_error *error)
{
    if (order != 2 && order != HIGHEST_ORDER)
        return ERROR_ARGUMENT(error, "tangents are estimated with order 2 or 4, not %zu", order);
    bat_status status = space_check_complete(curve->space, error);
    if (status == BAT_OK)
        status = hermite_check_counts(curve, error);
    if (status == BAT_OK)
        status = bat_space_check(curve->space, curve->points, curve->count, error);
    if (status != BAT_OK)
        return status;
    estimate e = {.curve = curve, .edges = curve->closed ? curve->count : curve->count - 1};
    if (array_make(&e.lengths, e.edges, sizeof *e.lengths, error) != BAT_OK)
        return BAT_NO_MEMORY;
    status = estimate_tangents(&e, order, error);
    free(e.lengths);
    if (status == BAT_OK)
        curve->kind = curve->times != NULL ? BAT_HERMITE_TANGENTS_VELOCITIES : BAT_HERMITE_TANGENTS_DIRECTIONS;
    return status;
}

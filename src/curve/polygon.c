#include "curve/polygon.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

enum
{
    CUBIC_DEGREE = 3
};

/// The point reflection of q in the centre. A point at the cut locus is its own image: the two geodesics of length pi to
/// it from the centre of a symmetric space are exchanged.
static bat_status reflect(const bat_space *space, const double *centre, const double *q, double *image)
{
    double tangent[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, centre, q, tangent);
    if (status == BAT_CUT_LOCUS)
    {
        memcpy(image, q, space->point_dim * sizeof *q);
        return BAT_OK;
    }
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] = -tangent[i];
    return space->exp(space, centre, tangent, image);
}

/// The mirror image of q in the perpendicular bisector of the edge from p to next.
static bat_status mirror(const bat_space *space, const double *p, const double *next, const double *q, double *image)
{
    double middle[BAT_SPACE_MAX_DIM], edge[BAT_SPACE_MAX_DIM], tangent[BAT_SPACE_MAX_DIM];
    bat_status status = bat_space_geodesic(space, p, next, 0.5, middle);
    if (status == BAT_OK)
        status = space->log(space, middle, next, edge);
    if (status == BAT_OK)
        status = space->log(space, middle, q, tangent);
    if (status != BAT_OK)
        return status;
    double factor = 2 * space->inner(space, middle, tangent, edge) / space->inner(space, middle, edge, edge);
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] -= factor * edge[i];
    return space->exp(space, middle, tangent, image);
}

/// The value at -distance of the polynomial through the points at 0, step, 2 step, … rows from `end`, in its tangent space.
static bat_status extrapolate(const bat_space *space, const double *end, ptrdiff_t step, size_t degree, double distance,
                              double *image)
{
    double tangent[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    memset(sum, 0, space->tangent_dim * sizeof *sum);
    for (size_t node = 1; node <= degree; node++)
    {
        double weight = 1;
        for (size_t other = 0; other <= degree; other++)
            if (other != node)
                weight *= (-distance - (double)other) / ((double)node - (double)other);
        bat_status status = space->log(space, end, end + (ptrdiff_t)node * step, tangent);
        if (status != BAT_OK)
            return status;
        for (size_t i = 0; i < space->tangent_dim; i++)
            sum[i] += weight * tangent[i];
    }
    return space->exp(space, end, sum, image);
}

/// The point `distance` steps beyond `end`; the polygon's other points lie at multiples of `step` from it.
static bat_status point_beyond(const bat_space *space, polygon_end rule, const double *end, ptrdiff_t step, size_t count,
                               size_t distance, double *image)
{
    switch (rule)
    {
    case POLYGON_END_LINE:
        return extrapolate(space, end, step, 1, (double)distance, image);
    case POLYGON_END_CUBIC:
        return extrapolate(space, end, step, count > CUBIC_DEGREE ? CUBIC_DEGREE : count - 1, (double)distance, image);
    case POLYGON_END_MIRROR:
        if (count > 2)
            return mirror(space, end, end + step, end + (ptrdiff_t)(distance + 1) * step, image);
        return reflect(space, end, end + (ptrdiff_t)distance * step, image);
    case POLYGON_END_REFLECT:
    default:
        return reflect(space, end, end + (ptrdiff_t)distance * step, image);
    }
}

static void wrap(double *points, size_t count, size_t dim, size_t before, size_t after)
{
    for (size_t i = 0; i < after; i++)
        memcpy(points + (count + i) * dim, points + (i % count) * dim, dim * sizeof *points);
    for (size_t i = 1; i <= before; i++)
        memcpy(points - i * dim, points + (count - 1 - (i - 1) % count) * dim, dim * sizeof *points);
}

bat_status polygon_extend(const bat_space *space, double *points, size_t count, bool closed, polygon_end end, size_t before,
                          size_t after, bat_error *error)
{
    size_t dim = space->point_dim;
    if (closed)
    {
        wrap(points, count, dim, before, after);
        return BAT_OK;
    }
    double *last = points + (count - 1) * dim;
    // Both sides in step: a short polygon's far points on one side are made from new points on the other.
    ptrdiff_t step = (ptrdiff_t)dim;
    for (size_t distance = 1; distance <= before || distance <= after; distance++)
    {
        bat_status status = BAT_OK;
        size_t at = 0;
        if (distance <= before)
            status = point_beyond(space, end, points, step, count, distance, points - (ptrdiff_t)distance * step);
        if (status == BAT_OK && distance <= after)
        {
            at = count - 1;
            status = point_beyond(space, end, last, -step, count, distance, last + (ptrdiff_t)distance * step);
        }
        if (status != BAT_OK)
            return error_set(error, status, at, 0, "the open curve cannot be continued beyond its end point %zu (%s)", at,
                             bat_status_name(status));
    }
    return BAT_OK;
}

#include "curve/polygon.h"

#include "base/error.h"
#include "space/builtin.h"

#include <float.h>
#include <string.h>

#define CUBIC_DEGREE 3

/// The point reflection of q in the centre. A point at the cut locus is its own image: the two geodesics of length pi to
/// it from the centre of a symmetric space are exchanged.
static bat_status reflect(const bat_space *space, const double *centre, const double *q, double *image)
{
    bat_status status = space_geodesic(space, centre, q, -1, image);
    if (status != BAT_CUT_LOCUS)
        return status;
    memcpy(image, q, space->point_dim * sizeof *q);
    return BAT_OK;
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
    vector_add(space->tangent_dim, -factor, edge, tangent);
    return space->exp(space, middle, tangent, image);
}

/// A tangent vector at p brought to length 1; by a power of two first, so that its square stays in range.
static void make_unit(const bat_space *space, const double *p, double *tangent)
{
    int exponent;
    (void)frexp(vector_largest(space->tangent_dim, tangent), &exponent);
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] = ldexp(tangent[i], -exponent);
    double length = sqrt(space->inner(space, p, tangent, tangent));
    for (size_t i = 0; i < space->tangent_dim; i++)
        tangent[i] /= length;
}

/// The angle between two unit vectors at p, by half angles (Kahan 2006): exact near 0 and near pi.
static double angle_between(const bat_space *space, const double *p, const double *u, const double *v)
{
    double difference[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    for (size_t i = 0; i < space->tangent_dim; i++)
    {
        difference[i] = u[i] - v[i];
        sum[i] = u[i] + v[i];
    }
    return 2 * atan2(sqrt(space->inner(space, p, difference, difference)), sqrt(space->inner(space, p, sum, sum)));
}

bat_status polygon_edge_point(const bat_space *space, const double *p, const double *q, size_t k, size_t parts,
                              double *point)
{
    bool from_q = 2 * k > parts;
    double share = (double)(from_q ? parts - k : k) / (double)parts;
    return bat_space_geodesic(space, from_q ? q : p, from_q ? p : q, share, point);
}

bat_status polygon_exterior_angle(const bat_space *space, const double *before, const double *p, const double *after,
                                  double *angle)
{
    double back[BAT_SPACE_MAX_DIM], forth[BAT_SPACE_MAX_DIM];
    bat_status status = space->log(space, p, before, back);
    if (status == BAT_OK)
        status = space->log(space, p, after, forth);
    if (status != BAT_OK)
        return status;
    vector_scale(space->tangent_dim, -1, back);
    make_unit(space, p, back);
    make_unit(space, p, forth);
    *angle = angle_between(space, p, back, forth);
    return BAT_OK;
}

bat_status polygon_value_beyond(const bat_space *space, const double *end, ptrdiff_t step, const double *knots,
                                size_t degree, double at, double *row)
{
    double tangent[BAT_SPACE_MAX_DIM], sum[BAT_SPACE_MAX_DIM];
    memset(sum, 0, space->tangent_dim * sizeof *sum);
    for (size_t node = 1; node <= degree; node++)
    {
        double weight = 1;
        for (size_t other = 0; other <= degree; other++)
            if (other != node)
                weight *= (-at - knots[other]) / (knots[node] - knots[other]);
        bat_status status = space->log(space, end, end + (ptrdiff_t)node * step, tangent);
        if (status != BAT_OK)
            return status;
        vector_add(space->tangent_dim, weight, tangent, sum);
    }
    return space->exp(space, end, sum, row);
}

/// The point `distance` steps beyond `end`; the polygon's other points lie at multiples of `step` from it.
static bat_status point_beyond(const bat_space *space, polygon_end rule, const double *end, ptrdiff_t step, size_t count,
                               size_t distance, double *image)
{
    static const double EVEN[CUBIC_DEGREE + 1] = {0, 1, 2, 3};
    if (rule == POLYGON_END_LINE)
        return polygon_value_beyond(space, end, step, EVEN, 1, (double)distance, image);
    if (rule == POLYGON_END_CUBIC)
        return polygon_value_beyond(space, end, step, EVEN, count > CUBIC_DEGREE ? CUBIC_DEGREE : count - 1,
                                    (double)distance, image);
    if (rule == POLYGON_END_MIRROR && count > 2)
        return mirror(space, end, end + step, end + (ptrdiff_t)(distance + 1) * step, image);
    return reflect(space, end, end + (ptrdiff_t)distance * step, image);
}

/// Farther points only tell how a polygon was sampled. Where the space ends before them, the polygon goes back.
static const int NEAR_POINTS = 8;

/// point_beyond(), or from NEAR_POINTS on the way back where the space has no such point.
static bat_status continue_by(const bat_space *space, polygon_end rule, double *end, ptrdiff_t step, size_t count,
                              size_t distance)
{
    double *image = end - (ptrdiff_t)distance * step;
    bat_status status = point_beyond(space, rule, end, step, count, distance, image);
    if (status == BAT_OK || distance <= NEAR_POINTS)
        return status;
    memcpy(image, image + 2 * step, space->point_dim * sizeof *image);
    return BAT_OK;
}

bat_status polygon_extend(const bat_space *space, double *points, size_t count, bool closed, polygon_end end, size_t before,
                          size_t after, bat_error *error)
{
    size_t dim = space->point_dim;
    if (closed)
    {
        for (size_t i = 0; i < after; i++)
            memcpy(points + (count + i) * dim, points + (i % count) * dim, dim * sizeof *points);
        for (size_t i = 1; i <= before; i++)
            memcpy(points - i * dim, points + (count - 1 - (i - 1) % count) * dim, dim * sizeof *points);
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
            status = continue_by(space, end, points, step, count, distance);
        if (status == BAT_OK && distance <= after)
        {
            at = count - 1;
            status = continue_by(space, end, last, -step, count, distance);
        }
        if (status != BAT_OK)
            return error_point(error, status, at, "the open curve cannot be continued beyond its end point", " (%s)",
                               bat_status_name(status));
    }
    return BAT_OK;
}

static double flat_distance(size_t dim, const double *p, const double *q, const double *point)
{
    double along = 0, square = 0, distance = 0;
    for (size_t c = 0; c < dim; c++)
    {
        along += (point[c] - p[c]) * (q[c] - p[c]);
        square += (q[c] - p[c]) * (q[c] - p[c]);
    }
    double share = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
    for (size_t c = 0; c < dim; c++)
    {
        double off = point[c] - p[c] - share * (q[c] - p[c]);
        distance += off * off;
    }
    return sqrt(distance);
}

/// The angle between unit vectors that differ by a vector.
static double angle_of(const double *difference)
{
    return 2 * asin(fmin(sqrt(vector3_dot(difference, difference)) / 2, 1));
}

static double sphere_distance(const double *p, const double *q, const double *point)
{
    double edge[3], from_p[3], from_q[3], normal[3], inwards[3];
    for (int c = 0; c < 3; c++)
    {
        edge[c] = q[c] - p[c];
        from_p[c] = point[c] - p[c];
        from_q[c] = point[c] - q[c];
    }
    vector3_cross(p, edge, normal);
    double square = vector3_dot(normal, normal);
    vector3_cross(normal, p, inwards);
    bool inside = square > 0 && vector3_dot(inwards, from_p) > 0;
    vector3_cross(q, normal, inwards);
    if (inside && vector3_dot(inwards, from_q) > 0)
        return asin(fmin(fabs(vector3_dot(normal, from_p)) / sqrt(square), 1));
    return fmin(angle_of(from_p), angle_of(from_q));
}

edge_geometry polygon_geometry_of(const bat_space *space)
{
    return space_is_euclidean(space) ? GEOMETRY_FLAT : space_is_sphere(space) ? GEOMETRY_SPHERE : GEOMETRY_ANY;
}

double polygon_edge_distance(const bat_space *space, edge_geometry geometry, const double *p, const double *q,
                             const double *point)
{
    double edge[BAT_SPACE_MAX_DIM], way[BAT_SPACE_MAX_DIM], foot[BAT_SPACE_MAX_DIM];
    if (geometry == GEOMETRY_FLAT)
        return flat_distance(space->point_dim, p, q, point);
    if (geometry == GEOMETRY_SPHERE)
        return sphere_distance(p, q, point);
    double nearer = fmin(space->distance(space, p, point), space->distance(space, q, point));
    if (!(nearer > 0) || space->log(space, p, q, edge) != BAT_OK || space->log(space, p, point, way) != BAT_OK)
        return nearer;
    double square = space->inner(space, p, edge, edge);
    double share = square > 0 ? space->inner(space, p, edge, way) / square : 0;
    if (!(share > 0 && share < 1) || bat_space_geodesic(space, p, q, share, foot) != BAT_OK)
        return nearer;
    return fmin(nearer, space->distance(space, foot, point));
}

bat_status coordinates_check(const bat_curve *curve, const char *which, bat_error *error)
{
    size_t dim = curve->space->point_dim;
    for (size_t i = 0; i < curve->count * dim; i++)
        if (!(fabs(curve->points[i]) <= DBL_MAX / 2))
            return error_set(error, BAT_INVALID_POINT, i / dim, 0, "point %zu of the %s curve %s", i / dim, which,
                             isfinite(curve->points[i]) ? "has a coordinate beyond 8.9e307" : "is not finite");
    return BAT_OK;
}

/// @file
/// Delaunay stars and shape-preserving weights; see weights.h.
///
/// Inversion p -> p / |p|^2 maps circles through the origin to lines. The empty circumcircles of the triangles at the origin
/// therefore become the supporting lines of the convex hull of the inverted points. The hull is computed by gift wrapping
/// (Jarvis, 1973).

#include "surface/parameterize/weights.h"

#include "linalg/vector.h"
#include "surface/cloud/delaunay.h"

#include <string.h>

/// Corners of the hull within this sine of a straight line are omitted.
static const double COLLINEAR = 1e-12;
/// Points are at the origin when their squared distance is below this fraction of the largest one.
static const double COINCIDENT = 1e-24;

static double cross(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/// Invert the points, scaled by the largest squared distance. Returns the index of the longest inverse, SIZE_MAX for none.
static size_t invert(const double (*planar)[2], size_t count, double (*inverse)[2])
{
    double farthest = 0, best = 0;
    size_t first = SIZE_MAX;
    for (size_t k = 0; k < count; k++)
        farthest = fmax(farthest, planar[k][0] * planar[k][0] + planar[k][1] * planar[k][1]);
    for (size_t k = 0; k < count; k++)
    {
        double square = planar[k][0] * planar[k][0] + planar[k][1] * planar[k][1];
        bool apart = square > COINCIDENT * farthest;
        // A zero inverse is never a corner.
        inverse[k][0] = apart ? planar[k][0] / square * farthest : 0;
        inverse[k][1] = apart ? planar[k][1] / square * farthest : 0;
        if (apart && farthest / square > best)
        {
            best = farthest / square;
            first = k;
        }
    }
    return first;
}

/// Whether `other` is clockwise from `direction`; for collinear directions, whether it is longer.
static bool is_further_clockwise(const double direction[2], const double other[2])
{
    double turn = cross(direction, other), length = direction[0] * direction[0] + direction[1] * direction[1];
    double other_length = other[0] * other[0] + other[1] * other[1];
    return turn * turn > COLLINEAR * COLLINEAR * length * other_length ? turn < 0 : other_length > length;
}

/// The corner after `from` of the convex hull of the origin and the points. SIZE_MAX stands for the origin.
static size_t next_corner(const double (*points)[2], size_t count, size_t from)
{
    static const double ORIGIN[2] = {0, 0};
    const double *at = from == SIZE_MAX ? ORIGIN : points[from];
    size_t next = SIZE_MAX;
    double direction[2] = {-at[0], -at[1]};
    for (size_t k = 0; k < count; k++)
    {
        double other[2] = {points[k][0] - at[0], points[k][1] - at[1]};
        if ((other[0] == 0 && other[1] == 0) || !is_further_clockwise(direction, other))
            continue;
        next = k;
        memcpy(direction, other, sizeof direction);
    }
    return next;
}

/// Rotate the ring so that it begins after its gap.
static void rotate_ring(size_t *ring, size_t count, size_t gap)
{
    size_t copy[STAR_MAX_RING];
    memcpy(copy, ring, count * sizeof *ring);
    for (size_t k = 0; k < count; k++)
        ring[k] = copy[(k + gap) % count];
}

size_t star_find(const double (*planar)[2], size_t count, double (*inverse)[2], size_t ring[STAR_MAX_RING], bool *closed)
{
    const double(*corners)[2] = (const double(*)[2])inverse;
    size_t first = invert(planar, count, inverse), found = 0, gap = 0, at = first;
    *closed = first != SIZE_MAX;
    if (first == SIZE_MAX)
        return 0;
    do
    {
        if (at != SIZE_MAX && found == STAR_MAX_RING)
            return 0;
        if (at != SIZE_MAX)
            ring[found++] = at;
        else if (!*closed)
            return 0; // the origin is a corner twice
        else
        {
            *closed = false;
            gap = found;
        }
        at = next_corner(corners, count, at);
    } while (at != first);
    rotate_ring(ring, found, gap % found);
    return found;
}

/// Add the barycentric coordinates of the origin in the triangle of corners l, r and next.
static void add_triangle(const double (*ring)[2], size_t l, size_t r, size_t next, double share, double *weights)
{
    double at_l = cross(ring[r], ring[next]), at_r = cross(ring[next], ring[l]), at_next = cross(ring[l], ring[r]);
    at_r = fmax(at_r, 0);
    at_next = fmax(at_next, 0);
    double scale = share / (at_l + at_r + at_next);
    weights[l] += scale * at_l;
    weights[r] += scale * at_r;
    weights[next] += scale * at_next;
}

void star_shape_preserving(const double (*ring)[2], size_t count, double *weights)
{
    for (size_t l = 0; l < count; l++)
        weights[l] = 0;
    for (size_t l = 0; l < count; l++)
        for (size_t step = 1; step + 1 < count; step++)
        {
            size_t r = (l + step) % count, next = (r + 1) % count;
            // The ray from l through the origin passes between corners r and next.
            if (cross(ring[l], ring[next]) <= 0 || step + 2 == count)
            {
                add_triangle(ring, l, r, next, 1 / (double)count, weights);
                break;
            }
        }
}

bool star_unfold(const double (*spokes)[3], size_t count, double (*ring)[2])
{
    double sum = 0, largest = 0, angle = 0;
    for (size_t k = 0; k < count; k++)
    {
        double between = vector3_angle(spokes[k], spokes[(k + 1) % count]);
        sum += between;
        largest = fmax(largest, between);
    }
    const double turn = ANGLE_TURN;
    if (!(largest / sum < 0.5 * (1 - 16 * DBL_EPSILON)))
        return false;
    for (size_t k = 0; k < count; k++)
    {
        double length = sqrt(vector3_dot(spokes[k], spokes[k]));
        ring[k][0] = length * cos(angle);
        ring[k][1] = length * sin(angle);
        angle += vector3_angle(spokes[k], spokes[(k + 1) % count]) * (turn / sum);
    }
    return true;
}

typedef struct spoke
{
    double angle; ///< first, for ascending()
    size_t place;
} spoke;

static bool add_spoke(const double (*planar)[2], size_t middle, size_t place, spoke spokes[STAR_MAX_RING], size_t *count)
{
    for (size_t k = 0; k < *count; k++)
        if (spokes[k].place == place)
            return true;
    if (*count == STAR_MAX_RING)
        return false;
    double angle = atan2(planar[place][1] - planar[middle][1], planar[place][0] - planar[middle][0]);
    spokes[(*count)++] = (spoke){.angle = angle, .place = place};
    return true;
}

/// Gather the corners of the triangles at `middle`. Returns their number, 0 if there are too many.
static size_t gather_spokes(const simplices *triangles, const double (*planar)[2], size_t middle,
                            spoke spokes[STAR_MAX_RING])
{
    size_t count = 0;
    for (size_t t = 0; t < triangles->count; t++)
    {
        const uint32_t *corners = triangles->corners + 3 * t;
        bool holds = corners[0] == middle || corners[1] == middle || corners[2] == middle;
        for (size_t k = 0; k < 3; k++)
            if (holds && corners[k] != middle && !add_spoke(planar, middle, corners[k], spokes, &count))
                return 0;
    }
    return count;
}

bat_status triangulated_star_find(const double (*planar)[2], size_t count, size_t middle, size_t ring[STAR_MAX_RING],
                                  size_t *ring_count, bat_error *error)
{
    spoke spokes[STAR_MAX_RING];
    simplices triangles;
    *ring_count = 0;
    bat_status status = planar_delaunay(planar, count, &triangles, error);
    if (status != BAT_OK)
        return status;
    size_t found = gather_spokes(&triangles, planar, middle, spokes);
    qsort(spokes, found, sizeof *spokes, ascending);
    *ring_count = found >= 3 ? found : 0;
    for (size_t k = 0; k < *ring_count; k++)
        ring[k] = spokes[k].place;
    simplices_free(&triangles);
    return BAT_OK;
}

#include "mesh/triangulate.h"

#include "base/memory.h"
#include "linalg/vector3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Triangulation of a polygon in space: quads along the better diagonal, convex polygons as a fan, others by ear clipping
/// (Meisters, "Polygons have ears", 1975).
///
/// The polygon is projected along Newell's normal n = sum_i p_i x p_(i+1), twice its area as a vector.

/// A polygon, translated and scaled so that no product overflows.
typedef struct outline
{
    const double *positions;
    const uint32_t *corners;
    size_t count;
    double scale; ///< the factor of all coordinates
    double normal[3];
} outline;

void polygon_workspace_free(polygon_workspace *workspace)
{
    free(workspace->numbers);
    *workspace = (polygon_workspace){0};
}

/// Corner `i` relative to corner 0, scaled.
static void corner_at(const outline *polygon, size_t i, double point[3])
{
    const double *origin = polygon->positions + 3 * (size_t)polygon->corners[0];
    const double *position = polygon->positions + 3 * (size_t)polygon->corners[i];
    for (int k = 0; k < 3; k++)
        point[k] = position[k] * polygon->scale - origin[k] * polygon->scale;
}

/// A triangle of three corners, projected along the normal.
typedef struct corner_triangle
{
    double area;    ///< twice the signed area times the length of the normal; negative when clockwise
    double squares; ///< the sum of the squared edge lengths
} corner_triangle;

static corner_triangle triangle_at(const outline *polygon, size_t i, size_t j, size_t k)
{
    double a[3], b[3], c[3], ab[3], ac[3], bc[3], normal[3];
    corner_at(polygon, i, a);
    corner_at(polygon, j, b);
    corner_at(polygon, k, c);
    for (int d = 0; d < 3; d++)
    {
        ab[d] = b[d] - a[d];
        ac[d] = c[d] - a[d];
        bc[d] = c[d] - b[d];
    }
    vector3_cross(ab, ac, normal);
    return (corner_triangle){vector3_dot(normal, polygon->normal),
                             vector3_dot(ab, ab) + vector3_dot(ac, ac) + vector3_dot(bc, bc)};
}

/// Choose the scale and compute Newell's normal.
static outline outline_of(const double *positions, const uint32_t *corners, size_t count)
{
    outline made = {positions, corners, count, 1.0, {0}};
    double largest = 0.0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(positions[3 * (size_t)corners[i] + (size_t)k]));
    int exponent;
    (void)frexp(largest, &exponent);
    made.scale = largest > 0 ? ldexp(1.0, -(exponent < -1000 ? -1000 : exponent)) : 1.0;
    double before[3], after[3], product[3];
    corner_at(&made, count - 1, before);
    for (size_t i = 0; i < count; i++)
    {
        corner_at(&made, i, after);
        vector3_cross(before, after, product);
        for (int k = 0; k < 3; k++)
        {
            made.normal[k] += product[k];
            before[k] = after[k];
        }
    }
    return made;
}

static void put_triangle(uint32_t **out, size_t a, size_t b, size_t c)
{
    (*out)[0] = (uint32_t)a;
    (*out)[1] = (uint32_t)b;
    (*out)[2] = (uint32_t)c;
    *out += 3;
}

static void put_fan(uint32_t *out, size_t count)
{
    for (size_t i = 1; i + 1 < count; i++)
        put_triangle(&out, 0, i, i + 1);
}

/// The lower quality of two triangles: area over squared edge lengths, largest for equilateral triangles.
static double min_quality(corner_triangle a, corner_triangle b)
{
    double first = a.squares > 0 ? a.area / a.squares : 0.0, second = b.squares > 0 ? b.area / b.squares : 0.0;
    return fmin(first, second);
}

static void cut_quad(const outline *quad, uint32_t *out)
{
    double even = min_quality(triangle_at(quad, 0, 1, 2), triangle_at(quad, 0, 2, 3));
    double odd = min_quality(triangle_at(quad, 1, 2, 3), triangle_at(quad, 1, 3, 0));
    size_t begin = odd > even ? 1 : 0;
    put_triangle(&out, begin, begin + 1, begin + 2);
    put_triangle(&out, begin, begin + 2, (begin + 3) % 4);
}

static bool is_convex(const outline *polygon)
{
    size_t count = polygon->count;
    for (size_t i = 0; i < count; i++)
        if (!(triangle_at(polygon, i, (i + 1) % count, (i + 2) % count).area > 0))
            return false;
    return true;
}

/// The remaining polygon during ear clipping: a doubly linked ring of corners.
typedef struct ear_ring
{
    const outline *polygon;
    uint32_t *next, *previous;
    uint32_t *ear; ///< 1 for a corner that is an ear
} ear_ring;

static bool same_place(const outline *polygon, size_t i, size_t j)
{
    double a[3], b[3];
    corner_at(polygon, i, a);
    corner_at(polygon, j, b);
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/// Whether a corner is an ear: convex, with no other corner in its triangle. Corners that coincide with one of the
/// triangle's three are ignored, because outlines joined to holes visit points twice.
static bool is_ear(const ear_ring *ring, uint32_t b)
{
    const outline *polygon = ring->polygon;
    uint32_t a = ring->previous[b], c = ring->next[b];
    if (!(triangle_at(polygon, a, b, c).area > 0))
        return false;
    for (uint32_t i = ring->next[c]; i != a; i = ring->next[i])
        if (triangle_at(polygon, a, b, i).area >= 0 && triangle_at(polygon, b, c, i).area >= 0 &&
            triangle_at(polygon, c, a, i).area >= 0 && !same_place(polygon, i, a) && !same_place(polygon, i, b) &&
            !same_place(polygon, i, c))
            return false;
    return true;
}

/// Clip ears until a triangle remains. An outline without an ear crosses itself or is degenerate; any corner is clipped
/// then.
static void cut_ears(const ear_ring *ring, uint32_t *out)
{
    uint32_t count = (uint32_t)ring->polygon->count;
    for (uint32_t i = 0; i < count; i++)
    {
        ring->next[i] = i + 1 < count ? i + 1 : 0;
        ring->previous[i] = i > 0 ? i - 1 : count - 1;
    }
    for (uint32_t i = 0; i < count; i++)
        ring->ear[i] = is_ear(ring, i);
    uint32_t at = 0;
    for (uint32_t left = count; left > 3; left--)
    {
        for (uint32_t tried = 0; tried < left && !ring->ear[at]; tried++)
            at = ring->next[at];
        uint32_t before = ring->previous[at], after = ring->next[at];
        put_triangle(&out, before, at, after);
        ring->next[before] = after;
        ring->previous[after] = before;
        ring->ear[before] = is_ear(ring, before);
        ring->ear[after] = is_ear(ring, after);
        at = ring->next[after]; // skip the neighbour, which would give a fan of slivers
    }
    put_triangle(&out, ring->previous[at], at, ring->next[at]);
}

bat_status polygon_triangulate(const double *positions, const uint32_t *corners, size_t count, uint32_t *triangles,
                               polygon_workspace *workspace)
{
    outline polygon = outline_of(positions, corners, count);
    if (count == 4)
    {
        cut_quad(&polygon, triangles);
        return BAT_OK;
    }
    if (count == 3 || is_convex(&polygon))
    {
        put_fan(triangles, count);
        return BAT_OK;
    }
    if (count > POLYGON_MAX_EARS)
        return BAT_TOO_LARGE;
    if (3 * count > workspace->capacity)
    {
        polygon_workspace_free(workspace);
        workspace->numbers = memory_array(3 * count, sizeof *workspace->numbers);
        if (workspace->numbers == NULL)
            return BAT_NO_MEMORY;
        workspace->capacity = 3 * count;
    }
    ear_ring ring = {&polygon, workspace->numbers, workspace->numbers + count, workspace->numbers + 2 * count};
    cut_ears(&ring, triangles);
    return BAT_OK;
}

#include "mesh/decimate/collapse_error.h"
#include "linalg/vector3.h"

#include <math.h>
#include <string.h>

/// @file
/// The quadric error of a vertex position p is the sum of area-weighted squared distances from planes, p^T A p + 2 b^T p + c
/// (Garland and Heckbert, 1997). The new vertex minimizes the sum of both ends' errors.

/// Relative to the trace of A, added to its diagonal. Directions with smaller eigenvalues leave the vertex near the
/// midpoint.
static const double DAMPING = 1e-6;
/// The weight of an edge's squared length. It orders edges by length where all errors vanish.
static const double LENGTH_SHARE = 1e-8;
/// Relative to weight times squared length: smaller differences of errors are rounding errors.
static const double ROUNDING = 1e-14;
/// The largest distance of the new vertex from the midpoint, relative to the edge's length.
static const double MAX_OFFSET = 2;
/// The quality of a face below which its normal is meaningless.
static const double DEGENERATE = 1e-7;
/// sqrt(12). The quality of a triangle is sqrt(12) times twice its area over its squared edge lengths; it is 1 for
/// equilateral triangles.
static const double QUALITY_FACTOR = 3.46410161513775458705;

static void add_curve_plane(const uint32_t *ends, const double *face_normal, double weight, error_vertex *vertices)
{
    double along[3], upright[3];
    vector3_subtract(vertices[ends[1]].position, vertices[ends[0]].position, along);
    vector3_cross(along, face_normal, upright);
    double length = sqrt(vector3_dot(upright, upright));
    if (!(length > 0))
        return;
    for (int c = 0; c < 3; c++)
        upright[c] /= length;
    for (int end = 0; end < 2; end++)
        quadric_add_plane(&vertices[ends[end]].planes, upright, weight * vector3_dot(along, along));
}

void error_vertices_set(const bat_mesh *mesh, const collapse_mesh *topology, double curve_weight, error_vertex *vertices)
{
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        vertices[v].planes = (quadric){0};
        memcpy(vertices[v].position, mesh->positions + 3 * v, sizeof vertices[v].position);
    }
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        double ab[3], ac[3], normal[3];
        vector3_subtract(vertices[corner[1]].position, vertices[corner[0]].position, ab);
        vector3_subtract(vertices[corner[2]].position, vertices[corner[0]].position, ac);
        vector3_cross(ab, ac, normal);
        double twice_area = sqrt(vector3_dot(normal, normal));
        if (!(twice_area > 0))
            continue;
        for (int c = 0; c < 3; c++)
            normal[c] /= twice_area;
        for (uint32_t c = 0; c < 3; c++)
        {
            uint32_t ends[2] = {corner[c], corner[(c + 1) % 3]};
            quadric_add_plane(&vertices[corner[c]].planes, normal, twice_area / 2);
            if (collapse_edge_is_curve(topology, topology->edge[3 * f + c]))
                add_curve_plane(ends, normal, collapse_edge_is_rim(topology, topology->edge[3 * f + c]) ? curve_weight : 1,
                                vertices);
        }
    }
}

/// The sum of the quadrics of both ends, about the midpoint, and half the edge vector.
static quadric planes_of_edge(const error_vertex *a, const error_vertex *b, double *half)
{
    double back[3];
    for (int c = 0; c < 3; c++)
    {
        half[c] = (b->position[c] - a->position[c]) / 2;
        back[c] = -half[c];
    }
    quadric of_a = quadric_moved(&a->planes, half), of_b = quadric_moved(&b->planes, back);
    return quadric_sum(&of_a, &of_b);
}

error_placement error_place(const collapse_mesh *mesh, const error_vertex *vertices, const attributes *fields, uint32_t edge,
                            uint32_t kept)
{
    uint32_t h = mesh->half_edge[edge], i = mesh->corner[h], j = mesh->corner[bat_mesh_next(h)];
    const error_vertex *a = &vertices[i], *b = &vertices[j];
    double half[3], offset[3] = {0};
    quadric planes = planes_of_edge(a, b, half);
    double square = 4 * vector3_dot(half, half), weight = quadric_weight(&planes), penalty = LENGTH_SHARE * weight * square;
    quadric of_values;
    double of_weights;
    if (attributes_error(fields, mesh, edge, half, kept, &of_values, &of_weights))
        planes = quadric_sum(&planes, &of_values);
    error_placement placed;
    const double back[3] = {-half[0], -half[1], -half[2]};
    if (kept != BAT_MESH_NONE)
    {
        placed.error = fmax(quadric_error(&planes, kept == i ? back : half), 0) + penalty;
        memcpy(placed.position, vertices[kept].position, sizeof placed.position);
        return placed;
    }
    double at_a = quadric_error(&planes, back), at_b = quadric_error(&planes, half), at_middle = planes.constant;
    double smallest = fmin(at_middle, fmin(at_a, at_b)), tolerance = ROUNDING * weight * square;
    bool solved = quadric_minimize(&planes, DAMPING * weight, offset) &&
                  vector3_dot(offset, offset) <= MAX_OFFSET * MAX_OFFSET * square;
    double best = solved ? quadric_error(&planes, offset) : INFINITY;
    if (best < smallest - tolerance)
        for (int c = 0; c < 3; c++)
            placed.position[c] = a->position[c] + half[c] + offset[c];
    else if (at_middle <= smallest + tolerance)
        for (int c = 0; c < 3; c++)
            placed.position[c] = a->position[c] + half[c];
    else
        memcpy(placed.position, at_a <= at_b ? a->position : b->position, sizeof placed.position);
    placed.error = fmax(fmin(best, smallest), 0) + penalty;
    return placed;
}

void error_merge(error_vertex *vertices, uint32_t i, uint32_t j, const double *position)
{
    double from_i[3], from_j[3];
    vector3_subtract(position, vertices[i].position, from_i);
    vector3_subtract(position, vertices[j].position, from_j);
    quadric of_i = quadric_moved(&vertices[i].planes, from_i), of_j = quadric_moved(&vertices[j].planes, from_j);
    vertices[i].planes = quadric_sum(&of_i, &of_j);
    memcpy(vertices[i].position, position, sizeof vertices[i].position);
}

/// The normal of a face, with twice its area as length, and the sum of its squared edge lengths.
typedef struct face_shape
{
    double normal[3], square; ///< `square` is the squared length of the normal
    double edges;
} face_shape;

static face_shape shape_of(const double *a, const double *b, const double *c)
{
    double ab[3], ac[3], bc[3];
    face_shape shape;
    vector3_subtract(b, a, ab);
    vector3_subtract(c, a, ac);
    vector3_subtract(c, b, bc);
    vector3_cross(ab, ac, shape.normal);
    shape.square = vector3_dot(shape.normal, shape.normal);
    shape.edges = vector3_dot(ab, ab) + vector3_dot(ac, ac) + vector3_dot(bc, bc);
    return shape;
}

/// Whether the quality of a face is at least `smallest`.
static bool has_quality(const face_shape *shape, double smallest)
{
    double bound = smallest * shape->edges / QUALITY_FACTOR;
    return shape->square >= bound * bound;
}

static bool has_normal(const face_shape *shape)
{
    double bound = DEGENERATE * shape->edges / QUALITY_FACTOR;
    return shape->square > bound * bound;
}

/// The lowest quality of the ring's faces before the collapse, including the vanishing ones.
static double worst_quality(const error_vertex *vertices, const collapse_ring *ring)
{
    double worst = 1;
    for (uint32_t k = 0; k < ring->count + ring->vanishing; k++)
    {
        uint32_t vertex[3];
        for (uint32_t c = 0; c < 3; c++)
        {
            uint32_t local = collapse_ring_corner(ring, k, c);
            vertex[c] = local == 0 ? ring->i : local == 1 ? ring->j : ring->vertex[local - 2];
        }
        face_shape shape =
            shape_of(vertices[vertex[0]].position, vertices[vertex[1]].position, vertices[vertex[2]].position);
        worst = fmin(worst, QUALITY_FACTOR * sqrt(shape.square) / shape.edges);
    }
    return worst;
}

bool error_faces_stay_valid(const error_vertex *vertices, const collapse_ring *ring, const double *position,
                            double min_normal, double min_quality)
{
    double smallest = min_quality;
    bool relaxed = false;
    for (uint32_t k = 0; k < ring->count; k++)
    {
        const double *apex = vertices[k >= ring->j_begin && k < ring->j_end ? ring->j : ring->i].position;
        const double *from = vertices[ring->vertex[k]].position, *to = vertices[ring->vertex[k + 1]].position;
        face_shape before = shape_of(apex, from, to), after = shape_of(position, from, to);
        if (has_normal(&before) &&
            !(vector3_dot(before.normal, after.normal) > min_normal * sqrt(before.square * after.square)))
            return false;
        if (has_quality(&after, smallest))
            continue;
        if (!relaxed)
            smallest = fmin(smallest, worst_quality(vertices, ring));
        relaxed = true;
        if (!has_quality(&after, smallest))
            return false;
    }
    return true;
}

#include "mesh/refine/scheme.h"

/// @file
/// The scheme of Loop, "Smooth subdivision surfaces based on triangles" (1987), with boundaries, creases and corners.
///
/// A smooth vertex of valence n becomes (1 - n b) v + b sum_i v_i with b = (5/8 - (3/8 + cos(2 pi / n) / 4)^2) / n; the
/// vertex of an edge becomes 3/8 of its ends and 1/8 of the opposite vertices. Sharp features follow Hoppe et al.,
/// "Piecewise smooth surface reconstruction" (1994). One rule differs: the vertex of a crease edge is always its midpoint,
/// so every crease is a cubic B-spline. Semi-sharp creases blend the rules of two levels as OpenSubdiv does.

/// The weight b of each neighbour in Loop's rule for a smooth vertex (Loop, 1987).
static double ring_weight(unsigned valence)
{
    static const int REGULAR = 6;
    if (valence == REGULAR)
        return 1.0 / 16;
    double root = 3.0 / 8 + cos(ANGLE_TURN / valence) / 4;
    return (5.0 / 8 - root * root) / valence;
}

vertex_mask loop_smooth_mask(unsigned valence)
{
    double ring = ring_weight(valence);
    return (vertex_mask){.own = 1 - valence * ring, .ring = ring};
}

/// The vertex at the end of a half-edge; with `in_parent` that on the edge of one of the parent's half-edges.
static inline uint32_t neighbour_at(const mesh_level *level, uint32_t half_edge, bool in_parent)
{
    if (in_parent)
        return (uint32_t)level->parent->links->vertex_count + level->parent->links->edge[half_edge];
    return mesh_end(level->faces, half_edge);
}

/// Compute a vertex. Its neighbours are gathered on its own level or, in arrays a quarter as long, on the parent's level. A
/// vertex without faces does not move. With `sharp` the vertex's rule is that of the sharp edges around it.
static inline void vertex_row(const mesh_rows *rows, uint32_t vertex, bool sharp, bool in_parent, size_t dim)
{
    const mesh_level *level = rows->level;
    const bat_mesh_connectivity *links = in_parent ? level->parent->links : level->links;
    const double *own = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    uint32_t first = links->first[vertex], h = first, last = first;
    for (size_t i = 0; i < dim; i++)
        to[i] = first == BAT_MESH_NONE ? own[i] : 0;
    if (first == BAT_MESH_NONE)
        return;
    unsigned valence = 0;
    do
    {
        vector_add(dim, 1, rows->from + neighbour_at(level, h, in_parent) * dim, to);
        valence++;
        last = h;
        h = bat_mesh_next_around(links, h);
    } while (h != BAT_MESH_NONE && h != first);
    uint32_t ends[2] = {vertex, vertex};
    if (!sharp && h == BAT_MESH_NONE) // no half-edge of the fan leads to the last neighbour
    {
        ends[0] = neighbour_at(level, first, in_parent);
        ends[1] = in_parent ? neighbour_at(level, bat_mesh_previous(last), true) : mesh_opposite(level->faces, last);
    }
    mask_vertex(rows, vertex, sharp, h == BAT_MESH_NONE, valence, loop_smooth_mask, ends, dim);
}

/// Compute the vertex on the parent's edge of a half-edge and the new vertices on both halves. The first one is regular: its
/// neighbours are the ends of that edge and the vertices on the other edges of both faces.
static inline void halves_rows(const mesh_rows *rows, uint32_t half_edge, size_t dim)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    const uint32_t *edge = parent->links->edge;
    uint32_t twin = parent->links->twin[half_edge], new_vertex = (uint32_t)parent->links->vertex_count;
    uint32_t begin = parent->faces[half_edge], end = mesh_end(parent->faces, half_edge);
    uint32_t vertex = new_vertex + edge[half_edge], near = split_near(half_edge), far = split_far(half_edge);
    double *edges = rows->to + level->links->vertex_count * dim;
    double *restrict to = rows->to + vertex * dim, *restrict first = edges + level->links->edge[near] * dim,
                     *restrict second = edges + level->links->edge[far] * dim;
    const double *own = rows->from + vertex * dim, *a = rows->from + begin * dim, *b = rows->from + end * dim;
    if (twin == BAT_MESH_NONE)
    {
        boundary_rows(a, own, b, to, first, second, dim);
        return;
    }
    const double *c = rows->from + (new_vertex + edge[bat_mesh_next(half_edge)]) * dim,
                 *d = rows->from + (new_vertex + edge[bat_mesh_previous(half_edge)]) * dim,
                 *e = rows->from + (new_vertex + edge[bat_mesh_next(twin)]) * dim,
                 *f = rows->from + (new_vertex + edge[bat_mesh_previous(twin)]) * dim;
    blend_row((four_rows){a, own, d, e}, (1 - edge_weight(level, near)) / 8, first, dim);
    blend_row((four_rows){own, b, c, f}, (1 - edge_weight(level, far)) / 8, second, dim);
    for (size_t i = 0; i < dim; i++)
        to[i] = 5.0 / 8 * own[i] + 1.0 / 16 * (((a[i] + b[i]) + (c[i] + d[i])) + (e[i] + f[i]));
}

/// Compute the new vertices on the edges inside a face of the parent, which are never sharp.
static inline void inner_rows(const mesh_rows *rows, uint32_t face, size_t dim)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    const uint32_t *corner = parent->faces + 3 * (size_t)face, *edge = parent->links->edge + 3 * (size_t)face;
    const double *middles = rows->from + parent->links->vertex_count * dim;
    const double *middle[3] = {middles + edge[0] * dim, middles + edge[1] * dim, middles + edge[2] * dim};
    double *edges = rows->to + level->links->vertex_count * dim;
    for (uint32_t c = 0; c < 3; c++)
    {
        uint32_t inside = split_near(3 * face + c) + 1;
        four_rows of = {middle[c], middle[(c + 2) % 3], rows->from + corner[c] * dim, middle[(c + 1) % 3]};
        blend_row(of, 1.0 / 8, edges + level->links->edge[inside] * dim, dim);
    }
}

/// The vertices of the level or, where it has a parent, those that the parent has as well.
static void vertex_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    for (size_t v = begin; v < end; v++)
        if (mesh_is_sharp(rows->level, v))
            continue;
        else if (rows->level->parent != NULL)
            BY_DIM(rows, vertex_row, (uint32_t)v, false, true);
        else
            BY_DIM(rows, vertex_row, (uint32_t)v, false, false);
}

/// The new vertices in some faces of the parent and on the edges that these own.
static void faces_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const uint32_t *twin = rows->level->parent->links->twin;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
    {
        for (uint32_t h = 3 * f; h < 3 * f + 3; h++)
            if (mesh_owns(twin, h))
                BY_DIM(rows, halves_rows, h);
        BY_DIM(rows, inner_rows, f);
    }
}

/// Compute the vertex on an edge: 3/8 of its ends and 1/8 of the opposite vertices, or the midpoint of a sharp edge.
static inline void edge_row(const mesh_rows *rows, uint32_t half_edge, size_t dim)
{
    const mesh_level *level = rows->level;
    const bat_mesh_connectivity *links = level->links;
    uint32_t twin = links->twin[half_edge], edge = links->edge[half_edge];
    const double *a = rows->from + level->faces[half_edge] * dim, *b = rows->from + mesh_end(level->faces, half_edge) * dim;
    double *restrict to = rows->to + (links->vertex_count + edge) * dim;
    double sharpness = twin != BAT_MESH_NONE ? edge_weight(level, half_edge) : 1;
    if (sharpness == 1)
    {
        middle_row(a, b, to, dim);
        return;
    }
    const double *c = rows->from + mesh_opposite(level->faces, half_edge) * dim,
                 *d = rows->from + mesh_opposite(level->faces, twin) * dim;
    blend_row((four_rows){a, b, c, d}, (1 - sharpness) / 8, to, dim);
}

/// Compute the new vertices on the edges that some faces own.
static void edge_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const uint32_t *twin = rows->level->links->twin;
    for (uint32_t h = (uint32_t)(3 * begin); h < 3 * end; h++)
        if (mesh_owns(twin, h))
            BY_DIM(rows, edge_row, h);
}

static void sharp_vertex_row(const void *context, uint32_t vertex)
{
    const mesh_rows *rows = context;
    BY_DIM(rows, vertex_row, vertex, true, false);
}

void loop_rule(const mesh_rows *rows, int threads)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    if (parent != NULL)
    {
        mesh_share(vertex_range, rows, parent->links->vertex_count, threads);
        mesh_share(faces_range, rows, parent->links->face_count, threads);
    }
    else
    {
        mesh_share(vertex_range, rows, level->links->vertex_count, threads);
        mesh_share(edge_range, rows, level->links->face_count, threads);
    }
    sharpness_visit(level, sharp_vertex_row, rows);
}

// Limit positions and normals (Loop, 1987; Halstead, Kass and DeRose, "Efficient, fair interpolation", 1993).
//
// A limit position is l^T (v, v_1, …, v_n), where l is the left eigenvector of the local subdivision matrix for the
// eigenvalue 1. For a smooth vertex l has the weights 1 - n w and w with w = 1 / (n + 3 / (8 b)). Creases are cubic
// B-splines with (1, 4, 1) / 6.

/// The limit weights around a dart, whose sharp edge leads to neighbour 0. With b = ring_weight() and weight 1 for the
/// vertex, 5 w_i - w_(i-1) - w_(i+1) = 8 b for 0 < i < n, without the terms w_0 and w_n, and w_0 = 2 b + (w_1 + w_(n-1))
/// / 4.
typedef struct dart_weights
{
    unsigned valence;
    double ring, total;
} dart_weights;

static double dart_weight(const dart_weights *dart, unsigned i)
{
    const double root = (5 - sqrt(21)) / 2;
    if (i == 0)
        return 2 * dart->ring + dart_weight(dart, 1) / 2;
    double there = pow(root, i), back = pow(root, dart->valence - i), around = pow(root, dart->valence);
    return 8 * dart->ring / 3 * (1 - (there + back) / (1 + around));
}

static void inner_limit(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp)
{
    const mesh_level *level = rows->level;
    size_t dim = rows->dim;
    bool is_dart = sharp->kind == SHARP_DART;
    unsigned valence = mesh_valence(level, vertex);
    dart_weights dart = {valence, ring_weight(valence), 1};
    for (unsigned i = 0; i < valence && is_dart; i++)
        dart.total += dart_weight(&dart, i);
    double ring = is_dart ? 0 : 1 / (valence + 3 / (8 * dart.ring));
    double own = is_dart ? 1 / dart.total : 1 - valence * ring;
    uint32_t h = is_dart ? mesh_half_edge_to(level, vertex, sharp->ends[0]) : level->links->first[vertex];
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = own * from[i];
    for (unsigned n = 0; n < valence; n++)
    {
        double weight = is_dart ? dart_weight(&dart, n) / dart.total : ring;
        vector_add(dim, weight, rows->from + mesh_end(level->faces, h) * dim, to);
        h = bat_mesh_next_around(level->links, h);
    }
}

void loop_limit(const mesh_rows *rows, int threads)
{
    limit_rows(rows, inner_limit, threads);
}

// Limit normals.

/// The normal of a smooth vertex, for the double eigenvalue 3/8 + cos(2 pi / n) / 4.
static void smooth_normal(const normal_job *job, uint32_t vertex, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t h = level->links->first[vertex];
    unsigned valence = mesh_valence(level, vertex);
    double a[3] = {0}, b[3] = {0};
    for (unsigned j = 0; j < valence; j++)
    {
        double angle = 2 * ANGLE_PI * j / valence;
        normal_add_way(job, cos(angle), vertex, mesh_end(level->faces, h), a);
        normal_add_way(job, sin(angle), vertex, mesh_end(level->faces, h), b);
        h = bat_mesh_next_around(level->links, h);
    }
    vector3_cross(a, b, normal);
}

/// The eigenvalue along the crease is 1/2; the one across is 3/8 + cos(pi / faces) / 4, or 1/4 for a single face.
static void side_normal(const normal_job *job, uint32_t half_edge, unsigned faces, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t vertex = level->faces[half_edge], end = mesh_end(level->faces, half_edge), h = half_edge;
    double angle = ANGLE_PI / faces;
    double side = faces == 1 ? 1 : -sin(angle) * cos(angle) / ((1 - cos(angle)) * (1 + 2 * cos(angle)));
    double along[3] = {0}, across[3] = {0};
    normal_add_way(job, 1, vertex, end, along);
    normal_add_way(job, side, vertex, end, across);
    for (unsigned j = 1; j <= faces; j++)
    {
        end = mesh_opposite(level->faces, h);
        normal_add_way(job, j < faces ? sin(j * angle) : side, vertex, end, across);
        h = bat_mesh_next_around(level->links, h);
    }
    normal_add_way(job, -1, vertex, end, along);
    vector3_cross(along, across, normal);
}

static void multiply_dart(unsigned valence, const double *row, double *product)
{
    double ring = ring_weight(valence);
    const double *from = row + 1;
    double *to = product + 1;
    product[0] = row[0] * (1 - valence * ring) + from[0] / 2;
    for (unsigned i = 0; i < valence; i++)
        to[i] = row[0] * ring + (i == 0 ? from[0] / 2 : 3.0 / 8 * from[i]);
    for (unsigned i = 1; i < valence; i++)
    {
        product[0] += 3.0 / 8 * from[i];
        to[i - 1] += from[i] / 8;
        to[(i + 1) % valence] += from[i] / 8;
    }
}

const normal_rules loop_normals = {.smooth = smooth_normal, .side = side_normal, .multiply = multiply_dart};

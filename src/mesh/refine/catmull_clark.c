#include "mesh/refine/scheme.h"

/// @file
/// The scheme of Catmull and Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes" (1978), with
/// boundaries, creases and corners after DeRose, Kass and Truong, "Subdivision surfaces in character animation" (1998).
///
/// A face gets the mean of its corners; an edge the mean of its ends and its faces' vertices, or its midpoint where it is
/// sharp; a smooth vertex of valence n becomes (n - 2) / n of itself and 1 / n^2 of each neighbour and each face's vertex.

vertex_mask catmull_clark_smooth_mask(unsigned valence)
{
    double n = valence;
    return (vertex_mask){.own = (n - 2) / n, .ring = 1 / (n * n)};
}

/// The first of the new rows that belong to faces.
static inline size_t faces_begin(const bat_mesh_connectivity *links)
{
    return links->vertex_count + links->edge_count;
}

static inline void face_row(const mesh_rows *rows, uint32_t face, uint32_t begin, uint32_t count, size_t dim)
{
    const mesh_level *level = rows->level;
    double *restrict to = rows->to + (faces_begin(level->links) + face) * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = 0;
    for (uint32_t c = begin; c < begin + count; c++)
        vector_add(dim, 1, rows->from + level->faces[c] * dim, to);
    vector_scale(dim, 1.0 / count, to);
}

static void face_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_sides *sides = &rows->level->sides;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (sides->quads && rows->dim == 3)
            face_row(rows, f, 4 * f, 4, 3);
        else
            BY_DIM(rows, face_row, f, sides_begin(sides, f), sides_begin(sides, f + 1) - sides_begin(sides, f));
}

/// Compute the vertex on an edge, from those of its faces.
static inline void edge_row(const mesh_rows *rows, uint32_t half_edge, bool quads, size_t dim)
{
    const mesh_level *level = rows->level;
    const bat_mesh_connectivity *links = level->links;
    const mesh_sides *sides = &level->sides;
    uint32_t twin = links->twin[half_edge];
    uint32_t next = quads ? (half_edge % 4 == 3 ? half_edge - 3 : half_edge + 1) : sides_next(sides, half_edge);
    const double *a = rows->from + level->faces[half_edge] * dim, *b = rows->from + level->faces[next] * dim;
    double *restrict to = rows->to + (links->vertex_count + links->edge[half_edge]) * dim;
    double sharpness = twin != BAT_MESH_NONE ? edge_weight(level, half_edge) : 1;
    if (sharpness == 1)
    {
        middle_row(a, b, to, dim);
        return;
    }
    const double *middles = rows->to + faces_begin(links) * dim;
    const double *c = middles + (quads ? half_edge / 4 : sides_face(sides, half_edge)) * dim,
                 *d = middles + (quads ? twin / 4 : sides_face(sides, twin)) * dim;
    blend_row((four_rows){a, b, c, d}, (1 - sharpness) / 4, to, dim);
}

static void edge_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_sides *sides = &rows->level->sides;
    const uint32_t *twin = rows->level->links->twin;
    uint32_t last = sides_begin(sides, (uint32_t)end);
    for (uint32_t h = sides_begin(sides, (uint32_t)begin); h < last; h++)
    {
        if (!mesh_owns(twin, h))
            continue;
        if (sides->quads && rows->dim == 3)
            edge_row(rows, h, true, 3);
        else
            BY_DIM(rows, edge_row, h, sides->quads);
    }
}

/// The vertex on the parent's edge of a half-edge.
static inline uint32_t middle_of(const bat_mesh_connectivity *parent, uint32_t half_edge)
{
    return (uint32_t)parent->vertex_count + parent->edge[half_edge];
}

/// Compute a vertex, with `sharp` by the sharp edges around it. A vertex without faces does not move. Its neighbours are
/// gathered on its own level or, in arrays a quarter as long, on the parent's level, where `quads` is false.
static inline void vertex_row(const mesh_rows *rows, uint32_t vertex, bool sharp, bool quads, bool in_parent, size_t dim)
{
    const mesh_level *level = rows->level, *from = in_parent ? level->parent : level;
    const bat_mesh_connectivity *links = from->links;
    const mesh_sides *sides = &from->sides;
    const double *own = rows->from + vertex * dim, *middles = rows->to + faces_begin(level->links) * dim;
    double *restrict to = rows->to + vertex * dim;
    uint32_t first = links->first[vertex], h = first, last = first;
    for (size_t i = 0; i < dim; i++)
        to[i] = first == BAT_MESH_NONE ? own[i] : 0;
    if (first == BAT_MESH_NONE)
        return;
    unsigned valence = 0;
    do
    {
        uint32_t next = quads ? (h % 4 == 3 ? h - 3 : h + 1) : sides_next(sides, h);
        uint32_t previous = quads ? (h % 4 == 0 ? h + 3 : h - 1) : sides_previous(sides, h);
        // The child quad of the parent's corner h has the number h.
        const double *neighbour = rows->from + (in_parent ? middle_of(links, h) : level->faces[next]) * dim,
                     *middle = middles + (in_parent ? h
                                          : quads   ? h / 4
                                                    : sides_face(sides, h)) *
                                             dim;
        for (size_t i = 0; i < dim; i++)
            to[i] += neighbour[i] + middle[i];
        valence++;
        last = h;
        h = links->twin[previous];
    } while (h != BAT_MESH_NONE && h != first);
    uint32_t ends[2] = {vertex, vertex};
    if (!sharp && h == BAT_MESH_NONE)
    {
        uint32_t before = sides_previous(sides, last);
        ends[0] = in_parent ? middle_of(links, first) : level->faces[sides_next(sides, first)];
        ends[1] = in_parent ? middle_of(links, before) : level->faces[before];
    }
    mask_vertex(rows, vertex, sharp, h == BAT_MESH_NONE, valence, catmull_clark_smooth_mask, ends, dim);
}

/// The vertices of the level or, where it has a parent, those that the parent has as well.
static void vertex_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    bool quads = rows->level->sides.quads;
    for (uint32_t v = (uint32_t)begin; v < end; v++)
        if (mesh_is_sharp(rows->level, v))
            continue;
        else if (rows->level->parent != NULL)
            BY_DIM(rows, vertex_row, v, false, false, true);
        else if (rows->dim == 3 && quads)
            vertex_row(rows, v, false, true, false, 3);
        else if (rows->dim == 3)
            vertex_row(rows, v, false, false, false, 3);
        else
            vertex_row(rows, v, false, quads, false, rows->dim);
}

static void sharp_vertex_row(const void *context, uint32_t vertex)
{
    const mesh_rows *rows = context;
    BY_DIM(rows, vertex_row, vertex, true, rows->level->sides.quads, false);
}

// Where the level's faces were split from those of a parent, the neighbours follow from the parent's arrays, a quarter as
// long. There vertices of edges have four faces, and those of faces one face for each corner.

/// The new vertices in a face of the parent: of its child quads, of the edges between them, and its own, which is smooth.
static inline void inner_rows(const mesh_rows *rows, uint32_t face, uint32_t begin, uint32_t count, size_t dim)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    const bat_mesh_connectivity *links = parent->links;
    size_t vertex = faces_begin(links) + face;
    uint32_t last = begin + count - 1;
    const double *own = rows->from + vertex * dim;
    double *middles = rows->to + faces_begin(level->links) * dim, *edges = rows->to + level->links->vertex_count * dim;
    double *restrict to = rows->to + vertex * dim;
    for (size_t i = 0; i < dim; i++)
        to[i] = 0;
    for (uint32_t h = begin; h <= last; h++)
    {
        const double *corner = rows->from + parent->faces[h] * dim, *next = rows->from + middle_of(links, h) * dim,
                     *previous = rows->from + middle_of(links, h > begin ? h - 1 : last) * dim;
        double *restrict middle = middles + h * dim;
        for (size_t i = 0; i < dim; i++)
        {
            middle[i] = 0.25 * (((corner[i] + next[i]) + own[i]) + previous[i]);
            to[i] += next[i] + middle[i];
        }
    }
    for (uint32_t h = begin; h <= last; h++)
    {
        const double *end = rows->from + middle_of(links, h) * dim, *p = middles + h * dim,
                     *q = middles + (h < last ? h + 1 : begin) * dim;
        double *restrict edge = edges + level->links->edge[4 * h + 1] * dim;
        for (size_t i = 0; i < dim; i++)
            edge[i] = 0.25 * (end[i] + own[i]) + 0.25 * (p[i] + q[i]);
    }
    vertex_mask mask = catmull_clark_smooth_mask(count);
    for (size_t i = 0; i < dim; i++)
        to[i] = mask.own * own[i] + mask.ring * to[i];
}

/// The half-edges along an edge of the parent, those after them, and their faces.
typedef struct edge_place
{
    uint32_t half_edge, next, face, twin, twin_next, twin_face;
} edge_place;

/// The new vertices on both halves of an edge of the parent, and the vertex between them, which is smooth.
static inline void halves_rows(const mesh_rows *rows, const edge_place *at, size_t dim)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    const bat_mesh_connectivity *links = parent->links;
    uint32_t near = 4 * at->half_edge, far = 4 * at->next + 3, vertex = middle_of(links, at->half_edge);
    double *edges = rows->to + level->links->vertex_count * dim;
    double *restrict to = rows->to + vertex * dim, *restrict first = edges + level->links->edge[near] * dim,
                     *restrict second = edges + level->links->edge[far] * dim;
    const double *own = rows->from + vertex * dim, *a = rows->from + parent->faces[at->half_edge] * dim,
                 *b = rows->from + parent->faces[at->next] * dim;
    if (at->twin == BAT_MESH_NONE)
    {
        boundary_rows(a, own, b, to, first, second, dim);
        return;
    }
    const double *centres = rows->from + faces_begin(links) * dim, *c = centres + at->face * dim,
                 *d = centres + at->twin_face * dim;
    const double *middles = rows->to + faces_begin(level->links) * dim, *p = middles + at->half_edge * dim,
                 *q = middles + at->next * dim, *r = middles + at->twin * dim, *s = middles + at->twin_next * dim;
    blend_row((four_rows){a, own, p, s}, (1 - edge_weight(level, near)) / 4, first, dim);
    blend_row((four_rows){own, b, q, r}, (1 - edge_weight(level, far)) / 4, second, dim);
    for (size_t i = 0; i < dim; i++)
        to[i] = 0.5 * own[i] + 1.0 / 16 * (((a[i] + b[i]) + (c[i] + d[i])) + ((p[i] + q[i]) + (r[i] + s[i])));
}

/// The new vertices on the edges that the parent's faces own.
static void halves_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_level *parent = rows->level->parent;
    const mesh_sides *sides = &parent->sides;
    const uint32_t *twin = parent->links->twin;
    uint32_t last = sides_begin(sides, (uint32_t)end);
    for (uint32_t h = sides_begin(sides, (uint32_t)begin); h < last; h++)
    {
        uint32_t other = twin[h];
        if (other < h)
            continue;
        bool inner = other != BAT_MESH_NONE;
        if (sides->quads && rows->dim == 3)
        {
            edge_place at = {h, h % 4 == 3 ? h - 3 : h + 1, h / 4, other, other % 4 == 3 ? other - 3 : other + 1, other / 4};
            halves_rows(rows, &at, 3);
            continue;
        }
        edge_place at = {h,
                         sides_next(sides, h),
                         sides_face(sides, h),
                         other,
                         inner ? sides_next(sides, other) : 0,
                         inner ? sides_face(sides, other) : 0};
        BY_DIM(rows, halves_rows, &at);
    }
}

static void inner_range(const void *context, size_t begin, size_t end)
{
    const mesh_rows *rows = context;
    const mesh_sides *sides = &rows->level->parent->sides;
    for (uint32_t f = (uint32_t)begin; f < end; f++)
        if (sides->quads && rows->dim == 3)
            inner_rows(rows, f, 4 * f, 4, 3);
        else
            BY_DIM(rows, inner_rows, f, sides_begin(sides, f), sides_begin(sides, f + 1) - sides_begin(sides, f));
}

void catmull_clark_rule(const mesh_rows *rows, int threads)
{
    const mesh_level *level = rows->level, *parent = level->parent;
    if (parent != NULL)
    {
        mesh_share(inner_range, rows, parent->links->face_count, threads);
        mesh_share(halves_range, rows, parent->links->face_count, threads);
        mesh_share(vertex_range, rows, parent->links->vertex_count, threads);
    }
    else
    {
        mesh_share(face_range, rows, level->links->face_count, threads);
        mesh_share(edge_range, rows, level->links->face_count, threads);
        mesh_share(vertex_range, rows, level->links->vertex_count, threads);
    }
    sharpness_visit(level, sharp_vertex_row, rows);
}

void catmull_clark_linear_rule(const mesh_rows *rows, int threads)
{
    midpoint_rule(rows, threads);
    mesh_share(face_range, rows, rows->level->links->face_count, threads);
}

// Limit positions and normals of Catmull and Clark's scheme (Halstead, Kass and DeRose, "Efficient, fair interpolation
// using Catmull-Clark surfaces", 1993).
//
// They are the left eigenvectors of the local subdivision matrix, applied to the vertices around. The rows of the limit
// position are given for the neighbours and the means of the faces, so that they hold for faces of any number of corners.

/// The mean of column `k` at a face's corners.
static double face_mean(const mesh_rows *rows, uint32_t face, size_t k)
{
    const mesh_level *level = rows->level;
    uint32_t begin = sides_begin(&level->sides, face), end = sides_begin(&level->sides, face + 1);
    double sum = 0;
    for (uint32_t c = begin; c < end; c++)
        sum += rows->from[level->faces[c] * rows->dim + k];
    return sum / (end - begin);
}

/// The weights around a dart, whose sharp edge leads to neighbour 0, with weight 1 for the vertex: of neighbour i, and of
/// the vertex opposite in the quad between the neighbours i and i + 1. In the equations of the left eigenvector, 7 w_i -
/// w_(i-1)
/// - w_(i+1) = 20 / n^2 for 0 < i < n, without the terms w_0 and w_n.
static double dart_inner_weight(unsigned valence, unsigned i)
{
    const double root = (7 - sqrt(45)) / 2;
    if (i == 0 || i == valence)
        return 0;
    double n = valence;
    return 4 / (n * n) * (1 - (pow(root, i) + pow(root, n - i)) / (1 + pow(root, n)));
}

static double dart_edge_weight(unsigned valence, unsigned i)
{
    double n = valence;
    return i > 0 ? dart_inner_weight(valence, i) : 10 / (3 * n * n) + dart_inner_weight(valence, 1) / 3;
}

static double dart_face_weight(unsigned valence, unsigned i)
{
    double n = valence;
    return 1 / (3 * n * n) + (dart_inner_weight(valence, i) + dart_inner_weight(valence, i + 1)) / 12;
}

/// The limit of a dart or a smooth vertex.
static void inner_limit(const mesh_rows *rows, uint32_t vertex, const sharp_vertex *sharp)
{
    const mesh_level *level = rows->level;
    size_t dim = rows->dim;
    unsigned valence = mesh_valence(level, vertex);
    bool is_dart = sharp->kind == SHARP_DART;
    double n = valence, total = 1;
    for (unsigned i = 0; is_dart && i < valence; i++)
        total += dart_edge_weight(valence, i) + dart_face_weight(valence, i);
    uint32_t h = is_dart ? mesh_half_edge_to(level, vertex, sharp->ends[0]) : level->links->first[vertex];
    const double *from = rows->from + vertex * dim;
    double *restrict to = rows->to + vertex * dim;
    double own = is_dart ? 1 / total : (n - 1) / (n + 5);
    for (size_t k = 0; k < dim; k++)
        to[k] = own * from[k];
    for (unsigned i = 0; i < valence; i++)
    {
        // The corner opposite in a quad is four times the face's mean less the other three corners.
        double edge = is_dart ? dart_edge_weight(valence, i) / total : 2 / (n * (n + 5));
        double mean_weight = is_dart ? 4 * dart_face_weight(valence, i) / total : 4 / (n * (n + 5));
        const double *neighbour = rows->from + level->faces[sides_next(&level->sides, h)] * dim,
                     *before = rows->from + level->faces[sides_previous(&level->sides, h)] * dim;
        for (size_t k = 0; k < dim; k++)
        {
            to[k] += edge * neighbour[k] + mean_weight * face_mean(rows, sides_face(&level->sides, h), k);
            if (is_dart)
                to[k] -= mean_weight / 4 * (from[k] + neighbour[k] + before[k]);
        }
        h = sides_next_around(level, h);
    }
}

void catmull_clark_limit(const mesh_rows *rows, int threads)
{
    limit_rows(rows, inner_limit, threads);
}

// Limit normals.

/// The vertex opposite to the begin of a half-edge in its quad.
static uint32_t opposite_in_quad(const mesh_level *level, uint32_t half_edge)
{
    return level->faces[half_edge ^ 2];
}

/// The normal of a smooth vertex of two quads. The eigenvalue 1/4 is threefold there, so that tangents in different
/// directions do not lie in one plane in general. The two antisymmetric ones give the normal.
static void normal_of_two(const normal_job *job, uint32_t half_edge, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t other = sides_next_around(level, half_edge);
    double edges[3] = {0}, faces[3] = {0};
    normal_add_way(job, 1, level->faces[sides_next(&level->sides, other)],
                   level->faces[sides_next(&level->sides, half_edge)], edges);
    normal_add_way(job, 1, opposite_in_quad(level, other), opposite_in_quad(level, half_edge), faces);
    vector3_cross(edges, faces, normal);
}

static void smooth_normal(const normal_job *job, uint32_t vertex, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t h = level->links->first[vertex];
    unsigned valence = mesh_valence(level, vertex);
    if (valence == 2)
    {
        normal_of_two(job, h, normal);
        return;
    }
    double step = 2 * ANGLE_PI / valence;
    double eigenvalue = (5 + cos(step) + cos(step / 2) * sqrt(2 * (9 + cos(step)))) / 16;
    double face = 1 / (4 * eigenvalue - 1), a[3] = {0}, b[3] = {0};
    for (unsigned i = 0; i < valence; i++)
    {
        uint32_t end = level->faces[sides_next(&level->sides, h)], opposite = opposite_in_quad(level, h);
        double angle = i * step;
        normal_add_way(job, 4 * cos(angle), vertex, end, a);
        normal_add_way(job, 4 * sin(angle), vertex, end, b);
        normal_add_way(job, face * (cos(angle) + cos(angle + step)), vertex, opposite, a);
        normal_add_way(job, face * (sin(angle) + sin(angle + step)), vertex, opposite, b);
        h = sides_next_around(level, h);
    }
    vector3_cross(a, b, normal);
}

/// The eigenvalue along the crease is 1/2. The tangent across is that of Biermann, Levin and Zorin, "Piecewise smooth
/// subdivision surfaces with normal control" (2000).
static void side_normal(const normal_job *job, uint32_t half_edge, unsigned faces, double normal[3])
{
    const mesh_level *level = job->level;
    uint32_t vertex = level->faces[half_edge], end = level->faces[sides_next(&level->sides, half_edge)], h = half_edge;
    double angle = ANGLE_PI / faces;
    double side = faces == 1 ? 1 : -(1 + cos(angle)) / sin(angle) * (1 + 2 * cos(angle));
    double along[3] = {0}, across[3] = {0};
    normal_add_way(job, 1, vertex, end, along);
    normal_add_way(job, side, vertex, end, across);
    for (unsigned i = 0; i < faces; i++)
    {
        if (faces > 1)
            normal_add_way(job, sin(i * angle) + sin((i + 1) * angle), vertex, opposite_in_quad(level, h), across);
        end = level->faces[sides_previous(&level->sides, h)];
        normal_add_way(job, i + 1 < faces ? 4 * sin((i + 1) * angle) : side, vertex, end, across);
        h = sides_next_around(level, h);
    }
    normal_add_way(job, -1, vertex, end, along);
    vector3_cross(along, across, normal);
}

static void multiply_dart(unsigned valence, const double *row, double *product)
{
    const double n = valence, *edges = row + 1, *faces = row + 1 + valence;
    double *edges_to = product + 1, *faces_to = product + 1 + valence;
    product[0] = row[0] * (1 - 7 / (4 * n)) + edges[0] / 2;
    for (unsigned i = 0; i < valence; i++)
    {
        edges_to[i] = row[0] * 3 / (2 * n * n) + (i == 0 ? edges[0] / 2 : 3.0 / 8 * edges[i]);
        faces_to[i] = row[0] / (4 * n * n) + faces[i] / 4;
    }
    for (unsigned i = 0; i < valence; i++)
    {
        unsigned after = (i + 1) % valence, before = (i + valence - 1) % valence;
        product[0] += faces[i] / 4;
        edges_to[i] += faces[i] / 4;
        edges_to[after] += faces[i] / 4;
        if (i == 0)
            continue;
        product[0] += 3.0 / 8 * edges[i];
        edges_to[before] += edges[i] / 16;
        edges_to[after] += edges[i] / 16;
        faces_to[before] += edges[i] / 16;
        faces_to[i] += edges[i] / 16;
    }
}

const normal_rules catmull_clark_normals = {
    .quads = true, .smooth = smooth_normal, .side = side_normal, .multiply = multiply_dart};

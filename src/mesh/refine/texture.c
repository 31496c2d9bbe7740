#include "mesh/refine/plan.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/hash_table.h"

#include <string.h>

/// @file
/// Smooth rules of texture coordinates. Every step runs on one thread.

/// The faces around a vertex that have the same texture coordinate there.
typedef struct value_span
{
    uint32_t value;       ///< the texture coordinate
    uint32_t begin, size; ///< the first of the faces in the ring, counter-clockwise, and their number
    bool disjoint;        ///< they are not one fan, or an edge between them is sharp for ever or a seam
    unsigned semi_sharp;  ///< edges between them that are sharp for a time
} value_span;

/// The faces around a vertex: their half-edges that begin there, and the spans of equal texture coordinates.
typedef struct value_ring
{
    uint32_t *half_edges;
    value_span *spans;
    uint32_t *span_of; ///< of each face
    uint32_t faces, span_count, seams;
    bool boundary;
} value_ring;

static uint32_t largest_ring(const mesh_level *level)
{
    const bat_mesh_connectivity *links = level->links;
    uint32_t largest = 0;
    for (size_t v = 0; v < links->vertex_count; v++)
    {
        uint32_t first = links->first[v], h = first, faces = 0;
        while (h != BAT_MESH_NONE && (faces == 0 || h != first))
        {
            faces++;
            h = sides_next_around(level, h);
        }
        largest = faces > largest ? faces : largest;
    }
    return largest;
}

/// Whether the edge of a half-edge is a seam; a boundary edge is none.
static bool is_seam(const texture_rows *rows, uint32_t half_edge)
{
    return rows->seams->twin[half_edge] == BAT_MESH_NONE && rows->level->links->twin[half_edge] != BAT_MESH_NONE;
}

/// Gather the faces around a vertex and count its seams. The edge of half-edge i is before face i.
static void gather_ring(const texture_rows *rows, uint32_t vertex, value_ring *ring)
{
    uint32_t first = rows->level->links->first[vertex], h = first;
    ring->faces = ring->seams = 0;
    do
    {
        ring->half_edges[ring->faces++] = h;
        ring->seams += is_seam(rows, h);
        h = sides_next_around(rows->level, h);
    } while (h != BAT_MESH_NONE && h != first);
    ring->boundary = h == BAT_MESH_NONE;
}

/// Note an edge between two faces of a span.
static void note_inner_edge(const texture_rows *rows, uint32_t half_edge, value_span *span)
{
    const mesh_level *level = rows->level;
    double sharpness = level->edge_sharpness != NULL ? level->edge_sharpness[level->links->edge[half_edge]] : 0;
    if (is_seam(rows, half_edge) || sharpness >= BAT_MESH_SHARP)
        span->disjoint = true;
    else
        span->semi_sharp += sharpness > 0;
}

/// The span of a texture coordinate, a new one if need be.
static uint32_t find_span(value_ring *ring, uint32_t value)
{
    for (uint32_t i = 0; i < ring->span_count; i++)
        if (ring->spans[i].value == value)
            return i;
    ring->spans[ring->span_count] = (value_span){.value = value};
    return ring->span_count++;
}

/// The only texture coordinate of a vertex: its faces begin at the only seam.
static void make_single_span(const texture_rows *rows, value_ring *ring)
{
    value_span *span = &ring->spans[0];
    span->size = ring->faces;
    span->disjoint = ring->boundary || ring->seams != 1;
    for (uint32_t i = 0; i < ring->faces; i++)
        if (is_seam(rows, ring->half_edges[i]))
            span->begin = i;
        else
            note_inner_edge(rows, ring->half_edges[i], span);
}

/// Find the spans around a vertex whose faces are gathered.
static void make_spans(const texture_rows *rows, value_ring *ring)
{
    ring->span_count = 0;
    for (uint32_t i = 0; i < ring->faces; i++)
        ring->span_of[i] = find_span(ring, rows->corners[ring->half_edges[i]]);
    if (ring->span_count == 1)
    {
        make_single_span(rows, ring);
        return;
    }
    for (uint32_t i = 0; i < ring->faces; i++)
    {
        value_span *span = &ring->spans[ring->span_of[i]];
        bool begins = i == 0 ? ring->boundary || ring->span_of[ring->faces - 1] != ring->span_of[0]
                             : ring->span_of[i] != ring->span_of[i - 1];
        if (!begins)
            note_inner_edge(rows, ring->half_edges[i], span);
        else
        {
            span->disjoint = span->disjoint || (span->size > 0 && span->begin != UINT32_MAX);
            span->begin = i;
        }
        if (i == 0 && !begins)
            span->begin = UINT32_MAX; // the span runs over the ring's end and begins later
        span->size++;
    }
}

/// How much a texture coordinate is a corner: 1 for a corner, 0 for a crease.
static double corner_weight(const texture_rows *rows, const value_ring *ring, const value_span *span, double own)
{
    const mesh_level *level = rows->level;
    double sum = 0, after_own = sharpness_after_level(own);
    unsigned count = 0;
    if (after_own > 0)
        return 1;
    if (own > 0)
    {
        sum += own;
        count++;
    }
    for (uint32_t i = 1; i < span->size; i++)
    {
        uint32_t h = ring->half_edges[(span->begin + i) % ring->faces];
        double sharpness = level->edge_sharpness != NULL ? level->edge_sharpness[level->links->edge[h]] : 0;
        if (!(sharpness > 0))
            continue;
        if (sharpness_of_half(level, h, true) > 0)
            return 1;
        sum += sharpness;
        count++;
    }
    return count > 0 ? fmin(sum / count, 1) : 0;
}

/// Whether all coordinates at a vertex with seams are corners.
static bool all_corners(const texture_rows *rows, const value_ring *ring, double own)
{
    bool plus2 = rows->linear == BAT_MESH_LINEAR_CORNERS_PLUS2;
    bool plus = plus2 || rows->linear == BAT_MESH_LINEAR_CORNERS_PLUS1;
    if (rows->linear == BAT_MESH_LINEAR_BOUNDARIES || own >= BAT_MESH_SHARP || (plus && ring->span_count > 2) ||
        (plus2 && ring->span_count == 1 && !ring->boundary))
        return true;
    if (!plus || ring->span_count != 2)
        return false;
    const value_span *a = &ring->spans[0], *b = &ring->spans[1];
    return a->disjoint || b->disjoint || (plus2 && (a->size == 1 || b->size == 1));
}

/// Whether an edge of a span stays sharp.
static bool stays_sharp(const texture_rows *rows, const value_ring *ring, const value_span *span)
{
    const mesh_level *level = rows->level;
    for (uint32_t i = 1; level->edge_sharpness != NULL && i < span->size; i++)
    {
        uint32_t h = ring->half_edges[(span->begin + i) % ring->faces];
        if (level->edge_sharpness[level->links->edge[h]] > 0 && sharpness_of_half(level, h, true) > 0)
            return true;
    }
    return false;
}

/// Whether an edge around a vertex, also one between two spans, is sharp for a time on the next level.
static bool has_semi_sharp_after(const texture_rows *rows, const value_ring *ring)
{
    const mesh_level *level = rows->level;
    for (uint32_t i = 0; level->edge_sharpness != NULL && i < ring->faces; i++)
    {
        uint32_t h = ring->half_edges[i];
        double after = level->edge_sharpness[level->links->edge[h]] > 0 ? sharpness_of_half(level, h, true) : 0;
        if (!mesh_at_boundary(level->links, h) && after > 0 && after < BAT_MESH_SHARP)
            return true;
    }
    return false;
}

enum
{
    INDEPENDENT,
    DEPENDENT, ///< a corner while the other coordinate's edges are sharp for a time
    RELEASED   ///< the other's edges are smooth now, but others at the vertex were not: a corner for one more level
};

/// How much one of two texture coordinates at a vertex is a corner, if it depends on the other one. Negative if it does not.
static double dependent_weight(const texture_rows *rows, const value_ring *ring, uint32_t i, double own)
{
    const value_span *span = &ring->spans[i], *other = &ring->spans[1 - i];
    if (rows->dependent == NULL || ring->span_count != 2 || span->value >= rows->dependent_count)
        return -1;
    unsigned char *state = &rows->dependent[span->value];
    if (rows->first_level)
        *state = !(own > 0) && span->semi_sharp == 0 && other->semi_sharp > 0 ? DEPENDENT : INDEPENDENT;
    if (*state == INDEPENDENT)
        return -1;
    bool released = *state == RELEASED;
    *state = INDEPENDENT;
    if (released)
        return 0;
    if (!has_semi_sharp_after(rows, ring))
        return corner_weight(rows, ring, other, own);
    *state = stays_sharp(rows, ring, other) ? DEPENDENT : RELEASED;
    return 1;
}

/// Compute the coordinate of a span that is a corner in part.
static void blend_span(const texture_rows *rows, const value_ring *ring, const value_span *span, double corner)
{
    const mesh_sides *sides = &rows->level->sides;
    uint32_t begin = ring->half_edges[span->begin], end = ring->half_edges[(span->begin + span->size - 1) % ring->faces];
    const double *own = rows->from + 2 * (size_t)span->value,
                 *p = rows->from + 2 * (size_t)rows->corners[sides_next(sides, begin)],
                 *q = rows->from + 2 * (size_t)rows->corners[sides_previous(sides, end)];
    double *to = rows->to + 2 * (size_t)span->value, side = (1 - corner) / 8;
    for (int i = 0; i < 2; i++)
        to[i] = (1 - 2 * side) * own[i] + side * (p[i] + q[i]);
}

/// Compute the coordinates of a vertex with seams.
static void divided_vertex(const texture_rows *rows, uint32_t vertex, value_ring *ring)
{
    const mesh_level *level = rows->level;
    double own = level->vertex_sharpness != NULL && vertex < level->coarse_count ? level->vertex_sharpness[vertex] : 0;
    bool all = all_corners(rows, ring, own), fixed = rows->linear != BAT_MESH_LINEAR_NONE;
    for (uint32_t i = 0; i < ring->span_count; i++)
    {
        const value_span *span = &ring->spans[i];
        if (all || span->disjoint || (fixed && span->size == 1))
        {
            memcpy(rows->to + 2 * (size_t)span->value, rows->from + 2 * (size_t)span->value, 2 * sizeof *rows->to);
            continue;
        }
        double corner = dependent_weight(rows, ring, i, own);
        if (corner < 0)
            corner = corner_weight(rows, ring, span, own);
        blend_span(rows, ring, span, corner);
    }
}

/// Compute the coordinate of a vertex without seams by the scheme's rule.
static void whole_vertex(const texture_rows *rows, uint32_t vertex, const value_ring *ring)
{
    const mesh_level *level = rows->level;
    const mesh_sides *sides = &level->sides;
    uint32_t value = rows->corners[ring->half_edges[0]];
    const double *own = rows->from + 2 * (size_t)value;
    const double *middles = rows->to + 2 * (rows->seams->vertex_count + rows->seams->edge_count);
    double sum[2] = {0};
    for (uint32_t i = 0; i < ring->faces; i++)
    {
        uint32_t h = ring->half_edges[i];
        const double *neighbour = rows->from + 2 * (size_t)rows->corners[sides_next(sides, h)];
        const double *middle = middles + 2 * (size_t)sides_face(sides, h);
        for (int k = 0; k < 2; k++)
            sum[k] += neighbour[k] + (rows->quads ? middle[k] : 0);
    }
    vertex_mask mask = mask_around(level, vertex, ring->faces, rows->smooth);
    const double *p = rows->from + 2 * (size_t)rows->corners[mask.corners[0]],
                 *q = rows->from + 2 * (size_t)rows->corners[mask.corners[1]];
    double *to = rows->to + 2 * (size_t)value;
    for (int k = 0; k < 2; k++)
        to[k] = mask.own * own[k] + mask.ring * sum[k] + mask.pair * (p[k] + q[k]);
}

static void face_values(const texture_rows *rows)
{
    const mesh_sides *sides = &rows->level->sides;
    double *to = rows->to + 2 * (rows->seams->vertex_count + rows->seams->edge_count);
    for (uint32_t f = 0; f < rows->level->links->face_count; f++, to += 2)
    {
        uint32_t begin = sides_begin(sides, f), end = sides_begin(sides, f + 1);
        to[0] = to[1] = 0;
        for (uint32_t c = begin; c < end; c++)
            for (int k = 0; k < 2; k++)
                to[k] += rows->from[2 * (size_t)rows->corners[c] + (size_t)k] / (end - begin);
    }
}

/// Compute the coordinates on the texture's edges: midpoints at seams and boundaries, else by the scheme's rule.
static void edge_values(const texture_rows *rows)
{
    const mesh_level *level = rows->level;
    const mesh_sides *sides = &level->sides;
    const double *middles = rows->to + 2 * (rows->seams->vertex_count + rows->seams->edge_count);
    uint32_t corners = sides_corners(sides, level->links->face_count);
    for (uint32_t h = 0; h < corners; h++)
    {
        uint32_t twin = rows->seams->twin[h];
        if (twin < h)
            continue;
        double sharpness = twin != BAT_MESH_NONE ? edge_weight(level, h) : 1;
        double side = (1 - sharpness) / (rows->quads ? 4 : 8), end = 0.5 - side;
        const double *a = rows->from + 2 * (size_t)rows->corners[h],
                     *b = rows->from + 2 * (size_t)rows->corners[sides_next(sides, h)], *c = a, *d = a;
        if (twin != BAT_MESH_NONE && rows->quads)
        {
            c = middles + 2 * (size_t)sides_face(sides, h);
            d = middles + 2 * (size_t)sides_face(sides, twin);
        }
        else if (twin != BAT_MESH_NONE)
        {
            c = rows->from + 2 * (size_t)rows->corners[sides_previous(sides, h)];
            d = rows->from + 2 * (size_t)rows->corners[sides_previous(sides, twin)];
        }
        double *to = rows->to + 2 * (rows->seams->vertex_count + rows->seams->edge[h]);
        for (int k = 0; k < 2; k++)
            to[k] = end * (a[k] + b[k]) + side * (c[k] + d[k]);
    }
}

/// Whether the rule of a vertex without seams differs from the scheme's, so that divided_vertex() must compute it.
static bool is_divided(const texture_rows *rows, const value_ring *ring)
{
    if (ring->seams > 0 || !ring->boundary)
        return ring->seams > 0;
    return rows->linear == BAT_MESH_LINEAR_BOUNDARIES || (ring->faces == 1 && rows->linear != BAT_MESH_LINEAR_NONE);
}

bat_status texture_rule(const texture_rows *rows, bat_error *error)
{
    const mesh_level *level = rows->level;
    uint32_t largest = largest_ring(level);
    memory_pool pool = {0};
    value_ring ring = {.half_edges = memory_pool_array(&pool, largest, sizeof *ring.half_edges),
                       .spans = memory_pool_array(&pool, largest, sizeof *ring.spans),
                       .span_of = memory_pool_array(&pool, largest, sizeof *ring.span_of)};
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        memcpy(rows->to, rows->from, 2 * rows->seams->vertex_count * sizeof *rows->to);
        if (rows->quads)
            face_values(rows);
        edge_values(rows);
    }
    for (uint32_t v = 0; v < level->links->vertex_count && status == BAT_OK; v++)
    {
        if (level->links->first[v] == BAT_MESH_NONE)
            continue;
        gather_ring(rows, v, &ring);
        if (!is_divided(rows, &ring))
            whole_vertex(rows, v, &ring);
        else
        {
            make_spans(rows, &ring);
            divided_vertex(rows, v, &ring);
        }
    }
    memory_pool_free(&pool);
    return status;
}

bat_status texture_separate(const bat_mesh *mesh, size_t corner_count, double **texture, size_t *texture_count,
                            uint32_t **texture_faces, bat_error *error)
{
    size_t count = mesh->texture_count;
    uint32_t *owner = memory_array(count, sizeof *owner), *faces = memory_array(corner_count, sizeof *faces);
    double *values = memory_array(count + corner_count, 2 * sizeof *values);
    key_map others = {0};
    bool made = owner != NULL && faces != NULL && values != NULL;
    if (made)
    {
        memset(owner, 0xff, count * sizeof *owner);
        memcpy(values, mesh->texture, 2 * count * sizeof *values);
    }
    for (size_t c = 0; made && c < corner_count; c++)
    {
        uint32_t value = mesh->texture_faces[c], vertex = mesh->faces[c];
        if (owner[value] == BAT_MESH_NONE)
            owner[value] = vertex;
        faces[c] = value;
        if (owner[value] == vertex)
            continue;
        uint32_t *number = key_map_at(&others, (uint64_t)vertex << 32 | value);
        made = number != NULL;
        if (made && *number == UINT32_MAX)
        {
            *number = (uint32_t)count;
            memcpy(values + 2 * count++, mesh->texture + 2 * (size_t)value, 2 * sizeof *values);
        }
        faces[c] = made ? *number : value;
    }
    key_map_free(&others);
    free(owner);
    if (!made)
    {
        free(faces);
        free(values);
        return error_memory(error, (count + corner_count) * 2 * sizeof *values);
    }
    *texture = values;
    *texture_count = count;
    *texture_faces = faces;
    return BAT_OK;
}

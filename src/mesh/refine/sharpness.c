#include "mesh/refine/sharpness.h"

#include "base/error.h"
#include "base/memory.h"

#include <string.h>

/// @file
/// Sharpness of edges and vertices: from creases, corners and angles, through the levels, and back to creases and corners.

uint32_t mesh_half_edge_between(const mesh_level *level, uint32_t a, uint32_t b)
{
    uint32_t first = level->links->first[a], h = first;
    while (h != BAT_MESH_NONE)
    {
        uint32_t previous = sides_previous(&level->sides, h);
        if (level->faces[sides_next(&level->sides, h)] == b)
            return h;
        if (level->faces[previous] == b)
            return previous;
        h = level->links->twin[previous];
        if (h == first)
            break;
    }
    return BAT_MESH_NONE;
}

static bat_status take_creases(const mesh_level *level, const bat_mesh *mesh, double *sharpness, bat_error *error)
{
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        uint32_t h = mesh_half_edge_between(level, crease->a, crease->b);
        if (h == BAT_MESH_NONE)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "crease %zu joins vertices %u and %u, which are not an edge",
                             i, crease->a, crease->b);
        double *edge = &sharpness[level->links->edge[h]];
        *edge = fmax(*edge, crease->sharpness);
    }
    return BAT_OK;
}

/// The normal of a face, with twice its area as length: Newell's sum of the triangles from the first corner.
static void face_normal(const mesh_level *level, const double *positions, uint32_t face, double normal[3])
{
    uint32_t begin = sides_begin(&level->sides, face), end = sides_begin(&level->sides, face + 1);
    const double *p = positions + 3 * (size_t)level->faces[begin];
    normal[0] = normal[1] = normal[2] = 0;
    for (uint32_t c = begin + 1; c + 1 < end; c++)
    {
        const double *q = positions + 3 * (size_t)level->faces[c], *r = positions + 3 * (size_t)level->faces[c + 1];
        double part[3];
        vector3_triangle(p, q, r, part);
        vector_add(3, 1, part, normal);
    }
}

/// The angle between the normals of two faces, 0 to pi; 0 where a face has no area.
static double angle_between_faces(const mesh_level *level, const double *positions, uint32_t f, uint32_t g)
{
    double m[3], n[3];
    face_normal(level, positions, f, m);
    face_normal(level, positions, g, n);
    return vector3_angle(m, n);
}

static void take_angles(const mesh_level *level, const double *positions, double crease_angle, double *sharpness)
{
    const bat_mesh_connectivity *links = level->links;
    const mesh_sides *sides = &level->sides;
    for (uint32_t h = 0; h < sides_corners(sides, links->face_count); h++)
    {
        uint32_t twin = links->twin[h];
        if (twin != BAT_MESH_NONE && h < twin &&
            angle_between_faces(level, positions, sides_face(sides, h), sides_face(sides, twin)) > crease_angle)
            sharpness[links->edge[h]] = fmax(sharpness[links->edge[h]], BAT_MESH_SHARP);
    }
}

/// Release an array of zeros and set it to null.
static void drop_if_zero(size_t count, double **sharpness)
{
    for (size_t i = 0; i < count; i++)
        if ((*sharpness)[i] > 0)
            return;
    free(*sharpness);
    *sharpness = NULL;
}

bat_status sharpness_of_edges(const mesh_level *level, const bat_mesh *mesh, double crease_angle, double **sharpness,
                              bat_error *error)
{
    const bat_mesh_connectivity *links = level->links;
    *sharpness = NULL;
    if (mesh->crease_count == 0 && !(crease_angle > 0))
        return BAT_OK;
    bat_status status = array_zeros(sharpness, links->edge_count, sizeof **sharpness, error);
    if (status == BAT_OK)
        status = take_creases(level, mesh, *sharpness, error);
    if (status != BAT_OK)
    {
        free(*sharpness);
        *sharpness = NULL;
        return status;
    }
    if (crease_angle > 0)
        take_angles(level, mesh->positions, crease_angle, *sharpness);
    drop_if_zero(links->edge_count, sharpness);
    return BAT_OK;
}

bat_status sharpness_of_vertices(const mesh_level *level, const bat_mesh *mesh, bool sharpen_boundary, double **sharpness,
                                 bat_error *error)
{
    *sharpness = NULL;
    sharpen_boundary = sharpen_boundary && level->links->boundary_edge_count > 0;
    if (mesh->corner_count == 0 && !sharpen_boundary)
        return BAT_OK;
    bat_status status = array_zeros(sharpness, mesh->vertex_count, sizeof **sharpness, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < mesh->corner_count; i++)
    {
        double *vertex = &(*sharpness)[mesh->corners[i].vertex];
        *vertex = fmax(*vertex, mesh->corners[i].sharpness);
    }
    for (size_t v = 0; v < level->links->vertex_count && sharpen_boundary; v++) // those of a single face
    {
        uint32_t first = level->links->first[v];
        if (first != BAT_MESH_NONE && sides_next_around(level, first) == BAT_MESH_NONE)
            (*sharpness)[v] = fmax((*sharpness)[v], BAT_MESH_SHARP);
    }
    drop_if_zero(mesh->vertex_count, sharpness);
    return BAT_OK;
}

/// The half-edges among which the sharp ones are: those of the list or, without it, all.
static uint32_t count_candidates(const mesh_level *level)
{
    return level->sharp != NULL ? (uint32_t)level->sharp->half_edge_count
                                : sides_corners(&level->sides, level->links->face_count);
}

static inline uint32_t candidate_at(const mesh_level *level, uint32_t i)
{
    return level->sharp != NULL ? level->sharp->half_edges[i] : i;
}

static inline bool owns_sharp(const mesh_level *level, uint32_t half_edge)
{
    return mesh_owns(level->links->twin, half_edge) && level->edge_sharpness[level->links->edge[half_edge]] > 0;
}

void sharp_list_free(sharp_list *list)
{
    free(list->half_edges);
    free(list->vertices);
    free(list->marked);
    *list = (sharp_list){0};
}

static void list_vertex(sharp_list *list, uint32_t vertex)
{
    if (list->marked[vertex] == 0)
        list->vertices[list->vertex_count++] = vertex;
    list->marked[vertex] = 1;
}

bat_status sharp_list_make(const mesh_level *level, sharp_list *list, bat_error *error)
{
    const bat_mesh_connectivity *links = level->links;
    size_t vertices = links->vertex_count, sharp = 0, corners = 0;
    *list = (sharp_list){0};
    for (size_t e = 0; level->edge_sharpness != NULL && e < links->edge_count; e++)
        sharp += level->edge_sharpness[e] > 0;
    for (size_t v = 0; level->vertex_sharpness != NULL && v < level->coarse_count; v++)
        corners += level->vertex_sharpness[v] > 0;
    if (sharp == 0 && corners == 0)
        return BAT_OK;
    size_t most = 2 * sharp + corners < vertices ? 2 * sharp + corners : vertices;
    sharp_list made = {.half_edges = memory_array(sharp, sizeof *made.half_edges),
                       .vertices = memory_array(most, sizeof *made.vertices),
                       .marked = calloc(vertices, 1)};
    if (made.half_edges == NULL || made.vertices == NULL || made.marked == NULL)
    {
        sharp_list_free(&made);
        return error_memory(error, vertices);
    }
    for (uint32_t v = 0; corners > 0 && v < level->coarse_count; v++)
        if (level->vertex_sharpness[v] > 0 && links->first[v] != BAT_MESH_NONE)
            list_vertex(&made, v);
    for (uint32_t h = 0; made.half_edge_count < sharp; h++)
        if (owns_sharp(level, h))
        {
            made.half_edges[made.half_edge_count++] = h;
            list_vertex(&made, level->faces[h]);
            list_vertex(&made, level->faces[sides_next(&level->sides, h)]);
        }
    *list = made;
    return BAT_OK;
}

static bool is_semi_sharp(double sharpness)
{
    return sharpness > 0 && sharpness < BAT_MESH_SHARP;
}

/// The semi-sharp edges at a vertex.
typedef struct sharp_sum
{
    double sum;
    uint32_t count;
} sharp_sum;

/// The part of an edge's sharpness that passes on at a vertex.
static double chaikin_after_level(double sharpness, sharp_sum around)
{
    if (is_semi_sharp(sharpness) && around.count > 1)
        sharpness = 0.75 * sharpness + 0.25 * ((around.sum - sharpness) / (around.count - 1));
    return sharpness_after_level(sharpness);
}

/// Add up the semi-sharp edges at every vertex. Boundary edges are sharp for ever.
static void sum_around(const mesh_level *level, sharp_sum *sums)
{
    const bat_mesh_connectivity *links = level->links;
    memset(sums, 0, links->vertex_count * sizeof *sums);
    for (uint32_t h = 0; h < sides_corners(&level->sides, links->face_count); h++)
    {
        double sharpness = level->edge_sharpness[links->edge[h]];
        if (mesh_at_boundary(links, h) || !mesh_owns(links->twin, h) || !is_semi_sharp(sharpness))
            continue;
        const uint32_t ends[2] = {level->faces[h], level->faces[sides_next(&level->sides, h)]};
        for (int i = 0; i < 2; i++)
        {
            sums[ends[i]].sum += sharpness;
            sums[ends[i]].count++;
        }
    }
}

bat_status sharpness_chaikin(const mesh_level *level, double **children, bat_error *error)
{
    const bat_mesh_connectivity *links = level->links;
    *children = NULL;
    if (level->edge_sharpness == NULL)
        return BAT_OK;
    sharp_sum *sums = memory_array(links->vertex_count, sizeof *sums);
    *children = memory_array(links->edge_count, 2 * sizeof **children);
    if (sums == NULL || *children == NULL)
    {
        free(sums);
        free(*children);
        *children = NULL;
        return error_memory(error, links->vertex_count * sizeof *sums);
    }
    sum_around(level, sums);
    for (uint32_t h = 0; h < sides_corners(&level->sides, links->face_count); h++)
    {
        if (!mesh_owns(links->twin, h))
            continue;
        double sharpness = level->edge_sharpness[links->edge[h]], *made = *children + 2 * (size_t)links->edge[h];
        made[0] = chaikin_after_level(sharpness, sums[level->faces[h]]);
        made[1] = chaikin_after_level(sharpness, sums[level->faces[sides_next(&level->sides, h)]]);
    }
    free(sums);
    return BAT_OK;
}

/// Runs on one thread: few edges are sharp.
bat_status sharpness_split(const mesh_level *level, const bat_mesh_connectivity *fine, double **result, bat_error *error)
{
    bat_status status = array_zeros(result, fine->edge_count, sizeof **result, error);
    if (status != BAT_OK)
        return status;
    // Quads are made of corners, triangles of triangles.
    bool quads = fine->face_count == sides_corners(&level->sides, level->links->face_count);
    uint32_t candidates = count_candidates(level);
    for (uint32_t i = 0; i < candidates; i++)
    {
        uint32_t h = candidate_at(level, i);
        if (owns_sharp(level, h))
        {
            (*result)[fine->edge[quads ? 4 * h : split_near(h)]] = sharpness_of_half(level, h, true);
            (*result)[fine->edge[quads ? 4 * sides_next(&level->sides, h) + 3 : split_far(h)]] =
                sharpness_of_half(level, h, false);
        }
    }
    drop_if_zero(fine->edge_count, result);
    return BAT_OK;
}

/// Write the halves of each edge that remain sharp. With `creases` null only count them.
static size_t write_creases(const mesh_level *level, bat_mesh_crease *creases)
{
    const bat_mesh_connectivity *links = level->links;
    size_t count = 0;
    uint32_t candidates = count_candidates(level);
    for (uint32_t i = 0; i < candidates; i++)
    {
        uint32_t h = candidate_at(level, i);
        if (!owns_sharp(level, h))
            continue;
        uint32_t middle = (uint32_t)links->vertex_count + links->edge[h];
        double begin = sharpness_of_half(level, h, true), end = sharpness_of_half(level, h, false);
        if (begin > 0 && creases != NULL)
            creases[count] = (bat_mesh_crease){level->faces[h], middle, begin};
        count += begin > 0;
        if (end > 0 && creases != NULL)
            creases[count] = (bat_mesh_crease){middle, level->faces[sides_next(&level->sides, h)], end};
        count += end > 0;
    }
    return count;
}

static size_t write_corners(const mesh_level *level, bat_mesh_corner *corners)
{
    size_t count = 0;
    for (uint32_t v = 0; v < level->coarse_count; v++)
    {
        double after = sharpness_after_level(level->vertex_sharpness[v]);
        if (!(after > 0))
            continue;
        if (corners != NULL)
            corners[count] = (bat_mesh_corner){v, after};
        count++;
    }
    return count;
}

bat_status sharpness_write(const mesh_level *level, bat_mesh *fine, bat_error *error)
{
    size_t creases = level->edge_sharpness != NULL ? write_creases(level, NULL) : 0;
    size_t corners = level->vertex_sharpness != NULL ? write_corners(level, NULL) : 0;
    if (creases > 0)
    {
        if (array_make(&fine->creases, creases, sizeof *fine->creases, error) != BAT_OK)
            return BAT_NO_MEMORY;
        fine->crease_count = write_creases(level, fine->creases);
    }
    if (corners > 0)
    {
        if (array_make(&fine->corners, corners, sizeof *fine->corners, error) != BAT_OK)
            return BAT_NO_MEMORY;
        fine->corner_count = write_corners(level, fine->corners);
    }
    return BAT_OK;
}

/// The sharp edges around a vertex: their number and the corners at the ends of the first two.
typedef struct sharp_count
{
    unsigned edges;
    uint32_t corners[2];
} sharp_count;

static void count_end(sharp_count *count, uint32_t corner)
{
    if (count->edges < 2)
        count->corners[count->edges] = corner;
    count->edges++;
}

static sharp_vertex kind_of(const mesh_level *level, const sharp_count *count, double vertex_sharpness)
{
    sharp_vertex made = {.corners = {count->corners[0], count->corners[1]}};
    for (unsigned i = 0; i < 2 && i < count->edges; i++)
        made.ends[i] = level->faces[count->corners[i]];
    if (vertex_sharpness > 0 || count->edges > 2)
        made.kind = SHARP_CORNER;
    else if (count->edges == 2)
        made.kind = SHARP_CREASE;
    else
        made.kind = count->edges == 1 ? SHARP_DART : SHARP_SMOOTH;
    return made;
}

/// The values of sharpness that reach 0 in this level: their sum and number.
typedef struct fading_sum
{
    double sum;
    unsigned count;
} fading_sum;

static void fade(fading_sum *fading, double sharpness, double after)
{
    if (sharpness > 0 && !(after > 0))
    {
        fading->sum += sharpness;
        fading->count++;
    }
}

/// Count one edge around a vertex, on this level and the next.
static void count_edge(double sharpness, double child, uint32_t corner, sharp_count *now, sharp_count *after,
                       fading_sum *fading)
{
    if (sharpness > 0)
        count_end(now, corner);
    if (child > 0)
        count_end(after, corner);
    fade(fading, sharpness, child);
}

void sharpness_around(const mesh_level *level, uint32_t vertex, sharp_vertex *now, sharp_vertex *after, double *fading)
{
    const bat_mesh_connectivity *links = level->links;
    const double *edges = level->edge_sharpness;
    sharp_count count_now = {0}, count_after = {0};
    fading_sum faded = {0};
    uint32_t first = links->first[vertex], h = first, last = first;
    do
    {
        bool boundary = mesh_at_boundary(links, h);
        double sharpness = boundary ? BAT_MESH_SHARP : edges != NULL ? edges[links->edge[h]] : 0;
        double child = sharpness > 0 && !boundary ? sharpness_of_half(level, h, true) : sharpness;
        count_edge(sharpness, child, sides_next(&level->sides, h), &count_now, &count_after, &faded);
        last = h;
        h = sides_next_around(level, h);
    } while (h != BAT_MESH_NONE && h != first);
    if (h == BAT_MESH_NONE)
        count_edge(BAT_MESH_SHARP, BAT_MESH_SHARP, sides_previous(&level->sides, last), &count_now, &count_after, &faded);
    double own = level->vertex_sharpness != NULL && vertex < level->coarse_count ? level->vertex_sharpness[vertex] : 0;
    double own_after = sharpness_after_level(own);
    fade(&faded, own, own_after);
    *now = kind_of(level, &count_now, own);
    if (after == NULL)
        return;
    *after = kind_of(level, &count_after, own_after);
    *fading = faded.count > 0 ? fmin(faded.sum / faded.count, 1) : 1;
}

/// The mask of a vertex whose kind does not change.
static vertex_mask mask_of(const sharp_vertex *vertex, unsigned valence, smooth_mask *smooth)
{
    if (vertex->kind == SHARP_CORNER)
        return (vertex_mask){.own = 1};
    if (vertex->kind == SHARP_CREASE)
        return (vertex_mask){.own = 3.0 / 4, .pair = 1.0 / 8, .corners = {vertex->corners[0], vertex->corners[1]}};
    return smooth(valence);
}

vertex_mask mask_around(const mesh_level *level, uint32_t vertex, unsigned valence, smooth_mask *smooth)
{
    sharp_vertex now, after;
    double fading;
    sharpness_around(level, vertex, &now, &after, &fading);
    vertex_mask mask = mask_of(&now, valence, smooth);
    if (now.kind == after.kind || now.kind < SHARP_CREASE)
        return mask;
    // Sharpness only decreases. So at most one of the two masks is a crease, and only that one has a pair.
    vertex_mask other = mask_of(&after, valence, smooth);
    mask.own = fading * mask.own + (1 - fading) * other.own;
    mask.ring = fading * mask.ring + (1 - fading) * other.ring;
    if (after.kind == SHARP_CREASE)
        memcpy(mask.corners, other.corners, sizeof mask.corners);
    mask.pair = fading * mask.pair + (1 - fading) * other.pair;
    return mask;
}

void sharpness_visit(const mesh_level *level, void (*visit)(const void *context, uint32_t vertex), const void *context)
{
    const bat_mesh_connectivity *links = level->links;
    if (level->sharp != NULL)
    {
        for (size_t i = 0; i < level->sharp->vertex_count; i++)
            visit(context, level->sharp->vertices[i]);
        return;
    }
    for (uint32_t v = 0; level->vertex_sharpness != NULL && v < level->coarse_count; v++)
        if (level->vertex_sharpness[v] > 0 && links->first[v] != BAT_MESH_NONE)
            visit(context, v);
    uint32_t corners = level->edge_sharpness != NULL ? sides_corners(&level->sides, links->face_count) : 0;
    for (uint32_t h = 0; h < corners; h++)
        if (owns_sharp(level, h))
        {
            visit(context, level->faces[h]);
            visit(context, level->faces[sides_next(&level->sides, h)]);
        }
}

#include "mesh/decimate/collapse.h"

#include "base/error.h"
#include "mesh/labels.h"
#include "mesh/refine/sharpness.h"

/// @file
/// Rings of edges, the link condition, and the collapse itself.

void collapse_mesh_free(collapse_mesh *mesh)
{
    free(mesh->twin);
    free(mesh->edge);
    free(mesh->first);
    memory_pool_free(&mesh->pool);
    *mesh = (collapse_mesh){0};
}

static uint32_t next_around(const collapse_mesh *mesh, uint32_t half_edge)
{
    return mesh->twin[bat_mesh_previous(half_edge)];
}

static bool is_boundary(const collapse_mesh *mesh, uint32_t vertex)
{
    return mesh->twin[mesh->first[vertex]] == BAT_MESH_NONE;
}

/// Count the curve edges at both ends of an edge that becomes one, up to 3.
static void count_ends(uint32_t a, uint32_t b, uint8_t *meeting)
{
    meeting[a] = meeting[a] < 3 ? meeting[a] + 1 : 3;
    meeting[b] = meeting[b] < 3 ? meeting[b] + 1 : 3;
}

static bat_status set_creases(const bat_mesh *mesh, collapse_mesh *made, uint8_t *meeting, bat_error *error)
{
    const bat_mesh_connectivity links = {.twin = made->twin, .edge = made->edge, .first = made->first};
    const mesh_level level = {.faces = made->corner, .links = &links};
    for (size_t i = 0; i < mesh->crease_count; i++)
    {
        const bat_mesh_crease *crease = &mesh->creases[i];
        uint32_t h = mesh_half_edge_between(&level, crease->a, crease->b);
        if (h == BAT_MESH_NONE)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "crease %zu joins vertices %u and %u, which are not an edge",
                             i, crease->a, crease->b);
        uint32_t edge = made->edge[h];
        if (crease->sharpness > 0 && made->sharpness[edge] == 0 && made->twin[made->half_edge[edge]] != BAT_MESH_NONE)
        {
            count_ends(crease->a, crease->b, meeting);
            made->sharpness[edge] = crease->sharpness;
        }
    }
    return BAT_OK;
}

/// Mark the edges at which the texture jumps. Where not exactly two of them meet, each with a jump at the vertex itself, the
/// vertex is fixed.
static bat_status set_seams(const bat_mesh *mesh, collapse_mesh *made, uint8_t *meeting, bat_error *error)
{
    uint8_t *edges = calloc(made->vertex_count + 1, sizeof *edges), *jumps = calloc(made->vertex_count + 1, sizeof *jumps);
    bool room = edges != NULL && jumps != NULL;
    for (uint32_t h = 0; h < 3 * made->face_count && room; h++)
    {
        uint32_t twin = made->twin[h], a = made->corner[h], b = made->corner[bat_mesh_next(h)];
        if (twin == BAT_MESH_NONE || twin < h)
            continue;
        bool at_a = collapse_texture_jumps(mesh, h, bat_mesh_next(twin)),
             at_b = collapse_texture_jumps(mesh, bat_mesh_next(h), twin);
        if (!at_a && !at_b)
            continue;
        count_ends(a, b, edges);
        jumps[a] = (uint8_t)(jumps[a] < 3 ? jumps[a] + at_a : 3);
        jumps[b] = (uint8_t)(jumps[b] < 3 ? jumps[b] + at_b : 3);
        if (made->sharpness == NULL || made->sharpness[made->edge[h]] == 0)
            count_ends(a, b, meeting);
        made->seam[made->edge[h]] = 1;
    }
    for (size_t v = 0; v < made->vertex_count && room; v++)
        if (edges[v] > 0 && (edges[v] != 2 || jumps[v] != 2))
            made->freedom[v] = COLLAPSE_FIXED;
    free(edges);
    free(jumps);
    return room ? BAT_OK : error_memory(error, made->vertex_count * sizeof *edges);
}

/// Whether faces of two labels belong to different parts of a model: objects, groups or materials. Smoothing groups alone
/// make no border.
static bool parts_differ(const bat_mesh *mesh, uint32_t a, uint32_t b)
{
    if (a == b)
        return false;
    const bat_mesh_label *of_a = mesh->labels + a, *of_b = mesh->labels + b;
    return !mesh_text_equals(of_a->object, of_b->object) || !mesh_text_equals(of_a->group, of_b->group) ||
           !mesh_text_equals(of_a->material, of_b->material);
}

/// Mark the edges between parts of the model.
static void set_borders(const bat_mesh *mesh, collapse_mesh *made, uint8_t *meeting)
{
    for (uint32_t h = 0; h < 3 * made->face_count; h++)
    {
        uint32_t twin = made->twin[h], edge = made->edge[h];
        if (twin == BAT_MESH_NONE || twin < h || !parts_differ(mesh, mesh->face_labels[h / 3], mesh->face_labels[twin / 3]))
            continue;
        if (!collapse_edge_is_curve(made, edge))
            count_ends(made->corner[h], made->corner[bat_mesh_next(h)], meeting);
        made->seam[edge] = 1;
    }
}

static bat_status set_curves(const bat_mesh *mesh, bool seams, collapse_mesh *made, bat_error *error)
{
    bool borders = mesh->face_labels != NULL && mesh->label_count > 1;
    seams = seams && mesh->texture != NULL;
    if (mesh->crease_count == 0 && !seams && !borders)
        return BAT_OK;
    uint8_t *meeting = memory_pool_zeros(&made->pool, made->vertex_count + 1, sizeof *meeting);
    if (mesh->crease_count > 0)
        made->sharpness = memory_pool_zeros(&made->pool, made->edge_count + 1, sizeof *made->sharpness);
    if (seams || borders)
        made->seam = memory_pool_zeros(&made->pool, made->edge_count + 1, sizeof *made->seam);
    bat_status status = memory_pool_check(&made->pool, error);
    if (status == BAT_OK)
        status = set_creases(mesh, made, meeting, error);
    if (status == BAT_OK && seams)
        status = set_seams(mesh, made, meeting, error);
    if (status == BAT_OK && borders)
        set_borders(mesh, made, meeting);
    for (size_t v = 0; v < made->vertex_count && status == BAT_OK; v++)
        if (meeting[v] > 0)
            made->freedom[v] = meeting[v] == 2 && made->freedom[v] == COLLAPSE_FREE ? COLLAPSE_ON_CURVE : COLLAPSE_FIXED;
    return status;
}

static void set_freedom(const bat_mesh *mesh, collapse_mesh *made)
{
    for (size_t v = 0; v < made->vertex_count; v++)
    {
        bool used = made->first[v] != BAT_MESH_NONE;
        made->vertices_left += used;
        made->freedom[v] = used && is_boundary(made, (uint32_t)v) ? COLLAPSE_ON_CURVE : COLLAPSE_FREE;
        made->stamp[v] = 0;
    }
    for (size_t i = 0; i < mesh->corner_count; i++)
        if (mesh->corners[i].sharpness > 0)
            made->freedom[mesh->corners[i].vertex] = COLLAPSE_FIXED;
    for (size_t h = 3 * made->face_count; h-- > 0;)
        made->half_edge[made->edge[h]] = (uint32_t)h;
}

bat_status collapse_mesh_make(const bat_mesh *mesh, bool seams, collapse_mesh *made, bat_error *error)
{
    bat_mesh_connectivity connectivity;
    bat_status status = bat_mesh_connect(mesh, &connectivity, error);
    if (status != BAT_OK)
        return status;
    collapse_mesh new = {.twin = connectivity.twin,
                         .edge = connectivity.edge,
                         .first = connectivity.first,
                         .vertex_count = mesh->vertex_count,
                         .face_count = mesh->face_count,
                         .edge_count = connectivity.edge_count,
                         .faces_left = mesh->face_count};
    new.corner = memory_pool_array(&new.pool, 3 * mesh->face_count, sizeof *new.corner);
    new.half_edge = memory_pool_array(&new.pool, connectivity.edge_count, sizeof *new.half_edge);
    new.freedom = memory_pool_array(&new.pool, mesh->vertex_count, sizeof *new.freedom);
    new.stamp = memory_pool_array(&new.pool, mesh->vertex_count, sizeof *new.stamp);
    status = memory_pool_check(&new.pool, error);
    if (status == BAT_OK)
    {
        memcpy(new.corner, mesh->faces, 3 * mesh->face_count * sizeof *new.corner);
        set_freedom(mesh, &new);
        status = set_curves(mesh, seams, &new, error);
    }
    if (status == BAT_OK)
        *made = new;
    else
        collapse_mesh_free(&new);
    return status;
}

/// Append faces counter-clockwise around the vertex where `from` begins, from its face up to the face of `until`, which is
/// excluded, or to the boundary. False when there are too many.
static bool append_fan(const collapse_mesh *mesh, collapse_ring *ring, uint32_t from, uint32_t until)
{
    for (uint32_t h = from; h != until && h != BAT_MESH_NONE; h = next_around(mesh, h))
    {
        if (ring->count == COLLAPSE_MAX_FACES)
            return false;
        ring->half_edge[ring->count] = h;
        ring->vertex[ring->count++] = mesh->corner[bat_mesh_next(h)];
    }
    return true;
}

/// The faces around a boundary edge: those of j, then those of i.
static bool find_boundary_ring(const collapse_mesh *mesh, uint32_t h, collapse_ring *ring)
{
    if (!append_fan(mesh, ring, mesh->first[ring->j], bat_mesh_next(h)))
        return false;
    ring->j_end = ring->count;
    return append_fan(mesh, ring, next_around(mesh, h), BAT_MESH_NONE);
}

/// The faces around an interior edge: those of i up to the right face, those of j, then the remaining ones of a boundary
/// vertex i.
static bool find_inner_ring(const collapse_mesh *mesh, uint32_t h, collapse_ring *ring)
{
    uint32_t back = mesh->twin[h];
    uint32_t after_left = next_around(mesh, h);
    uint32_t from = ring->closed ? after_left : mesh->first[ring->i];
    if (!append_fan(mesh, ring, from, bat_mesh_next(back)))
        return false;
    ring->j_begin = ring->count;
    if (!append_fan(mesh, ring, next_around(mesh, back), bat_mesh_next(h)))
        return false;
    ring->j_end = ring->count;
    return ring->closed || append_fan(mesh, ring, after_left, BAT_MESH_NONE);
}

/// Whether all vertices of a ring are different. The ring contains the common neighbours of i and j in the vanishing faces
/// once. So this is the link condition: i and j have no other common neighbour.
static bool vertices_differ(collapse_mesh *mesh, const collapse_ring *ring)
{
    uint32_t stamp = ++mesh->last_stamp;
    if (stamp == 0)
    {
        memset(mesh->stamp, 0, mesh->vertex_count * sizeof *mesh->stamp);
        stamp = mesh->last_stamp = 1;
    }
    for (uint32_t k = 0; k < collapse_ring_vertices(ring); k++)
    {
        if (mesh->stamp[ring->vertex[k]] == stamp)
            return false;
        mesh->stamp[ring->vertex[k]] = stamp;
    }
    return true;
}

/// Whether two curve edges of a vanishing face would become one.
static bool pinches_curves(const collapse_mesh *mesh, uint32_t half_edge)
{
    return collapse_edge_is_curve(mesh, mesh->edge[bat_mesh_next(half_edge)]) &&
           collapse_edge_is_curve(mesh, mesh->edge[bat_mesh_previous(half_edge)]);
}

bool collapse_ring_find(collapse_mesh *mesh, uint32_t edge, collapse_ring *ring)
{
    uint32_t h = mesh->half_edge[edge], back = mesh->twin[h];
    bool i_open = is_boundary(mesh, mesh->corner[h]), j_open = is_boundary(mesh, mesh->corner[bat_mesh_next(h)]);
    if (back != BAT_MESH_NONE && i_open && j_open)
        return false;
    if (back != BAT_MESH_NONE && j_open)
    {
        h = back;
        back = mesh->twin[h];
    }
    ring->i = mesh->corner[h];
    ring->j = mesh->corner[bat_mesh_next(h)];
    ring->closed = !i_open && !j_open;
    ring->count = ring->j_begin = 0;
    bool fits = back == BAT_MESH_NONE ? find_boundary_ring(mesh, h, ring) : find_inner_ring(mesh, h, ring);
    if (!fits || ring->count < (ring->closed ? 3U : 1U))
        return false;
    ring->vertex[ring->count] = mesh->corner[bat_mesh_previous(ring->half_edge[ring->count - 1])];
    ring->vanishing = back == BAT_MESH_NONE ? 1 : 2;
    ring->half_edge[ring->count] = h;
    ring->half_edge[ring->count + 1] = back;
    return vertices_differ(mesh, ring) && !pinches_curves(mesh, h) && (back == BAT_MESH_NONE || !pinches_curves(mesh, back));
}

/// Remove the face of a half-edge and join the faces at its other two edges. Returns the edge that vanishes.
static uint32_t close_face(collapse_mesh *mesh, uint32_t half_edge)
{
    uint32_t next = bat_mesh_next(half_edge), previous = bat_mesh_previous(half_edge);
    uint32_t a = mesh->twin[next], b = mesh->twin[previous], opposite = mesh->corner[previous];
    uint32_t stays = mesh->edge[previous], goes = mesh->edge[next];
    if (a != BAT_MESH_NONE)
    {
        mesh->twin[a] = b;
        mesh->edge[a] = stays;
    }
    if (b != BAT_MESH_NONE)
        mesh->twin[b] = a;
    mesh->half_edge[stays] = a != BAT_MESH_NONE ? a : b;
    mesh->half_edge[goes] = BAT_MESH_NONE;
    if (mesh->sharpness != NULL && mesh->sharpness[goes] > 0)
        mesh->sharpness[stays] = mesh->sharpness[goes];
    if (mesh->seam != NULL && mesh->seam[goes] != 0)
        mesh->seam[stays] = 1;
    if (mesh->first[opposite] == previous)
        mesh->first[opposite] = a;
    uint32_t *corner = mesh->corner + half_edge / 3 * 3;
    corner[0] = corner[1] = corner[2] = BAT_MESH_NONE;
    mesh->faces_left--;
    return goes;
}

void collapse_apply(collapse_mesh *mesh, const collapse_ring *ring, uint32_t *gone, uint32_t *gone_count)
{
    uint32_t h = ring->half_edge[ring->count], count = 0;
    gone[count++] = mesh->edge[h];
    mesh->half_edge[mesh->edge[h]] = BAT_MESH_NONE;
    for (uint32_t k = ring->j_begin; k < ring->j_end; k++)
        mesh->corner[ring->half_edge[k]] = ring->i;
    for (uint32_t k = 0; k < ring->vanishing; k++)
        gone[count++] = close_face(mesh, ring->half_edge[ring->count + k]);
    mesh->first[ring->i] = ring->half_edge[0];
    mesh->first[ring->j] = BAT_MESH_NONE;
    if (mesh->freedom[ring->j] > mesh->freedom[ring->i])
        mesh->freedom[ring->i] = mesh->freedom[ring->j];
    mesh->vertices_left--;
    *gone_count = count;
}

#include "base/error.h"
#include "base/memory.h"
#include "mesh/sides.h"

#include <string.h>

/// @file
/// Twins, edge numbers and first half-edges of a mesh, in O(faces x arboricity).
///
/// Half-edge h runs from corner h to the next corner of its face. Its twin runs the other way along the same edge.

void bat_mesh_connectivity_free(bat_mesh_connectivity *connectivity)
{
    free(connectivity->twin);
    free(connectivity->first);
    free(connectivity->edge);
    *connectivity = (bat_mesh_connectivity){0};
}

/// The faces of a mesh.
typedef struct corner_list
{
    mesh_sides sides;
    const uint32_t *faces; ///< the vertices at the corners
    size_t face_count, vertex_count;
    uint32_t count; ///< of the corners
} corner_list;

static bat_status check_corners(const bat_mesh *mesh, bat_error *error)
{
    if (mesh->face_count > BAT_MESH_MAX_FACES || mesh->vertex_count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the mesh has more than %zu faces or %zu vertices", BAT_MESH_MAX_FACES,
                               (size_t)BAT_MESH_NONE);
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *corner = mesh->faces + 3 * f;
        if (corner[0] >= mesh->vertex_count || corner[1] >= mesh->vertex_count || corner[2] >= mesh->vertex_count)
            return error_set(error, BAT_INVALID_POINT, f, 0, "face %zu names a vertex beyond the %zu there are", f,
                             mesh->vertex_count);
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            return error_set(error, BAT_INVALID_POINT, f, 0, "face %zu has vertex %u twice", f,
                             corner[0] == corner[1] ? corner[0] : corner[2]);
    }
    return BAT_OK;
}

/// Find the twin of every half-edge. Each edge hangs its half-edges in a chain at its end with fewer faces. A half-edge
/// searches the chain for its twin among the earlier ones. All chains together are at most as long as the mesh times its
/// arboricity (Chiba and Nishizeki, 1985), which is at most 3 for planar meshes.
///
/// @param head  workspace, one number for each vertex
/// @param chain workspace, one number for each half-edge
/// @param high  workspace, one number for each half-edge: the other end of an edge in a chain
static bat_status join_twins(const corner_list *list, const uint32_t *faces_at, uint32_t *twin, uint32_t *head,
                             uint32_t *chain, uint32_t *high, bat_error *error)
{
    const uint32_t *faces = list->faces;
    memset(head, 0xff, list->vertex_count * sizeof *head);
    uint32_t face = 0, begin = 0, end = list->count > 0 ? sides_begin(&list->sides, 1) : 0;
    for (uint32_t h = 0; h < list->count; h++)
    {
        if (h == end)
        {
            begin = end;
            end = sides_begin(&list->sides, ++face + 1);
        }
        uint32_t a = faces[h], b = faces[h + 1 < end ? h + 1 : begin];
        bool a_is_low = faces_at[a] != faces_at[b] ? faces_at[a] < faces_at[b] : a < b;
        uint32_t low = a_is_low ? a : b, other = head[low];
        high[h] = a_is_low ? b : a;
        twin[h] = BAT_MESH_NONE;
        while (other != BAT_MESH_NONE && high[other] != high[h])
            other = chain[other];
        if (other == BAT_MESH_NONE)
        {
            chain[h] = head[low];
            head[low] = h;
            continue;
        }
        if (twin[other] != BAT_MESH_NONE)
            return error_set(error, BAT_NOT_MANIFOLD, face, 0, "face %u is the third at the edge of vertices %u and %u",
                             face, a, b);
        if (faces[other] == a)
            return error_set(error, BAT_NOT_MANIFOLD, face, 0,
                             "faces %u and %u run along the edge of vertices %u and %u in the same direction",
                             sides_face(&list->sides, other), face, a, b);
        twin[h] = other;
        twin[other] = h;
    }
    return BAT_OK;
}

/// Number the edges, count the boundary edges and choose the first half-edge of every vertex.
static void number_edges(const corner_list *list, bat_mesh_connectivity *made)
{
    uint32_t edges = 0;
    memset(made->first, 0xff, list->vertex_count * sizeof *made->first);
    for (uint32_t h = 0; h < list->count; h++)
    {
        uint32_t twin = made->twin[h], *first = &made->first[list->faces[h]];
        made->edge[h] = twin < h ? made->edge[twin] : edges++;
        made->boundary_edge_count += twin == BAT_MESH_NONE;
        if (*first == BAT_MESH_NONE || twin == BAT_MESH_NONE)
            *first = h;
    }
    made->edge_count = edges;
}

/// Check that the faces around each vertex form a single fan.
/// @param turned workspace, one number for each half-edge: the one that follows around the vertex where it begins
static bat_status check_fans(const corner_list *list, const bat_mesh_connectivity *made, const uint32_t *faces_at,
                             uint32_t *turned, bat_error *error)
{
    for (uint32_t f = 0; f < list->face_count; f++)
    {
        uint32_t begin = sides_begin(&list->sides, f), end = sides_begin(&list->sides, f + 1);
        turned[begin] = made->twin[end - 1];
        for (uint32_t h = begin + 1; h < end; h++)
            turned[h] = made->twin[h - 1];
    }
    for (size_t v = 0; v < made->vertex_count; v++)
    {
        uint32_t first = made->first[v], h = first;
        if (first == BAT_MESH_NONE)
            continue;
        uint32_t fan = 0;
        do
        {
            fan++;
            h = turned[h];
        } while (h != BAT_MESH_NONE && h != first);
        if (fan != faces_at[v])
            return error_set(
                error, BAT_NOT_MANIFOLD, sides_face(&list->sides, first), 0,
                "vertex %zu joins several fans of faces: one of them has %u of its %u faces, among them face %u", v, fan,
                faces_at[v], sides_face(&list->sides, first));
    }
    return BAT_OK;
}

bat_status sides_connect(const mesh_sides *sides, const uint32_t *faces, size_t count, size_t vertex_count,
                         bat_mesh_connectivity *connectivity, bat_error *error)
{
    const corner_list corners = {*sides, faces, count, vertex_count, sides_corners(sides, count)}, *list = &corners;
    bat_status status = BAT_OK;
    bat_mesh_connectivity made = {.twin = memory_array(list->count, sizeof *made.twin),
                                  .first = memory_array(list->vertex_count, sizeof *made.first),
                                  .edge = memory_array(list->count, sizeof *made.edge),
                                  .vertex_count = list->vertex_count,
                                  .face_count = list->face_count};
    uint32_t *faces_at = memory_array(list->vertex_count, sizeof *faces_at);
    uint32_t *work = memory_array(list->count, sizeof *work);
    if (made.twin == NULL || made.first == NULL || made.edge == NULL || faces_at == NULL || work == NULL)
        status = error_memory(error, list->count * sizeof *made.twin);
    if (status == BAT_OK)
    {
        memset(faces_at, 0, list->vertex_count * sizeof *faces_at);
        for (size_t i = 0; i < list->count; i++)
            faces_at[list->faces[i]]++;
        // `first` and `edge` serve as workspace until number_edges() fills them.
        status = join_twins(list, faces_at, made.twin, made.first, made.edge, work, error);
    }
    if (status == BAT_OK)
    {
        number_edges(list, &made);
        status = check_fans(list, &made, faces_at, work, error);
    }
    free(faces_at);
    free(work);
    if (status != BAT_OK)
    {
        bat_mesh_connectivity_free(&made);
        return status == BAT_NOT_MANIFOLD ? error_remedy(error, status, "repair", "cuts the mesh there") : status;
    }
    *connectivity = made;
    return BAT_OK;
}

uint32_t *sides_offsets(size_t face_count, uint32_t count)
{
    uint32_t *offsets = memory_array(face_count + 1, sizeof *offsets);
    for (size_t f = 0; offsets != NULL && f <= face_count; f++)
        offsets[f] = (uint32_t)f * count;
    return offsets;
}

bat_status sides_of_mesh(const bat_mesh *mesh, mesh_sides *sides, uint32_t **face, bat_error *error)
{
    size_t quads = 0;
    *face = NULL;
    *sides = (mesh_sides){0};
    for (size_t f = 0; mesh->offsets != NULL && f < mesh->face_count; f++)
        quads += mesh->offsets[f + 1] - mesh->offsets[f] == 4;
    sides->quads = mesh->offsets != NULL && quads == mesh->face_count;
    if (mesh->offsets == NULL || sides->quads)
        return BAT_OK;
    size_t corners = mesh->offsets[mesh->face_count];
    uint32_t *made = memory_array(corners, sizeof *made);
    if (made == NULL)
        return error_memory(error, corners * sizeof *made);
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (uint32_t c = mesh->offsets[f]; c < mesh->offsets[f + 1]; c++)
            made[c] = f;
    *sides = (mesh_sides){.offsets = mesh->offsets, .face = made};
    *face = made;
    return BAT_OK;
}

bat_status bat_mesh_connect(const bat_mesh *mesh, bat_mesh_connectivity *connectivity, bat_error *error)
{
    mesh_sides sides = {0};
    uint32_t *face = NULL;
    bat_status status = mesh->offsets != NULL ? bat_mesh_check(mesh, error) : check_corners(mesh, error);
    if (status == BAT_OK)
        status = sides_of_mesh(mesh, &sides, &face, error);
    if (status == BAT_OK)
        status = sides_connect(&sides, mesh->faces, mesh->face_count, mesh->vertex_count, connectivity, error);
    free(face);
    return status;
}

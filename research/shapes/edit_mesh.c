#include "research/shapes/edit_mesh.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The least cosine between the normals of a face before and after a change.
#define MIN_COSINE 0.2

void edit_mesh_free(edit_mesh *edit)
{
    free(edit->positions);
    free(edit->first);
    free(edit->faces);
    free(edit->twin);
    free(edit->marks);
    *edit = (edit_mesh){0};
}

/// Take a finished connectivity over: its arrays become the mesh's.
static bat_status adopt(const bat_mesh *mesh, const uint16_t *marks, bat_mesh_connectivity *connectivity, edit_mesh *edit,
                        bat_error *error)
{
    edit_mesh made = {.vertex_count = mesh->vertex_count,
                      .vertex_room = mesh->vertex_count,
                      .face_count = mesh->face_count,
                      .face_room = mesh->face_count};
    made.positions = malloc(mesh->vertex_count * sizeof *made.positions);
    made.faces = malloc(mesh->face_count * sizeof *made.faces);
    made.marks = malloc(mesh->face_count * sizeof *made.marks);
    if (made.positions == NULL || made.faces == NULL || made.marks == NULL)
    {
        edit_mesh_free(&made);
        return error_memory(error, mesh->face_count * sizeof *made.faces);
    }
    memcpy(made.positions, mesh->positions, mesh->vertex_count * sizeof *made.positions);
    memcpy(made.faces, mesh->faces, mesh->face_count * sizeof *made.faces);
    memcpy(made.marks, marks, mesh->face_count * sizeof *made.marks);
    made.twin = connectivity->twin;
    made.first = connectivity->first;
    connectivity->twin = connectivity->first = NULL;
    *edit = made;
    return BAT_OK;
}

bat_status edit_mesh_begin(const bat_mesh *mesh, const uint16_t *marks, edit_mesh *edit, bat_error *error)
{
    bat_mesh_connectivity connectivity;
    bat_status status = bat_mesh_connect(mesh, &connectivity, error);
    if (status != BAT_OK)
        return status;
    if (connectivity.boundary_edge_count > 0)
        status = error_set(error, BAT_NOT_MANIFOLD, BAT_NO_INDEX, 0, "the mesh has a boundary of %zu edges",
                           connectivity.boundary_edge_count);
    if (status == BAT_OK)
        status = adopt(mesh, marks, &connectivity, edit, error);
    bat_mesh_connectivity_free(&connectivity);
    return status;
}

size_t edit_valence(const edit_mesh *edit, uint32_t vertex)
{
    size_t valence = 0;
    uint32_t first = edit->first[vertex], h = first;
    do
    {
        valence++;
        h = edit_turn(edit, h);
    } while (h != first);
    return valence;
}

edit_corner edit_corner_of(const edit_mesh *edit, uint32_t vertex)
{
    edit_corner corner = {.mark_count = 0};
    uint32_t first = edit->first[vertex], h = first;
    do
    {
        size_t mark = edit->marks[h / 3];
        bool known = false;
        for (size_t i = 0; i < corner.mark_count; i++)
            known = known || corner.marks[i] == mark;
        if (!known && corner.mark_count < EDIT_MAX_MARKS)
            corner.marks[corner.mark_count++] = mark;
        corner.feature_count += edit_is_feature(edit, h);
        h = edit_turn(edit, h);
    } while (h != first);
    return corner;
}

/// (b - a) x (c - a)
static void cross(const double *a, const double *b, const double *c, double normal[3])
{
    vector3_triangle(a, b, c, normal);
}

void edit_normal(const edit_mesh *edit, size_t face, double normal[3])
{
    const uint32_t *corner = edit->faces[face];
    cross(edit->positions[corner[0]], edit->positions[corner[1]], edit->positions[corner[2]], normal);
}

/// Whether normals, of any length, look the same way. One without length, of a face that had collapsed, looks every way.
static bool agree(const double *before, const double *after)
{
    return vector3_dot(before, after) >= MIN_COSINE * sqrt(vector3_dot(before, before) * vector3_dot(after, after));
}

/// Whether a face keeps looking its way when one of its vertices moves.
static bool face_may_move(const edit_mesh *edit, size_t face, uint32_t vertex, const double point[3])
{
    double before[3], after[3];
    edit_normal(edit, face, before);
    const double *at[3];
    for (int c = 0; c < 3; c++)
        at[c] = edit->faces[face][c] == vertex ? point : edit->positions[edit->faces[face][c]];
    cross(at[0], at[1], at[2], after);
    return agree(before, after);
}

bool edit_move(edit_mesh *edit, uint32_t vertex, const double point[3])
{
    uint32_t first = edit->first[vertex], h = first;
    do
    {
        if (!face_may_move(edit, h / 3, vertex, point))
            return false;
        h = edit_turn(edit, h);
    } while (h != first);
    memcpy(edit->positions[vertex], point, sizeof edit->positions[vertex]);
    return true;
}

static bool grow(void **array, size_t room, size_t size)
{
    void *grown = realloc(*array, room * size);
    if (grown == NULL)
        return false;
    *array = grown;
    return true;
}

/// Room for one more vertex and two more faces.
static bool reserve(edit_mesh *edit)
{
    if (edit->vertex_count + 1 > edit->vertex_room)
    {
        size_t room = 2 * edit->vertex_room;
        if (!grow((void **)&edit->positions, room, sizeof *edit->positions) ||
            !grow((void **)&edit->first, room, sizeof *edit->first))
            return false;
        edit->vertex_room = room;
    }
    if (edit->face_count + 2 > edit->face_room)
    {
        size_t room = 2 * edit->face_room + 2;
        if (!grow((void **)&edit->faces, room, sizeof *edit->faces) ||
            !grow((void **)&edit->twin, room, 3 * sizeof *edit->twin) ||
            !grow((void **)&edit->marks, room, sizeof *edit->marks))
            return false;
        edit->face_room = room;
    }
    return true;
}

static void join(edit_mesh *edit, uint32_t a, uint32_t b)
{
    edit->twin[a] = b;
    edit->twin[b] = a;
}

/// Cut the face of a half-edge from the vertex `middle` on it to the opposite corner. The face keeps the half-edge's begin;
/// the new one, which is appended, keeps its end.
/// @return the half-edge from `middle` to the end, in the new face
static uint32_t cut_face(edit_mesh *edit, uint32_t h, uint32_t middle)
{
    uint32_t next = bat_mesh_next(h), opposite = edit_to(edit, next), end = edit_to(edit, h);
    size_t made = edit->face_count++;
    uint32_t base = (uint32_t)(3 * made);
    edit->faces[made][0] = middle;
    edit->faces[made][1] = end;
    edit->faces[made][2] = opposite;
    edit->marks[made] = edit->marks[h / 3];
    join(edit, base + 1, edit->twin[next]);
    edit->faces[next / 3][next % 3] = middle;
    join(edit, base + 2, next);
    edit->first[end] = base + 1;
    edit->first[opposite] = base + 2;
    return base;
}

bool edit_split(edit_mesh *edit, uint32_t half_edge)
{
    if (!reserve(edit))
        return false;
    uint32_t twin = edit->twin[half_edge];
    uint32_t middle = (uint32_t)edit->vertex_count++;
    const double *a = edit->positions[edit_from(edit, half_edge)], *b = edit->positions[edit_from(edit, twin)];
    for (int c = 0; c < 3; c++)
        edit->positions[middle][c] = (a[c] + b[c]) / 2;
    uint32_t far_half = cut_face(edit, half_edge, middle), near_half = cut_face(edit, twin, middle);
    join(edit, half_edge, near_half);
    join(edit, twin, far_half);
    edit->first[middle] = far_half;
    return true;
}

static bool has_edge(const edit_mesh *edit, uint32_t a, uint32_t b)
{
    uint32_t first = edit->first[a], h = first;
    do
    {
        if (edit_to(edit, h) == b)
            return true;
        h = edit_turn(edit, h);
    } while (h != first);
    return false;
}

bool edit_flip(edit_mesh *edit, uint32_t half_edge)
{
    uint32_t h = half_edge, t = edit->twin[h];
    uint32_t h1 = bat_mesh_next(h), h2 = bat_mesh_previous(h), t1 = bat_mesh_next(t), t2 = bat_mesh_previous(t);
    uint32_t a = edit_from(edit, h), b = edit_from(edit, t), c = edit_from(edit, h2), d = edit_from(edit, t2);
    if (edit_is_feature(edit, h) || c == d || has_edge(edit, c, d))
        return false;
    double left[3], right[3], before[3], upper[3], lower[3];
    edit_normal(edit, h / 3, left);
    edit_normal(edit, t / 3, right);
    for (int i = 0; i < 3; i++)
        before[i] = left[i] + right[i];
    cross(edit->positions[c], edit->positions[d], edit->positions[b], upper);
    cross(edit->positions[d], edit->positions[c], edit->positions[a], lower);
    if (!agree(before, upper) || !agree(before, lower) || !agree(upper, lower))
        return false;
    // The faces become (c, d, b) and (d, c, a), their first half-edges the turned edge.
    uint32_t b_to_c = edit->twin[h1], c_to_a = edit->twin[h2], a_to_d = edit->twin[t1], d_to_b = edit->twin[t2];
    uint32_t f = h / 3, g = t / 3;
    memcpy(edit->faces[f], (uint32_t[3]){c, d, b}, sizeof edit->faces[f]);
    memcpy(edit->faces[g], (uint32_t[3]){d, c, a}, sizeof edit->faces[g]);
    join(edit, 3 * f, 3 * g);
    join(edit, 3 * f + 1, d_to_b);
    join(edit, 3 * f + 2, b_to_c);
    join(edit, 3 * g + 1, c_to_a);
    join(edit, 3 * g + 2, a_to_d);
    edit->first[c] = 3 * f;
    edit->first[d] = 3 * g;
    edit->first[b] = 3 * f + 2;
    edit->first[a] = 3 * g + 2;
    return true;
}

/// Whether the ends of an edge have no neighbours in common but the two across it (the link condition), and these keep three
/// neighbours.
static bool keeps_manifold(const edit_mesh *edit, uint32_t h)
{
    uint32_t t = edit->twin[h], a = edit_from(edit, h), b = edit_from(edit, t);
    uint32_t c = edit_from(edit, bat_mesh_previous(h)), d = edit_from(edit, bat_mesh_previous(t));
    if (c == d || edit_valence(edit, c) <= 3 || edit_valence(edit, d) <= 3)
        return false;
    uint32_t around = edit->first[a], first = around;
    do
    {
        uint32_t neighbour = edit_to(edit, around);
        if (neighbour != b && neighbour != c && neighbour != d && has_edge(edit, neighbour, b))
            return false;
        around = edit_turn(edit, around);
    } while (around != first);
    return true;
}

/// Whether all faces around `vertex` that do not have `other` may follow it to `point`, with edges not longer than
/// `longest`.
static bool fan_may_move(const edit_mesh *edit, uint32_t vertex, uint32_t other, const double point[3], double longest)
{
    uint32_t first = edit->first[vertex], h = first;
    do
    {
        uint32_t next = edit_to(edit, h), last = edit_from(edit, bat_mesh_previous(h));
        const double *at = edit->positions[next];
        double away[3] = {at[0] - point[0], at[1] - point[1], at[2] - point[2]};
        if (next != other && vector3_dot(away, away) > longest * longest)
            return false;
        if (next != other && last != other && !face_may_move(edit, h / 3, vertex, point))
            return false;
        h = edit_turn(edit, h);
    } while (h != first);
    return true;
}

/// Take the face of a half-edge out, its two other edges becoming one.
static void close_face(edit_mesh *edit, uint32_t h)
{
    uint32_t left = edit->twin[bat_mesh_next(h)], right = edit->twin[bat_mesh_previous(h)];
    uint32_t b = edit_to(edit, h), c = edit_from(edit, bat_mesh_previous(h));
    join(edit, left, right);
    edit->first[c] = left;
    edit->first[b] = right;
    edit->faces[h / 3][0] = BAT_MESH_NONE;
    edit->dead_faces++;
}

bool edit_collapse(edit_mesh *edit, uint32_t half_edge, const double point[3], double longest)
{
    uint32_t h = half_edge, t = edit->twin[h], a = edit_from(edit, h), b = edit_from(edit, t);
    if (!keeps_manifold(edit, h) || !fan_may_move(edit, a, b, point, longest) || !fan_may_move(edit, b, a, point, longest))
        return false;
    uint32_t around = edit_turn(edit, h);
    while (around != h)
    {
        edit->faces[around / 3][around % 3] = b;
        around = edit_turn(edit, around);
    }
    edit->faces[h / 3][h % 3] = b;
    // In both faces the collapsed edge now runs from b to b; what is left of them closes.
    uint32_t beyond_h = edit->twin[bat_mesh_previous(h)];
    close_face(edit, h);
    close_face(edit, t);
    edit->first[b] = beyond_h;
    edit->first[a] = BAT_MESH_NONE;
    edit->dead_vertices++;
    memcpy(edit->positions[b], point, sizeof edit->positions[b]);
    return true;
}

bat_status edit_mesh_compact(edit_mesh *edit, bat_error *error)
{
    uint32_t *vertex_at = memory_array(edit->vertex_count, sizeof *vertex_at);
    uint32_t *face_at = memory_array(edit->face_count, sizeof *face_at);
    if (vertex_at == NULL || face_at == NULL)
    {
        free(vertex_at);
        free(face_at);
        return error_memory(error, edit->face_count * sizeof *face_at);
    }
    uint32_t vertices = 0, faces = 0;
    for (size_t f = 0; f < edit->face_count; f++)
        face_at[f] = edit->faces[f][0] == BAT_MESH_NONE ? BAT_MESH_NONE : faces++;
    for (size_t v = 0; v < edit->vertex_count; v++)
    {
        if (edit->first[v] == BAT_MESH_NONE)
            continue;
        memmove(edit->positions[vertices], edit->positions[v], sizeof *edit->positions);
        edit->first[vertices] = 3 * face_at[edit->first[v] / 3] + edit->first[v] % 3;
        vertex_at[v] = vertices++;
    }
    for (size_t f = 0; f < edit->face_count; f++)
    {
        uint32_t to = face_at[f];
        if (to == BAT_MESH_NONE)
            continue;
        for (uint32_t c = 0; c < 3; c++)
        {
            uint32_t twin = edit->twin[3 * f + c];
            edit->faces[to][c] = vertex_at[edit->faces[f][c]];
            edit->twin[3 * to + c] = 3 * face_at[twin / 3] + twin % 3;
        }
        edit->marks[to] = edit->marks[f];
    }
    free(vertex_at);
    free(face_at);
    edit->vertex_count = vertices;
    edit->face_count = faces;
    edit->dead_vertices = edit->dead_faces = 0;
    return BAT_OK;
}

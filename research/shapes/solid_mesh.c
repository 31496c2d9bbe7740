/// @file
/// Isotropic remeshing of the boundary of a solid, with sharp features: Botsch and Kobbelt, "A remeshing approach to
/// multiresolution modeling" (2004). Split long edges, collapse short ones, flip, relax tangentially, project to the
/// surfaces.

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "research/shapes/edit_mesh.h"
#include "research/shapes/solid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Edges are split above and collapsed below these multiples of the target length.
#define LONGEST_EDGE (4.0 / 3.0)
#define SHORTEST_EDGE (4.0 / 5.0)
/// Corners closer than this multiple are merged.
#define NEAREST_CORNERS 0.25

/// Cells of the first lattice, which measures the area, along the longest side of the bounding box.
#define FIRST_CELLS 28.0
/// Spacing of the lattice, as a multiple of the target edge length.
#define CELL_PER_EDGE 1.15

/// Assumed Lipschitz constant of the values: initial, and maximum after failures.
#define STEEPEST 2.0
#define MAX_STEEPEST 16.0

#define ROUNDS 7
/// Factor on the measured number of vertices, because collapses slightly outnumber splits.
#define LAST_GAIN 0.985
/// Final passes of flips and relaxation, and final Newton steps to the surfaces.
#define LAST_PASSES 3
#define LAST_STEPS 4

typedef struct remesher
{
    const solid *shape;
    edit_mesh edit;
    double edge; ///< target edge length
} remesher;

static double edge_length(const edit_mesh *edit, uint32_t h)
{
    return vector3_distance(edit->positions[edit_from(edit, h)], edit->positions[edit_to(edit, h)]);
}

/// Follow edges to the longest edge of both its faces (longest-edge bisection; Rivara, 1984). Only these are split, which
/// prevents ever flatter triangles.
static uint32_t longest_near(const edit_mesh *edit, uint32_t h)
{
    double longest = edge_length(edit, h) * (1 + 1e-9);
    for (;;)
    {
        uint32_t t = edit->twin[h], best = h;
        uint32_t around[4] = {bat_mesh_next(h), bat_mesh_previous(h), bat_mesh_next(t), bat_mesh_previous(t)};
        for (int i = 0; i < 4; i++)
            if (edge_length(edit, around[i]) > longest)
            {
                longest = edge_length(edit, around[i]) * (1 + 1e-9);
                best = around[i];
            }
        if (best == h)
            return h;
        h = best;
    }
}

static bat_status split_long(remesher *r, bat_error *error)
{
    edit_mesh *edit = &r->edit;
    for (uint32_t h = 0; h < 3 * edit->face_count; h++)
        while (edge_length(edit, h) > LONGEST_EDGE * r->edge)
            if (!edit_split(edit, longest_near(edit, h)))
                return error_memory(error, 2 * edit->face_room * sizeof *edit->faces);
    return BAT_OK;
}

/// Whether the begin of an edge may be collapsed into its end. Vertices on features may only move along features. Corners
/// may merge along a feature if they are very close.
static bool may_collapse(const remesher *r, uint32_t h)
{
    const edit_mesh *edit = &r->edit;
    size_t from = edit_corner_of(edit, edit_from(edit, h)).feature_count;
    if (from == 0 || !edit_is_feature(edit, h))
        return from == 0;
    size_t to = edit_corner_of(edit, edit_to(edit, h)).feature_count;
    return from == 2 || (to != 2 && edge_length(edit, h) < NEAREST_CORNERS * r->edge);
}

static bool collapse_one(remesher *r, uint32_t h)
{
    edit_mesh *edit = &r->edit;
    uint32_t t = edit->twin[h];
    bool first_moves = may_collapse(r, h), second_moves = may_collapse(r, t);
    if (!first_moves && !second_moves)
        return false;
    const double *a = edit->positions[edit_from(edit, h)], *b = edit->positions[edit_from(edit, t)];
    double share = !second_moves ? 1 : !first_moves ? 0 : 0.5;
    bool surface_ends = first_moves && second_moves;
    if (surface_ends && !edit_is_feature(edit, h))
    {
        // One vertex may be on a feature that does not contain this edge.
        bool first_free = edit_corner_of(edit, edit_from(edit, h)).feature_count == 0;
        bool second_free = edit_corner_of(edit, edit_from(edit, t)).feature_count == 0;
        share = first_free && second_free ? 0.5 : first_free ? 1 : 0;
    }
    double point[3];
    for (int c = 0; c < 3; c++)
        point[c] = (1 - share) * a[c] + share * b[c];
    return edit_collapse(edit, first_moves ? h : t, point, LONGEST_EDGE * r->edge);
}

static bat_status collapse_short(remesher *r, bat_error *error)
{
    edit_mesh *edit = &r->edit;
    for (uint32_t h = 0; h < 3 * edit->face_count; h++)
        if (edit->faces[h / 3][0] != BAT_MESH_NONE && edge_length(edit, h) < SHORTEST_EDGE * r->edge)
            collapse_one(r, h);
    return edit_mesh_compact(edit, error);
}

static double corner_cosine(const double *at, const double *b, const double *c)
{
    double u[3] = {b[0] - at[0], b[1] - at[1], b[2] - at[2]}, v[3] = {c[0] - at[0], c[1] - at[1], c[2] - at[2]};
    return (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / (vector3_distance(at, b) * vector3_distance(at, c) + 1e-300);
}

/// Flip edges: before the last round, if valences get closer to 6; later, if the opposite angles sum to more than pi
/// (Delaunay).
static void flip_edges(remesher *r, bool by_valence)
{
    edit_mesh *edit = &r->edit;
    for (uint32_t h = 0; h < 3 * edit->face_count; h++)
    {
        uint32_t t = edit->twin[h];
        if (t < h || edit_is_feature(edit, h))
            continue;
        uint32_t a = edit_from(edit, h), b = edit_from(edit, t);
        uint32_t c = edit_from(edit, bat_mesh_previous(h)), d = edit_from(edit, bat_mesh_previous(t));
        bool better;
        if (by_valence)
        {
            int va = (int)edit_valence(edit, a), vb = (int)edit_valence(edit, b);
            int vc = (int)edit_valence(edit, c), vd = (int)edit_valence(edit, d);
            int before = abs(va - 6) + abs(vb - 6) + abs(vc - 6) + abs(vd - 6);
            int after = abs(va - 7) + abs(vb - 7) + abs(vc - 5) + abs(vd - 5);
            better = after < before && va > 3 && vb > 3;
        }
        else
        {
            const double *pa = edit->positions[a], *pb = edit->positions[b];
            better = corner_cosine(edit->positions[c], pa, pb) + corner_cosine(edit->positions[d], pa, pb) < -1e-9 &&
                     edit_valence(edit, a) > 3 && edit_valence(edit, b) > 3;
        }
        if (better)
            edit_flip(edit, h);
    }
}

/// The mean of the neighbours of a vertex (on a feature: along it), and the normal.
static void neighbourhood(const edit_mesh *edit, uint32_t vertex, bool along_feature, double mean[3], double normal[3])
{
    double weight = 0;
    for (int c = 0; c < 3; c++)
        mean[c] = normal[c] = 0;
    uint32_t first = edit->first[vertex], h = first;
    do
    {
        double face_normal[3];
        edit_normal(edit, h / 3, face_normal);
        if (!along_feature || edit_is_feature(edit, h))
        {
            const double *at = edit->positions[edit_to(edit, h)];
            for (int c = 0; c < 3; c++)
                mean[c] += at[c];
            weight += 1;
        }
        for (int c = 0; c < 3; c++)
            normal[c] += face_normal[c];
        h = edit_turn(edit, h);
    } while (h != first);
    for (int c = 0; c < 3; c++)
        mean[c] /= weight;
}

/// Move a vertex tangentially towards the mean of its neighbours, and project it to its surfaces.
static void relax(remesher *r, uint32_t vertex)
{
    edit_mesh *edit = &r->edit;
    edit_corner corner = edit_corner_of(edit, vertex);
    double point[3];
    memcpy(point, edit->positions[vertex], sizeof point);
    if (corner.feature_count == 0 || corner.feature_count == 2)
    {
        double mean[3], normal[3], towards[3];
        neighbourhood(edit, vertex, corner.feature_count == 2, mean, normal);
        double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2], out = 0;
        for (int c = 0; c < 3; c++)
        {
            towards[c] = mean[c] - point[c];
            out += towards[c] * normal[c];
        }
        out = corner.feature_count == 0 && square > 0 ? out / square : 0;
        for (int c = 0; c < 3; c++)
            point[c] += 0.7 * (towards[c] - out * normal[c]);
    }
    if (corner.mark_count <= SOLID_MAX_MEETING)
        solid_step_towards(r->shape, corner.marks, corner.mark_count, 0.3 * r->edge, 1e-3 * r->edge, point);
    edit_move(edit, vertex, point);
}

static void relax_all(remesher *r)
{
    for (uint32_t v = 0; v < r->edit.vertex_count; v++)
        relax(r, v);
}

/// Project all vertices to their surfaces.
static void project_vertices(remesher *r)
{
    edit_mesh *edit = &r->edit;
    for (uint32_t v = 0; v < edit->vertex_count; v++)
    {
        edit_corner corner = edit_corner_of(edit, v);
        if (corner.mark_count > SOLID_MAX_MEETING)
            continue;
        double point[3];
        memcpy(point, edit->positions[v], sizeof point);
        for (int step = 0; step < LAST_STEPS; step++)
            solid_step_towards(r->shape, corner.marks, corner.mark_count, 0.2 * r->edge, 1e-5 * r->edge, point);
        edit_move(edit, v, point);
    }
}

/// The estimated number of vertices without omitted surfaces: half the number of faces.
static double count_vertices(const remesher *r)
{
    size_t faces = 0;
    for (size_t f = 0; f < r->edit.face_count; f++)
        faces += !r->shape->surfaces[r->edit.marks[f]].open;
    return 0.5 * (double)faces;
}

static bat_status remesh(remesher *r, size_t vertices, bat_error *error)
{
    bat_status status = BAT_OK;
    for (int round = 0; round < ROUNDS && status == BAT_OK; round++)
    {
        status = split_long(r, error);
        if (status == BAT_OK)
            status = collapse_short(r, error);
        if (status != BAT_OK)
            break;
        flip_edges(r, round < ROUNDS - 1);
        relax_all(r);
        if (round > 0)
            r->edge *= sqrt(LAST_GAIN * count_vertices(r) / (double)vertices);
    }
    if (status != BAT_OK)
        return status;
    for (int pass = 0; pass < LAST_PASSES; pass++)
    {
        flip_edges(r, false);
        relax_all(r);
    }
    flip_edges(r, false);
    project_vertices(r);
    return BAT_OK;
}

/// The area without omitted surfaces.
static double area_of(const solid *s, const bat_mesh *mesh, const uint16_t *surfaces)
{
    double area = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        if (s->surfaces[surfaces[f]].open)
            continue;
        const uint32_t *corner = mesh->faces + 3 * f;
        const double *a = mesh->positions + 3 * corner[0], *b = mesh->positions + 3 * corner[1];
        const double *c = mesh->positions + 3 * corner[2];
        double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        area +=
            sqrt(pow(u[1] * v[2] - u[2] * v[1], 2) + pow(u[2] * v[0] - u[0] * v[2], 2) + pow(u[0] * v[1] - u[1] * v[0], 2)) /
            2;
    }
    return area;
}

/// The edge length for a given number of vertices, with twice as many equilateral triangles.
static double edge_for(double area, size_t vertices)
{
    return sqrt(area / (0.5 * sqrt(3) * (double)vertices));
}

/// The target edge length, from the area of a coarse mesh.
static bat_status choose_edge(const solid *s, size_t vertices, double *edge, bat_error *error)
{
    double longest = fmax(fmax(s->high[0] - s->low[0], s->high[1] - s->low[1]), s->high[2] - s->low[2]);
    bat_mesh rough;
    uint16_t *surfaces;
    bat_status status = solid_cut(s, longest / FIRST_CELLS, STEEPEST, &rough, &surfaces, error);
    if (status != BAT_OK)
        return status;
    *edge = edge_for(area_of(s, &rough, surfaces), vertices);
    bat_mesh_free(&rough);
    free(surfaces);
    return BAT_OK;
}

/// Extract the mesh without the faces of omitted surfaces.
static bat_status extract_mesh(const solid *s, const edit_mesh *edit, bat_mesh *mesh, bat_error *error)
{
    uint32_t *number = memory_array(edit->vertex_count, sizeof *number);
    bat_mesh made = {.positions = memory_array(edit->vertex_count, 3 * sizeof(double)),
                     .faces = memory_array(edit->face_count, 3 * sizeof(uint32_t))};
    if (number == NULL || made.positions == NULL || made.faces == NULL)
    {
        free(number);
        bat_mesh_free(&made);
        return error_memory(error, edit->vertex_count * 3 * sizeof(double));
    }
    memset(number, 0xff, edit->vertex_count * sizeof *number);
    for (size_t f = 0; f < edit->face_count; f++)
    {
        if (s->surfaces[edit->marks[f]].open)
            continue;
        for (int c = 0; c < 3; c++)
        {
            uint32_t v = edit->faces[f][c];
            if (number[v] == UINT32_MAX)
            {
                memcpy(made.positions + 3 * made.vertex_count, edit->positions[v], 3 * sizeof(double));
                number[v] = (uint32_t)made.vertex_count++;
            }
            made.faces[3 * made.face_count + (size_t)c] = number[v];
        }
        made.face_count++;
    }
    free(number);
    *mesh = made;
    return BAT_OK;
}

/// Extract the boundary from the lattice. If it is not a manifold, increase the assumed Lipschitz constant.
static bat_status begin(remesher *r, bat_error *error)
{
    bat_status status = BAT_NOT_MANIFOLD;
    for (double steepest = STEEPEST; steepest <= MAX_STEEPEST && status == BAT_NOT_MANIFOLD; steepest *= 2)
    {
        bat_mesh rough;
        uint16_t *surfaces;
        status = solid_cut(r->shape, CELL_PER_EDGE * r->edge, steepest, &rough, &surfaces, error);
        if (status != BAT_OK)
            return status;
        status = edit_mesh_begin(&rough, surfaces, &r->edit, error);
        bat_mesh_free(&rough);
        free(surfaces);
    }
    return status;
}

bat_status solid_mesh(const solid *s, size_t vertices, bat_mesh *mesh, bat_error *error)
{
    remesher r = {.shape = s};
    bat_status status = choose_edge(s, vertices, &r.edge, error);
    if (status == BAT_OK)
        status = begin(&r, error);
    if (status == BAT_OK)
        status = remesh(&r, vertices, error);
    if (status == BAT_OK)
        status = extract_mesh(s, &r.edit, mesh, error);
    edit_mesh_free(&r.edit);
    return status;
}

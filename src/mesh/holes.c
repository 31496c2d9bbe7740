#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"
#include "mesh/check.h"
#include "mesh/hash_table.h"

#include <string.h>

/// @file
/// Filling of holes: boundary loops of few edges get the triangles of least area (Barequet and Sharir, "Filling gaps in the
/// boundary of a polyhedron", 1995), by dynamic programming over all triangulations of a loop.
///
/// A boundary that passes a point twice, at copies of one vertex, is several loops. The copies become one vertex again where
/// such a loop is filled; a loop of two edges needs no triangle.

/// A loop of `count` boundary half-edges, and the tables of its triangulations.
typedef struct hole
{
    const bat_mesh *mesh;
    const bat_mesh_connectivity *links;
    const uint32_t *half_edges; ///< in the order of the loop
    size_t count;
    double *cost;     ///< count x count: least cost of the part of the loop between two vertices; infinite for none
    uint32_t *apex;   ///< count x count: the third vertex of the triangle on the chord between two vertices
    uint32_t *place;  ///< vertex_count: the place in the loop, or BAT_MESH_NONE
    uint32_t *path;   ///< the half-edges of a boundary that belong to no loop yet
    uint32_t *passed; ///< vertex_count: the place in the path, or BAT_MESH_NONE
    uint32_t *point;  ///< vertex_count: the first boundary vertex with the same position; the vertex itself within the mesh
    bool *joins;      ///< for each point: whether its vertices become one
} hole;

static uint32_t vertex_of(const hole *at, size_t i)
{
    return at->mesh->faces[at->half_edges[i]];
}

static uint32_t end_of(const hole *at, size_t i)
{
    return at->mesh->faces[bat_mesh_next(at->half_edges[i])];
}

/// The area of a triangle, and a little of its squared edges: of equal areas the better shapes win.
static double cost_of(const hole *at, size_t i, size_t j, size_t k)
{
    static const double share = 1e-3;
    const size_t corners[3] = {i, j, k};
    double edge[3][3], normal[3], squares = 0;
    for (size_t c = 0; c < 3; c++)
    {
        const double *a = at->mesh->positions + 3 * (size_t)vertex_of(at, corners[c]),
                     *b = at->mesh->positions + 3 * (size_t)vertex_of(at, corners[(c + 1) % 3]);
        vector3_subtract(b, a, edge[c]);
        squares += vector3_dot(edge[c], edge[c]);
    }
    vector3_cross(edge[0], edge[1], normal);
    return sqrt(vector3_dot(normal, normal)) / 2 + share * squares;
}

/// Forbid chords that are edges of the mesh already.
static void forbid_edges(hole *at)
{
    size_t n = at->count;
    for (size_t i = 0; i < n; i++)
        at->place[at->point[vertex_of(at, i)]] = (uint32_t)i;
    for (size_t i = 0; i < 2 * n; i++) // the faces around the begins, then those around the ends
    {
        size_t j = i < n ? i : (i + 1) % n;
        uint32_t h = i < n ? at->half_edges[i] : at->links->first[end_of(at, i - n)];
        for (; h != BAT_MESH_NONE; h = bat_mesh_next_around(at->links, h))
        {
            size_t k = at->place[at->point[at->mesh->faces[bat_mesh_next(h)]]];
            if (k != BAT_MESH_NONE && k + 1 != j && j + 1 != k)
                at->cost[j * n + k] = at->cost[k * n + j] = NAN;
        }
    }
    for (size_t i = 0; i < n; i++)
        at->place[at->point[vertex_of(at, i)]] = BAT_MESH_NONE;
}

/// Find the cheapest triangulation of every part of the loop. False when the whole has none.
static bool find_triangles(hole *at)
{
    size_t n = at->count;
    memset(at->cost, 0, n * n * sizeof *at->cost);
    forbid_edges(at);
    for (size_t span = 2; span < n; span++)
        for (size_t i = 0; i + span < n; i++)
        {
            size_t k = i + span;
            double best = INFINITY;
            bool whole = span == n - 1; // the edge from the last vertex to the first one is the mesh's own
            for (size_t j = i + 1; j < k && (whole || !isnan(at->cost[i * n + k])); j++)
            {
                double cost = at->cost[i * n + j] + at->cost[j * n + k] + cost_of(at, i, j, k);
                if (cost < best)
                {
                    best = cost;
                    at->apex[i * n + k] = (uint32_t)j;
                }
            }
            at->cost[i * n + k] = best;
        }
    return isfinite(at->cost[n - 1]);
}

/// Append the triangles of a part of the loop, which run against the loop. `stack` holds the parts that wait.
static void add_triangles(const hole *at, size_t (*stack)[2], bat_mesh *closed)
{
    size_t n = at->count, waiting = 1;
    stack[0][0] = 0;
    stack[0][1] = n - 1;
    while (waiting > 0)
    {
        size_t i = stack[--waiting][0], k = stack[waiting][1];
        if (k < i + 2)
            continue;
        size_t j = at->apex[i * n + k], f = closed->face_count++;
        const size_t corners[3] = {k, j, i};
        for (size_t c = 0; c < 3; c++)
        {
            closed->faces[3 * f + c] = vertex_of(at, corners[c]);
            if (closed->texture_faces != NULL)
                closed->texture_faces[3 * f + c] = at->mesh->texture_faces[at->half_edges[corners[c]]];
        }
        if (closed->face_labels != NULL)
            closed->face_labels[f] = at->mesh->face_labels[at->half_edges[i] / 3];
        stack[waiting][0] = i;
        stack[waiting++][1] = j;
        stack[waiting][0] = j;
        stack[waiting++][1] = k;
    }
}

/// Lengthen the arrays of faces.
static bool reserve_faces(bat_mesh *mesh, size_t count)
{
    uint32_t *faces = realloc(mesh->faces, 3 * count * sizeof *faces);
    mesh->faces = faces != NULL ? faces : mesh->faces;
    uint32_t *texture = mesh->texture_faces != NULL ? realloc(mesh->texture_faces, 3 * count * sizeof *texture) : NULL;
    bool room = faces != NULL && (texture != NULL || mesh->texture_faces == NULL);
    mesh->texture_faces = texture != NULL ? texture : mesh->texture_faces;
    uint32_t *labels = mesh->face_labels != NULL ? realloc(mesh->face_labels, count * sizeof *labels) : NULL;
    room = room && (labels != NULL || mesh->face_labels == NULL);
    mesh->face_labels = labels != NULL ? labels : mesh->face_labels;
    return room;
}

/// Fill the loop at the end of a path, from its place `begin` on, unless it has more than `most` edges.
static bool fill_loop(hole *at, size_t begin, size_t end, size_t most, size_t (*stack)[2], size_t *filled, bat_mesh *closed)
{
    at->half_edges = at->path + begin;
    at->count = end - begin;
    for (size_t i = 0; i < at->count; i++)
        at->passed[at->point[vertex_of(at, i)]] = BAT_MESH_NONE;
    if (at->count < 2 || at->count > most || (at->count > 2 && !find_triangles(at)))
        return true;
    if (!reserve_faces(closed, closed->face_count + at->count - 2))
        return false;
    add_triangles(at, stack, closed);
    for (size_t i = 0; i < at->count; i++)
        at->joins[at->point[end_of(at, i)]] |= end_of(at, i) != vertex_of(at, (i + 1) % at->count);
    ++*filled;
    return true;
}

/// Fill all loops of at most `most` edges. `closed` is a copy of the mesh.
static bool fill_loops(hole *at, size_t most, unsigned char *seen, size_t (*stack)[2], size_t *filled, bat_mesh *closed)
{
    bool room = true;
    for (uint32_t begin = 0; begin < 3 * at->mesh->face_count && room; begin++)
    {
        uint32_t length = 0;
        for (uint32_t h = begin; at->links->twin[h] == BAT_MESH_NONE && seen[h] == 0 && room;)
        {
            uint32_t *passed = &at->passed[at->point[at->mesh->faces[h]]], back = *passed;
            seen[h] = 1;
            if (back != BAT_MESH_NONE)
                room = fill_loop(at, back, length, most, stack, filled, closed);
            length = back != BAT_MESH_NONE ? back : length;
            *passed = length;
            at->path[length++] = h;
            h = at->links->first[at->mesh->faces[bat_mesh_next(h)]];
        }
        room = room && fill_loop(at, 0, length, most, stack, filled, closed);
    }
    return room;
}

/// Find the boundary vertices at each point. False when out of memory.
static bool find_points(hole *at)
{
    point_table table = {.points = at->mesh->positions};
    bool room = true;
    for (uint32_t v = 0; v < at->mesh->vertex_count && room; v++)
    {
        uint32_t first = at->links->first[v], found = BAT_MESH_NONE;
        bool open = first != BAT_MESH_NONE && at->links->twin[first] == BAT_MESH_NONE;
        if (open)
            found = point_table_find(&table, at->mesh->positions + 3 * (size_t)v);
        room = !open || found != BAT_MESH_NONE || point_table_add(&table, v);
        at->point[v] = found != BAT_MESH_NONE ? found : v;
    }
    point_table_free(&table);
    return room;
}

/// Make one vertex of the copies at each point that joins them, and repair what does not belong together.
static bat_status join_copies(const hole *at, bat_mesh *closed, bat_error *error)
{
    uint32_t kept = 0, *number = at->place; // used as workspace here
    bat_mesh joined;
    for (uint32_t v = 0; v < at->mesh->vertex_count; v++)
        number[v] = at->point[v] != v && at->joins[at->point[v]] ? number[at->point[v]] : kept++;
    if (kept == at->mesh->vertex_count)
        return BAT_OK;
    for (size_t i = 0; i < 3 * closed->face_count; i++)
        closed->faces[i] = number[closed->faces[i]];
    mesh_renumber(closed, kept, number);
    bat_status status = bat_mesh_repair(closed, NULL, &joined, error);
    if (status != BAT_OK)
        return status;
    bat_mesh_free(closed);
    *closed = joined;
    return BAT_OK;
}

bat_status bat_mesh_fill_holes(const bat_mesh *mesh, size_t max_edges, size_t *filled, bat_mesh *closed, bat_error *error)
{
    bat_mesh_connectivity links;
    bat_mesh made = {0};
    bat_status status = mesh_check_triangles(mesh, error);
    if (status == BAT_OK && max_edges > BAT_MESH_MAX_HOLE)
        status = ERROR_ARGUMENT(error, "holes of more than %d edges are not filled", BAT_MESH_MAX_HOLE);
    if (status == BAT_OK)
        status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
        return status;
    size_t n = links.boundary_edge_count < max_edges ? links.boundary_edge_count : max_edges, count = 0;
    memory_pool pool = {0};
    hole at = {.mesh = mesh, .links = &links};
    at.path = memory_pool_array(&pool, links.boundary_edge_count + 1, sizeof *at.path);
    at.passed = memory_pool_array(&pool, mesh->vertex_count, sizeof *at.passed);
    at.point = memory_pool_array(&pool, mesh->vertex_count, sizeof *at.point);
    at.joins = memory_pool_zeros(&pool, mesh->vertex_count, sizeof *at.joins);
    at.cost = memory_pool_array(&pool, n * n + 1, sizeof *at.cost);
    at.apex = memory_pool_array(&pool, n * n + 1, sizeof *at.apex);
    at.place = memory_pool_array(&pool, mesh->vertex_count, sizeof *at.place);
    unsigned char *seen = memory_pool_zeros(&pool, 3 * mesh->face_count, 1);
    size_t(*stack)[2] = memory_pool_array(&pool, n + 2, sizeof *stack);
    status = pool.missing == 0 ? bat_mesh_copy(mesh, &made, error) : error_memory(error, pool.missing);
    if (status == BAT_OK)
    {
        memset(at.place, 0xff, mesh->vertex_count * sizeof *at.place);
        memset(at.passed, 0xff, mesh->vertex_count * sizeof *at.passed);
        if (!find_points(&at) || !fill_loops(&at, n, seen, stack, &count, &made))
            status = error_memory(error, 3 * made.face_count * sizeof *made.faces);
        else
            status = join_copies(&at, &made, error);
    }
    if (status == BAT_OK)
    {
        *closed = made;
        if (filled != NULL)
            *filled = count;
    }
    else
        bat_mesh_free(&made);
    memory_pool_free(&pool);
    bat_mesh_connectivity_free(&links);
    return status;
}

/// @file
/// False handles of the mesh that connects the points of a shell; see shell.h.
///
/// Where parts, or gaps between parts, are thinner than a cell, the mesh has tunnels through the parts and bridges over the
/// gaps. Short loops that do not separate the mesh are found from a tree of vertices and a tree of the faces that it leaves:
/// each edge in neither closes one (Eppstein, "Dynamic generators of topologically embedded graphs", 2003; Erickson and
/// Whittlesey, "Greedy optimal homotopy and homology generators", 2005). A loop around a tunnel or a bridge is false where
/// the points beside it have normals along that of the disc in the loop rather than along those of the mesh, and there are
/// points beside the middle of the disc.
/// The mesh is cut along false loops, and both sides get discs.

#include "surface/shell/shell.h"

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

#define MAX_CUTS 1000
#define MAX_LOOP 24   ///< edges
#define SHORT 8       ///< edges
#define MAX_ROOTS 96  ///< trees for one cut
#define MAX_LOOPS 400 ///< stored
#define RINGS 4       ///< around a disc that are evened out
#define SMOOTHINGS 30

/// Mean square of the product of unit normals, and distance of the middle from points in spacings, of a false loop. A short
/// one is about as wide as the points are apart: normals of all directions, whose mean square is 1/3, do not support it.
static const double MIN_ALONG = 0.6, MIN_ALONG_SHORT = 1.0 / 3, MAX_EMPTY = 2;
/// The same of a loop that few points support: their mean distance from it, in spacings, is 0.5 on a surface.
static const double MIN_BARE = 1.1, MIN_ALONG_BARE = 0.2;

static const uint32_t NONE = BAT_MESH_NONE;

typedef struct handle_loop
{
    uint32_t count, vertices[MAX_LOOP];
} handle_loop;

typedef struct handle_search
{
    bat_mesh *mesh;
    bat_mesh_connectivity links;
    const double *points;
    const nearest_tree *tree;
    double cell;
    uint32_t *depth, *parent, *queue; ///< vertex_count each: of the tree of vertices
    uint32_t *joined;                 ///< face_count + vertex_count: union-find of faces, and of the boundaries' vertices
    uint32_t *edges, *starts;         ///< half-edges by descending length of their loops
    handle_loop *loops;
    uint32_t roots[MAX_ROOTS]; ///< vertices near handles
    size_t loop_count, root_count;
    neighbour_list near;
    memory_pool pool;
} handle_search;

/// Visit all vertices by edges, from a root, and from a vertex of each other piece.
static void grow_tree(handle_search *work, uint32_t root)
{
    size_t begin = 0, end = 0;
    memset(work->depth, 0xff, work->mesh->vertex_count * sizeof *work->depth);
    for (uint32_t next = 0; next <= work->mesh->vertex_count; next++)
    {
        uint32_t start = next == 0 ? root : next - 1;
        if (work->depth[start] != NONE || work->links.first[start] == NONE)
            continue;
        work->depth[start] = 0;
        work->parent[start] = NONE;
        work->queue[end++] = start;
        while (begin < end)
        {
            uint32_t from = work->queue[begin++], first = work->links.first[from], h = first;
            while (h != NONE)
            {
                const uint32_t beside[2] = {work->mesh->faces[bat_mesh_next(h)], work->mesh->faces[bat_mesh_previous(h)]};
                for (int k = 0; k < 2; k++)
                    if (work->depth[beside[k]] == NONE)
                    {
                        work->depth[beside[k]] = work->depth[from] + 1;
                        work->parent[beside[k]] = from;
                        work->queue[end++] = beside[k];
                    }
                h = bat_mesh_next_around(&work->links, h);
                if (h == first)
                    break;
            }
        }
    }
}

static void add_root(handle_search *work, uint32_t vertex)
{
    if (work->root_count < MAX_ROOTS)
        work->roots[work->root_count++] = vertex;
}

/// Store the loop that an edge closes with the tree, where it is short and off boundaries.
static void store_loop(handle_search *work, uint32_t half_edge)
{
    uint32_t ends[2] = {work->mesh->faces[half_edge], work->mesh->faces[bat_mesh_next(half_edge)]}, path[2][MAX_LOOP];
    uint32_t count[2] = {0, 0};
    handle_loop *loop = &work->loops[work->loop_count];
    add_root(work, ends[0]);
    while (ends[0] != ends[1])
    {
        int k = work->depth[ends[0]] >= work->depth[ends[1]] ? 0 : 1;
        if (count[0] + count[1] + 1 >= MAX_LOOP)
        {
            add_root(work, ends[0]);
            add_root(work, ends[1]);
            return;
        }
        path[k][count[k]++] = ends[k];
        ends[k] = work->parent[ends[k]];
    }
    path[0][count[0]++] = ends[0];
    loop->count = count[0] + count[1];
    for (uint32_t k = 0; k < loop->count; k++)
    {
        // From the edge's begin to the common vertex, and back to its end.
        loop->vertices[k] = k < count[0] ? path[0][k] : path[1][loop->count - 1 - k];
        if (work->links.twin[work->links.first[loop->vertices[k]]] == NONE)
            return;
    }
    add_root(work, loop->vertices[loop->count / 2]);
    work->loop_count++;
}

/// Store the loops of a root.
static void find_loops(handle_search *work, uint32_t root)
{
    const bat_mesh *mesh = work->mesh;
    const bat_mesh_connectivity *links = &work->links;
    size_t corners = 3 * mesh->face_count, deepest = 0;
    grow_tree(work, root);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        deepest = work->depth[v] != NONE && work->depth[v] > deepest ? work->depth[v] : deepest;
    for (uint32_t k = 0; k < mesh->face_count + mesh->vertex_count; k++)
        work->joined[k] = k;
    memset(work->starts, 0, (2 * deepest + 2) * sizeof *work->starts);
    for (int pass = 0; pass < 2; pass++)
    {
        for (uint32_t h = 0; h < corners; h++)
        {
            uint32_t a = mesh->faces[h], b = mesh->faces[bat_mesh_next(h)];
            if (links->twin[h] < h || work->parent[a] == b || work->parent[b] == a)
                continue;
            size_t rank = 2 * deepest - work->depth[a] - work->depth[b];
            if (pass == 0)
                work->starts[rank + 1]++;
            else
                work->edges[work->starts[rank]++] = h;
        }
        for (size_t k = 0; k <= 2 * deepest && pass == 0; k++)
            work->starts[k + 1] += work->starts[k];
    }
    for (uint32_t h = 0; h < corners; h++)
        if (links->twin[h] == NONE)
            (void)sets_join(work->joined, (uint32_t)mesh->face_count + mesh->faces[h],
                            (uint32_t)mesh->face_count + mesh->faces[bat_mesh_next(h)]);
    for (size_t k = 0; k < work->starts[2 * deepest]; k++)
    {
        uint32_t h = work->edges[k], twin = links->twin[h];
        uint32_t other = twin != NONE ? twin / 3 : (uint32_t)mesh->face_count + mesh->faces[h];
        if (!sets_join(work->joined, h / 3, other) && work->loop_count < MAX_LOOPS)
            store_loop(work, h);
    }
}

/// The normal of the mesh at a vertex.
static void vertex_normal(const handle_search *work, uint32_t vertex, double normal[3])
{
    const bat_mesh *mesh = work->mesh;
    uint32_t first = work->links.first[vertex], h = first;
    memset(normal, 0, 3 * sizeof *normal);
    do
    {
        double part[3];
        const double *place = mesh->positions + 3 * (size_t)vertex;
        vector3_triangle(place, mesh->positions + 3 * (size_t)mesh->faces[bat_mesh_next(h)],
                         mesh->positions + 3 * (size_t)mesh->faces[bat_mesh_previous(h)], part);
        for (int c = 0; c < 3; c++)
            normal[c] += part[c];
        h = bat_mesh_next_around(&work->links, h);
    } while (h != NONE && h != first);
    (void)vector3_normalize(normal);
}

/// Whether the points contradict a loop.
static bat_status judge_loop(handle_search *work, const handle_loop *loop, bool *is_false, bat_error *error)
{
    double middle[3] = {0}, area[3] = {0}, along = 0, alike = 0, bare = 0;
    const double *positions = work->mesh->positions;
    for (uint32_t k = 0; k < loop->count; k++)
        for (size_t c = 0; c < 3; c++)
            middle[c] += positions[3 * (size_t)loop->vertices[k] + c] / loop->count;
    for (uint32_t k = 0; k < loop->count; k++)
    {
        double part[3];
        vector3_triangle(middle, positions + 3 * (size_t)loop->vertices[k],
                         positions + 3 * (size_t)loop->vertices[(k + 1) % loop->count], part);
        for (size_t c = 0; c < 3; c++)
            area[c] += part[c];
    }
    *is_false = false;
    bat_status status = neighbours_nearest(work->tree, middle, 1, &work->near, error);
    if (status != BAT_OK || !vector3_normalize(area))
        return status;
    double empty = sqrt(work->near.entries[0].squared);
    status = neighbours_nearest(work->tree, work->points + 3 * (size_t)work->near.entries[0].item, SHELL_SPACING_POINTS,
                                &work->near, error);
    if (status != BAT_OK || empty > MAX_EMPTY * fmax(shell_spacing(&work->near), work->cell))
        return status;
    double spacing = shell_spacing(&work->near);
    for (uint32_t k = 0; k < loop->count && status == BAT_OK; k++)
    {
        local_plane plane;
        status = neighbourhood_find(work->tree, work->points, positions + 3 * (size_t)loop->vertices[k], NEIGHBOURHOOD_MIN,
                                    &work->near, &plane, error);
        double normal[3];
        vertex_normal(work, loop->vertices[k], normal);
        if (status == BAT_OK)
        {
            bare += sqrt(work->near.entries[0].squared) / spacing / loop->count;
            along += pow(vector3_dot(plane.axes[2], area), 2) / loop->count;
            alike += pow(vector3_dot(plane.axes[2], normal), 2) / loop->count;
        }
    }
    *is_false = (along > MIN_ALONG && along > alike) || (loop->count <= SHORT && along > MIN_ALONG_SHORT) ||
                (bare > MIN_BARE && along > MIN_ALONG_BARE);
    return status;
}

/// Cut the mesh along a loop, and put a disc on each side. `links` are those before.
static bat_status cut_loop(handle_search *work, const handle_loop *loop, bat_error *error)
{
    bat_mesh *mesh = work->mesh;
    uint32_t n = loop->count, old = (uint32_t)mesh->vertex_count;
    double *positions = realloc(mesh->positions, (old + n + 2) * 3 * sizeof *positions);
    mesh->positions = positions != NULL ? positions : mesh->positions;
    uint32_t *faces = realloc(mesh->faces, (mesh->face_count + 2 * (size_t)n) * 3 * sizeof *faces);
    mesh->faces = faces != NULL ? faces : mesh->faces;
    if (positions == NULL || faces == NULL)
        return error_memory(error, (old + n + 2) * 3 * sizeof *positions);
    double *middles = positions + 3 * (size_t)(old + n);
    memset(middles, 0, 6 * sizeof *middles);
    for (uint32_t k = 0; k < n; k++)
    {
        uint32_t v = loop->vertices[k], next = loop->vertices[(k + 1) % n], last = loop->vertices[(k + n - 1) % n];
        memcpy(positions + 3 * (size_t)(old + k), positions + 3 * (size_t)v, 3 * sizeof *positions);
        for (size_t c = 0; c < 6; c++)
            middles[c] += positions[3 * (size_t)v + c % 3] / n;
        // Corners to the left of the loop, from the edge ahead to the edge behind. Heads of edges that were passed may be
        // new already: the edge behind is known by its twin's corner, which is on the other side.
        uint32_t h = work->links.first[v];
        while (work->links.twin[h] == NONE || faces[bat_mesh_next(work->links.twin[h])] != v ||
               faces[work->links.twin[h]] != next)
            h = bat_mesh_next_around(&work->links, h);
        for (;;)
        {
            uint32_t back = bat_mesh_previous(h);
            faces[h] = old + k;
            if (faces[work->links.twin[back]] == v && faces[bat_mesh_next(work->links.twin[back])] == last)
                break;
            h = work->links.twin[back];
        }
    }
    uint32_t *face = faces + 3 * mesh->face_count;
    for (uint32_t k = 0; k < n; k++, face += 6)
    {
        uint32_t next = (k + 1) % n;
        const uint32_t made[6] = {old + next, old + k, old + n, loop->vertices[k], loop->vertices[next], old + n + 1};
        memcpy(face, made, sizeof made);
    }
    mesh->vertex_count += n + 2;
    mesh->face_count += 2 * (size_t)n;
    return BAT_OK;
}

static int compare_loops(const void *a, const void *b)
{
    const handle_loop *p = a, *q = b;
    return p->count != q->count ? ORDER_OF(p->count, q->count)
                                : memcmp(p->vertices, q->vertices, p->count * sizeof *p->vertices);
}

/// Cut along the shortest false loop.
/// @param cut receives whether there is one
static bat_status cut_once(handle_search *work, bool *cut, bat_error *error)
{
    const bat_mesh *mesh = work->mesh;
    size_t vertices = mesh->vertex_count, faces = mesh->face_count;
    bat_status status = bat_mesh_connect(mesh, &work->links, error);
    if (status != BAT_OK)
        return status;
    work->depth = memory_pool_array(&work->pool, vertices, sizeof *work->depth);
    work->parent = memory_pool_array(&work->pool, vertices, sizeof *work->parent);
    work->queue = memory_pool_array(&work->pool, vertices, sizeof *work->queue);
    work->joined = memory_pool_array(&work->pool, vertices + faces, sizeof *work->joined);
    work->edges = memory_pool_array(&work->pool, work->links.edge_count, sizeof *work->edges);
    work->starts = memory_pool_array(&work->pool, 2 * vertices + 2, sizeof *work->starts);
    work->loops = memory_pool_array(&work->pool, MAX_LOOPS + 1, sizeof *work->loops);
    work->loop_count = work->root_count = 0;
    status = memory_pool_check(&work->pool, error);
    if (status == BAT_OK)
    {
        find_loops(work, 0);
        // A loop through its own root is shortest.
        size_t roots = work->root_count;
        for (size_t k = 0; k < roots; k++)
            find_loops(work, work->roots[k]);
        qsort(work->loops, work->loop_count, sizeof *work->loops, compare_loops);
    }
    bool is_false = false;
    for (size_t k = 0; k < work->loop_count && status == BAT_OK && !is_false; k++)
    {
        status = judge_loop(work, &work->loops[k], &is_false, error);
        if (status == BAT_OK && is_false)
            status = cut_loop(work, &work->loops[k], error);
        if (status == BAT_OK && is_false)
            status =
                shell_even_out(work->mesh, work->mesh->vertex_count - work->loops[k].count - 2, RINGS, SMOOTHINGS, error);
    }
    bat_mesh_connectivity_free(&work->links);
    memory_pool_free(&work->pool);
    *cut = is_false;
    return status;
}

bat_status shell_cut_handles(const shell_cloud *cloud, bat_mesh *mesh, bat_shell_report *report, bat_error *error)
{
    handle_search work = {.mesh = mesh, .points = cloud->points, .tree = cloud->tree, .cell = cloud->cell};
    bool cut = true;
    bat_status status = BAT_OK;
    while (cut && report->cut_handles < MAX_CUTS && status == BAT_OK)
    {
        status = cut_once(&work, &cut, error);
        report->cut_handles += cut;
    }
    neighbour_list_free(&work.near);
    return status;
}

/// @file
/// Pieces and holes of the mesh that connects the points of a shell; see shell.h.
///
/// Distances from the nearest point are in its spacings. A piece with few vertices nearer than BARE is not there at all.
/// Vertices farther than OPEN, joined to one that is farther than HOLE, are a hole of the points; it takes those nearer than
/// MARGIN to it, too. So the rest is the closing of the points by a ball, little wider (Serra, "Image analysis and
/// mathematical morphology", 1982), and its boundaries run beside the outermost points.

#include "surface/shell/shell.h"

#include "base/error.h"
#include "linalg/vector.h"

#include <string.h>

#define SMOOTHINGS 40 ///< of boundaries
#define RINGS 8       ///< of vertices that follow
#define EARS 8        ///< rounds that cut off faces with two sides on a boundary

static const double BARE = 1.3, OPEN = 2, HOLE = 3.5, MARGIN = 1.4;
/// Distance in spacings from which a part of bare vertices counts as a hole that is closed.
static const double CLOSED_HOLE = 3;
/// Least share of covered vertices of a piece, and of all points at it.
static const double MIN_COVERED = 0.3, MIN_PIECE = 0.01;

typedef struct opening
{
    bat_mesh *mesh;
    bat_mesh_connectivity links;
    double *far;     ///< vertex_count: distance from the nearest point in its spacings
    uint32_t *piece; ///< vertex_count
    uint32_t *stack;
    bool *gone; ///< vertex_count
    memory_pool pool;
} opening;

bat_status shell_distances(const double *points, const nearest_tree *tree, const double *places, size_t place_count,
                           double less, double least, double *distances, bat_error *error)
{
    neighbour_list near = {0};
    bat_status status = BAT_OK;
    for (size_t k = 0; k < place_count && status == BAT_OK; k++)
    {
        status = neighbours_nearest(tree, places + 3 * k, 1, &near, error);
        if (status != BAT_OK)
            break;
        double distance = fmax(sqrt(near.entries[0].squared) - less, 0);
        status = neighbours_nearest(tree, points + 3 * (size_t)near.entries[0].item, SHELL_SPACING_POINTS, &near, error);
        if (status == BAT_OK)
            distances[k] = distance / fmax(shell_spacing(&near), least);
    }
    neighbour_list_free(&near);
    return status;
}

/// Visit the vertices that edges join to one, where `far` is at least `bound`. Returns their number, in `stack`.
static size_t spread(opening *work, uint32_t vertex, double bound, uint32_t *labels, uint32_t label)
{
    size_t begin = 0, end = 1;
    work->stack[0] = vertex;
    labels[vertex] = label;
    while (begin < end)
    {
        uint32_t from = work->stack[begin++], first = work->links.first[from], h = first;
        while (h != BAT_MESH_NONE)
        {
            const uint32_t beside[2] = {work->mesh->faces[bat_mesh_next(h)], work->mesh->faces[bat_mesh_previous(h)]};
            for (int k = 0; k < 2; k++)
                if (labels[beside[k]] == UINT32_MAX && work->far[beside[k]] >= bound)
                {
                    labels[beside[k]] = label;
                    work->stack[end++] = beside[k];
                }
            h = bat_mesh_next_around(&work->links, h);
            if (h == first)
                break;
        }
    }
    return end;
}

/// The volume that the listed vertices of a piece enclose; negative where normals lead inwards, 0 where it is open.
static double volume_of(const opening *work, size_t members)
{
    const double *at = work->mesh->positions;
    double sum = 0;
    for (size_t k = 0; k < members; k++)
    {
        uint32_t first = work->links.first[work->stack[k]], h = first;
        do
        {
            double normal[3];
            const uint32_t *face = work->mesh->faces + h / 3 * 3;
            vector3_cross(at + 3 * (size_t)face[0], at + 3 * (size_t)face[1], normal);
            sum += vector3_dot(normal, at + 3 * (size_t)face[2]) / 18;
            h = bat_mesh_next_around(&work->links, h);
        } while (h != first && h != BAT_MESH_NONE);
        if (h == BAT_MESH_NONE)
            return 0;
    }
    return sum;
}

/// Mark pieces with few points as gone. At least the largest stays. Returns whether one that stays is a hollow: the points
/// close a gap whose walls are nearer to each other than the spacing or the noise.
static bool drop_pieces(opening *work, bat_shell_report *report)
{
    size_t count = work->mesh->vertex_count, largest = 0;
    bool hollow = false;
    for (int pass = 0; pass < 2; pass++)
    {
        memset(work->piece, 0xff, count * sizeof *work->piece);
        for (uint32_t v = 0; v < count; v++)
        {
            if (work->piece[v] != UINT32_MAX || work->links.first[v] == BAT_MESH_NONE)
                continue;
            size_t members = spread(work, v, 0, work->piece, v), covered = 0;
            for (size_t k = 0; k < members; k++)
                covered += work->far[work->stack[k]] < BARE;
            largest = covered > largest ? covered : largest;
            bool stays = (double)covered >= MIN_COVERED * (double)members && (double)covered >= MIN_PIECE * (double)largest;
            for (size_t k = 0; k < members && pass == 1; k++)
                work->gone[work->stack[k]] = !stays;
            report->dropped_pieces += pass == 1 && !stays;
            hollow = hollow || (pass == 1 && stays && covered < largest && volume_of(work, members) < 0);
        }
    }
    return hollow;
}

static void open_holes(opening *work, double fill, bat_shell_report *report)
{
    size_t count = work->mesh->vertex_count;
    memset(work->piece, 0xff, count * sizeof *work->piece);
    for (uint32_t v = 0; v < count; v++)
    {
        if (work->piece[v] != UINT32_MAX || work->far[v] < OPEN || work->gone[v] || work->links.first[v] == BAT_MESH_NONE)
            continue;
        size_t members = spread(work, v, OPEN, work->piece, v);
        double farthest = 0, low[3], high[3];
        box_clear(3, low, high);
        for (size_t k = 0; k < members; k++)
        {
            farthest = fmax(farthest, work->far[work->stack[k]]);
            box_include(3, work->mesh->positions + 3 * (size_t)work->stack[k], low, high);
        }
        bool fills = farthest < HOLE || vector3_distance(low, high) <= fill;
        report->filled += fills && farthest > CLOSED_HOLE;
        for (size_t k = 0; k < members && !fills; k++)
            work->gone[work->stack[k]] = true;
    }
}

/// Take away what is nearer than MARGIN to a hole.
static bat_status widen_holes(opening *work, const shell_cloud *cloud, bat_error *error)
{
    const double *at = work->mesh->positions;
    size_t vertices = work->mesh->vertex_count, count = 0;
    double *places = memory_pool_array(&work->pool, vertices, 3 * sizeof *places);
    nearest_tree tree = {0};
    neighbour_list near = {0};
    bat_status status = memory_pool_check(&work->pool, error);
    for (size_t v = 0; v < vertices && status == BAT_OK; v++)
        if (work->gone[v] && work->piece[v] != UINT32_MAX)
            memcpy(places + 3 * count++, at + 3 * v, 3 * sizeof *places);
    if (status == BAT_OK && count > 0)
        status = neighbours_build(places, count, &tree, error);
    for (size_t v = 0; v < vertices && count > 0 && status == BAT_OK; v++)
    {
        if (work->gone[v])
            continue;
        status = neighbours_nearest(&tree, at + 3 * v, 1, &near, error);
        double squared = status == BAT_OK ? near.entries[0].squared : 0;
        if (status == BAT_OK)
            status = neighbours_nearest(cloud->tree, at + 3 * v, 1, &near, error);
        work->gone[v] = status == BAT_OK && sqrt(squared) * work->far[v] < MARGIN * sqrt(near.entries[0].squared);
    }
    neighbour_list_free(&near);
    nearest_free(&tree);
    return status;
}

/// Keep the faces whose corners all stay, but for ears: smoothed boundaries would flatten those.
static bat_status keep_rest(opening *work, bat_error *error)
{
    bat_mesh rest = *work->mesh, repaired;
    bat_mesh_repair_report repairs;
    uint32_t *faces = memory_pool_array(&work->pool, rest.face_count, 3 * sizeof *faces);
    if (faces == NULL)
        return memory_pool_check(&work->pool, error);
    size_t kept = 0;
    bool ears = true;
    for (int round = 0; round < EARS && ears; round++)
    {
        ears = false;
        kept = 0;
        memset(work->stack, 0, rest.vertex_count * sizeof *work->stack);
        for (size_t f = 0; f < rest.face_count; f++)
        {
            const uint32_t *face = rest.faces + 3 * f;
            if (work->gone[face[0]] || work->gone[face[1]] || work->gone[face[2]])
                continue;
            memcpy(faces + 3 * kept++, face, 3 * sizeof *faces);
            for (int c = 0; c < 3; c++)
                work->stack[face[c]]++;
        }
        for (size_t v = 0; v < rest.vertex_count; v++)
        {
            ears = ears || work->stack[v] == 1;
            work->gone[v] = work->gone[v] || work->stack[v] == 1;
        }
    }
    rest.faces = faces;
    rest.face_count = kept;
    if (kept == 0)
        return error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the points are too scattered for a surface");
    bat_status status = bat_mesh_repair(&rest, &repairs, &repaired, error);
    if (status == BAT_OK)
    {
        bat_mesh_free(work->mesh);
        *work->mesh = repaired;
    }
    return status;
}

bat_status shell_even_out(bat_mesh *mesh, size_t first, uint8_t ring_count, int rounds, bat_error *error)
{
    bat_mesh_connectivity links;
    memory_pool pool = {0};
    size_t count = mesh->vertex_count;
    double *sums = memory_pool_array(&pool, count, 4 * sizeof *sums);
    uint8_t *rings = memory_pool_array(&pool, count, sizeof *rings);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(mesh, &links, error);
    if (status != BAT_OK)
    {
        memory_pool_free(&pool);
        return status;
    }
    for (size_t v = 0; v < count; v++)
        rings[v] = v >= first ? 0 : ring_count;
    for (uint32_t h = 0; h < 3 * mesh->face_count && first == count; h++)
        if (links.twin[h] == BAT_MESH_NONE)
            rings[mesh->faces[h]] = 0;
    for (int k = 1; k < ring_count; k++)
        for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        {
            uint8_t *a = &rings[mesh->faces[h]], *b = &rings[mesh->faces[bat_mesh_next(h)]];
            *a = *a == ring_count && *b == k - 1 ? (uint8_t)k : *a;
            *b = *b == ring_count && *a == k - 1 ? (uint8_t)k : *b;
        }
    for (int k = 0; k < rounds && (first < count || links.boundary_edge_count > 0); k++)
    {
        memset(sums, 0, count * 4 * sizeof *sums);
        for (uint32_t h = 0; h < 3 * mesh->face_count; h++)
        {
            uint32_t ends[2] = {mesh->faces[h], mesh->faces[bat_mesh_next(h)]};
            bool outer = links.twin[h] == BAT_MESH_NONE;
            for (size_t e = 0; e < 2; e++)
            {
                // A vertex of the boundary takes its neighbours there alone. Each inner edge comes twice.
                double weight = links.twin[links.first[ends[e]]] == BAT_MESH_NONE ? (outer ? 1 : 0) : outer ? 1 : 0.5;
                for (size_t c = 0; c < 3; c++)
                    sums[4 * (size_t)ends[e] + c] += weight * mesh->positions[3 * (size_t)ends[1 - e] + c];
                sums[4 * (size_t)ends[e] + 3] += weight;
            }
        }
        for (size_t v = 0; v < count; v++)
            for (size_t c = 0; c < 3 && rings[v] < ring_count && sums[4 * v + 3] > 0; c++)
                mesh->positions[3 * v + c] = (mesh->positions[3 * v + c] + sums[4 * v + c] / sums[4 * v + 3]) / 2;
    }
    bat_mesh_connectivity_free(&links);
    memory_pool_free(&pool);
    return BAT_OK;
}

static bat_status open_once(const shell_cloud *cloud, double fill, bat_mesh *mesh, bat_shell_report *report,
                            bat_error *error)
{
    opening work = {.mesh = mesh};
    size_t vertices = mesh->vertex_count;
    work.far = memory_pool_zeros(&work.pool, vertices, sizeof *work.far);
    work.piece = memory_pool_array(&work.pool, vertices, sizeof *work.piece);
    work.stack = memory_pool_array(&work.pool, vertices, sizeof *work.stack);
    work.gone = memory_pool_zeros(&work.pool, vertices, sizeof *work.gone);
    bat_status status = memory_pool_check(&work.pool, error);
    if (status == BAT_OK)
        status = bat_mesh_connect(mesh, &work.links, error);
    if (status == BAT_OK)
        status = shell_distances(cloud->points, cloud->tree, mesh->positions, vertices, 0, cloud->cell, work.far, error);
    if (status == BAT_OK)
    {
        if (drop_pieces(&work, report))
            status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0,
                               "the points enclose a hollow: a gap is narrower than their spacing or their noise");
        open_holes(&work, fill, report);
        if (status == BAT_OK)
            status = widen_holes(&work, cloud, error);
        if (status == BAT_OK)
            status = keep_rest(&work, error);
    }
    bat_mesh_connectivity_free(&work.links);
    memory_pool_free(&work.pool);
    return status;
}

bat_status shell_open_holes(const shell_cloud *cloud, double fill, bat_mesh *mesh, bat_shell_report *report,
                            bat_error *error)
{
    bat_shell_report islands = {0};
    size_t faces = mesh->face_count;
    bat_status status = open_once(cloud, fill, mesh, report, error);
    // Holes that are open may leave islands, which are pieces without points.
    if (status == BAT_OK && mesh->face_count < faces)
        status = open_once(cloud, fill, mesh, &islands, error);
    // Boundaries follow the cells of a grid.
    return status == BAT_OK ? shell_even_out(mesh, mesh->vertex_count, RINGS, SMOOTHINGS, error) : status;
}

#include "base/array_grow.h"
#include "base/bisect.h"
#include "base/counting_sort.h"
#include "base/error.h"
#include "mesh/check.h"
#include "mesh/hash_table.h"
#include "mesh/labels.h"

#include <math.h>

/// @file
/// Repair of a triangle mesh to an oriented manifold, in four steps: drop degenerate and repeated faces, pair half-edges,
/// orient the faces, split vertices.
///
/// An edge of more than two faces is cut apart; so is an edge whose two faces cannot be oriented alike. Every fan of faces
/// then has its own copy of its vertex (Guéziec et al., "Cutting and stitching", 2001). All steps run in linear time by
/// counting sorts.

/// The state of a repair. Half-edges belong to the remaining faces.
typedef struct repair_work
{
    const bat_mesh *mesh;
    uint32_t *faces;   ///< face_count x 3: the remaining faces, in vertices of the mesh
    uint32_t *sources; ///< for each remaining face: its index in the mesh
    size_t face_count;
    uint32_t *sorted; ///< for each half-edge: the other one on its edge, in either direction; BAT_MESH_NONE at a cut
    uint32_t
        *twin; ///< for each half-edge: the other one of an edge of two faces, in either direction; BAT_MESH_NONE at a cut
    uint32_t *fan;       ///< for each half-edge: the smallest half-edge of its fan, among those with the same first vertex
    uint32_t *copies;    ///< face_count x 3: the remaining faces, in vertices of the result
    uint32_t *origins;   ///< for each vertex of the result: its vertex of the mesh
    size_t vertex_count; ///< the number of vertices of the result
    memory_pool pool;    ///< of all arrays
} repair_work;

/// An edge, by its two vertices in the mesh in increasing order.
typedef struct repair_edge
{
    uint32_t low, high;
} repair_edge;

static inline repair_edge repair_edge_of(const repair_work *work, uint32_t half_edge)
{
    uint32_t a = work->faces[half_edge], b = work->faces[bat_mesh_next(half_edge)];
    return a < b ? (repair_edge){a, b} : (repair_edge){b, a};
}

/// The vertex that follows `steps` corners after the smallest vertex of a face.
static uint32_t cyclic_vertex(const repair_work *work, uint32_t face, uint32_t steps)
{
    const uint32_t *corner = work->faces + 3 * (size_t)face;
    uint32_t smallest = corner[1] < corner[0] ? 1 : 0;
    smallest = corner[2] < corner[smallest] ? 2 : smallest;
    return corner[(smallest + steps) % 3];
}

static size_t first_vertex(const void *work, uint32_t face)
{
    return cyclic_vertex(work, face, 0);
}

static size_t second_vertex(const void *work, uint32_t face)
{
    return cyclic_vertex(work, face, 1);
}

static size_t third_vertex(const void *work, uint32_t face)
{
    return cyclic_vertex(work, face, 2);
}

static bool same_face(const repair_work *work, uint32_t a, uint32_t b)
{
    return first_vertex(work, a) == first_vertex(work, b) && second_vertex(work, a) == second_vertex(work, b) &&
           third_vertex(work, a) == third_vertex(work, b);
}

/// Copy the faces with three different vertices.
static void drop_degenerate(repair_work *work)
{
    for (size_t f = 0; f < work->mesh->face_count; f++)
    {
        const uint32_t *corner = work->mesh->faces + 3 * f;
        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
            continue;
        memcpy(work->faces + 3 * work->face_count, corner, 3 * sizeof *corner);
        work->sources[work->face_count++] = (uint32_t)f;
    }
}

/// Step 1: drop faces with a vertex twice and faces that repeat an earlier one.
static bool repair_drop_faces(repair_work *work, bat_mesh_repair_report *report)
{
    size_t keys = work->mesh->vertex_count;
    drop_degenerate(work);
    report->degenerate_faces = work->mesh->face_count - work->face_count;
    size_t *starts = memory_array(keys + 1, sizeof *starts);
    if (starts == NULL)
        return false;
    uint32_t *order = work->sorted, *other = work->twin, *repeated = work->twin; // used as workspace here
    size_t count = work->face_count, kept = 0;
    counting_sort(NULL, count, third_vertex, work, keys, starts, order);
    counting_sort(order, count, second_vertex, work, keys, starts, other);
    counting_sort(other, count, first_vertex, work, keys, starts, order);
    free(starts);
    // The order is stable, so a face's predecessor in it comes earlier in the mesh.
    memset(repeated, 0, count * sizeof *repeated);
    for (size_t i = 1; i < count; i++)
        repeated[order[i]] = same_face(work, order[i - 1], order[i]);
    for (size_t f = 0; f < count; f++)
    {
        if (repeated[f])
            continue;
        memmove(work->faces + 3 * kept, work->faces + 3 * f, 3 * sizeof *work->faces);
        work->sources[kept++] = work->sources[f];
    }
    work->face_count = kept;
    report->duplicate_faces = count - kept;
    return true;
}

static size_t low_vertex(const void *work, uint32_t half_edge)
{
    return repair_edge_of(work, half_edge).low;
}

static size_t high_vertex(const void *work, uint32_t half_edge)
{
    return repair_edge_of(work, half_edge).high;
}

/// The end of the run of half-edges that share the edge of the half-edge at `begin` in the sorted order.
static size_t end_of_run(const repair_work *work, size_t begin)
{
    repair_edge edge = repair_edge_of(work, work->sorted[begin]);
    size_t end = begin + 1;
    for (; end < 3 * work->face_count; end++)
    {
        repair_edge next = repair_edge_of(work, work->sorted[end]);
        if (next.low != edge.low || next.high != edge.high)
            break;
    }
    return end;
}

/// Step 2: sort the half-edges by edge and pair those of edges with exactly two faces.
static bool repair_join_faces(repair_work *work, bat_mesh_repair_report *report)
{
    size_t count = 3 * work->face_count, keys = work->mesh->vertex_count;
    size_t *starts = memory_array(keys + 1, sizeof *starts);
    if (starts == NULL)
        return false;
    uint32_t *by_high = work->fan; // used as workspace here
    counting_sort(NULL, count, high_vertex, work, keys, starts, by_high);
    counting_sort(by_high, count, low_vertex, work, keys, starts, work->sorted);
    free(starts);
    memset(work->twin, 0xff, count * sizeof *work->twin);
    for (size_t begin = 0, end; begin < count; begin = end)
    {
        end = end_of_run(work, begin);
        report->nonmanifold_edges += end - begin > 2;
        if (end - begin != 2)
            continue;
        work->twin[work->sorted[begin]] = work->sorted[begin + 1];
        work->twin[work->sorted[begin + 1]] = work->sorted[begin];
    }
    return true;
}

/// Whether a face is visited and whether it is turned over.
enum
{
    UNVISITED,
    UNTURNED,
    TURNED
};

/// Decide which of the faces connected to `first` to turn over. Appends them to `queue` and returns its new length.
static size_t propagate_turns(const repair_work *work, uint32_t first, unsigned char *turn, uint32_t *queue, size_t begin)
{
    size_t end = begin;
    turn[first] = UNTURNED;
    queue[end++] = first;
    for (size_t i = begin; i < end; i++)
        for (uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; h++)
        {
            uint32_t twin = work->twin[h];
            if (twin == BAT_MESH_NONE || turn[twin / 3] != UNVISITED)
                continue;
            bool against = work->faces[twin] == work->faces[h];
            unsigned char here = turn[queue[i]];
            turn[twin / 3] = against ? (unsigned char)(UNTURNED + TURNED - here) : here;
            queue[end++] = twin / 3;
        }
    return end;
}

/// Turn over the smaller of the two groups of faces of a connected piece.
static void turn_minority(const uint32_t *piece, size_t count, unsigned char *turn)
{
    size_t turned = 0;
    for (size_t i = 0; i < count; i++)
        turned += turn[piece[i]] == TURNED;
    bool other = turned > count - turned;
    for (size_t i = 0; i < count && other; i++)
        turn[piece[i]] = (unsigned char)(UNTURNED + TURNED - turn[piece[i]]);
}

/// The index of a half-edge after corners 1 and 2 of its face are exchanged.
static uint32_t turned_half_edge(uint32_t half_edge)
{
    return 3 * (half_edge / 3) + 2 - half_edge % 3;
}

/// Exchange corners 1 and 2 of the turned faces and renumber their half-edges.
static void turn_faces(repair_work *work, const unsigned char *turn, bat_mesh_repair_report *report)
{
    size_t count = 3 * work->face_count;
    for (size_t i = 0; i < count; i++)
    {
        uint32_t twin = work->twin[i], sorted = work->sorted[i];
        if (twin != BAT_MESH_NONE && turn[twin / 3] == TURNED)
            work->twin[i] = turned_half_edge(twin);
        if (turn[sorted / 3] == TURNED)
            work->sorted[i] = turned_half_edge(sorted);
    }
    for (size_t f = 0; f < work->face_count; f++)
    {
        if (turn[f] != TURNED)
            continue;
        uint32_t *corner = work->faces + 3 * f, *twin = work->twin + 3 * f;
        SWAP(corner[1], corner[2]);
        SWAP(twin[0], twin[2]);
        report->flipped_faces++;
    }
}

/// Step 3: orient the faces alike, and cut the edges whose faces still have opposite orientations.
static bool repair_orient_faces(repair_work *work, bat_mesh_repair_report *report)
{
    unsigned char *turn = calloc(work->face_count, sizeof *turn);
    if (turn == NULL)
        return false;
    uint32_t *queue = work->fan; // used as workspace here
    size_t begin = 0;
    for (uint32_t f = 0; f < work->face_count; f++)
    {
        if (turn[f] != UNVISITED)
            continue;
        size_t end = propagate_turns(work, f, turn, queue, begin);
        turn_minority(queue + begin, end - begin, turn);
        begin = end;
    }
    turn_faces(work, turn, report);
    free(turn);
    for (size_t h = 0; h < 3 * work->face_count; h++)
    {
        uint32_t twin = work->twin[h];
        if (twin == BAT_MESH_NONE || work->faces[twin] != work->faces[h])
            continue;
        work->twin[h] = work->twin[twin] = BAT_MESH_NONE;
        report->unorientable_edges++;
    }
    return true;
}

/// Mark the half-edges of a fan around a vertex, in one direction from `begin`. True when the fan is closed.
static bool walk_fan(repair_work *work, uint32_t begin, bool counter_clockwise)
{
    uint32_t h = begin;
    for (;;)
    {
        uint32_t across = counter_clockwise ? work->twin[bat_mesh_previous(h)] : work->twin[h];
        if (across == BAT_MESH_NONE)
            return false;
        h = counter_clockwise ? across : bat_mesh_next(across);
        if (h == begin)
            return true;
        work->fan[h] = begin;
    }
}

/// Count the fans of every vertex and, in the report, the vertices to be split. Returns the number of all fans.
static size_t count_fans(const repair_work *work, uint32_t *fans, bat_mesh_repair_report *report)
{
    size_t total = 0;
    memset(fans, 0, work->mesh->vertex_count * sizeof *fans);
    for (uint32_t h = 0; h < 3 * work->face_count; h++)
        if (work->fan[h] == h)
        {
            fans[work->faces[h]]++;
            total++;
        }
    for (size_t v = 0; v < work->mesh->vertex_count; v++)
    {
        report->unused_vertices += fans[v] == 0;
        report->split_vertices += fans[v] > 1;
        report->added_vertices += fans[v] > 1 ? fans[v] - 1 : 0;
    }
    return total;
}

/// Number the fans: first the first fan of every vertex in the order of the vertices, then all others.
static void number_fans(repair_work *work, uint32_t *number)
{
    uint32_t next = 0;
    for (size_t v = 0; v < work->mesh->vertex_count; v++)
        if (number[v] > 0)
        {
            work->origins[next] = (uint32_t)v;
            number[v] = next++;
        }
        else
            number[v] = BAT_MESH_NONE;
    for (uint32_t h = 0; h < 3 * work->face_count; h++)
    {
        uint32_t fan = work->fan[h], vertex = work->faces[h];
        if (fan != h)
        {
            work->copies[h] = work->copies[fan];
            continue;
        }
        bool first = number[vertex] != BAT_MESH_NONE;
        work->copies[h] = first ? number[vertex] : next++;
        work->origins[work->copies[h]] = vertex;
        number[vertex] = BAT_MESH_NONE;
    }
}

/// Step 4: give every fan its own copy of the vertex.
static bool repair_split_vertices(repair_work *work, bat_mesh_repair_report *report)
{
    uint32_t *fans = memory_array(work->mesh->vertex_count, sizeof *fans);
    if (fans == NULL)
        return false;
    uint32_t count = (uint32_t)(3 * work->face_count);
    memset(work->fan, 0xff, count * sizeof *work->fan);
    for (uint32_t h = 0; h < count; h++)
    {
        if (work->fan[h] != BAT_MESH_NONE)
            continue;
        work->fan[h] = h;
        if (!walk_fan(work, h, true))
            (void)walk_fan(work, h, false);
    }
    work->vertex_count = count_fans(work, fans, report);
    work->copies = memory_pool_array(&work->pool, work->face_count, 3 * sizeof *work->copies);
    work->origins = memory_pool_array(&work->pool, work->vertex_count, sizeof *work->origins);
    if (work->pool.missing == 0)
        number_fans(work, fans);
    free(fans);
    return work->pool.missing == 0;
}

static bool work_begin(const bat_mesh *broken, repair_work *work)
{
    size_t half_edges = 3 * broken->face_count;
    *work = (repair_work){.mesh = broken};
    work->faces = memory_pool_array(&work->pool, half_edges, sizeof *work->faces);
    work->sources = memory_pool_array(&work->pool, broken->face_count, sizeof *work->sources);
    work->sorted = memory_pool_array(&work->pool, half_edges, sizeof *work->sorted);
    work->twin = memory_pool_array(&work->pool, half_edges, sizeof *work->twin);
    work->fan = memory_pool_array(&work->pool, half_edges, sizeof *work->fan);
    return work->pool.missing == 0;
}

/// Copy the texture coordinates; the texture corners follow the faces.
static bool carry_texture(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    if (mesh->texture_faces == NULL)
        return true;
    made->texture_count = mesh->texture_count;
    made->texture_faces = memory_array(work->face_count, 3 * sizeof *made->texture_faces);
    if (!mesh_copy_array(mesh->texture, mesh->texture_count, 2 * sizeof *made->texture, (void **)&made->texture) ||
        made->texture_faces == NULL)
        return false;
    for (size_t f = 0; f < work->face_count; f++)
    {
        const uint32_t *from = mesh->texture_faces + 3 * (size_t)work->sources[f];
        bool flipped = work->faces[3 * f + 1] != mesh->faces[3 * (size_t)work->sources[f] + 1];
        made->texture_faces[3 * f] = from[0];
        made->texture_faces[3 * f + 1] = from[flipped ? 2 : 1];
        made->texture_faces[3 * f + 2] = from[flipped ? 1 : 2];
    }
    return true;
}

static bool carry_channels(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    size_t count = mesh->channel_count;
    if (count == 0)
        return true;
    if (channels_make(mesh, work->vertex_count, made, NULL) != BAT_OK)
        return false;
    for (size_t v = 0; v < work->vertex_count; v++)
        memcpy(made->channels + v * count, mesh->channels + work->origins[v] * count, count * sizeof *made->channels);
    return true;
}

static bool carry_vertices(const repair_work *work, bat_mesh *made)
{
    made->vertex_count = work->vertex_count;
    made->face_count = work->face_count;
    made->positions = memory_array(work->vertex_count, 3 * sizeof *made->positions);
    made->faces = memory_array(work->face_count, 3 * sizeof *made->faces);
    if (made->positions == NULL || made->faces == NULL)
        return false;
    for (size_t v = 0; v < work->vertex_count; v++)
        memcpy(made->positions + 3 * v, work->mesh->positions + 3 * (size_t)work->origins[v], 3 * sizeof *made->positions);
    memcpy(made->faces, work->copies, work->face_count * 3 * sizeof *made->faces);
    return true;
}

DEFINE_ORDER(compare_creases, bat_mesh_crease, a, b)

/// The largest sharpness given for each vertex, -1 for none. Null when out of memory.
static double *sharpness_of_vertices(const bat_mesh *mesh)
{
    double *sharpness = memory_array(mesh->vertex_count, sizeof *sharpness);
    for (size_t v = 0; v < mesh->vertex_count && sharpness != NULL; v++)
        sharpness[v] = -1.0;
    for (size_t i = 0; i < mesh->corner_count && sharpness != NULL; i++)
        if (mesh->corners[i].sharpness > sharpness[mesh->corners[i].vertex])
            sharpness[mesh->corners[i].vertex] = mesh->corners[i].sharpness;
    return sharpness;
}

static bool carry_corners(const repair_work *work, bat_mesh *made)
{
    if (work->mesh->corner_count == 0)
        return true;
    double *sharpness = sharpness_of_vertices(work->mesh);
    if (sharpness == NULL)
        return false;
    size_t count = 0;
    for (size_t v = 0; v < work->vertex_count; v++)
        count += sharpness[work->origins[v]] >= 0;
    made->corners = memory_array(count, sizeof *made->corners);
    for (size_t v = 0; v < work->vertex_count && made->corners != NULL; v++)
        if (sharpness[work->origins[v]] >= 0)
            made->corners[made->corner_count++] = (bat_mesh_corner){(uint32_t)v, sharpness[work->origins[v]]};
    free(sharpness);
    return made->corners != NULL;
}

/// Whether an edge is less than (a, b).
static bool precedes(repair_edge edge, uint32_t a, uint32_t b)
{
    return edge.low < a || (edge.low == a && edge.high < b);
}

/// The first place in work->sorted whose edge is not less than (a, b), by bisection.
static size_t first_of_edge(const repair_work *work, uint32_t a, uint32_t b)
{
    size_t low = 0, high = 3 * work->face_count;
    BISECT(low, high, middle, precedes(repair_edge_of(work, work->sorted[middle]), a, b))
    return low;
}

/// Append a crease for every half-edge on the edge of a crease. False when out of memory.
static bool follow_crease(const repair_work *work, const bat_mesh_crease *crease, size_t *room, bat_mesh *made)
{
    uint32_t a = crease->a < crease->b ? crease->a : crease->b, b = crease->a < crease->b ? crease->b : crease->a;
    for (size_t i = first_of_edge(work, a, b); i < 3 * work->face_count; i++)
    {
        uint32_t h = work->sorted[i];
        repair_edge edge = repair_edge_of(work, h);
        if (edge.low != a || edge.high != b)
            break;
        uint32_t from = work->copies[h], to = work->copies[bat_mesh_next(h)];
        const bat_mesh_crease copy = {from < to ? from : to, from < to ? to : from, crease->sharpness};
        if (!ARRAY_ADD(made->creases, *room, made->crease_count, copy))
            return false;
    }
    return true;
}

/// Copy the creases to all copies of their edges. Of several creases on one edge the sharpest remains.
static bool carry_creases(const repair_work *work, bat_mesh *made)
{
    const bat_mesh *mesh = work->mesh;
    size_t room = 0, kept = 0;
    for (size_t i = 0; i < mesh->crease_count; i++)
        if (!follow_crease(work, &mesh->creases[i], &room, made))
            return false;
    bat_mesh_crease *creases = made->creases;
    size_t count = made->crease_count;
    if (count > 0)
        qsort(creases, count, sizeof *creases, compare_creases);
    for (size_t i = 0; i < count; i++)
    {
        if (kept == 0 || compare_creases(&creases[kept - 1], &creases[i]) != 0)
            creases[kept++] = creases[i];
        else if (creases[i].sharpness > creases[kept - 1].sharpness)
            creases[kept - 1].sharpness = creases[i].sharpness;
    }
    made->crease_count = kept;
    return true;
}

bat_status bat_mesh_repair(const bat_mesh *broken, bat_mesh_repair_report *report, bat_mesh *repaired, bat_error *error)
{
    bat_mesh_repair_report done = {0};
    repair_work work = {0};
    bat_status status = mesh_check_except_degenerate(broken, error);
    if (status != BAT_OK)
        return status;
    bool room = work_begin(broken, &work) && repair_drop_faces(&work, &done);
    if (room && work.face_count == 0)
        status = ERROR_ARGUMENT(error, "every face has the same vertex twice");
    else if (!room || !repair_join_faces(&work, &done) || !repair_orient_faces(&work, &done) ||
             !repair_split_vertices(&work, &done))
        status = error_memory(error, 3 * broken->face_count * sizeof(uint32_t));
    if (status == BAT_OK && work.vertex_count >= BAT_MESH_NONE)
        status = ERROR_TOO_LARGE(error, "the repaired mesh has more than %zu vertices", (size_t)BAT_MESH_NONE);
    if (status == BAT_OK)
    {
        bat_mesh made = {0};
        if (carry_vertices(&work, &made) && carry_texture(&work, &made) && carry_channels(&work, &made) &&
            carry_corners(&work, &made) && carry_creases(&work, &made))
            status = mesh_labels_carry(work.mesh, work.sources, 1, &made, error);
        else
            status = error_memory(error, work.face_count * 3 * sizeof *made.faces);
        if (status == BAT_OK)
            *repaired = made;
        else
            bat_mesh_free(&made);
    }
    if (status == BAT_OK && report != NULL)
        *report = done;
    memory_pool_free(&work.pool);
    return status;
}

size_t bat_mesh_repair_places(const bat_mesh_repair_report *report)
{
    return report->degenerate_faces + report->duplicate_faces + report->flipped_faces + report->nonmanifold_edges +
           report->unorientable_edges + report->split_vertices + report->filled_holes;
}

// Merging of vertices that coincide or, with a distance, lie near an earlier vertex that remains.

/// Find the welded vertex of every vertex. `kept` receives how many remain, in their order.
static bool find_targets(const bat_mesh *mesh, double distance, uint32_t *target, size_t *kept)
{
    point_table table = {.points = mesh->positions, .cell = distance};
    bool room = point_table_reserve(&table, mesh->vertex_count);
    *kept = 0;
    for (uint32_t v = 0; v < mesh->vertex_count && room; v++)
    {
        const double *position = mesh->positions + 3 * (size_t)v;
        uint32_t other = distance > 0 ? point_table_near(&table, position) : point_table_find(&table, position);
        if (other != BAT_MESH_NONE)
        {
            target[v] = target[other];
            continue;
        }
        target[v] = (uint32_t)(*kept)++;
        room = point_table_add(&table, v);
    }
    point_table_free(&table);
    return room;
}

bat_status bat_mesh_weld(const bat_mesh *mesh, double distance, size_t *merged, bat_mesh *welded, bat_error *error)
{
    if (!(distance >= 0) || !isfinite(distance))
        return ERROR_ARGUMENT(error, "the distance of welding is %g", distance);
    bat_status status = mesh_check_except_degenerate(mesh, error);
    if (status != BAT_OK)
        return status;
    size_t count = mesh->vertex_count, kept = 0;
    uint32_t *target = memory_array(count, sizeof *target);
    bat_mesh made = {0};
    if (target == NULL || !find_targets(mesh, distance, target, &kept))
        status = error_memory(error, count * sizeof *target);
    if (status == BAT_OK)
        status = bat_mesh_copy(mesh, &made, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < 3 * made.face_count; i++)
            made.faces[i] = target[made.faces[i]];
        mesh_renumber(&made, kept, target);
        *welded = made;
        if (merged != NULL)
            *merged = count - kept;
    }
    free(target);
    return status;
}

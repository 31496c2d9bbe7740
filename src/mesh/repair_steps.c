#include "mesh/repair_steps.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// Sort items stably by a number of each: counting sort.
/// @param starts room for `key_count` + 1 numbers
static void sort_by(const uint32_t *items, size_t count, uint32_t (*key)(const repair_work *, uint32_t),
                    const repair_work *work, size_t key_count, size_t *starts, uint32_t *sorted)
{
    memset(starts, 0, (key_count + 1) * sizeof *starts);
    for (size_t i = 0; i < count; i++)
        starts[key(work, items[i]) + 1]++;
    for (size_t k = 0; k < key_count; k++)
        starts[k + 1] += starts[k];
    for (size_t i = 0; i < count; i++)
        sorted[starts[key(work, items[i])]++] = items[i];
}

/// The corner of a face with its least vertex.
static uint32_t least_corner(const repair_work *work, uint32_t face)
{
    const uint32_t *corner = work->faces + 3 * (size_t)face;
    uint32_t least = corner[1] < corner[0] ? 1 : 0;
    return corner[2] < corner[least] ? 2 : least;
}

/// The vertex of a face that comes `steps` corners after its least one.
static uint32_t cyclic_vertex(const repair_work *work, uint32_t face, uint32_t steps)
{
    return work->faces[3 * (size_t)face + (least_corner(work, face) + steps) % 3];
}

static uint32_t first_vertex(const repair_work *work, uint32_t face)
{
    return cyclic_vertex(work, face, 0);
}

static uint32_t second_vertex(const repair_work *work, uint32_t face)
{
    return cyclic_vertex(work, face, 1);
}

static uint32_t third_vertex(const repair_work *work, uint32_t face)
{
    return cyclic_vertex(work, face, 2);
}

static bool same_face(const repair_work *work, uint32_t a, uint32_t b)
{
    return first_vertex(work, a) == first_vertex(work, b) && second_vertex(work, a) == second_vertex(work, b) &&
           third_vertex(work, a) == third_vertex(work, b);
}

/// Keep the faces of three different vertices.
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

/// Drop faces that are like the one before them in the sorted order, which is an earlier face.
static void drop_repeated(repair_work *work, const uint32_t *order, uint32_t *repeated)
{
    memset(repeated, 0, work->face_count * sizeof *repeated);
    for (size_t i = 1; i < work->face_count; i++)
        repeated[order[i]] = same_face(work, order[i - 1], order[i]);
    size_t kept = 0;
    for (size_t f = 0; f < work->face_count; f++)
    {
        if (repeated[f])
            continue;
        memmove(work->faces + 3 * kept, work->faces + 3 * f, 3 * sizeof *work->faces);
        work->sources[kept++] = work->sources[f];
    }
    work->face_count = kept;
}

bool repair_drop_faces(repair_work *work, bat_mesh_repair_report *report)
{
    size_t keys = work->mesh->vertex_count;
    drop_degenerate(work);
    report->degenerate_faces = work->mesh->face_count - work->face_count;
    size_t *starts = memory_array(keys + 1, sizeof *starts);
    if (starts == NULL)
        return false;
    uint32_t *order = work->sorted, *other = work->twin; // not in use yet
    size_t count = work->face_count;
    for (uint32_t f = 0; f < count; f++)
        other[f] = f;
    sort_by(other, count, third_vertex, work, keys, starts, order);
    sort_by(order, count, second_vertex, work, keys, starts, other);
    sort_by(other, count, first_vertex, work, keys, starts, order);
    free(starts);
    drop_repeated(work, order, other);
    report->duplicate_faces = count - work->face_count;
    return true;
}

static uint32_t low_vertex(const repair_work *work, uint32_t half_edge)
{
    return repair_edge_of(work, half_edge).low;
}

static uint32_t high_vertex(const repair_work *work, uint32_t half_edge)
{
    return repair_edge_of(work, half_edge).high;
}

/// The end of the run of half-edges on one edge that begins at a place of the sorted order.
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

bool repair_join_faces(repair_work *work, bat_mesh_repair_report *report)
{
    size_t count = 3 * work->face_count, keys = work->mesh->vertex_count;
    size_t *starts = memory_array(keys + 1, sizeof *starts);
    if (starts == NULL)
        return false;
    uint32_t *by_high = work->fan; // not in use yet
    for (uint32_t h = 0; h < count; h++)
        work->twin[h] = h;
    sort_by(work->twin, count, high_vertex, work, keys, starts, by_high);
    sort_by(by_high, count, low_vertex, work, keys, starts, work->sorted);
    free(starts);
    memset(work->twin, 0xff, count * sizeof *work->twin);
    for (size_t begin = 0, end; begin < count; begin = end)
    {
        end = end_of_run(work, begin);
        report->crowded_edges += end - begin > 2;
        if (end - begin != 2)
            continue;
        work->twin[work->sorted[begin]] = work->sorted[begin + 1];
        work->twin[work->sorted[begin + 1]] = work->sorted[begin];
    }
    return true;
}

/// How a face is turned, while a piece is walked through.
enum
{
    UNSEEN,
    AS_IT_IS,
    TURNED
};

/// Walk through the piece of a face and say of each face how it must be turned to run as the first. The faces are appended
/// to `queue`; returns its new length.
static size_t walk_piece(const repair_work *work, uint32_t first, unsigned char *turn, uint32_t *queue, size_t begin)
{
    size_t end = begin;
    turn[first] = AS_IT_IS;
    queue[end++] = first;
    for (size_t i = begin; i < end; i++)
        for (uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; h++)
        {
            uint32_t twin = work->twin[h];
            if (twin == BAT_MESH_NONE || turn[twin / 3] != UNSEEN)
                continue;
            bool against = work->faces[twin] == work->faces[h];
            unsigned char here = turn[queue[i]];
            turn[twin / 3] = against ? (unsigned char)(AS_IT_IS + TURNED - here) : here;
            queue[end++] = twin / 3;
        }
    return end;
}

/// Turn the lesser part of a piece.
static void settle_piece(const uint32_t *piece, size_t count, unsigned char *turn)
{
    size_t turned = 0;
    for (size_t i = 0; i < count; i++)
        turned += turn[piece[i]] == TURNED;
    bool other = turned > count - turned;
    for (size_t i = 0; i < count && other; i++)
        turn[piece[i]] = (unsigned char)(AS_IT_IS + TURNED - turn[piece[i]]);
}

/// Where a half-edge is after its face was turned by exchanging corners 1 and 2.
static uint32_t turned_half_edge(uint32_t half_edge)
{
    return 3 * (half_edge / 3) + 2 - half_edge % 3;
}

/// Exchange corners 1 and 2 of the turned faces, and bring all that is said of their half-edges along.
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
        uint32_t *corner = work->faces + 3 * f, *twin = work->twin + 3 * f, kept = corner[1];
        corner[1] = corner[2];
        corner[2] = kept;
        kept = twin[0];
        twin[0] = twin[2];
        twin[2] = kept;
        report->flipped_faces++;
    }
}

bool repair_orient_faces(repair_work *work, bat_mesh_repair_report *report)
{
    unsigned char *turn = calloc(work->face_count, sizeof *turn);
    if (turn == NULL)
        return false;
    uint32_t *queue = work->fan; // not in use yet
    size_t begin = 0;
    for (uint32_t f = 0; f < work->face_count; f++)
    {
        if (turn[f] != UNSEEN)
            continue;
        size_t end = walk_piece(work, f, turn, queue, begin);
        settle_piece(queue + begin, end - begin, turn);
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
        report->opposed_edges++;
    }
    return true;
}

/// Turn around a vertex from a half-edge, in one direction, and note the fan of all that begin there. True when it comes
/// back.
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

static void find_fans(repair_work *work)
{
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
}

/// Count the fans of every vertex, and what follows from that.
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

/// Number the fans: the first of each vertex in the order of vertices, then the others.
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

bool repair_split_vertices(repair_work *work, bat_mesh_repair_report *report)
{
    uint32_t *fans = memory_array(work->mesh->vertex_count, sizeof *fans);
    if (fans == NULL)
        return false;
    find_fans(work);
    work->vertex_count = count_fans(work, fans, report);
    work->copies = memory_array(work->face_count, 3 * sizeof *work->copies);
    work->origins = memory_array(work->vertex_count, sizeof *work->origins);
    if (work->copies != NULL && work->origins != NULL)
        number_fans(work, fans);
    free(fans);
    return work->copies != NULL && work->origins != NULL;
}

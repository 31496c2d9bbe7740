#include "surface/cloud/tube_cut.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/key_map.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/// A side of a face.
typedef struct face_side
{
    uint64_t key;
    uint32_t side; ///< 3 x face + k
} face_side;

/// The faces as a graph.
typedef struct face_graph
{
    const uint32_t *faces;
    size_t count, points;
    uint32_t *other; ///< 3 x count: the face on the other side; NONE at the boundary
    uint32_t *next;  ///< points: the side of the boundary that begins at a point
    uint8_t *loop;   ///< 3 x count: 1 or 2, the loop of a side of the boundary; 0 elsewhere
    uint32_t *queue; ///< count
    uint32_t *from;  ///< count: the face before, in breadth-first order
} face_graph;

static int compare_sides(const void *a, const void *b)
{
    const face_side *p = a, *q = b;
    if (p->key != q->key)
        return p->key < q->key ? -1 : 1;
    return (p->side > q->side) - (p->side < q->side);
}

static uint32_t begin_of(const face_graph *graph, uint32_t side)
{
    return graph->faces[side];
}

static uint32_t end_of(const face_graph *graph, uint32_t side)
{
    return graph->faces[side / 3 * 3 + (side + 1) % 3];
}

/// Find the neighbours of all faces. False when out of memory.
static bool find_others(face_graph *graph)
{
    size_t sides = 3 * graph->count;
    face_side *sorted = memory_array(sides, sizeof *sorted);
    if (sorted == NULL)
        return false;
    for (size_t s = 0; s < sides; s++)
    {
        sorted[s] = (face_side){key_of_pair(begin_of(graph, (uint32_t)s), end_of(graph, (uint32_t)s)), (uint32_t)s};
        graph->other[s] = NONE;
    }
    qsort(sorted, sides, sizeof *sorted, compare_sides);
    for (size_t s = 0; s + 1 < sides; s++)
        if (sorted[s].key == sorted[s + 1].key)
        {
            graph->other[sorted[s].side] = sorted[s + 1].side / 3;
            graph->other[sorted[s + 1].side] = sorted[s].side / 3;
        }
    free(sorted);
    return true;
}

/// Number the loops of the boundary. Returns their number, 0 where a loop visits a point twice, at most 3.
static uint8_t number_loops(face_graph *graph)
{
    size_t sides = 3 * graph->count;
    uint8_t loops = 0;
    for (size_t p = 0; p < graph->points; p++)
        graph->next[p] = NONE;
    for (size_t s = 0; s < sides; s++)
    {
        if (graph->other[s] != NONE)
            continue;
        uint32_t *next = &graph->next[begin_of(graph, (uint32_t)s)];
        if (*next != NONE)
            return 0;
        *next = (uint32_t)s;
    }
    for (size_t s = 0; s < sides && loops < 3; s++)
    {
        if (graph->other[s] != NONE || graph->loop[s] != 0)
            continue;
        loops++;
        for (uint32_t side = (uint32_t)s; side != NONE && graph->loop[side] == 0; side = graph->next[end_of(graph, side)])
            graph->loop[side] = loops;
    }
    return loops;
}

/// Whether a face has exactly one side on the boundary, of a loop. The strip ends at such faces, so that no point is lost.
static bool meets(const face_graph *graph, uint32_t face, uint8_t loop)
{
    int sides = 0, wanted = 0;
    for (size_t k = 0; k < 3; k++)
    {
        sides += graph->loop[3 * (size_t)face + k] != 0;
        wanted += graph->loop[3 * (size_t)face + k] == loop;
    }
    return sides == 1 && wanted == 1;
}

/// The last face of the shortest strip from loop 1 to loop 2; NONE without one.
static uint32_t find_strip(face_graph *graph)
{
    size_t begin = 0, end = 0;
    for (uint32_t f = 0; f < graph->count; f++)
    {
        bool first = meets(graph, f, 1);
        graph->from[f] = first ? f : NONE;
        if (first)
            graph->queue[end++] = f;
    }
    while (begin < end)
    {
        uint32_t face = graph->queue[begin++];
        if (meets(graph, face, 2))
            return face;
        for (size_t k = 0; k < 3; k++)
        {
            uint32_t other = graph->other[3 * (size_t)face + k];
            if (other == NONE || graph->from[other] != NONE)
                continue;
            graph->from[other] = face;
            graph->queue[end++] = other;
        }
    }
    return NONE;
}

/// Remove the faces of a strip.
static void remove_strip(const face_graph *graph, uint32_t last, uint32_t *faces, size_t *count)
{
    // The loops are no longer needed.
    uint8_t *removed = graph->loop;
    memset(removed, 0, graph->count);
    removed[last] = 1;
    for (uint32_t face = last; graph->from[face] != face; face = graph->from[face])
        removed[graph->from[face]] = 1;
    size_t kept = 0;
    for (size_t f = 0; f < graph->count; f++)
    {
        if (removed[f] != 0)
            continue;
        memmove(faces + 3 * kept, faces + 3 * f, 3 * sizeof *faces);
        kept++;
    }
    *count = kept;
}

bat_status tube_cut(uint32_t *faces, size_t *count, size_t points, bat_error *error)
{
    face_graph graph = {.faces = faces,
                        .count = *count,
                        .points = points,
                        .other = memory_array(*count, 3 * sizeof *graph.other),
                        .next = memory_array(points, sizeof *graph.next),
                        .loop = calloc(*count + 1, 3 * sizeof *graph.loop),
                        .queue = memory_array(*count, sizeof *graph.queue),
                        .from = memory_array(*count, sizeof *graph.from)};
    bat_status status = BAT_OK;
    if (graph.other == NULL || graph.next == NULL || graph.loop == NULL || graph.queue == NULL || graph.from == NULL ||
        !find_others(&graph))
        status = error_memory(error, *count * 6 * sizeof *graph.other);
    uint32_t last = status == BAT_OK && number_loops(&graph) == 2 ? find_strip(&graph) : NONE;
    if (status == BAT_OK && last == NONE)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the triangles are no tube");
    if (status == BAT_OK)
        remove_strip(&graph, last, faces, count);
    free(graph.other);
    free(graph.next);
    free(graph.loop);
    free(graph.queue);
    free(graph.from);
    return status;
}

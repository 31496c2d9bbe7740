#include "surface/cloud/tube_cut.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/// The faces as a graph.
typedef struct face_graph
{
    const uint32_t *faces;
    size_t count;
    bat_mesh_connectivity connectivity;
    uint8_t *loop;   ///< 3 x count: 1 or 2, the loop of a half-edge of the boundary; 0 elsewhere
    uint32_t *queue; ///< count
    uint32_t *from;  ///< count: the face before, in breadth-first order
} face_graph;

/// Number the loops of the boundary. Returns their number, at most 3.
static uint8_t number_loops(face_graph *graph)
{
    const bat_mesh_connectivity *connectivity = &graph->connectivity;
    uint8_t loops = 0;
    for (uint32_t h = 0; h < 3 * graph->count && loops < 3; h++)
    {
        if (connectivity->twin[h] != BAT_MESH_NONE || graph->loop[h] != 0)
            continue;
        loops++;
        // The first half-edge of a vertex of the boundary is on it.
        for (uint32_t side = h; graph->loop[side] == 0; side = connectivity->first[graph->faces[bat_mesh_next(side)]])
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
            uint32_t twin = graph->connectivity.twin[3 * (size_t)face + k], other = twin / 3;
            if (twin == BAT_MESH_NONE || graph->from[other] != NONE)
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
    const bat_mesh mesh = {.faces = faces, .vertex_count = points, .face_count = *count};
    face_graph graph = {.faces = faces,
                        .count = *count,
                        .loop = calloc(*count + 1, 3 * sizeof *graph.loop),
                        .queue = memory_array(*count, sizeof *graph.queue),
                        .from = memory_array(*count, sizeof *graph.from)};
    bat_status status = graph.loop == NULL || graph.queue == NULL || graph.from == NULL
                            ? error_memory(error, *count * sizeof *graph.queue)
                            : bat_mesh_connect(&mesh, &graph.connectivity, error);
    bool is_tube = status == BAT_OK && number_loops(&graph) == 2;
    uint32_t last = is_tube ? find_strip(&graph) : NONE;
    if (status != BAT_NO_MEMORY && last == NONE)
        status = error_set(error, BAT_NO_CONVERGENCE, BAT_NO_INDEX, 0, "the triangles are no tube");
    if (status == BAT_OK)
        remove_strip(&graph, last, faces, count);
    bat_mesh_connectivity_free(&graph.connectivity);
    free(graph.loop);
    free(graph.queue);
    free(graph.from);
    return status;
}

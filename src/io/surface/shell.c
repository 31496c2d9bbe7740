#include "io/surface/shell.h"

#include "base/array_grow.h"
#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// Corners are sorted along lines of both directions. Each side of a face is then split at the vertices on it.

/// A corner. Sorted corners of a line are consecutive.
typedef struct shell_point
{
    uint64_t line, along;
    uint32_t vertex;
} shell_point;

/// The state of the construction.
typedef struct shell_builder
{
    const shell_face *faces;
    size_t face_count;
    shell_point *lines[2];   ///< all vertices along lines of u, and along lines of v
    uint32_t *edge_after[2]; ///< for each vertex: the edge that begins there along u, and along v
    size_t edge_capacity, use_count, use_capacity;
    surface_shell *shell;
} shell_builder;

static int compare_points(const void *a, const void *b)
{
    const shell_point *x = a, *y = b;
    if (x->line != y->line)
        return x->line < y->line ? -1 : 1;
    return (x->along > y->along) - (x->along < y->along);
}

/// Collect all corners, each once, sorted along lines v = constant.
static bat_status find_vertices(shell_builder *builder, bat_error *error)
{
    size_t corners = 4 * builder->face_count, count = 0;
    shell_point *points = builder->lines[0] = memory_array(corners, sizeof *points);
    if (points == NULL)
        return error_memory(error, corners * sizeof *points);
    for (size_t i = 0; i < corners; i++)
    {
        const shell_face *face = &builder->faces[i / 4];
        points[i].line = i % 4 < 2 ? face->low[1] : face->high[1];
        points[i].along = i % 2 == 0 ? face->low[0] : face->high[0];
    }
    qsort(points, corners, sizeof *points, compare_points);
    for (size_t i = 0; i < corners; i++)
        if (i == 0 || compare_points(&points[i], &points[count - 1]) != 0)
        {
            points[count] = points[i];
            points[count].vertex = (uint32_t)count;
            count++;
        }
    builder->shell->vertex_count = count;
    return BAT_OK;
}

/// Sort the vertices along lines u = constant, and set their coordinates.
static bat_status sort_vertices(shell_builder *builder, bat_error *error)
{
    surface_shell *shell = builder->shell;
    size_t count = shell->vertex_count;
    builder->lines[1] = memory_array(count, sizeof *builder->lines[1]);
    builder->edge_after[0] = memory_array(count, sizeof **builder->edge_after);
    builder->edge_after[1] = memory_array(count, sizeof **builder->edge_after);
    shell->vertices = memory_array(count, 2 * sizeof *shell->vertices);
    if (builder->lines[1] == NULL || builder->edge_after[0] == NULL || builder->edge_after[1] == NULL ||
        shell->vertices == NULL)
        return error_memory(error, count * sizeof **builder->lines);
    for (size_t i = 0; i < count; i++)
    {
        const shell_point *point = &builder->lines[0][i];
        builder->lines[1][i] = (shell_point){point->along, point->line, point->vertex};
        builder->edge_after[0][i] = builder->edge_after[1][i] = SHELL_NONE;
        shell->vertices[2 * i] = point->along;
        shell->vertices[2 * i + 1] = point->line;
    }
    qsort(builder->lines[1], count, sizeof **builder->lines, compare_points);
    return BAT_OK;
}

static bool grow(void **array, size_t *capacity, size_t count, size_t size)
{
    return array_grow(array, capacity, count + 1, size);
}

/// The edge from a vertex to the next one on its line, as a part of a side of a face; SHELL_NONE when out of memory.
static uint32_t use_edge(shell_builder *builder, uint32_t direction, uint32_t from, uint32_t to, uint32_t face,
                         uint32_t side)
{
    surface_shell *shell = builder->shell;
    uint32_t *place = &builder->edge_after[direction][from];
    if (*place != SHELL_NONE)
    {
        shell->edges[*place].faces[1] = face;
        shell->edges[*place].sides[1] = side;
        return *place;
    }
    void *edges = shell->edges;
    if (!grow(&edges, &builder->edge_capacity, shell->edge_count, sizeof *shell->edges))
        return SHELL_NONE;
    shell->edges = edges;
    shell->edges[shell->edge_count] = (shell_edge){from, to, direction, {face, SHELL_NONE}, {side, side}};
    *place = (uint32_t)shell->edge_count++;
    return *place;
}

/// Append the edges of a side of a face to its loop.
static bool add_side(shell_builder *builder, uint32_t face, uint32_t side)
{
    const shell_face *rectangle = &builder->faces[face];
    uint32_t direction = side % 2;
    const uint64_t *line = side == 1 || side == 2 ? rectangle->high : rectangle->low;
    const shell_point key = {.line = line[1 - direction], .along = rectangle->low[direction]};
    const shell_point *point =
        bsearch(&key, builder->lines[direction], builder->shell->vertex_count, sizeof key, compare_points);
    size_t first = builder->use_count;
    for (; point->along < rectangle->high[direction]; point++)
    {
        void *uses = builder->shell->uses;
        uint32_t edge = use_edge(builder, direction, point[0].vertex, point[1].vertex, face, side);
        if (edge == SHELL_NONE || !grow(&uses, &builder->use_capacity, builder->use_count, sizeof *builder->shell->uses))
            return false;
        builder->shell->uses = uses;
        builder->shell->uses[builder->use_count++] = (shell_use){edge, side >= 2};
    }
    // Two sides run against their direction; their edges are reversed.
    shell_use *uses = builder->shell->uses;
    for (size_t i = first, j = builder->use_count; side >= 2 && i + 1 < j; i++)
    {
        shell_use use = uses[--j];
        uses[j] = uses[i];
        uses[i] = use;
    }
    return true;
}

static bat_status find_edges(shell_builder *builder, bat_error *error)
{
    surface_shell *shell = builder->shell;
    shell->face_count = builder->face_count;
    shell->loops = memory_array(shell->face_count + 1, sizeof *shell->loops);
    if (shell->loops == NULL)
        return error_memory(error, (shell->face_count + 1) * sizeof *shell->loops);
    for (size_t f = 0; f < shell->face_count; f++)
    {
        shell->loops[f] = builder->use_count;
        for (uint32_t side = 0; side < 4; side++)
            if (!add_side(builder, (uint32_t)f, side))
                return error_memory(error, builder->use_count * sizeof *shell->uses);
    }
    shell->loops[shell->face_count] = builder->use_count;
    return BAT_OK;
}

bat_status shell_make(const shell_face *faces, size_t count, surface_shell *shell, bat_error *error)
{
    enum
    {
        MAX_FACES = 1 << 29 // with four vertices each, all numbers fit into 32 bits
    };
    if (count > MAX_FACES)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "%zu faces are more than %d", count, MAX_FACES);
    surface_shell made = {0};
    shell_builder builder = {.faces = faces, .face_count = count, .shell = &made};
    bat_status status = find_vertices(&builder, error);
    if (status == BAT_OK)
        status = sort_vertices(&builder, error);
    if (status == BAT_OK)
        status = find_edges(&builder, error);
    for (int d = 0; d < 2; d++)
    {
        free(builder.lines[d]);
        free(builder.edge_after[d]);
    }
    if (status == BAT_OK)
        *shell = made;
    else
        shell_free(&made);
    return status;
}

void shell_free(surface_shell *shell)
{
    free(shell->vertices);
    free(shell->edges);
    free(shell->loops);
    free(shell->uses);
    *shell = (surface_shell){0};
}

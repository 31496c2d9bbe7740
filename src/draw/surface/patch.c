#include "draw/surface/scene.h"

#include "base/error.h"
#include "linalg/vector.h"
#include "surface/trim/trimming.h"

#include <string.h>

/// @file
/// Triangulations of spline surfaces by grids of parameters.

/// The smallest number of steps along a side, also of a trimmed surface, and the largest.
#define MIN_STEPS ((size_t)96)
#define MIN_TRIMMED_STEPS ((size_t)256)
#define MAX_STEPS ((size_t)320)

/// Steps across a cell, where the number of all steps allows it.
#define STEPS_OF_CELL ((size_t)3)

/// The largest number of lines along borders of cells, and of places where they may be.
#define MAX_LINES ((size_t)241)
#define MAX_LATTICE 0x1p24

/// A patch is nearly closed when its areas facing the eye and away differ by less than this fraction of the whole.
#define OPEN_SHARE 0.2

/// The lines of a grid in one direction: parameters from 0 to 1.
typedef struct patch_lines
{
    double *at;   ///< steps + 1
    size_t steps; ///< at least 1
} patch_lines;

/// Mark the borders of cells up to a level, on the lattice of this level.
/// @param marks one for each line of the lattice
/// @return the number of marked lines
static size_t mark_lines(const bat_hierarchical_space *space, int direction, uint32_t level, char *marks, size_t lines)
{
    size_t count = 0;
    memset(marks, 0, lines);
    for (size_t c = 0; c < bat_hierarchical_space_cells(space); c++)
    {
        bat_spline_box cell = bat_hierarchical_space_cell(space, c);
        if (cell.level <= level)
            for (size_t end = 0; end < 2; end++)
                marks[((size_t)cell.low[direction] + end) << (level - cell.level)] = 1;
    }
    for (size_t k = 0; k < lines; k++)
        count += marks[k] != 0;
    return count;
}

/// The marked line after another.
static size_t next_line(const char *marks, size_t line)
{
    do
        line++;
    while (marks[line] == 0);
    return line;
}

/// The equal steps of an interval of the lattice: each at most 1 / least long, and at least `parts` of them.
static size_t steps_between(size_t begin, size_t end, size_t lattice, size_t least, size_t parts)
{
    size_t wide = ((end - begin) * least + lattice - 1) / lattice;
    return wide > parts ? wide : parts;
}

/// Divide the intervals between marked lines into steps_between(), up to STEPS_OF_CELL where there are few lines.
static bat_status divide_lines(const char *marks, size_t lattice, size_t least, patch_lines *lines, bat_error *error)
{
    size_t parts = STEPS_OF_CELL + 1, total;
    do
    {
        parts--;
        total = 0;
        for (size_t begin = 0, end; begin < lattice; begin = end)
        {
            end = next_line(marks, begin);
            total += steps_between(begin, end, lattice, least, parts);
        }
    } while (total > MAX_STEPS && parts > 1);
    if (array_make(&lines->at, total + 1, sizeof *lines->at, error) != BAT_OK)
        return BAT_NO_MEMORY;
    lines->steps = 0;
    for (size_t begin = 0, end; begin < lattice; begin = end)
    {
        end = next_line(marks, begin);
        size_t count = steps_between(begin, end, lattice, least, parts);
        for (size_t k = 0; k < count; k++)
            lines->at[lines->steps++] =
                ((double)begin + (double)(end - begin) * (double)k / (double)count) / (double)lattice;
    }
    lines->at[lines->steps] = 1;
    return BAT_OK;
}

/// Choose the lines of a grid. They pass along the borders of cells, so that parts of a surface in few small cells are
/// drawn with as many steps as those in large ones; the finest levels are left out where these are too many lines.
static bat_status make_lines(const bat_spline_surface *surface, int direction, patch_lines *lines, bat_error *error)
{
    const bat_hierarchical_space *space = surface->space;
    size_t spans = bat_hierarchical_space_options(space).spans[direction];
    // Smaller cells cannot be seen.
    bool by_cells = spans < MAX_LINES;
    size_t least = !by_cells ? MAX_STEPS : surface->trim.loop_count > 0 ? MIN_TRIMMED_STEPS : MIN_STEPS;
    uint32_t level = (uint32_t)bat_hierarchical_space_levels(space) - 1;
    while (level > 0 && ldexp((double)spans, (int)level) > MAX_LATTICE)
        level--;
    size_t lattice = by_cells ? spans << level : 1;
    char *marks = memory_array(lattice + 1, 1);
    if (marks == NULL)
        return error_memory(error, lattice + 1);
    while (by_cells && mark_lines(space, direction, level, marks, lattice + 1) > MAX_LINES)
        lattice = spans << --level;
    marks[0] = marks[lattice] = 1;
    bat_status status = divide_lines(marks, lattice, least, lines, error);
    free(marks);
    return status;
}

/// The vertex in column i and row j of the grid.
static uint32_t vertex_at(const size_t steps[2], size_t i, size_t j)
{
    size_t m = steps[0], n = steps[1], number;
    if (j == 0)
        number = i;
    else if (i == m)
        number = m + j;
    else if (j == n)
        number = 2 * m + n - i;
    else if (i == 0)
        number = 2 * m + 2 * n - j;
    else
        number = 2 * m + 2 * n + (j - 1) * (m - 1) + i - 1;
    return (uint32_t)number;
}

static void fill_faces(const size_t steps[2], uint32_t *faces)
{
    for (size_t j = 0; j < steps[1]; j++)
        for (size_t i = 0; i < steps[0]; i++)
        {
            uint32_t a = vertex_at(steps, i, j), b = vertex_at(steps, i + 1, j);
            uint32_t c = vertex_at(steps, i + 1, j + 1), d = vertex_at(steps, i, j + 1);
            const uint32_t both[6] = {a, b, c, a, c, d};
            for (int k = 0; k < 6; k++)
                *faces++ = both[k];
        }
}

/// Keep the triangles whose corners are within the trimming curves, and the vertices of these.
static bat_status trim_patch(const bat_spline_surface *surface, const patch_lines lines[2], bat_mesh *mesh,
                             double *parameters, bat_error *error)
{
    const size_t steps[2] = {lines[0].steps, lines[1].steps};
    trim_region region;
    bat_status status = trim_region_make(&surface->trim, &region, error);
    if (status != BAT_OK)
        return status;
    uint32_t *numbers = memory_array(mesh->vertex_count, sizeof *numbers);
    if (numbers == NULL)
    {
        trim_region_free(&region);
        return error_memory(error, mesh->vertex_count * sizeof *numbers);
    }
    memset(numbers, 0, mesh->vertex_count * sizeof *numbers);
    for (size_t j = 0; j <= steps[1]; j++)
        for (size_t i = 0; i <= steps[0]; i++)
            numbers[vertex_at(steps, i, j)] = trim_region_contains(&region, lines[0].at[i], lines[1].at[j]);
    size_t vertices = 0, faces = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        bool kept = numbers[v] == 1;
        memmove(mesh->positions + 3 * vertices, mesh->positions + 3 * v, 3 * sizeof *mesh->positions);
        memmove(parameters + 2 * vertices, parameters + 2 * v, 2 * sizeof *parameters);
        numbers[v] = kept ? (uint32_t)vertices : BAT_MESH_NONE;
        vertices += kept;
    }
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        const uint32_t *face = mesh->faces + 3 * f;
        const uint32_t corners[3] = {numbers[face[0]], numbers[face[1]], numbers[face[2]]};
        bool kept = corners[0] != BAT_MESH_NONE && corners[1] != BAT_MESH_NONE && corners[2] != BAT_MESH_NONE;
        memcpy(mesh->faces + 3 * faces, corners, sizeof corners);
        faces += kept;
    }
    mesh->vertex_count = vertices;
    mesh->face_count = faces;
    free(numbers);
    trim_region_free(&region);
    return BAT_OK;
}

static bat_status make_patch(const bat_spline_surface *surface, const patch_lines lines[2], bat_mesh *mesh,
                             double **parameters, bat_error *error)
{
    const size_t steps[2] = {lines[0].steps, lines[1].steps};
    *mesh = (bat_mesh){.vertex_count = (steps[0] + 1) * (steps[1] + 1), .face_count = 2 * steps[0] * steps[1]};
    mesh->positions = memory_array(mesh->vertex_count, 3 * sizeof *mesh->positions);
    mesh->faces = memory_array(mesh->face_count, 3 * sizeof *mesh->faces);
    *parameters = memory_array(mesh->vertex_count, 2 * sizeof **parameters);
    if (mesh->positions == NULL || mesh->faces == NULL || *parameters == NULL)
        return error_memory(error, mesh->vertex_count * 3 * sizeof *mesh->positions);
    for (size_t j = 0; j <= steps[1]; j++)
        for (size_t i = 0; i <= steps[0]; i++)
        {
            double *parameter = *parameters + 2 * (size_t)vertex_at(steps, i, j);
            parameter[0] = lines[0].at[i];
            parameter[1] = lines[1].at[j];
        }
    bat_status status = bat_spline_surface_evaluate(surface, *parameters, mesh->vertex_count, 0, mesh->positions, error);
    if (status != BAT_OK)
        return status;
    fill_faces(steps, mesh->faces);
    return surface->trim.loop_count > 0 ? trim_patch(surface, lines, mesh, *parameters, error) : BAT_OK;
}

bat_status surface_patch_make(const bat_spline_surface *surface, bat_mesh *mesh, double **parameters, size_t *loop_count,
                              bat_error *error)
{
    double *places = NULL;
    patch_lines lines[2] = {0};
    bat_mesh made = {0};
    bat_status status = make_lines(surface, 0, &lines[0], error);
    if (status == BAT_OK)
        status = make_lines(surface, 1, &lines[1], error);
    if (status == BAT_OK)
        status = make_patch(surface, lines, &made, &places, error);
    *loop_count = surface->trim.loop_count > 0 ? 0 : 2 * (lines[0].steps + lines[1].steps);
    free(lines[0].at);
    free(lines[1].at);
    if (status != BAT_OK)
    {
        bat_mesh_free(&made);
        free(places);
        return status;
    }
    *mesh = made;
    *parameters = places;
    return BAT_OK;
}

void surface_patch_cut(bat_mesh *mesh, const double low[3], const double high[3])
{
    size_t kept = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        bool inside = true;
        for (size_t i = 0; i < 9; i++)
        {
            double coordinate = mesh->positions[3 * (size_t)mesh->faces[3 * f + i / 3] + i % 3];
            inside = inside && coordinate >= low[i % 3] && coordinate <= high[i % 3];
        }
        for (size_t corner = 0; inside && corner < 3; corner++)
            mesh->faces[3 * kept + corner] = mesh->faces[3 * f + corner];
        kept += inside;
    }
    mesh->face_count = kept;
}

bool surface_patch_turn(bat_mesh *mesh, const double eye[3])
{
    double facing = 0, seen = 0, volume = 0;
    const double *origin = mesh->positions;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double sides[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            vector3_subtract(mesh->positions + 3 * (size_t)mesh->faces[3 * f + (size_t)k], origin, sides[k]);
        vector3_cross(sides[1], sides[2], normal);
        volume += vector3_dot(sides[0], normal);
        vector3_subtract(sides[1], sides[0], sides[1]);
        vector3_subtract(sides[2], sides[0], sides[2]);
        vector3_cross(sides[1], sides[2], normal);
        facing += vector3_dot(normal, eye);
        seen += fabs(vector3_dot(normal, eye));
    }
    if ((fabs(facing) > OPEN_SHARE * seen ? facing : volume) >= 0)
        return false;
    for (size_t f = 0; f < mesh->face_count; f++)
        SWAP(mesh->faces[3 * f], mesh->faces[3 * f + 1]);
    return true;
}

#include "draw/surface/scene.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector3.h"
#include "surface/trim/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Uniform triangulations of spline surfaces.

/// The smallest number of steps along a side, also of a trimmed surface, and the largest.
#define MIN_STEPS ((size_t)96)
#define MIN_TRIMMED_STEPS ((size_t)256)
#define MAX_STEPS ((size_t)320)

/// Steps across a cell of the finest level, up to the largest number of all steps.
#define STEPS_OF_CELL ((size_t)3)

/// A patch is nearly closed when the area facing the eye exceeds the area facing away by less than this fraction of the
/// whole.
#define OPEN_SHARE 0.2

static size_t steps_for(const bat_spline_surface *surface, int direction)
{
    const bat_hierarchical_space *space = surface->space;
    size_t cells = bat_hierarchical_space_options(space).spans[direction];
    size_t least = surface->trim.loop_count > 0 ? MIN_TRIMMED_STEPS : MIN_STEPS;
    for (size_t level = 1; level < bat_hierarchical_space_levels(space) && cells < MAX_STEPS; level++)
        cells *= 2;
    size_t steps = cells < MAX_STEPS ? STEPS_OF_CELL * cells : MAX_STEPS;
    return steps < least ? least : steps > MAX_STEPS ? MAX_STEPS : steps;
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

static bat_status evaluate_grid(const bat_spline_surface *surface, const size_t steps[2], bat_mesh *mesh, bat_error *error)
{
    double *parameters = memory_array(mesh->vertex_count, 2 * sizeof *parameters);
    if (parameters == NULL)
        return error_memory(error, mesh->vertex_count * 2 * sizeof *parameters);
    for (size_t j = 0; j <= steps[1]; j++)
        for (size_t i = 0; i <= steps[0]; i++)
        {
            double *parameter = parameters + 2 * (size_t)vertex_at(steps, i, j);
            parameter[0] = (double)i / (double)steps[0];
            parameter[1] = (double)j / (double)steps[1];
        }
    bat_status status = bat_spline_surface_evaluate(surface, parameters, mesh->vertex_count, 0, mesh->positions, error);
    free(parameters);
    return status;
}

/// Keep the triangles whose corners are within the trimming curves, and the vertices of these.
static bat_status trim_patch(const bat_spline_surface *surface, const size_t steps[2], bat_mesh *mesh, bat_error *error)
{
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
            numbers[vertex_at(steps, i, j)] =
                trim_region_contains(&region, (double)i / (double)steps[0], (double)j / (double)steps[1]);
    size_t vertices = 0, faces = 0;
    for (size_t v = 0; v < mesh->vertex_count; v++)
    {
        bool kept = numbers[v] == 1;
        memmove(mesh->positions + 3 * vertices, mesh->positions + 3 * v, 3 * sizeof *mesh->positions);
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

bat_status surface_patch_make(const bat_spline_surface *surface, bat_mesh *mesh, size_t *loop_count, bat_error *error)
{
    const size_t steps[2] = {steps_for(surface, 0), steps_for(surface, 1)};
    bat_mesh made = {.vertex_count = (steps[0] + 1) * (steps[1] + 1), .face_count = 2 * steps[0] * steps[1]};
    made.positions = memory_array(made.vertex_count, 3 * sizeof *made.positions);
    made.faces = memory_array(made.face_count, 3 * sizeof *made.faces);
    bat_status status = BAT_OK;
    if (made.positions == NULL || made.faces == NULL)
        status = error_memory(error, made.vertex_count * 3 * sizeof *made.positions);
    if (status == BAT_OK)
        status = evaluate_grid(surface, steps, &made, error);
    if (status != BAT_OK)
    {
        bat_mesh_free(&made);
        return status;
    }
    fill_faces(steps, made.faces);
    *loop_count = 2 * (steps[0] + steps[1]);
    if (surface->trim.loop_count > 0)
    {
        status = trim_patch(surface, steps, &made, error);
        *loop_count = 0;
    }
    if (status == BAT_OK)
        *mesh = made;
    else
        bat_mesh_free(&made);
    return status;
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

void surface_patch_turn(bat_mesh *mesh, const double eye[3])
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
        return;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        uint32_t kept = mesh->faces[3 * f];
        mesh->faces[3 * f] = mesh->faces[3 * f + 1];
        mesh->faces[3 * f + 1] = kept;
    }
}

#include "draw/surface/scene.h"

#include "base/error.h"
#include "batten/mesh_measure.h"

#include <string.h>

/// @file
/// Triangulations of shells, and the places of points on them.

/// Quads of all patches, with bounds for the samples of a patch and direction.
#define WANTED_QUADS 2e5
#define MIN_SAMPLES 3.0
#define MAX_SAMPLES 16.0
/// The most steps from the nearest point of the triangles to that of the shell.
#define PLACE_STEPS 12

/// Make two triangles of each quad, and the outlines.
static void cut_quads(surface_row *row, const bat_mesh *quads)
{
    size_t samples = row->samples, spans = row->shell->spans, side = samples * spans;
    for (size_t q = 0; q < quads->face_count; q++)
    {
        const uint32_t *quad = quads->faces + 4 * q, both[6] = {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]};
        size_t patch = q / (samples * samples), i = patch % spans * samples + q % samples;
        size_t j = patch / spans % spans * samples + q / samples % samples;
        const bool at_side[4] = {j == 0, i + 1 == side, j + 1 == side, i == 0};
        memcpy(row->patch.faces + 6 * q, both, sizeof both);
        for (size_t k = 0; k < 4; k++)
            if (at_side[k] && quad[k] < quad[(k + 1) % 4]) // once of both faces
            {
                row->outlines[row->outline_count++] = quad[k];
                row->outlines[row->outline_count++] = quad[(k + 1) % 4];
            }
    }
}

shell_place surface_shell_place(const surface_row *row, size_t triangle, const double share[3])
{
    size_t samples = row->samples, quad = triangle / 2;
    // A turned triangle has its first two corners exchanged.
    double second = share[!row->turned], both = second + share[2];
    double across = triangle % 2 == 0 ? both : second, up = triangle % 2 == 0 ? share[2] : both;
    return (shell_place){.face = (uint32_t)(quad / (samples * samples)),
                         .u = fmin(((double)(quad % samples) + across) / (double)samples, 1),
                         .v = fmin(((double)(quad / samples % samples) + up) / (double)samples, 1)};
}

/// Find the places of the points and their distances. Places keep to the patch of the nearest point of the triangles.
static bat_status project_points(surface_row *row, bat_error *error)
{
    const double *points = row->panel->cloud->points;
    size_t count = row->panel->cloud->count, corners = 4 * row->shell->cage.face_count;
    shell_grid grid = {.links.twin = memory_pool_array(&row->pool, corners, sizeof *grid.links.twin)};
    double *distances = memory_pool_array(&row->pool, count, sizeof *distances);
    bat_mesh_closest_point *closest = memory_pool_array(&row->pool, count, sizeof *closest);
    row->places = memory_pool_array(&row->pool, count, sizeof *row->places);
    bat_status status = memory_pool_check(&row->pool, error);
    if (status == BAT_OK)
        status = bat_mesh_closest(&row->patch, points, count, 0, closest, error);
    for (size_t c = 0; c < corners && status == BAT_OK; c++)
        grid.links.twin[c] = BAT_MESH_NONE;
    for (size_t i = 0; i < count && status == BAT_OK; i++)
    {
        row->places[i] = surface_shell_place(row, closest[i].at.face, closest[i].at.barycentric);
        distances[i] = sqrt(shell_place_correct(&grid, row->shell->patches, points + 3 * i, PLACE_STEPS, &row->places[i]));
    }
    row->distances = distances;
    return status;
}

bat_status surface_shell_make(surface_row *row, bat_error *error)
{
    const bat_shell *shell = row->shell;
    bat_mesh quads = {0};
    row->samples = (size_t)fmin(fmax(sqrt(WANTED_QUADS / (double)shell->cage.face_count), MIN_SAMPLES), MAX_SAMPLES);
    bat_status status = bat_shell_tessellate(shell, row->samples, &quads, error);
    row->patch = (bat_mesh){.positions = quads.positions, .vertex_count = quads.vertex_count};
    row->patch.face_count = 2 * quads.face_count;
    row->patch.faces = memory_array(quads.face_count, 6 * sizeof *quads.faces);
    row->outlines = memory_pool_array(&row->pool, shell->face_count * shell->spans * row->samples, 8 * sizeof *quads.faces);
    quads.positions = NULL;
    if (status == BAT_OK)
        status = row->patch.faces == NULL ? error_memory(error, 6 * quads.face_count * sizeof *quads.faces)
                                          : memory_pool_check(&row->pool, error);
    if (status == BAT_OK)
        cut_quads(row, &quads);
    bat_mesh_free(&quads);
    return status == BAT_OK && row->panel->cloud != NULL ? project_points(row, error) : status;
}

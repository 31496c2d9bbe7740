#include "research/studies/mesh_points.h"

#include "base/error.h"
#include "base/memory.h"
#include "linalg/vector.h"

#include <math.h>
#include <stdlib.h>

void mesh_face_sums(const bat_mesh *mesh, point_density *density, const void *context, double *sums)
{
    sums[0] = 0;
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        double normal[3];
        const uint32_t *face = mesh->faces + 3 * f;
        vector3_triangle(mesh->positions + 3 * (size_t)face[0], mesh->positions + 3 * (size_t)face[1],
                         mesh->positions + 3 * (size_t)face[2], normal);
        double area = vector3_length(normal);
        (void)vector3_normalize(normal);
        sums[f + 1] = sums[f] + (density != NULL ? area * density(context, normal) : area);
    }
}

size_t mesh_face_at(const double *sums, size_t face_count, double place)
{
    size_t low = 0, high = face_count - 1;
    while (low < high)
    {
        size_t middle = low + (high - low) / 2;
        if (sums[middle + 1] <= place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bat_status mesh_points_draw(const bat_mesh *mesh, point_density *density, const void *context, double noise, size_t count,
                            bat_random *random, double *points, bat_error *error)
{
    double *sums = memory_array(mesh->face_count + 1, sizeof *sums);
    if (sums == NULL)
        return error_memory(error, (mesh->face_count + 1) * sizeof *sums);
    mesh_face_sums(mesh, density, context, sums);
    for (size_t i = 0; i < count; i++)
    {
        double at = bat_random_uniform(random) * sums[mesh->face_count], root = sqrt(bat_random_uniform(random)),
               v = bat_random_uniform(random);
        const uint32_t *face = mesh->faces + 3 * mesh_face_at(sums, mesh->face_count, at);
        const double weights[3] = {1 - root, root * (1 - v), root * v};
        for (size_t c = 0; c < 3; c++)
        {
            double place = noise * bat_random_normal(random);
            for (size_t k = 0; k < 3; k++)
                place += weights[k] * mesh->positions[3 * (size_t)face[k] + c];
            points[3 * i + c] = place;
        }
    }
    free(sums);
    return BAT_OK;
}

bat_status mesh_of_grid(size_t cells, bat_mesh *mesh, bat_error *error)
{
    size_t row = cells + 1, made = 0;
    *mesh = (bat_mesh){.positions = memory_array(row * row, 3 * sizeof *mesh->positions),
                       .faces = memory_array(cells * cells, 6 * sizeof *mesh->faces),
                       .vertex_count = row * row,
                       .face_count = 2 * cells * cells};
    if (mesh->positions == NULL || mesh->faces == NULL)
    {
        bat_mesh_free(mesh);
        return error_memory(error, row * row * 3 * sizeof *mesh->positions);
    }
    for (size_t i = 0; i < cells; i++)
        for (size_t k = 0; k < cells; k++)
        {
            const size_t a = i * row + k, cell[6] = {a, a + row, a + row + 1, a, a + row + 1, a + 1};
            for (int c = 0; c < 6; c++)
                mesh->faces[made++] = (uint32_t)cell[c];
        }
    return BAT_OK;
}

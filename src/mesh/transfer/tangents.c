#include "base/error.h"
#include "base/memory.h"
#include "batten/mesh_transfer.h"
#include "linalg/vector.h"
#include "mesh/hash_table.h"

#include <string.h>

/// @file
/// Tangents of vertices, as Mikkelsen, "Simulation of wrinkled surfaces revisited" (2008): sums over the faces around, each
/// tangent perpendicular to the vertex normal, weighted by the face's angle.

/// Number the pairs of a vertex and a texture coordinate. Returns their number, SIZE_MAX when out of memory.
static size_t number_pairs(const bat_mesh *mesh, uint32_t *pair)
{
    key_map numbers = {0};
    size_t count = 0;
    for (size_t h = 0; h < 3 * mesh->face_count; h++)
    {
        uint32_t *number = key_map_at(&numbers, (uint64_t)mesh->faces[h] << 32 | mesh->texture_faces[h]);
        if (number == NULL)
        {
            count = SIZE_MAX;
            break;
        }
        *number = *number == UINT32_MAX ? (uint32_t)count++ : *number;
        pair[h] = *number;
    }
    key_map_free(&numbers);
    return count;
}

/// Remove from `v` what it has along a normal, and normalize it. False for nothing left.
static bool flatten(const double *normal, double v[3])
{
    double along = vector3_dot(normal, v);
    vector_add(3, -along, normal, v);
    return vector3_normalize(v);
}

/// Add the tangent of a face to the sums of its corners.
static void add_face(const bat_mesh *mesh, size_t face, const double *normals, const uint32_t *pair, double *sums)
{
    const uint32_t *corner = mesh->faces + 3 * face;
    double edge[3][3], shift[3][2], tangent[3];
    for (size_t c = 0; c < 3; c++)
    {
        const double *from = mesh->texture + 2 * (size_t)mesh->texture_faces[3 * face + c],
                     *to = mesh->texture + 2 * (size_t)mesh->texture_faces[3 * face + (c + 1) % 3];
        vector3_subtract(mesh->positions + 3 * (size_t)corner[(c + 1) % 3], mesh->positions + 3 * (size_t)corner[c],
                         edge[c]);
        shift[c][0] = to[0] - from[0];
        shift[c][1] = to[1] - from[1];
    }
    double turn = shift[0][0] * shift[1][1] - shift[0][1] * shift[1][0], sign = turn < 0 ? -1 : 1;
    for (size_t k = 0; k < 3; k++)
        tangent[k] = sign * (edge[0][k] * shift[1][1] - edge[1][k] * shift[0][1]);
    if (turn == 0 || !vector3_normalize(tangent))
        return;
    for (size_t c = 0; c < 3; c++)
    {
        double own[3], across[3], *sum = sums + 4 * (size_t)pair[3 * face + c];
        vector3_cross(edge[c], edge[(c + 2) % 3], across);
        double angle = atan2(vector3_length(across), -vector3_dot(edge[c], edge[(c + 2) % 3]));
        memcpy(own, tangent, sizeof own);
        if (!flatten(normals + 3 * (size_t)corner[c], own))
            continue;
        vector_add(3, angle, own, sum);
        sum[3] += angle * sign;
    }
}

bat_status bat_mesh_tangents(const bat_mesh *mesh, const double *normals, double **tangents, bat_error *error)
{
    size_t corners = 3 * mesh->face_count;
    if (mesh->texture_faces == NULL || mesh->offsets != NULL)
        return ERROR_ARGUMENT(error, "tangents need triangles with texture coordinates");
    uint32_t *pair = memory_array(corners, sizeof *pair);
    size_t count = pair != NULL ? number_pairs(mesh, pair) : SIZE_MAX;
    double *sums = count != SIZE_MAX ? calloc(count + 1, 4 * sizeof *sums) : NULL,
           *made = memory_array(corners, 4 * sizeof *made);
    bool room = sums != NULL && made != NULL;
    for (size_t f = 0; f < mesh->face_count && room; f++)
        add_face(mesh, f, normals, pair, sums);
    for (size_t h = 0; h < corners && room; h++)
    {
        const double *normal = normals + 3 * (size_t)mesh->faces[h];
        memcpy(made + 4 * h, sums + 4 * (size_t)pair[h], 4 * sizeof *made);
        double unit[3] = {fabs(normal[0]) < 0.6, fabs(normal[0]) >= 0.6, 0};
        if (!flatten(normal, made + 4 * h) && flatten(normal, unit)) // no face tells a tangent: any will do
            memcpy(made + 4 * h, unit, sizeof unit);
        made[4 * h + 3] = made[4 * h + 3] < 0 ? -1 : 1;
    }
    free(pair);
    free(sums);
    if (!room)
    {
        free(made);
        return error_memory(error, corners * 4 * sizeof *made);
    }
    *tangents = made;
    return BAT_OK;
}

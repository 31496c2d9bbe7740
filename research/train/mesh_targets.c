#include "research/train/mesh_targets.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/decimate/map.h"

#include <math.h>
#include <stdlib.h>

/// @file
/// Positions and normals of a fine mesh at the images of a subdivided coarse one.

/// Interpolate vectors at a point: sum_c barycentric[c] values[corner[c]].
static void interpolate(const bat_mesh *mesh, const double *values, const bat_mesh_point *point, double *result)
{
    const uint32_t *corner = mesh->faces + 3 * (size_t)point->face;
    for (size_t k = 0; k < 3; k++)
    {
        result[k] = 0;
        for (size_t c = 0; c < 3; c++)
            result[k] += point->barycentric[c] * values[3 * (size_t)corner[c] + k];
    }
}

/// The normal of a face, with twice its area as length.
static void face_vector(const bat_mesh *mesh, size_t face, double *vector)
{
    const double *a = mesh->positions + 3 * (size_t)mesh->faces[3 * face],
                 *b = mesh->positions + 3 * (size_t)mesh->faces[3 * face + 1],
                 *c = mesh->positions + 3 * (size_t)mesh->faces[3 * face + 2];
    for (size_t k = 0; k < 3; k++)
    {
        size_t l = (k + 1) % 3, m = (k + 2) % 3;
        vector[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
    }
}

static bool make_unit(double *vector)
{
    double length = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    for (int k = 0; k < 3 && length > 0; k++)
        vector[k] /= length;
    return length > 0;
}

/// Unit normals at points, from area-weighted vertex normals; where those cancel, the normal of the face.
static bat_status set_normals(const bat_mesh *fine, const bat_mesh_point *points, size_t count, double *normals,
                              bat_error *error)
{
    double *at_vertices = calloc(fine->vertex_count, 3 * sizeof *at_vertices);
    if (at_vertices == NULL)
        return error_memory(error, fine->vertex_count * 3 * sizeof *at_vertices);
    for (size_t f = 0; f < fine->face_count; f++)
    {
        double vector[3];
        face_vector(fine, f, vector);
        for (size_t i = 0; i < 9; i++)
            at_vertices[3 * (size_t)fine->faces[3 * f + i / 3] + i % 3] += vector[i % 3];
    }
    for (size_t v = 0; v < fine->vertex_count; v++)
        (void)make_unit(at_vertices + 3 * v);
    for (size_t i = 0; i < count; i++)
    {
        double *normal = normals + 3 * i;
        interpolate(fine, at_vertices, &points[i], normal);
        if (make_unit(normal))
            continue;
        face_vector(fine, points[i].face, normal);
        (void)make_unit(normal);
    }
    free(at_vertices);
    return BAT_OK;
}

bat_status mesh_map_targets(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                            double *positions, double *normals, bat_error *error)
{
    bat_mesh_point *points = NULL;
    size_t count = 0;
    bat_status status = map_check(map, fine, coarse, error);
    if (status == BAT_OK)
        status = bat_mesh_midpoints(coarse, levels, &points, &count, error);
    if (status == BAT_OK)
        status = bat_mesh_map_to_fine(map, points, count, error);
    for (size_t i = 0; i < count && status == BAT_OK; i++)
        interpolate(fine, fine->positions, &points[i], positions + 3 * i);
    if (status == BAT_OK && normals != NULL)
        status = set_normals(fine, points, count, normals, error);
    free(points);
    return status;
}

#include "batten/decimate.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// The images on the fine mesh of the vertices of the coarse one, subdivided.
static bat_status find_images(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                              bat_mesh_point **points, size_t *count, bat_error *error)
{
    bat_mesh_point *made = NULL;
    bat_status status = map_check(map, fine, coarse, error);
    if (status == BAT_OK)
        status = bat_mesh_midpoints(coarse, levels, &made, count, error);
    if (status == BAT_OK)
        status = bat_mesh_map_to_fine(map, made, *count, error);
    if (status != BAT_OK)
        free(made);
    else
        *points = made;
    return status;
}

/// The values of a point: those at its face's corners by their barycentric coordinates. `corner` are three rows of `values`.
static void interpolate(const double *values, size_t width, const uint32_t *corner, const double *barycentric,
                        double *result)
{
    for (size_t k = 0; k < width; k++)
    {
        result[k] = 0;
        for (size_t c = 0; c < 3; c++)
            result[k] += barycentric[c] * values[width * corner[c] + k];
    }
}

/// Twice a face's area, along its normal.
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

/// Unit normals at the points, from the vertices' area-weighted ones; where those cancel out, the face's.
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
        interpolate(at_vertices, 3, fine->faces + 3 * (size_t)points[i].face, points[i].barycentric, normal);
        if (make_unit(normal))
            continue;
        face_vector(fine, points[i].face, normal);
        (void)make_unit(normal);
    }
    free(at_vertices);
    return BAT_OK;
}

bat_status bat_mesh_map_targets(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                                double *positions, double *normals, bat_error *error)
{
    bat_mesh_point *points;
    size_t count;
    bat_status status = find_images(map, fine, coarse, levels, &points, &count, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        interpolate(fine->positions, 3, fine->faces + 3 * (size_t)points[i].face, points[i].barycentric, positions + 3 * i);
    if (normals != NULL)
        status = set_normals(fine, points, count, normals, error);
    free(points);
    return status;
}

/// Room in `refined` for what the fine mesh carries.
static bat_status allocate_signals(const bat_mesh *fine, size_t count, bat_mesh *signals, bat_error *error)
{
    *signals = (bat_mesh){0};
    bool room = true;
    if (fine->channel_count > 0)
    {
        signals->channels = memory_array(count, fine->channel_count * sizeof *signals->channels);
        signals->channel_names = calloc(fine->channel_count, sizeof *signals->channel_names);
        signals->channel_count = signals->channel_names != NULL ? fine->channel_count : 0;
        room = signals->channels != NULL && signals->channel_names != NULL;
    }
    for (size_t i = 0; i < fine->channel_count && room; i++)
    {
        size_t size = strlen(fine->channel_names[i]) + 1;
        signals->channel_names[i] = malloc(size);
        room = signals->channel_names[i] != NULL;
        if (room)
            memcpy(signals->channel_names[i], fine->channel_names[i], size);
    }
    if (fine->texture != NULL)
        signals->texture = memory_array(count, 2 * sizeof *signals->texture);
    if (room && (fine->texture == NULL || signals->texture != NULL))
        return BAT_OK;
    bat_mesh_free(signals);
    return error_memory(error, count * fine->channel_count * sizeof *signals->channels);
}

/// Move the signals into `refined`, in place of what it has.
static bat_status set_signals(bat_mesh *signals, size_t count, bat_mesh *refined, bat_error *error)
{
    bat_mesh old = {.texture = refined->texture,
                    .texture_faces = refined->texture_faces,
                    .channels = refined->channels,
                    .channel_names = refined->channel_names,
                    .channel_count = refined->channel_count};
    if (signals->texture != NULL)
    {
        signals->texture_faces = memory_array(refined->face_count, 3 * sizeof *signals->texture_faces);
        if (signals->texture_faces == NULL)
            return error_memory(error, refined->face_count * 3 * sizeof *signals->texture_faces);
        memcpy(signals->texture_faces, refined->faces, refined->face_count * 3 * sizeof *signals->texture_faces);
    }
    refined->texture = signals->texture;
    refined->texture_faces = signals->texture_faces;
    refined->texture_count = signals->texture != NULL ? count : 0;
    refined->channels = signals->channels;
    refined->channel_names = signals->channel_names;
    refined->channel_count = signals->channel_count;
    *signals = (bat_mesh){0};
    bat_mesh_free(&old);
    return BAT_OK;
}

bat_status bat_mesh_map_transfer(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                                 bat_mesh *refined, bat_error *error)
{
    bat_mesh_point *points;
    bat_mesh signals;
    size_t count;
    bat_status status = find_images(map, fine, coarse, levels, &points, &count, error);
    if (status != BAT_OK)
        return status;
    if (refined->vertex_count != count || refined->face_count != coarse->face_count << 2 * levels)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "the mesh is not the coarse one subdivided %zu times: it has %zu vertices, not %zu", levels,
                           refined->vertex_count, count);
    if (status == BAT_OK)
        status = allocate_signals(fine, count, &signals, error);
    if (status == BAT_OK)
    {
        for (size_t i = 0; i < count; i++)
        {
            const bat_mesh_point *point = &points[i];
            size_t face = 3 * (size_t)point->face;
            if (signals.channels != NULL)
                interpolate(fine->channels, fine->channel_count, fine->faces + face, point->barycentric,
                            signals.channels + fine->channel_count * i);
            if (signals.texture != NULL)
                interpolate(fine->texture, 2, fine->texture_faces + face, point->barycentric, signals.texture + 2 * i);
        }
        status = set_signals(&signals, count, refined, error);
        bat_mesh_free(&signals);
    }
    free(points);
    return status;
}

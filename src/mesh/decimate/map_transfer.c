#include "batten/mesh_decimate.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/channels.h"
#include "mesh/check.h"
#include "mesh/decimate/map.h"
#include "mesh/decimate/map_transfer.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Images of midpoint subdivisions under a decimation map, and the transfer of positions, normals, channels and texture.

static void midpoint_mesh_free(midpoint_mesh *mesh)
{
    free(mesh->faces);
    free(mesh->corners);
    free(mesh->points);
    *mesh = (midpoint_mesh){0};
}

static bat_status split_allocate(size_t faces, size_t vertices, midpoint_mesh *mesh, bat_error *error)
{
    *mesh = (midpoint_mesh){.faces = memory_array(faces, 3 * sizeof *mesh->faces),
                            .corners = memory_array(faces, sizeof *mesh->corners),
                            .points = memory_array(vertices, sizeof *mesh->points),
                            .face_count = faces,
                            .vertex_count = vertices};
    if (mesh->faces != NULL && mesh->corners != NULL && mesh->points != NULL)
        return BAT_OK;
    midpoint_mesh_free(mesh);
    return error_memory(error, faces * sizeof *mesh->corners);
}

static bat_status split_begin(const bat_mesh *coarse, midpoint_mesh *mesh, bat_error *error)
{
    static const double WHOLE[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    bat_status status = mesh_check_triangles(coarse, error);
    if (status == BAT_OK)
        status = split_allocate(coarse->face_count, coarse->vertex_count, mesh, error);
    if (status != BAT_OK)
        return status;
    for (size_t v = 0; v < coarse->vertex_count; v++)
        mesh->points[v].face = BAT_MESH_NONE;
    memcpy(mesh->faces, coarse->faces, 3 * coarse->face_count * sizeof *mesh->faces);
    for (size_t f = 0; f < coarse->face_count; f++)
    {
        memcpy(mesh->corners[f], WHOLE, sizeof WHOLE);
        for (int c = 0; c < 3; c++)
            mesh->points[mesh->faces[3 * f + (size_t)c]] =
                (bat_mesh_point){(uint32_t)f, {WHOLE[c][0], WHOLE[c][1], WHOLE[c][2]}};
    }
    for (size_t v = 0; v < coarse->vertex_count; v++)
        if (mesh->points[v].face == BAT_MESH_NONE)
        {
            midpoint_mesh_free(mesh);
            return error_set(error, BAT_INVALID_POINT, v, 0, "vertex %zu has no face", v);
        }
    return BAT_OK;
}

/// Split each face f into faces 4 f + c at its corners and 4 f + 3 in the middle; vertex `vertex_count` + e is the midpoint
/// of edge e.
static void split_faces(const midpoint_mesh *mesh, const bat_mesh_connectivity *connectivity, int level,
                        midpoint_mesh *split)
{
    memcpy(split->points, mesh->points, mesh->vertex_count * sizeof *split->points);
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        uint32_t middle[3];
        double halves[3][3];
        for (uint32_t c = 0; c < 3; c++)
        {
            middle[c] = (uint32_t)mesh->vertex_count + connectivity->edge[3 * f + c];
            for (int k = 0; k < 3; k++)
                halves[c][k] = (mesh->corners[f][c][k] + mesh->corners[f][(c + 1) % 3][k]) / 2;
            split->points[middle[c]] =
                (bat_mesh_point){(uint32_t)(f >> 2 * level), {halves[c][0], halves[c][1], halves[c][2]}};
        }
        for (uint32_t c = 0; c < 3; c++)
        {
            size_t made = 4 * f + c;
            const uint32_t corner[3] = {mesh->faces[3 * f + c], middle[c], middle[(c + 2) % 3]};
            memcpy(split->faces + 3 * made, corner, sizeof corner);
            memcpy(split->corners[made][0], mesh->corners[f][c], sizeof halves[0]);
            memcpy(split->corners[made][1], halves[c], sizeof halves[0]);
            memcpy(split->corners[made][2], halves[(c + 2) % 3], sizeof halves[0]);
        }
        memcpy(split->faces + 3 * (4 * f + 3), middle, sizeof middle);
        memcpy(split->corners[4 * f + 3], halves, sizeof halves);
    }
}

static bat_status split_level(midpoint_mesh *mesh, int level, bat_error *error)
{
    bat_mesh shell = {.faces = mesh->faces, .face_count = mesh->face_count, .vertex_count = mesh->vertex_count};
    bat_mesh_connectivity connectivity;
    midpoint_mesh split;
    if (mesh->face_count > BAT_MESH_MAX_FACES / 4)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the subdivided mesh would have more than %zu faces",
                         BAT_MESH_MAX_FACES);
    bat_status status = bat_mesh_connect(&shell, &connectivity, error);
    if (status != BAT_OK)
        return status;
    status = split_allocate(4 * mesh->face_count, mesh->vertex_count + connectivity.edge_count, &split, error);
    if (status == BAT_OK)
    {
        split_faces(mesh, &connectivity, level, &split);
        midpoint_mesh_free(mesh);
        *mesh = split;
    }
    bat_mesh_connectivity_free(&connectivity);
    return status;
}

/// Subdivide a mesh `levels` times.
/// @return as bat_mesh_midpoints()
static bat_status midpoint_mesh_make(const bat_mesh *coarse, size_t levels, midpoint_mesh *made, bat_error *error)
{
    midpoint_mesh mesh;
    bat_status status = split_begin(coarse, &mesh, error);
    if (status != BAT_OK)
        return status;
    for (size_t level = 0; level < levels && status == BAT_OK; level++)
        status = split_level(&mesh, (int)level, error);
    if (status == BAT_OK)
        *made = mesh;
    else
        midpoint_mesh_free(&mesh);
    return status;
}

bat_status bat_mesh_midpoints(const bat_mesh *coarse, size_t levels, bat_mesh_point **points, size_t *count,
                              bat_error *error)
{
    midpoint_mesh mesh;
    bat_status status = midpoint_mesh_make(coarse, levels, &mesh, error);
    if (status != BAT_OK)
        return status;
    *points = mesh.points;
    *count = mesh.vertex_count;
    mesh.points = NULL;
    midpoint_mesh_free(&mesh);
    return BAT_OK;
}

/// Subdivide the coarse mesh and compute the images of its vertices on the fine mesh. Release `images` with free().
static bat_status find_images(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                              midpoint_mesh *split, bat_mesh_point **images, bat_error *error)
{
    bat_status status = map_check(map, fine, coarse, error);
    if (status == BAT_OK)
        status = midpoint_mesh_make(coarse, levels, split, error);
    if (status != BAT_OK)
        return status;
    bat_mesh_point *made = memory_array(split->vertex_count, sizeof *made);
    if (made == NULL)
        status = error_memory(error, split->vertex_count * sizeof *made);
    if (status == BAT_OK)
    {
        memcpy(made, split->points, split->vertex_count * sizeof *made);
        status = bat_mesh_map_to_fine(map, made, split->vertex_count, error);
    }
    if (status != BAT_OK)
    {
        midpoint_mesh_free(split);
        free(made);
        return status;
    }
    *images = made;
    return BAT_OK;
}

/// Interpolate values at a point: sum_c barycentric[c] values[corner[c]].
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
    midpoint_mesh split;
    bat_status status = find_images(map, fine, coarse, levels, &split, &points, error);
    if (status != BAT_OK)
        return status;
    size_t count = split.vertex_count;
    midpoint_mesh_free(&split);
    for (size_t i = 0; i < count; i++)
        interpolate(fine->positions, 3, fine->faces + 3 * (size_t)points[i].face, points[i].barycentric, positions + 3 * i);
    if (normals != NULL)
        status = set_normals(fine, points, count, normals, error);
    free(points);
    return status;
}

/// The channels at the images, in a mesh that holds nothing else.
static bat_status set_channels(const bat_mesh *fine, const bat_mesh_point *images, size_t count, bat_mesh *signals,
                               bat_error *error)
{
    size_t width = fine->channel_count;
    if (width == 0)
        return BAT_OK;
    bat_status status = channels_make(fine, count, signals, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < count; i++)
        interpolate(fine->channels, width, fine->faces + 3 * (size_t)images[i].face, images[i].barycentric,
                    signals->channels + width * i);
    return BAT_OK;
}

/// Exchange texture and channels of the two meshes.
static void exchange_signals(bat_mesh *signals, bat_mesh *refined)
{
    bat_mesh old = {.texture = refined->texture,
                    .texture_faces = refined->texture_faces,
                    .texture_count = refined->texture_count,
                    .channels = refined->channels,
                    .channel_names = refined->channel_names,
                    .channel_count = refined->channel_count};
    refined->texture = signals->texture;
    refined->texture_faces = signals->texture_faces;
    refined->texture_count = signals->texture_count;
    refined->channels = signals->channels;
    refined->channel_names = signals->channel_names;
    refined->channel_count = signals->channel_count;
    *signals = old;
}

bat_status bat_mesh_map_transfer(const bat_mesh_map *map, const bat_mesh *fine, const bat_mesh *coarse, size_t levels,
                                 bat_mesh *refined, bat_error *error)
{
    bat_mesh_point *images;
    midpoint_mesh split;
    bat_mesh signals = {0};
    bat_status status = find_images(map, fine, coarse, levels, &split, &images, error);
    if (status != BAT_OK)
        return status;
    if (refined->vertex_count != split.vertex_count || refined->face_count != split.face_count)
        status = error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0,
                           "the mesh is not the coarse one subdivided %zu times: it has %zu vertices, not %zu", levels,
                           refined->vertex_count, split.vertex_count);
    if (status == BAT_OK)
        status = set_channels(fine, images, split.vertex_count, &signals, error);
    if (status == BAT_OK && fine->texture != NULL)
        status = map_texture_transfer(map, fine, &split, images, levels, &signals, error);
    if (status == BAT_OK)
        exchange_signals(&signals, refined);
    bat_mesh_free(&signals);
    midpoint_mesh_free(&split);
    free(images);
    return status;
}

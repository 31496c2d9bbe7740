#include "mesh/decimate/midpoints.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

void midpoint_mesh_free(midpoint_mesh *mesh)
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
    bat_status status = bat_mesh_check(coarse, error);
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

/// Faces 4 f + c at the corners of face f and 4 f + 3 in its middle; vertex `vertex_count` + e halves edge e.
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

bat_status midpoint_mesh_make(const bat_mesh *coarse, size_t levels, midpoint_mesh *made, bat_error *error)
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

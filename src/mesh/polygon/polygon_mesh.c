#include "mesh/polygon/polygon.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/check.h"
#include "mesh/labels.h"
#include "mesh/sides.h"
#include "mesh/triangulate.h"

#include <stdlib.h>
#include <string.h>

/// @file
/// Copies, checks and triangulation of polygon meshes.

bat_mesh polygon_mesh_view(const bat_polygon_mesh *mesh)
{
    return (bat_mesh){.positions = mesh->positions,
                      .faces = mesh->faces,
                      .vertex_count = mesh->vertex_count,
                      .face_count = mesh->face_count,
                      .texture = mesh->texture,
                      .texture_faces = mesh->texture_faces,
                      .texture_count = mesh->texture_count,
                      .channels = mesh->channels,
                      .channel_names = mesh->channel_names,
                      .channel_count = mesh->channel_count,
                      .creases = mesh->creases,
                      .crease_count = mesh->crease_count,
                      .corners = mesh->corners,
                      .corner_count = mesh->corner_count,
                      .face_labels = mesh->face_labels,
                      .labels = mesh->labels,
                      .label_count = mesh->label_count,
                      .material_files = mesh->material_files,
                      .material_json = mesh->material_json,
                      .rules = mesh->rules};
}

bat_polygon_mesh polygon_mesh_from_view(const bat_mesh *view, uint32_t *offsets)
{
    return (bat_polygon_mesh){.positions = view->positions,
                              .offsets = offsets,
                              .faces = view->faces,
                              .vertex_count = view->vertex_count,
                              .face_count = view->face_count,
                              .texture = view->texture,
                              .texture_faces = view->texture_faces,
                              .texture_count = view->texture_count,
                              .channels = view->channels,
                              .channel_names = view->channel_names,
                              .channel_count = view->channel_count,
                              .creases = view->creases,
                              .crease_count = view->crease_count,
                              .corners = view->corners,
                              .corner_count = view->corner_count,
                              .face_labels = view->face_labels,
                              .labels = view->labels,
                              .label_count = view->label_count,
                              .material_files = view->material_files,
                              .material_json = view->material_json,
                              .rules = view->rules};
}

uint32_t *polygon_offsets(size_t face_count, uint32_t sides)
{
    uint32_t *offsets = memory_array(face_count + 1, sizeof *offsets);
    for (size_t f = 0; offsets != NULL && f <= face_count; f++)
        offsets[f] = (uint32_t)f * sides;
    return offsets;
}

uint32_t *polygon_faces_of_corners(const bat_polygon_mesh *mesh)
{
    uint32_t *face = memory_array(mesh->offsets[mesh->face_count], sizeof *face);
    for (uint32_t f = 0; face != NULL && f < mesh->face_count; f++)
        for (uint32_t c = mesh->offsets[f]; c < mesh->offsets[f + 1]; c++)
            face[c] = f;
    return face;
}

void bat_polygon_mesh_free(bat_polygon_mesh *mesh)
{
    bat_mesh view = polygon_mesh_view(mesh);
    bat_mesh_free(&view);
    free(mesh->offsets);
    *mesh = (bat_polygon_mesh){0};
}

uint32_t *polygon_copy_offsets(const bat_polygon_mesh *mesh)
{
    uint32_t *offsets = memory_array(mesh->face_count + 1, sizeof *offsets);
    if (offsets != NULL)
        memcpy(offsets, mesh->offsets, (mesh->face_count + 1) * sizeof *offsets);
    return offsets;
}

bat_status bat_polygon_mesh_copy(const bat_polygon_mesh *mesh, bat_polygon_mesh *copy, bat_error *error)
{
    bat_mesh view = polygon_mesh_view(mesh), made;
    if (mesh->offsets == NULL)
    {
        *copy = *mesh; // it is empty
        return BAT_OK;
    }
    uint32_t *offsets = polygon_copy_offsets(mesh);
    if (offsets == NULL)
        return error_memory(error, (mesh->face_count + 1) * sizeof *offsets);
    bat_status status = mesh_copy_corners(&view, mesh->offsets[mesh->face_count], &made, error);
    if (status != BAT_OK)
    {
        free(offsets);
        return status;
    }
    *copy = polygon_mesh_from_view(&made, offsets);
    return BAT_OK;
}

static bat_status check_offsets(const bat_polygon_mesh *mesh, bat_error *error)
{
    if (mesh->face_count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the mesh has no faces");
    if (mesh->face_count > BAT_MESH_MAX_FACES || mesh->vertex_count >= BAT_MESH_NONE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the mesh has more than %zu faces or %zu vertices",
                         BAT_MESH_MAX_FACES, (size_t)BAT_MESH_NONE);
    for (size_t f = 0; f < mesh->face_count; f++)
    {
        if (mesh->offsets[f + 1] < mesh->offsets[f] || mesh->offsets[0] != 0)
            return error_set(error, BAT_INVALID_ARGUMENT, f, 0, "the offsets of face %zu decrease or do not begin with 0",
                             f);
        uint32_t size = mesh->offsets[f + 1] - mesh->offsets[f];
        if (size < 3)
            return error_set(error, BAT_INVALID_POINT, f, 0, "face %zu has %u corners, fewer than 3", f, size);
    }
    return BAT_OK;
}

/// Check that a face's corners exist and differ. `seen` holds for each vertex the last face that had it, plus 1.
static bat_status check_face(const bat_polygon_mesh *mesh, uint32_t face, uint32_t *seen, bat_error *error)
{
    for (uint32_t i = mesh->offsets[face]; i < mesh->offsets[face + 1]; i++)
    {
        uint32_t vertex = mesh->faces[i];
        if (vertex >= mesh->vertex_count)
            return error_set(error, BAT_INVALID_POINT, face, 0, "face %u names vertex %u, but there are %zu", face, vertex,
                             mesh->vertex_count);
        if (mesh->texture_faces != NULL && mesh->texture_faces[i] >= mesh->texture_count)
            return error_set(error, BAT_INVALID_POINT, face, 0, "face %u names texture coordinate %u, but there are %zu",
                             face, mesh->texture_faces[i], mesh->texture_count);
        if (seen[vertex] == face + 1)
            return error_remedy(error,
                                error_set(error, BAT_INVALID_POINT, face, 0, "face %u has vertex %u twice", face, vertex),
                                "repair", "drops the face");
        seen[vertex] = face + 1;
    }
    return BAT_OK;
}

bat_status bat_polygon_mesh_check(const bat_polygon_mesh *mesh, bat_error *error)
{
    bat_status status = check_offsets(mesh, error);
    if (status != BAT_OK)
        return status;
    uint32_t *seen = memory_array(mesh->vertex_count, sizeof *seen);
    if (seen == NULL)
        return error_memory(error, mesh->vertex_count * sizeof *seen);
    memset(seen, 0, mesh->vertex_count * sizeof *seen);
    for (uint32_t f = 0; f < mesh->face_count && status == BAT_OK; f++)
        status = check_face(mesh, f, seen, error);
    free(seen);
    if (status != BAT_OK)
        return status;
    bat_mesh view = polygon_mesh_view(mesh);
    return mesh_check_data(&view, error);
}

bat_status bat_polygon_mesh_connect(const bat_polygon_mesh *mesh, bat_mesh_connectivity *connectivity, bat_error *error)
{
    bat_status status = bat_polygon_mesh_check(mesh, error);
    if (status != BAT_OK)
        return status;
    uint32_t *face_of = polygon_faces_of_corners(mesh);
    mesh_sides sides = {.offsets = mesh->offsets, .face = face_of};
    if (face_of == NULL)
        return error_memory(error, mesh->offsets[mesh->face_count] * sizeof *face_of);
    status = sides_connect(&sides, mesh->faces, mesh->face_count, mesh->vertex_count, connectivity, error);
    free(face_of);
    return status;
}

/// Cut all faces, into the faces of `made`, which has the room.
static bat_status cut_faces(const bat_polygon_mesh *mesh, bat_mesh *made, uint32_t *places, bat_error *error)
{
    polygon_workspace room = {0};
    bat_status status = BAT_OK;
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count && status == BAT_OK; f++)
    {
        uint32_t begin = mesh->offsets[f], size = mesh->offsets[f + 1] - begin;
        status = polygon_triangulate(mesh->positions, mesh->faces + begin, size, places, &room);
        if (status == BAT_TOO_LARGE)
            (void)error_set(error, status, f, 0, "face %zu is not convex and has %u corners, more than %d", f, size,
                            POLYGON_MAX_EARS);
        else if (status != BAT_OK)
            (void)error_memory(error, 3 * (size_t)size * sizeof(uint32_t));
        for (uint32_t i = 0; status == BAT_OK && i < 3 * (size - 2); i++, corner++)
        {
            made->faces[corner] = mesh->faces[begin + places[i]];
            if (mesh->texture_faces != NULL)
                made->texture_faces[corner] = mesh->texture_faces[begin + places[i]];
        }
    }
    polygon_workspace_free(&room);
    return status;
}

/// Give the triangles the labels of their polygons.
static bat_status cut_labels(const bat_polygon_mesh *mesh, bat_mesh *made, bat_error *error)
{
    bat_mesh view = polygon_mesh_view(mesh);
    uint32_t *sources = memory_array(made->face_count, sizeof *sources), triangle = 0;
    if (sources == NULL)
        return error_memory(error, made->face_count * sizeof *sources);
    for (uint32_t f = 0; f < mesh->face_count; f++)
        for (uint32_t c = mesh->offsets[f] + 2; c < mesh->offsets[f + 1]; c++)
            sources[triangle++] = f;
    bat_status status = mesh_labels_carry(&view, sources, 1, made, error);
    free(sources);
    return status;
}

bat_status bat_polygon_mesh_triangulate(const bat_polygon_mesh *mesh, bat_mesh *triangles, bat_error *error)
{
    bat_status status = bat_polygon_mesh_check(mesh, error);
    if (status != BAT_OK)
        return status;
    size_t corners = mesh->offsets[mesh->face_count], count = corners - 2 * mesh->face_count, largest = 0;
    if (count > BAT_MESH_MAX_FACES)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the mesh has more than %zu triangles", BAT_MESH_MAX_FACES);
    for (size_t f = 0; f < mesh->face_count; f++)
        largest = mesh->offsets[f + 1] - mesh->offsets[f] > largest ? mesh->offsets[f + 1] - mesh->offsets[f] : largest;
    bat_mesh view = polygon_mesh_view(mesh), made;
    view.faces = view.texture_faces = NULL;
    mesh_labels_forget(&view);
    status = mesh_copy_corners(&view, 0, &made, error);
    if (status != BAT_OK)
        return status;
    made.face_count = count;
    made.faces = memory_array(3 * count, sizeof *made.faces);
    if (mesh->texture_faces != NULL)
        made.texture_faces = memory_array(3 * count, sizeof *made.texture_faces);
    uint32_t *places = memory_array(3 * largest, sizeof *places);
    if (made.faces == NULL || places == NULL || (mesh->texture_faces != NULL && made.texture_faces == NULL))
        status = error_memory(error, 3 * count * sizeof *made.faces);
    else
        status = cut_faces(mesh, &made, places, error);
    if (status == BAT_OK)
        status = cut_labels(mesh, &made, error);
    free(places);
    if (status == BAT_OK)
        *triangles = made;
    else
        bat_mesh_free(&made);
    return status;
}

bat_status bat_polygon_mesh_of_triangles(const bat_mesh *mesh, bat_polygon_mesh *polygons, bat_error *error)
{
    bat_mesh copy;
    bat_status status = bat_mesh_check(mesh, error);
    if (status == BAT_OK)
        status = bat_mesh_copy(mesh, &copy, error);
    if (status != BAT_OK)
        return status;
    uint32_t *offsets = polygon_offsets(mesh->face_count, 3);
    if (offsets == NULL)
    {
        bat_mesh_free(&copy);
        return error_memory(error, (mesh->face_count + 1) * sizeof *offsets);
    }
    *polygons = polygon_mesh_from_view(&copy, offsets);
    return BAT_OK;
}

/// @file
/// Clouds: memory, validity checks, and conversion of a triangle mesh with one boundary loop (a topological disk, V - E + F
/// = 1).

#include "base/error.h"
#include "mesh/check.h"
#include "mesh/hash_table.h"
#include "surface/cloud/spatial_order.h"

#include <math.h>
#include <string.h>

void bat_cloud_free(bat_cloud *cloud)
{
    free(cloud->points);
    free(cloud->order);
    free(cloud->triangles);
    *cloud = (bat_cloud){0};
}

bat_status bat_cloud_copy(const bat_cloud *cloud, bat_cloud *copy, bat_error *error)
{
    bat_cloud made = *cloud;
    bool points = mesh_copy_array(cloud->points, cloud->count, 3 * sizeof(double), (void **)&made.points);
    bool order = mesh_copy_array(cloud->order, cloud->count, sizeof(size_t), (void **)&made.order);
    bool triangles =
        mesh_copy_array(cloud->triangles, cloud->triangle_count, 3 * sizeof(uint32_t), (void **)&made.triangles);
    if (!points || !order || !triangles)
    {
        bat_cloud_free(&made);
        return error_memory(error, cloud->count * 3 * sizeof(double));
    }
    *copy = made;
    return BAT_OK;
}

static bat_status check_finite(const bat_cloud *cloud, bat_error *error)
{
    for (size_t i = 0; i < 3 * cloud->count; i++)
        if (!isfinite(cloud->points[i]))
        {
            size_t place = cloud_input_index(cloud, i / 3);
            return error_set(error, BAT_INVALID_POINT, place, 0, "point %zu is not finite", place);
        }
    return BAT_OK;
}

static bat_status check_distinct(const bat_cloud *cloud, bat_error *error)
{
    point_table table = {.points = cloud->points};
    bat_status status = BAT_OK;
    bool room = point_table_reserve(&table, cloud->count);
    for (size_t i = 0; i < cloud->count && room && status == BAT_OK; i++)
    {
        uint32_t other = point_table_find(&table, cloud->points + 3 * i);
        if (other == BAT_MESH_NONE)
        {
            room = point_table_add(&table, (uint32_t)i);
            continue;
        }
        size_t first = cloud_input_index(cloud, other), second = cloud_input_index(cloud, i);
        size_t later = first > second ? first : second;
        status = error_set(error, BAT_INVALID_POINT, later, 0, "point %zu repeats point %zu", later,
                           first > second ? second : first);
    }
    point_table_free(&table);
    return room ? status : error_memory(error, cloud->count * sizeof(uint32_t));
}

static bat_status check_boundary(const bat_cloud *cloud, bat_error *error)
{
    static const int MIN_BOUNDARY = 4;
    size_t boundary = cloud->boundary_count;
    if (boundary > 0 && boundary < MIN_BOUNDARY)
        return ERROR_ARGUMENT(error, "a boundary of %zu points cannot have four corners", boundary);
    if (boundary > cloud->count)
        return ERROR_ARGUMENT(error, "the boundary has %zu points, the cloud only %zu", boundary, cloud->count);
    for (size_t i = 0; i < 4 && cloud->has_corners; i++)
    {
        if (cloud->corners[i] >= boundary)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "corner %zu is point %zu, beyond the %zu of the boundary", i,
                             cloud->corners[i], boundary);
        if (i > 0 && cloud->corners[i] <= cloud->corners[i - 1])
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "corner %zu does not follow the corner before it", i);
    }
    return BAT_OK;
}

bat_status bat_cloud_check(const bat_cloud *cloud, bat_error *error)
{
    if (cloud->count == 0)
        return ERROR_ARGUMENT(error, "the cloud has no points");
    if (cloud->count >= BAT_MESH_NONE)
        return ERROR_TOO_LARGE(error, "the cloud has %zu points, more than %u", cloud->count, BAT_MESH_NONE - 1);
    bat_status status = check_boundary(cloud, error);
    for (size_t i = 0; i < 3 * cloud->triangle_count && status == BAT_OK; i++)
        if (cloud->triangles[i] >= cloud->count)
            status = error_set(error, BAT_INVALID_ARGUMENT, i / 3, 0, "triangle %zu names point %u, but there are %zu",
                               i / 3, cloud->triangles[i], cloud->count);
    if (status == BAT_OK)
        status = check_finite(cloud, error);
    return status == BAT_OK ? check_distinct(cloud, error) : status;
}

typedef struct mesh_patch
{
    memory_pool pool;
    const bat_mesh *mesh;
    bat_mesh_connectivity connectivity;
    uint32_t *new_number; ///< count of vertices: index in the cloud, or BAT_MESH_NONE
    size_t *order;        ///< the inverse of new_number
    size_t boundary_count, count;
} mesh_patch;

static bat_status unsupported(bat_error *error, const char *fault)
{
    bat_status status = ERROR_UNSUPPORTED(error, 0, "the mesh %s; it must be a patch with one boundary loop", fault);
    return error_remedy(error, status, "shell", "fits any shape");
}

static void number_vertex(mesh_patch *patch, uint32_t vertex)
{
    patch->new_number[vertex] = (uint32_t)patch->count;
    patch->order[patch->count++] = vertex;
}

/// Number the loop from its lowest vertex, with the faces to its left, then all other vertices with faces.
static bat_status number_vertices(mesh_patch *patch, bat_error *error)
{
    const bat_mesh_connectivity *connectivity = &patch->connectivity;
    size_t vertices = patch->mesh->vertex_count;
    if (connectivity->boundary_edge_count == 0)
        return unsupported(error, "is closed");
    memset(patch->new_number, 0xff, vertices * sizeof *patch->new_number);
    uint32_t begin = 0;
    while (connectivity->first[begin] == BAT_MESH_NONE || connectivity->twin[connectivity->first[begin]] != BAT_MESH_NONE)
        begin++;
    uint32_t vertex = begin;
    do
    {
        number_vertex(patch, vertex);
        vertex = patch->mesh->faces[bat_mesh_next(connectivity->first[vertex])];
    } while (vertex != begin);
    patch->boundary_count = patch->count;
    if (patch->boundary_count < connectivity->boundary_edge_count)
        return unsupported(error, "has several boundary loops");
    for (vertex = 0; vertex < vertices; vertex++)
        if (patch->new_number[vertex] == BAT_MESH_NONE && connectivity->first[vertex] != BAT_MESH_NONE)
            number_vertex(patch, vertex);
    return BAT_OK;
}

/// Whether the faces are connected. `waiting` is a workspace with one entry for each face.
static bool is_one_part(const bat_mesh_connectivity *connectivity, uint32_t *waiting, bool *visited)
{
    size_t top = 0, reached = 1;
    memset(visited, 0, connectivity->face_count * sizeof *visited);
    visited[0] = true;
    waiting[top++] = 0;
    while (top > 0)
    {
        uint32_t face = waiting[--top];
        for (uint32_t h = 3 * face; h < 3 * face + 3; h++)
        {
            uint32_t twin = connectivity->twin[h];
            if (twin == BAT_MESH_NONE || visited[twin / 3])
                continue;
            visited[twin / 3] = true;
            waiting[top++] = twin / 3;
            reached++;
        }
    }
    return reached == connectivity->face_count;
}

static bat_status make_cloud(mesh_patch *patch, bat_cloud *cloud, bat_error *error)
{
    const bat_mesh *mesh = patch->mesh;
    bat_cloud made = {.points = memory_array(patch->count, 3 * sizeof(double)),
                      .count = patch->count,
                      .boundary_count = patch->boundary_count,
                      .order = memory_array(patch->count, sizeof(size_t)),
                      .triangles = memory_array(mesh->face_count, 3 * sizeof(uint32_t)),
                      .triangle_count = mesh->face_count};
    if (made.points == NULL || made.order == NULL || made.triangles == NULL)
    {
        bat_cloud_free(&made);
        return error_memory(error, patch->count * 3 * sizeof(double));
    }
    for (size_t i = 0; i < made.count; i++)
    {
        made.order[i] = patch->order[i];
        memcpy(made.points + 3 * i, mesh->positions + 3 * made.order[i], 3 * sizeof(double));
    }
    for (size_t i = 0; i < 3 * mesh->face_count; i++)
        made.triangles[i] = patch->new_number[mesh->faces[i]];
    bat_status status = bat_cloud_check(&made, error);
    if (status != BAT_OK)
        bat_cloud_free(&made);
    else
        *cloud = made;
    return status;
}

bat_status bat_cloud_from_mesh(const bat_mesh *mesh, bat_cloud *cloud, bat_error *error)
{
    mesh_patch patch = {.mesh = mesh};
    if (mesh->face_count == 0)
        return ERROR_ARGUMENT(error, "the mesh has no faces");
    bat_status status = bat_mesh_connect(mesh, &patch.connectivity, error);
    if (status != BAT_OK)
        return status;
    patch.new_number = memory_pool_array(&patch.pool, mesh->vertex_count, sizeof *patch.new_number);
    patch.order = memory_pool_array(&patch.pool, mesh->vertex_count, sizeof *patch.order);
    status = memory_pool_check(&patch.pool, error);
    if (status == BAT_OK)
        status = number_vertices(&patch, error);
    if (status == BAT_OK)
    {
        const bat_mesh_connectivity *connectivity = &patch.connectivity;
        uint32_t *waiting = memory_pool_array(&patch.pool, connectivity->face_count, sizeof *waiting);
        bool *visited = memory_pool_array(&patch.pool, connectivity->face_count, sizeof *visited);
        status = memory_pool_check(&patch.pool, error);
        if (status == BAT_OK && !is_one_part(connectivity, waiting, visited))
            status = unsupported(error, "has several parts");
        // Euler's formula for a disk
        else if (status == BAT_OK && patch.count + connectivity->face_count != connectivity->edge_count + 1)
            status = unsupported(error, "has handles");
    }
    if (status == BAT_OK)
        status = make_cloud(&patch, cloud, error);
    bat_mesh_connectivity_free(&patch.connectivity);
    memory_pool_free(&patch.pool);
    return status;
}

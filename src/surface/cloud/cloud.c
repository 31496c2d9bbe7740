#include "batten/cloud.h"

#include "base/error.h"
#include "base/memory.h"
#include "mesh/point_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void bat_cloud_free(bat_cloud *cloud)
{
    free(cloud->points);
    free(cloud->order);
    free(cloud->triangles);
    *cloud = (bat_cloud){0};
}

/// A copy of an array that may be absent. False when out of memory.
static bool copy_array(const void *from, size_t count, size_t size, void **to)
{
    *to = NULL;
    if (from == NULL)
        return true;
    *to = memory_array(count, size);
    if (*to != NULL && count > 0)
        memcpy(*to, from, count * size);
    return *to != NULL;
}

bat_status bat_cloud_copy(const bat_cloud *cloud, bat_cloud *copy, bat_error *error)
{
    bat_cloud made = *cloud;
    bool points = copy_array(cloud->points, cloud->count, 3 * sizeof(double), (void **)&made.points);
    bool order = copy_array(cloud->order, cloud->count, sizeof(size_t), (void **)&made.order);
    bool triangles = copy_array(cloud->triangles, cloud->triangle_count, 3 * sizeof(uint32_t), (void **)&made.triangles);
    if (!points || !order || !triangles)
    {
        bat_cloud_free(&made);
        return error_memory(error, cloud->count * 3 * sizeof(double));
    }
    *copy = made;
    return BAT_OK;
}

/// The point's place in the input.
static size_t place_in_input(const bat_cloud *cloud, size_t point)
{
    return cloud->order != NULL ? cloud->order[point] : point;
}

static bat_status check_finite(const bat_cloud *cloud, bat_error *error)
{
    for (size_t i = 0; i < 3 * cloud->count; i++)
        if (!isfinite(cloud->points[i]))
        {
            size_t place = place_in_input(cloud, i / 3);
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
        size_t first = place_in_input(cloud, other), second = place_in_input(cloud, i);
        size_t later = first > second ? first : second;
        status = error_set(error, BAT_INVALID_POINT, later, 0, "point %zu repeats point %zu", later,
                           first > second ? second : first);
    }
    point_table_free(&table);
    return room ? status : error_memory(error, cloud->count * sizeof(uint32_t));
}

static bat_status check_boundary(const bat_cloud *cloud, bat_error *error)
{
    enum
    {
        LEAST_BOUNDARY = 4
    };
    size_t boundary = cloud->boundary_count;
    if (boundary > 0 && boundary < LEAST_BOUNDARY)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "a boundary of %zu points has no four corners",
                         boundary);
    if (boundary > cloud->count)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the boundary has %zu points, the cloud only %zu",
                         boundary, cloud->count);
    for (size_t i = 0; i < 4 && cloud->has_corners; i++)
    {
        if (cloud->corners[i] >= boundary)
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "corner %zu is point %zu, beyond the %zu of the boundary", i,
                             cloud->corners[i], boundary);
        if (i > 0 && cloud->corners[i] <= cloud->corners[i - 1])
            return error_set(error, BAT_INVALID_ARGUMENT, i, 0, "corner %zu does not come after the one before it", i);
    }
    return BAT_OK;
}

static bat_status check_triangles(const bat_cloud *cloud, bat_error *error)
{
    for (size_t i = 0; i < 3 * cloud->triangle_count; i++)
        if (cloud->triangles[i] >= cloud->count)
            return error_set(error, BAT_INVALID_ARGUMENT, i / 3, 0, "triangle %zu names point %u, but there are %zu", i / 3,
                             cloud->triangles[i], cloud->count);
    return BAT_OK;
}

bat_status bat_cloud_check(const bat_cloud *cloud, bat_error *error)
{
    if (cloud->count == 0)
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the cloud has no points");
    if (cloud->count >= BAT_MESH_NONE)
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "the cloud has %zu points, more than %u", cloud->count,
                         BAT_MESH_NONE - 1);
    bat_status status = check_boundary(cloud, error);
    if (status == BAT_OK)
        status = check_triangles(cloud, error);
    if (status == BAT_OK)
        status = check_finite(cloud, error);
    return status == BAT_OK ? check_distinct(cloud, error) : status;
}

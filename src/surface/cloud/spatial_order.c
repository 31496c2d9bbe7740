/// @file
/// Renumbering of clouds in spatial order; see spatial_order.h.

#include "surface/cloud/spatial_order.h"

#include "surface/cloud/local_plane.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

void spatial_order_free(spatial_order *order)
{
    bat_cloud_free(&order->cloud);
    neighbour_tree_free(&order->tree);
    free(order->places);
    *order = (spatial_order){0};
}

/// Number interior points in leaf order, and renumber the items of the tree. `numbers` receives the new index of each point.
static void renumber(const bat_cloud *cloud, spatial_order *order, uint32_t *numbers)
{
    size_t next = cloud->boundary_count;
    for (size_t i = 0; i < cloud->boundary_count; i++)
        order->places[i] = numbers[i] = (uint32_t)i;
    for (size_t k = 0; k < cloud->count; k++)
    {
        uint32_t *item = &order->tree.items[k];
        if (*item >= cloud->boundary_count)
        {
            order->places[next] = *item;
            numbers[*item] = (uint32_t)next++;
        }
        *item = numbers[*item];
    }
}

static void fill_cloud(const bat_cloud *from, const double *points, const spatial_order *order, const uint32_t *numbers,
                       bat_cloud *to)
{
    to->count = from->count;
    to->boundary_count = from->boundary_count;
    to->triangle_count = from->triangle_count;
    for (size_t i = 0; i < from->count; i++)
    {
        memcpy(to->points + 3 * i, points + 3 * (size_t)order->places[i], 3 * sizeof *to->points);
        to->order[i] = cloud_input_index(from, order->places[i]);
    }
    for (size_t k = 0; k < 3 * from->triangle_count; k++)
        to->triangles[k] = numbers[from->triangles[k]];
}

bat_status spatial_order_make(const bat_cloud *cloud, spatial_order *order, bat_error *error)
{
    *order = (spatial_order){.places = memory_array(cloud->count, sizeof *order->places),
                             .cloud = {.points = memory_array(cloud->count, 3 * sizeof(double)),
                                       .order = memory_array(cloud->count, sizeof(size_t)),
                                       .triangles = memory_array(cloud->triangle_count, 3 * sizeof(uint32_t))}};
    double *points = points_to_unit_size(cloud->points, cloud->count);
    uint32_t *numbers = memory_array(cloud->count, sizeof *numbers);
    bat_status status = BAT_OK;
    if (points == NULL || numbers == NULL || order->places == NULL || order->cloud.points == NULL ||
        order->cloud.order == NULL || order->cloud.triangles == NULL)
        status = error_memory(error, cloud->count * 3 * sizeof(double));
    if (status == BAT_OK)
        status = neighbour_tree_build(points, cloud->count, &order->tree, error);
    if (status == BAT_OK)
    {
        renumber(cloud, order, numbers);
        fill_cloud(cloud, points, order, numbers, &order->cloud);
    }
    else
        spatial_order_free(order);
    free(points);
    free(numbers);
    return status;
}

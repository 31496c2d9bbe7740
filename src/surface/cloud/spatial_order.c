/// @file
/// Renumbering of clouds in spatial order; see spatial_order.h.

#include "base/error.h"
#include "surface/cloud/local_plane.h"

#include <math.h>
#include <string.h>

void spatial_order_free(spatial_order *order)
{
    bat_cloud_free(&order->cloud);
    nearest_free(&order->tree);
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
        size_t *item = &order->tree.items[k];
        if (*item >= cloud->boundary_count)
        {
            order->places[next] = (uint32_t)*item;
            numbers[*item] = (uint32_t)next++;
        }
        *item = numbers[*item];
    }
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
        status = neighbours_build(points, cloud->count, &order->tree, error);
    if (status == BAT_OK)
    {
        renumber(cloud, order, numbers);
        order->cloud.count = cloud->count;
        order->cloud.boundary_count = cloud->boundary_count;
        order->cloud.triangle_count = cloud->triangle_count;
        for (size_t i = 0; i < cloud->count; i++)
        {
            memcpy(order->cloud.points + 3 * i, points + 3 * (size_t)order->places[i], 3 * sizeof *order->cloud.points);
            order->cloud.order[i] = cloud_input_index(cloud, order->places[i]);
        }
        for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
            order->cloud.triangles[k] = numbers[cloud->triangles[k]];
    }
    else
        spatial_order_free(order);
    free(points);
    free(numbers);
    return status;
}

// Canonical order

typedef struct sort_entry
{
    double squared; ///< distance from the centre
    double at[3];
    size_t item;
} sort_entry;

static int compare_entries(const void *a, const void *b)
{
    const sort_entry *p = a, *q = b;
    if (p->squared != q->squared)
        return p->squared < q->squared ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (p->at[k] != q->at[k])
            return p->at[k] < q->at[k] ? -1 : 1;
    return (p->item > q->item) - (p->item < q->item);
}

double canonical_order_key(const double point[3], const double centre[3])
{
    double x = point[0] * 0.5 - centre[0] * 0.5, y = point[1] * 0.5 - centre[1] * 0.5, z = point[2] * 0.5 - centre[2] * 0.5;
    return hypot(hypot(x, y), z);
}

bat_status canonical_order_find(const double *points, size_t count, size_t *order, bat_error *error)
{
    sort_entry *entries = memory_array(count, sizeof *entries);
    if (entries == NULL)
        return error_memory(error, count * sizeof *entries);
    const unit_frame frame = unit_frame_of(points, count);
    for (size_t i = 0; i < count; i++)
    {
        const double *at = points + 3 * i;
        entries[i] = (sort_entry){canonical_order_key(at, frame.middle), {at[0], at[1], at[2]}, i};
    }
    qsort(entries, count, sizeof *entries, compare_entries);
    for (size_t i = 0; i < count; i++)
        order[i] = entries[i].item;
    free(entries);
    return BAT_OK;
}

/// The order of the cloud's points after sorting: the loop from its first point in the canonical order, then the others.
static void arrange(const bat_cloud *cloud, const size_t *sorted, size_t *order)
{
    size_t loop = cloud->boundary_count, begin = 0, made = loop;
    bool found = cloud->has_corners || loop == 0;
    for (size_t k = 0; k < cloud->count; k++)
    {
        size_t point = sorted[k];
        if (point >= loop)
            order[made++] = point;
        else if (!found)
        {
            begin = point;
            found = true;
        }
    }
    for (size_t k = 0; k < loop; k++)
        order[k] = (begin + k) % loop;
}

bat_status cloud_permute(bat_cloud *cloud, const size_t *order, bat_error *error)
{
    size_t count = cloud->count;
    memory_pool pool = {0};
    size_t *places = memory_pool_array(&pool, count, sizeof *places);
    double *points = memory_pool_array(&pool, count, 3 * sizeof *points);
    size_t *inputs = memory_array(count, sizeof *inputs);
    bat_status status = inputs == NULL ? error_memory(error, count * sizeof *inputs) : memory_pool_check(&pool, error);
    if (status == BAT_OK)
    {
        memcpy(points, cloud->points, count * 3 * sizeof *points);
        for (size_t i = 0; i < count; i++)
        {
            memcpy(cloud->points + 3 * i, points + 3 * order[i], 3 * sizeof *points);
            places[order[i]] = i;
            inputs[i] = cloud_input_index(cloud, order[i]);
        }
        for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
            cloud->triangles[k] = (uint32_t)places[cloud->triangles[k]];
        free(cloud->order);
        cloud->order = inputs;
    }
    else
        free(inputs);
    memory_pool_free(&pool);
    return status;
}

bat_status canonical_order_apply(bat_cloud *cloud, bat_error *error)
{
    memory_pool pool = {0};
    size_t *sorted = memory_pool_array(&pool, cloud->count, sizeof *sorted);
    size_t *order = memory_pool_array(&pool, cloud->count, sizeof *order);
    bat_status status = memory_pool_check(&pool, error);
    if (status == BAT_OK)
        status = canonical_order_find(cloud->points, cloud->count, sorted, error);
    if (status == BAT_OK)
    {
        arrange(cloud, sorted, order);
        status = cloud_permute(cloud, order, error);
    }
    memory_pool_free(&pool);
    return status;
}

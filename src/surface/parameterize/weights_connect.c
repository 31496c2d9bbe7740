/// @file
/// Connection of all interior points to the boundary by chains of weights, which makes the linear system regular.

#include "surface/parameterize/weights.h"

#include "base/disjoint_sets.h"
#include "base/error.h"

#include <math.h>
#include <string.h>

#define LINKS 3 ///< links of an unconnected point

/// Points of a component are linked if their squared distance is at most this multiple of the smallest one.
static const double LINK_REACH = 4;

/// Mark the connected points, by breadth-first search from the boundary along reversed weights.
static bat_status mark_joined(const bat_cloud *cloud, const sparse_rows *rows, bool *joined, size_t *joined_count,
                              bat_error *error)
{
    sparse_rows backward = {0};
    uint32_t *queue = memory_array(cloud->count, sizeof *queue);
    bat_status status =
        queue != NULL ? sparse_rows_transpose(rows, &backward, error) : error_memory(error, cloud->count * sizeof *queue);
    size_t end = 0;
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        joined[i] = i < cloud->boundary_count;
        if (joined[i])
            queue[end++] = (uint32_t)i;
    }
    for (size_t at = 0; at < end && status == BAT_OK; at++)
        for (size_t e = backward.starts[queue[at]]; e < backward.starts[queue[at] + 1]; e++)
        {
            size_t point = cloud->boundary_count + backward.columns[e];
            if (!joined[point])
                queue[end++] = (uint32_t)point;
            joined[point] = true;
        }
    *joined_count = end;
    sparse_rows_free(&backward);
    free(queue);
    return status;
}

bat_status weights_find_unjoined(const bat_cloud *cloud, const sparse_rows *rows, size_t *point, bat_error *error)
{
    bool *joined = memory_array(cloud->count, sizeof *joined);
    if (joined == NULL)
        return error_memory(error, cloud->count);
    size_t joined_count = 0;
    bat_status status = mark_joined(cloud, rows, joined, &joined_count, error);
    *point = BAT_NO_INDEX;
    for (size_t i = 0; i < cloud->count && status == BAT_OK && *point == BAT_NO_INDEX; i++)
        if (!joined[i])
            *point = i;
    free(joined);
    return status;
}

/// The nearest connected points of every unconnected point.
typedef struct link_table
{
    memory_pool pool;
    uint32_t *points; ///< count: the unconnected points
    neighbour *links; ///< count x LINKS
    size_t count;
    size_t link_count; ///< links of each point
} link_table;

static bat_status find_links(const bat_cloud *cloud, const bool *joined, size_t joined_count, link_table *table,
                             bat_error *error)
{
    size_t count = cloud->count - joined_count, end = 0;
    *table = (link_table){.link_count = joined_count < LINKS ? joined_count : LINKS};
    table->points = memory_pool_array(&table->pool, count, sizeof *table->points);
    table->links = memory_pool_array(&table->pool, count, LINKS * sizeof *table->links);
    double *points = memory_pool_array(&table->pool, joined_count, 3 * sizeof *points);
    uint32_t *numbers = memory_pool_array(&table->pool, joined_count, sizeof *numbers);
    nearest_tree tree = {0};
    neighbour_list near = {0};
    bat_status status = memory_pool_check(&table->pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        if (joined[i])
        {
            memcpy(points + 3 * end, cloud->points + 3 * i, 3 * sizeof *points);
            numbers[end++] = (uint32_t)i;
        }
    if (status == BAT_OK)
        status = neighbours_build(points, joined_count, &tree, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
        if (!joined[i])
        {
            status = neighbours_nearest(&tree, cloud->points + 3 * i, LINKS, &near, error);
            table->points[table->count] = (uint32_t)i;
            for (size_t k = 0; k < table->link_count && status == BAT_OK; k++)
            {
                table->links[table->count * LINKS + k] = near.entries[k];
                table->links[table->count * LINKS + k].item = numbers[near.entries[k].item];
            }
            table->count++;
        }
    nearest_free(&tree);
    neighbour_list_free(&near);
    return status;
}

/// Choose the points to link: those of each component that are closest to the connected points, up to LINK_REACH.
static bat_status choose_links(const bat_cloud *cloud, const sparse_rows *rows, const bool *joined, const link_table *table,
                               bool *chosen, bat_error *error)
{
    memory_pool pool = {0};
    uint32_t *parts = memory_pool_array(&pool, cloud->count, sizeof *parts);
    double *minimum = memory_pool_array(&pool, cloud->count, sizeof *minimum);
    bat_status status = memory_pool_check(&pool, error);
    for (size_t i = 0; i < cloud->count && status == BAT_OK; i++)
    {
        parts[i] = (uint32_t)i;
        minimum[i] = INFINITY;
    }
    for (size_t k = 0; k < table->count && status == BAT_OK; k++)
    {
        size_t row = table->points[k] - cloud->boundary_count;
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++)
            if (!joined[rows->columns[e]])
                parts[sets_root(parts, rows->columns[e])] = sets_root(parts, table->points[k]);
    }
    for (size_t k = 0; k < table->count && status == BAT_OK; k++)
    {
        double *part = &minimum[sets_root(parts, table->points[k])];
        *part = fmin(*part, table->links[k * LINKS].squared);
    }
    for (size_t k = 0; k < table->count && status == BAT_OK; k++)
        chosen[k] = table->links[k * LINKS].squared <= LINK_REACH * minimum[sets_root(parts, table->points[k])];
    memory_pool_free(&pool);
    return status;
}

/// Insert the chosen links. The old weights of a linked point and its links, by inverse distance, contribute half each.
static bat_status add_links(const bat_cloud *cloud, const link_table *table, const bool *chosen, sparse_rows *rows,
                            bat_error *error)
{
    sparse_rows linked;
    size_t added = 0;
    for (size_t k = 0; k < table->count; k++)
        added += chosen[k] ? table->link_count : 0;
    bat_status status =
        sparse_rows_make(rows->row_count, rows->column_count, rows->starts[rows->row_count] + added, &linked, error);
    if (status != BAT_OK)
        return status;
    for (size_t row = 0, at = 0, k = 0; row < rows->row_count; row++)
    {
        linked.starts[row] = at;
        while (k < table->count && table->points[k] - cloud->boundary_count < row)
            k++;
        bool links = k < table->count && table->points[k] - cloud->boundary_count == row && chosen[k];
        for (size_t e = rows->starts[row]; e < rows->starts[row + 1]; e++, at++)
        {
            linked.columns[at] = rows->columns[e];
            linked.values[at] = links ? 0.5 * rows->values[e] : rows->values[e];
        }
        double sum = 0;
        for (size_t l = 0; links && l < table->link_count; l++)
            sum += 1 / sqrt(table->links[k * LINKS + l].squared);
        for (size_t l = 0; links && l < table->link_count; l++, at++)
        {
            linked.columns[at] = table->links[k * LINKS + l].item;
            linked.values[at] = 0.5 / sum / sqrt(table->links[k * LINKS + l].squared);
        }
    }
    sparse_rows_free(rows);
    *rows = linked;
    return BAT_OK;
}

bat_status weights_join(const bat_cloud *cloud, sparse_rows *rows, bat_error *error)
{
    bool *joined = memory_array(cloud->count, 2 * sizeof *joined);
    if (joined == NULL)
        return error_memory(error, 2 * cloud->count);
    bool *chosen = joined + cloud->count;
    size_t joined_count = 0;
    bat_status status = mark_joined(cloud, rows, joined, &joined_count, error);
    while (status == BAT_OK && joined_count < cloud->count)
    {
        link_table table;
        status = find_links(cloud, joined, joined_count, &table, error);
        if (status == BAT_OK)
            status = choose_links(cloud, rows, joined, &table, chosen, error);
        if (status == BAT_OK)
            status = add_links(cloud, &table, chosen, rows, error);
        if (status == BAT_OK)
            status = mark_joined(cloud, rows, joined, &joined_count, error);
        memory_pool_free(&table.pool);
    }
    free(joined);
    return status;
}

/// @file
/// Assembly of the weight matrix, in parallel; mean values; and chains of weights that connect all interior points to the
/// boundary, which makes the linear system regular. See weights.h.

#include "surface/parameterize/weights.h"

#include "base/disjoint_sets.h"
#include "base/error.h"
#include "base/threads.h"
#include "linalg/vector.h"

#include <string.h>

static const size_t CHUNK_ROWS = 512; ///< rows computed by one thread at a time

void weight_scratch_free(weight_scratch *scratch)
{
    neighbour_list_free(&scratch->near);
    free(scratch->planar);
    free(scratch->inverse);
    *scratch = (weight_scratch){0};
}

bat_status weight_scratch_reserve(weight_scratch *scratch, size_t count, bat_error *error)
{
    if (count <= scratch->capacity)
        return BAT_OK;
    size_t capacity = count + count / 2;
    free(scratch->planar);
    free(scratch->inverse);
    scratch->planar = memory_array(capacity, sizeof *scratch->planar);
    scratch->inverse = memory_array(capacity, sizeof *scratch->inverse);
    scratch->capacity = scratch->planar != NULL && scratch->inverse != NULL ? capacity : 0;
    return scratch->capacity > 0 ? BAT_OK : error_memory(error, capacity * 2 * sizeof *scratch->planar);
}

bat_status weight_chunk_reserve(weight_chunk *chunk, size_t more, bat_error *error)
{
    if (more <= chunk->capacity - chunk->count)
        return BAT_OK;
    size_t capacity = chunk->count + more + chunk->capacity;
    uint32_t *columns = realloc(chunk->columns, capacity * sizeof *columns);
    chunk->columns = columns != NULL ? columns : chunk->columns;
    double *values = realloc(chunk->values, capacity * sizeof *values);
    chunk->values = values != NULL ? values : chunk->values;
    if (columns == NULL || values == NULL)
        return error_memory(error, capacity * (sizeof *columns + sizeof *values));
    chunk->capacity = capacity;
    return BAT_OK;
}

/// Concatenate the chunks. lengths[i] is the length of row i.
static bat_status join_chunks(const weight_chunk *chunks, size_t chunk_count, size_t *lengths, size_t rows_count,
                              size_t columns_count, sparse_rows *rows, bat_error *error)
{
    size_t entries = 0;
    for (size_t c = 0; c < chunk_count; c++)
        entries += chunks[c].count;
    bat_status status = sparse_rows_make(rows_count, columns_count, entries, rows, error);
    if (status != BAT_OK)
        return status;
    for (size_t i = 0; i < rows_count; i++)
        rows->starts[i + 1] = rows->starts[i] + lengths[i];
    for (size_t c = 0, at = 0; c < chunk_count; at += chunks[c++].count)
        if (chunks[c].count > 0)
        {
            memcpy(rows->columns + at, chunks[c].columns, chunks[c].count * sizeof *rows->columns);
            memcpy(rows->values + at, chunks[c].values, chunks[c].count * sizeof *rows->values);
        }
    return BAT_OK;
}

/// Compute the chunks in parallel. Of several failures, the first in row order is reported.
static bat_status make_chunks(const weight_source *source, weight_maker *maker, int threads, size_t rows_count,
                              weight_chunk *chunks, size_t chunk_count, size_t *lengths, bat_error *error)
{
    bat_status status = BAT_OK;
    size_t failed = chunk_count;
#pragma omp parallel num_threads(threads_for(threads, chunk_count))
    {
        weight_scratch scratch = {0};
#pragma omp for schedule(dynamic, 1)
        for (size_t c = 0; c < chunk_count; c++)
        {
            bat_error own;
            size_t first = c * CHUNK_ROWS, end = first + CHUNK_ROWS < rows_count ? first + CHUNK_ROWS : rows_count;
            bat_status made = weight_chunk_reserve(&chunks[c], 8 * (end - first), &own);
            for (size_t row = first; row < end && made == BAT_OK; row++)
            {
                size_t before = chunks[c].count;
                made = maker(source, &scratch, source->cloud->boundary_count + row, &chunks[c], &own);
                lengths[row] = chunks[c].count - before;
            }
            if (made != BAT_OK)
#pragma omp critical(weights_failure)
                if (c < failed)
                {
                    failed = c;
                    status = made;
                    if (error != NULL)
                        *error = own;
                }
        }
        weight_scratch_free(&scratch);
    }
    return status;
}

bat_status weights_build(const weight_source *source, weight_maker *maker, int threads, sparse_rows *rows, bat_error *error)
{
    const bat_cloud *cloud = source->cloud;
    size_t rows_count = cloud->count - cloud->boundary_count, chunk_count = (rows_count + CHUNK_ROWS - 1) / CHUNK_ROWS;
    weight_chunk *chunks = calloc(chunk_count > 0 ? chunk_count : 1, sizeof *chunks);
    size_t *lengths = memory_array(rows_count, sizeof *lengths);
    bat_status status = chunks == NULL || lengths == NULL ? error_memory(error, rows_count * sizeof *lengths) : BAT_OK;
    if (status == BAT_OK)
        status = make_chunks(source, maker, threads, rows_count, chunks, chunk_count, lengths, error);
    if (status == BAT_OK)
        status = join_chunks(chunks, chunk_count, lengths, rows_count, cloud->count, rows, error);
    for (size_t c = 0; chunks != NULL && c < chunk_count; c++)
    {
        free(chunks[c].columns);
        free(chunks[c].values);
    }
    free(chunks);
    free(lengths);
    return status;
}

double weights_longest_side(const bat_cloud *cloud)
{
    double low[3], high[3], longest = 0;
    box_of_points(3, cloud->points, cloud->count, low, high);
    for (size_t c = 0; c < 3; c++)
        longest = fmax(longest, high[c] - low[c]);
    return longest;
}

// Mean-value weights (Floater, "Mean value coordinates", 2003):
//     w_ik = (tan(a / 2) + tan(b / 2)) / |x_i - x_k|,   normalized to sum_k w_ik = 1,
// where a and b are the angles at x_i on both sides of edge ik.

/// The contribution of a triangle to the weights of corner `at`: tan(angle / 2) / length for both adjacent edges.
static void triangle_weights(const double *points, uint32_t at, uint32_t second, uint32_t third, double added[2])
{
    double a[3], b[3], product[3];
    vector3_subtract(points + 3 * (size_t)second, points + 3 * (size_t)at, a);
    vector3_subtract(points + 3 * (size_t)third, points + 3 * (size_t)at, b);
    vector3_cross(a, b, product);
    double length_a = sqrt(vector3_dot(a, a)), length_b = sqrt(vector3_dot(b, b));
    double half_tangent = tan(0.5 * atan2(sqrt(vector3_dot(product, product)), vector3_dot(a, b)));
    added[0] = half_tangent / length_a;
    added[1] = half_tangent / length_b;
}

/// Add to the entry of a column in a row that ends at *end; append the entry if there is none.
static void add_entry(sparse_rows *rows, size_t start, size_t *end, uint32_t column, double value)
{
    size_t e = start;
    while (e < *end && rows->columns[e] != column)
        e++;
    if (e == *end)
    {
        rows->columns[(*end)++] = column;
        rows->values[e] = 0;
    }
    rows->values[e] += value;
}

/// Compact the rows, and scale each to sum 1.
static bat_status finish_rows(const bat_cloud *cloud, const size_t *ends, sparse_rows *rows, bat_error *error)
{
    size_t at = 0;
    for (size_t row = 0; row < rows->row_count; row++)
    {
        size_t start = rows->starts[row];
        double sum = 0;
        for (size_t e = start; e < ends[row]; e++)
            sum += rows->values[e];
        if (!(sum > 0 && isfinite(sum)))
        {
            size_t place = cloud_input_index(cloud, cloud->boundary_count + row);
            return error_set(error, BAT_NO_CONVERGENCE, place, 0, "all triangles of point %zu are degenerate", place);
        }
        rows->starts[row] = at;
        for (size_t e = start; e < ends[row]; e++)
        {
            // Only degenerate triangles have weight 0.
            if (rows->values[e] == 0)
                continue;
            rows->columns[at] = rows->columns[e];
            rows->values[at++] = rows->values[e] / sum;
        }
    }
    rows->starts[rows->row_count] = at;
    return BAT_OK;
}

static void add_triangles(const bat_cloud *cloud, size_t *ends, sparse_rows *rows)
{
    for (size_t t = 0; t < cloud->triangle_count; t++)
        for (size_t c = 0; c < 3; c++)
        {
            const uint32_t *triangle = cloud->triangles + 3 * t;
            uint32_t at = triangle[c], second = triangle[(c + 1) % 3], third = triangle[(c + 2) % 3];
            if (at < cloud->boundary_count)
                continue;
            size_t row = at - cloud->boundary_count;
            double added[2];
            triangle_weights(cloud->points, at, second, third, added);
            add_entry(rows, rows->starts[row], &ends[row], second, added[0]);
            add_entry(rows, rows->starts[row], &ends[row], third, added[1]);
        }
}

bat_status weights_of_triangles(const bat_cloud *cloud, sparse_rows *rows, bat_error *error)
{
    size_t count = cloud->count - cloud->boundary_count, entries = 0;
    size_t *ends = memory_array(count, sizeof *ends);
    if (ends == NULL)
        return error_memory(error, count * sizeof *ends);
    // A point has up to two entries for each of its triangles.
    for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
        entries += cloud->triangles[k] >= cloud->boundary_count ? 2 : 0;
    bat_status status = sparse_rows_make(count, cloud->count, entries, rows, error);
    if (status == BAT_OK)
    {
        memset(rows->starts, 0, (count + 1) * sizeof *rows->starts);
        for (size_t k = 0; k < 3 * cloud->triangle_count; k++)
            if (cloud->triangles[k] >= cloud->boundary_count)
                rows->starts[cloud->triangles[k] - cloud->boundary_count + 1] += 2;
        for (size_t row = 0; row < count; row++)
            rows->starts[row + 1] += rows->starts[row];
        memcpy(ends, rows->starts, count * sizeof *ends);
        add_triangles(cloud, ends, rows);
        status = finish_rows(cloud, ends, rows, error);
        if (status != BAT_OK)
            sparse_rows_free(rows);
    }
    free(ends);
    return status;
}

// Connection to the boundary

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

/// Connect all points to the boundary: those without a chain of weights to their nearest connected neighbours.
static bat_status weights_join(const bat_cloud *cloud, sparse_rows *rows, bat_error *error)
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

bat_status weights_make(const bat_cloud *cloud, const nearest_tree *tree, const bat_cloud_parameterize_options *options,
                        sparse_rows *rows, bat_error *error)
{
    weight_source source = {
        .cloud = cloud, .tree = tree, .method = options->method, .radius = options->radius * weights_longest_side(cloud)};
    bool star = options->method == BAT_CLOUD_PARAMETERIZATION_SHAPE_PRESERVING ||
                options->method == BAT_CLOUD_PARAMETERIZATION_STRETCH_MINIMIZING ||
                options->method == BAT_CLOUD_PARAMETERIZATION_ISOMETRIC;
    bat_status status =
        options->method == BAT_CLOUD_PARAMETERIZATION_MEAN_VALUE
            ? weights_of_triangles(cloud, rows, error)
            : weights_build(&source, star ? weights_of_star : weights_of_nearest, options->threads, rows, error);
    return status == BAT_OK ? weights_join(cloud, rows, error) : status;
}

// Uniform weights w_ik = 1 / n and inverse-distance weights w_ik = |x_i - x_k|^-1 / sum_j |x_i - x_j|^-1.

static const int NEAREST = 16; ///< number of nearest neighbours without a given radius

/// Append the weights of the neighbours in the list, without the point itself.
static bat_status append_neighbours(const weight_source *source, const neighbour_list *near, size_t point,
                                    weight_chunk *chunk, bat_error *error)
{
    bat_status status = weight_chunk_reserve(chunk, near->count, error);
    if (status != BAT_OK)
        return status;
    size_t first = chunk->count;
    double sum = 0;
    for (size_t k = 0; k < near->count; k++)
    {
        const neighbour *entry = &near->entries[k];
        if (entry->item == point)
            continue;
        double weight = source->method == BAT_CLOUD_PARAMETERIZATION_UNIFORM ? 1 : 1 / sqrt(entry->squared);
        chunk->columns[chunk->count] = entry->item;
        chunk->values[chunk->count++] = weight;
        sum += weight;
    }
    for (size_t e = first; e < chunk->count; e++)
        chunk->values[e] /= sum;
    return BAT_OK;
}

bat_status weights_of_ball(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                           bat_error *error)
{
    bat_status status =
        neighbours_within(source->tree, source->cloud->points + 3 * point, source->radius, &scratch->near, error);
    if (status != BAT_OK)
        return status;
    size_t place = cloud_input_index(source->cloud, point);
    if (scratch->near.count < 2)
        return error_set(error, BAT_NO_CONVERGENCE, place, 0, "point %zu has no neighbour within the radius", place);
    return append_neighbours(source, &scratch->near, point, chunk, error);
}

bat_status weights_of_nearest(const weight_source *source, weight_scratch *scratch, size_t point, weight_chunk *chunk,
                              bat_error *error)
{
    const double *place = source->cloud->points + 3 * point;
    bat_status status = BAT_OK;
    scratch->near.count = 0;
    if (source->radius > 0)
        status = neighbours_within(source->tree, place, source->radius, &scratch->near, error);
    if (status == BAT_OK && scratch->near.count <= NEAREST)
        status = neighbours_nearest(source->tree, place, NEAREST + 1, &scratch->near, error);
    return status == BAT_OK ? append_neighbours(source, &scratch->near, point, chunk, error) : status;
}

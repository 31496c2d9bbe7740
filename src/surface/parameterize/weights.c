/// @file
/// Parallel assembly of the weight matrix; see weights.h.

#include "surface/parameterize/weights.h"

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

static bat_status make_chunk(const weight_source *source, weight_maker *maker, size_t first, size_t end,
                             weight_scratch *scratch, weight_chunk *chunk, size_t *lengths, bat_error *error)
{
    bat_status status = weight_chunk_reserve(chunk, 8 * (end - first), error);
    for (size_t row = first; row < end && status == BAT_OK; row++)
    {
        size_t before = chunk->count;
        status = maker(source, scratch, source->cloud->boundary_count + row, chunk, error);
        lengths[row] = chunk->count - before;
    }
    return status;
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
            bat_status made = make_chunk(source, maker, first, end, &scratch, &chunks[c], lengths, &own);
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

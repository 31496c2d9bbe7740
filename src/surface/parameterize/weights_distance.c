/// @file
/// Uniform weights w_ik = 1 / n and inverse-distance weights w_ik = |x_i - x_k|^-1 / sum_j |x_i - x_j|^-1.

#include "surface/parameterize/weights.h"

#include "base/error.h"

#include <math.h>

enum
{
    NEAREST = 16 ///< number of nearest neighbours without a given radius
};

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

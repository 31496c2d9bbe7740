#include "models/surface_cloud.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

void sampled_cloud_free(sampled_cloud *sampled)
{
    free(sampled->cloud.points);
    free(sampled->parameters);
    *sampled = (sampled_cloud){0};
}

/// The number of points, if they and all sizes made of it can be counted.
static bool count_points(const size_t sides[2], size_t interior, size_t *count)
{
    const size_t most = SIZE_MAX / (16 * sizeof(double));
    if (sides[0] > most / 4 || sides[1] > most / 4 || interior > most)
        return false;
    *count = interior + 2 * (sides[0] - 1) + 2 * (sides[1] - 1);
    return true;
}

bat_status sampled_cloud_make(const size_t sides[2], size_t interior, sampled_cloud *sampled, bat_error *error)
{
    size_t count, across = sides[0] - 1, up = sides[1] - 1;
    if (!count_points(sides, interior, &count))
        return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0,
                         "a cloud cannot have %zu points inside and sides of %zu and %zu", interior, sides[0], sides[1]);
    sampled_cloud made = {.cloud = {.points = memory_array(count, 3 * sizeof(double)),
                                    .count = count,
                                    .boundary_count = count - interior,
                                    .corners = {0, across, across + up, 2 * across + up},
                                    .has_corners = true},
                          .parameters = memory_array(count, 2 * sizeof(double))};
    if (made.cloud.points == NULL || made.parameters == NULL)
    {
        sampled_cloud_free(&made);
        return error_memory(error, count * 3 * sizeof(double));
    }
    *sampled = made;
    return BAT_OK;
}

void sampled_cloud_give(sampled_cloud *sampled, bat_cloud *cloud, double **parameters)
{
    *cloud = sampled->cloud;
    if (parameters != NULL)
        *parameters = sampled->parameters;
    else
        free(sampled->parameters);
    *sampled = (sampled_cloud){0};
}

void cloud_add_noise(bat_cloud *cloud, double deviation, bat_random *random)
{
    for (size_t i = 0; i < 3 * cloud->count; i++)
        cloud->points[i] += deviation * bat_random_normal(random);
}

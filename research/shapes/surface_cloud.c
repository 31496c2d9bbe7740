#include "research/shapes/surface_cloud.h"

#include "base/error.h"
#include "base/memory.h"

#include <stdlib.h>

void sampled_cloud_free(sampled_cloud *sampled)
{
    free(sampled->cloud.points);
    free(sampled->parameters);
    *sampled = (sampled_cloud){0};
}

bat_status sampled_cloud_make(const size_t steps[4], size_t interior, sampled_cloud *sampled, bat_error *error)
{
    const size_t most = SIZE_MAX / (16 * sizeof(double)) / 8;
    bat_cloud cloud = {.has_corners = true};
    for (int s = 0; s < 4; s++)
    {
        if (steps[s] > most || interior > most)
            return error_set(error, BAT_TOO_LARGE, BAT_NO_INDEX, 0, "a cloud of so many points cannot be counted");
        cloud.corners[s] = cloud.boundary_count;
        cloud.boundary_count += steps[s];
    }
    cloud.count = cloud.boundary_count + interior;
    cloud.points = memory_array(cloud.count, 3 * sizeof(double));
    sampled_cloud made = {.cloud = cloud, .parameters = memory_array(cloud.count, 2 * sizeof(double))};
    if (made.cloud.points == NULL || made.parameters == NULL)
    {
        sampled_cloud_free(&made);
        return error_memory(error, cloud.count * 3 * sizeof(double));
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

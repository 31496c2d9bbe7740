/// @file
/// Models that parameterize clouds: reading them, and scaling clouds to the unit box.

#include "surface/network/chart_network.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/cloud_parameterize.h"
#include "learn/weights.h"
#include "mesh/measure/unit_box.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct bat_surface_model
{
    learn_model base;
};

static const learn_network *const NETWORKS[] = {&surface_network_batten};
const learn_networks surface_networks = {NETWORKS, 1, &weights_surface};

bat_status surface_model_read(const learn_networks *networks, const char *path, bat_surface_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status == BAT_OK)
        *model = (bat_surface_model *)read;
    return status;
}

bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error)
{
    return surface_model_read(&surface_networks, path, model, error);
}

void bat_surface_model_free(bat_surface_model *model)
{
    learn_model_free((learn_model *)model);
}

bat_status bat_surface_model_parameterize(const bat_surface_model *model, const bat_cloud *cloud, const double *boundary,
                                          int threads, double *parameters, bat_error *error)
{
    bat_status status = bat_cloud_check(cloud, error);
    if (status != BAT_OK)
        return status;
    bat_cloud boxed = *cloud;
    unit_box box = unit_box_of(cloud->points, cloud->count);
    if (!isfinite(box.size))
        return error_set(error, BAT_INVALID_ARGUMENT, BAT_NO_INDEX, 0, "the size of the cloud is not finite");
    boxed.points = memory_array(cloud->count, 3 * sizeof *boxed.points);
    if (boxed.points == NULL)
        return error_memory(error, cloud->count * 3 * sizeof *boxed.points);
    for (size_t i = 0; i < 3 * cloud->count; i++)
        boxed.points[i] = unit_box_in(&box, i, cloud->points[i]);
    memcpy(parameters, boundary, 2 * cloud->boundary_count * sizeof *parameters);
    const surface_rule *rule = model->base.kind->rule;
    status = rule->infer(model->base.network, &boxed, boundary, threads, parameters + 2 * cloud->boundary_count, error);
    free(boxed.points);
    return status;
}

/// @file
/// Models that parameterize clouds: the table of network kinds, reading weights, and scaling clouds to the unit box.

#include "surface/network/model.h"

#include "base/error.h"
#include "base/memory.h"
#include "batten/cloud_parameterize.h"
#include "curve/network/tension_weights.h"
#include "learn/safetensors.h"
#include "learn/weights.h"
#include "mesh/measure/unit_box.h"
#include "surface/network/bidgcn.h"
#include "surface/network/chart_network.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct bat_surface_model
{
    const surface_network_kind *kind;
    void *network;
};

/// Extract the weights of a kind from a file; from a checkpoint, the best weights so far.
static bat_status extract_weights(const safetensors *content, const surface_network_kind *kind, bat_surface_model *model,
                                  bat_error *error)
{
    learn_parameters parameters = {0};
    const char *prefix = "";
    bat_status status = kind->make(&parameters, error);
    if (status == BAT_OK)
        (void)tension_weights_prefix(content, parameters.list[0].name, &prefix);
    if (status == BAT_OK)
        status = learn_parameters_extract(&parameters, content, prefix, parameters.values, error);
    model->kind = kind;
    if (status == BAT_OK)
        status = kind->make_network(&parameters, &model->network, error);
    learn_parameters_free(&parameters);
    return status;
}

/// Make the model that a file's content holds.
static bat_status make_model(const safetensors *content, bat_surface_model **model, bat_error *error)
{
    const char *recipe = safetensors_find_note(content, "recipe");
    const surface_network_kind *kind = surface_network_kind_by_name(recipe);
    bat_surface_model *made = calloc(1, sizeof *made);
    bat_status status = BAT_OK;
    if (made == NULL)
        status = error_memory(error, sizeof *made);
    else if (kind == NULL)
        status = error_set(error, BAT_BAD_FILE, BAT_NO_INDEX, 0,
                           "the file contains no network for surfaces; its recipe is '%.60s'", recipe != NULL ? recipe : "");
    else
        status = extract_weights(content, kind, made, error);
    if (status == BAT_OK)
        *model = made;
    else
        bat_surface_model_free(made);
    return status;
}

bat_status bat_surface_model_read(const char *path, bat_surface_model **model, bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    status = make_model(&content, model, error);
    safetensors_free(&content);
    return status;
}

bat_status bat_surface_model_builtin(bat_surface_model **model, bat_error *error)
{
    return make_model(&weights_surface, model, error);
}

void bat_surface_model_free(bat_surface_model *model)
{
    if (model == NULL)
        return;
    if (model->kind != NULL)
        model->kind->free_network(model->network);
    free(model);
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
    status = model->kind->infer(model->network, &boxed, boundary, threads, parameters + 2 * cloud->boundary_count, error);
    free(boxed.points);
    return status;
}

static const surface_network_kind *const KINDS[] = {&surface_network_published, &surface_network_uninformed,
                                                    &surface_network_batten};
enum
{
    KIND_COUNT = sizeof KINDS / sizeof *KINDS
};

const surface_network_kind *surface_network_kind_by_name(const char *recipe)
{
    static const char PREFIX[] = "surface ";
    if (recipe == NULL || strncmp(recipe, PREFIX, sizeof PREFIX - 1) != 0)
        return NULL;
    recipe += sizeof PREFIX - 1;
    size_t length = strcspn(recipe, ",");
    for (size_t i = 0; i < KIND_COUNT; i++)
        if (strlen(KINDS[i]->name) == length && strncmp(KINDS[i]->name, recipe, length) == 0)
            return KINDS[i];
    return NULL;
}

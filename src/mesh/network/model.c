#include "batten/mesh_refine.h"

#include "base/error.h"
#include "base/memory.h"
#include "curve/network/tension_weights.h"
#include "learn/safetensors.h"
#include "learn/weights.h"
#include "mesh/measure/unit_box.h"
#include "mesh/network/inference.h"
#include "mesh/network/learned_rule.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// Networks as bat_mesh_rule, with weights from a file or built in: batten's, and the published one, which is applied in the
/// unit box of the coarse mesh.

enum
{
    /// The number of levels in the published training.
    PUBLISHED_LEVELS = 2
};

struct bat_mesh_model
{
    bat_mesh_rule rule;
    mesh_inference published; ///< or:
    mesh_learned learned;
};

static bat_status published_refine(const bat_mesh_rule *rule, const bat_mesh *coarse,
                                   const bat_mesh_connectivity *connectivity, size_t levels,
                                   const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                                   bat_error *error)
{
    const bat_mesh_model *model = rule->context;
    int threads = options->threads;
    unit_box box = unit_box_of(coarse->positions, coarse->vertex_count);
    mesh_levels all;
    bat_status status = mesh_levels_make(coarse->faces, connectivity, levels, threads, &all, error);
    if (status != BAT_OK)
        return status;
    real *from = memory_array(coarse->vertex_count, 3 * sizeof *from), *to = memory_array(all.vertex_count, 3 * sizeof *to);
    if (from == NULL || to == NULL)
        status = error_memory(error, all.vertex_count * 3 * sizeof *to);
    for (size_t i = 0; i < 3 * coarse->vertex_count && status == BAT_OK; i++)
        from[i] = (real)unit_box_in(&box, i, coarse->positions[i]);
    if (status == BAT_OK)
        status = mesh_inference_refine(&model->published, &all, threads, from, to, fallback, error);
    for (size_t i = 0; i < 3 * all.vertex_count && status == BAT_OK; i++)
        fine->positions[i] = unit_box_out(&box, i, (double)to[i]);
    free(from);
    free(to);
    mesh_levels_free(&all);
    return status;
}

static bat_status learned_refine(const bat_mesh_rule *rule, const bat_mesh *coarse,
                                 const bat_mesh_connectivity *connectivity, size_t levels,
                                 const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback, bat_error *error)
{
    const bat_mesh_model *model = rule->context;
    return mesh_learned_rule(&model->learned, coarse, connectivity, levels, options, fine, fallback, error);
}

// Reading

/// The form of the network in a file, from its notes and shapes.
static mesh_network_form form_of(const safetensors *content, const char *prefix)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%snet_init.layerIn.weight", prefix);
    const safetensors_array *first = safetensors_find(content, name);
    const char *recipe = safetensors_find_note(content, "recipe");
    return (mesh_network_form){
        .fixed_frames = recipe != NULL && strstr(recipe, MESH_NETWORK_FIXED) != NULL,
        .relative = recipe != NULL && strstr(recipe, MESH_NETWORK_RELATIVE) != NULL,
        .no_differences = first != NULL && first->rank == 2 && first->shape[1] == FLAP_EDGES,
    };
}

static bat_status take_published(const safetensors *content, const char *prefix, bat_mesh_model *model, bat_error *error)
{
    learn_parameters parameters = {0};
    mesh_network_form form = form_of(content, prefix);
    bat_status status = mesh_network_make(form, &parameters, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(&parameters, content, prefix, parameters.values, error);
    if (status == BAT_OK)
        status = mesh_inference_make(&parameters, form, &model->published, error);
    learn_parameters_free(&parameters);
    model->rule = (bat_mesh_rule){.levels = PUBLISHED_LEVELS, .context = model, .refine = published_refine};
    return status;
}

static bat_status take_learned(const safetensors *content, const char *prefix, bat_mesh_model *model, bat_error *error)
{
    learn_parameters parameters = {0};
    bat_status status = mesh_learned_make(&parameters, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(&parameters, content, prefix, parameters.values, error);
    if (status == BAT_OK)
        status = mesh_learned_pack(&parameters, &model->learned, error);
    learn_parameters_free(&parameters);
    model->rule = (bat_mesh_rule){.levels = LEARNED_LEVELS_OF_MESH, .context = model, .refine = learned_refine};
    return status;
}

/// Make the model that a file's content holds.
static bat_status model_of(const safetensors *content, bat_mesh_model **model, bat_error *error)
{
    const char *prefix;
    bool learned = tension_weights_prefix(content, LEARNED_FIRST_NAME, &prefix);
    if (!learned)
        (void)tension_weights_prefix(content, "net_init.layerIn.weight", &prefix);
    bat_mesh_model *made = calloc(1, sizeof *made);
    bat_status status = BAT_OK;
    if (made == NULL)
        status = error_memory(error, sizeof *made);
    else
        status = (learned ? take_learned : take_published)(content, prefix, made, error);
    if (status == BAT_OK)
        *model = made;
    else
        bat_mesh_model_free(made);
    return status;
}

bat_status bat_mesh_model_read(const char *path, bat_mesh_model **model, bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    status = model_of(&content, model, error);
    safetensors_free(&content);
    return status;
}

bat_status bat_mesh_model_builtin(bat_mesh_model **model, bat_error *error)
{
    return model_of(&weights_mesh, model, error);
}

void bat_mesh_model_free(bat_mesh_model *model)
{
    if (model == NULL)
        return;
    mesh_inference_free(&model->published);
    mesh_learned_free(&model->learned);
    free(model);
}

const bat_mesh_rule *bat_mesh_model_rule(const bat_mesh_model *model)
{
    return &model->rule;
}

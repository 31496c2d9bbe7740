#include "batten/research/networks.h"

#include "base/error.h"
#include "base/memory.h"
#include "learn/weights.h"
#include "mesh/measure/unit_box.h"
#include "mesh/network/learned_network.h"
#include "research/networks/mesh_inference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// @file
/// The published network as a bat_mesh_rule. It is applied in the unit box of the coarse mesh.

enum
{
    /// The number of levels in the published training.
    PUBLISHED_LEVELS = 2
};

static const char FIRST_ARRAY[] = "net_init.layerIn.weight";

static bat_status refine(const bat_mesh_rule *rule, const bat_mesh *coarse, const bat_mesh_connectivity *connectivity,
                         size_t levels, const bat_mesh_refine_options *options, bat_mesh *fine, size_t *fallback,
                         bat_error *error)
{
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
        status = mesh_inference_refine(rule->context, &all, threads, from, to, fallback, error);
    for (size_t i = 0; i < 3 * all.vertex_count && status == BAT_OK; i++)
        fine->positions[i] = box.low[i % 3] + box.size * (double)to[i];
    free(from);
    free(to);
    mesh_levels_free(&all);
    return status;
}

static const bat_mesh_rule RULE = {.levels = PUBLISHED_LEVELS, .refine = refine};

/// The form of the network in a file, from its notes and shapes.
static mesh_network_form form_of(const learn_source *source)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s%s", source->prefix, FIRST_ARRAY);
    const safetensors_array *first = safetensors_find(source->content, name);
    const char *recipe = safetensors_find_note(source->content, "recipe");
    return (mesh_network_form){
        .fixed_frames = recipe != NULL && strstr(recipe, MESH_NETWORK_FIXED) != NULL,
        .relative = recipe != NULL && strstr(recipe, MESH_NETWORK_RELATIVE) != NULL,
        .no_differences = first != NULL && first->rank == 2 && first->shape[1] == FLAP_EDGES,
    };
}

static bat_status make(const learn_source *source, learn_parameters *parameters, bat_error *error)
{
    return mesh_network_make(form_of(source), parameters, error);
}

static bat_status pack(const learn_source *source, const learn_parameters *parameters, void **network, bat_error *error)
{
    mesh_inference *made = malloc(sizeof *made);
    bat_status status =
        made == NULL ? error_memory(error, sizeof *made) : mesh_inference_make(parameters, form_of(source), made, error);
    if (status == BAT_OK)
        *network = made;
    else
        free(made);
    return status;
}

static void release(void *network)
{
    if (network != NULL)
        mesh_inference_free(network);
    free(network);
}

static const learn_network PUBLISHED = {FIRST_ARRAY, NULL, &RULE, make, pack, release};

bat_status bat_mesh_model_read_published(const char *path, bat_mesh_model **model, bat_error *error)
{
    static const learn_network *const ALL[] = {&mesh_network_learned, &PUBLISHED};
    const learn_networks networks = {ALL, 2, &weights_mesh};
    return mesh_model_read(&networks, path, model, error);
}

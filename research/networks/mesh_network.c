#include "research/networks/mesh_network.h"

#include <assert.h>
#include <stdio.h>

/// @file
/// Names and shapes of the parameters, as in the published program.

static void add_layer(learn_parameters *parameters, size_t inputs, const char *module, const char *layer)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s.%s.weight", module, layer);
    (void)learn_parameters_add(parameters, MESH_WIDTH, inputs, name);
    (void)snprintf(name, sizeof name, "%s.%s.bias", module, layer);
    (void)learn_parameters_add(parameters, 0, MESH_WIDTH, name);
}

bat_status mesh_network_make(mesh_network_form form, learn_parameters *parameters, bat_error *error)
{
    static const char *const modules[MESH_MODULE_COUNT] = {"net_init", "net_edge", "net_vertex"};
    for (int m = 0; m < MESH_MODULE_COUNT; m++)
    {
        size_t state = m != MESH_MODULE_INIT ? MESH_WIDTH : form.no_differences ? 3 : 6;
        add_layer(parameters, 4 * state - 3, modules[m], "layerIn");
        add_layer(parameters, MESH_WIDTH, modules[m], "hidden.0");
        add_layer(parameters, MESH_WIDTH, modules[m], "layerOut");
    }
    bat_status status = learn_parameters_allocate(parameters, error);
    if (status != BAT_OK)
        learn_parameters_free(parameters);
    assert(status != BAT_OK || parameters->count == MESH_PARAMETERS);
    assert(status != BAT_OK || form.no_differences || parameters->total == MESH_WEIGHTS);
    return status;
}

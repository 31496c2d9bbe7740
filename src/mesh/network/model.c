#include "batten/mesh_refine.h"

#include "learn/weights.h"
#include "mesh/network/learned_rule.h"

struct bat_mesh_model
{
    learn_model network;
    bat_mesh_rule rule;
};

static const learn_network *const NETWORKS[] = {&mesh_network_learned};
const learn_networks mesh_networks = {NETWORKS, 1, &weights_mesh};

bat_status mesh_model_read(const learn_networks *networks, const char *path, bat_mesh_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status != BAT_OK)
        return status;
    *model = (bat_mesh_model *)read;
    (*model)->rule = *(const bat_mesh_rule *)read->kind->rule;
    (*model)->rule.context = read->network;
    return BAT_OK;
}

bat_status bat_mesh_model_read(const char *path, bat_mesh_model **model, bat_error *error)
{
    return mesh_model_read(&mesh_networks, path, model, error);
}

void bat_mesh_model_free(bat_mesh_model *model)
{
    learn_model_free((learn_model *)model);
}

const bat_mesh_rule *bat_mesh_model_rule(const bat_mesh_model *model)
{
    return &model->rule;
}

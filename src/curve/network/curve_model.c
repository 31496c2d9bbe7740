#include "batten/curve_scheme.h"

#include "base/choice.h"
#include "curve/network/learned_rule.h"
#include "learn/weights.h"

struct bat_curve_model
{
    learn_model network;
    bat_curve_angle_rule rule;
    bool has_fairness;
};

static const learn_network *const NETWORKS[] = {&curve_network_learned};
const learn_networks curve_networks = {NETWORKS, 1, &weights_learned};

bat_status curve_model_read(const learn_networks *networks, const char *path, bat_curve_model **model, bat_error *error)
{
    learn_model *read = NULL;
    bat_status status = learn_model_read(networks, path, sizeof **model, &read, error);
    if (status != BAT_OK)
        return status;
    *model = (bat_curve_model *)read;
    (*model)->rule = *(const bat_curve_angle_rule *)read->kind->rule;
    (*model)->rule.parameters = read->network;
    (*model)->has_fairness = read->kind == &curve_network_learned;
    return BAT_OK;
}

bat_status bat_curve_model_read(const char *path, bat_curve_model **model, bat_error *error)
{
    return curve_model_read(&curve_networks, path, model, error);
}

static const bat_choice MODELS[] = {
    {.name = "learned", .summary = "the curve scheme that comes with the library, 134,720 weights; weights/batten.md"},
};
const bat_family bat_curve_model_family = FAMILY("curve model", MODELS);

bool bat_curve_model_has_fairness(const bat_curve_model *model)
{
    return model->has_fairness;
}

void bat_curve_model_free(bat_curve_model *model)
{
    learn_model_free((learn_model *)model);
}

bat_curve_scheme bat_curve_scheme_of_model(const bat_curve_model *model)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle_rule(&model->rule);
    scheme.fairness = 0.25;
    return scheme;
}

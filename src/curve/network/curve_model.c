#include "batten/curve_scheme.h"

#include "base/choice.h"
#include "base/error.h"
#include "curve/network/learned_network.h"
#include "curve/network/learned_rule.h"
#include "curve/network/tension_inference.h"
#include "curve/network/tension_weights.h"
#include "learn/weights.h"
#include "space/known.h"

#include <stdlib.h>
#include <string.h>

struct bat_curve_model
{
    bat_curve_angle_rule rule;
    tension_inference published; ///< empty where the weights are those of the library's own recipe
    learn_parameters fairing;    ///< empty where they are not
};

/// One call's memory.
typedef struct model_run
{
    _Alignas(64) real scratch[TENSION_INFERENCE_SCRATCH];
    real features[(BAT_CURVE_ANGLE_RULE_EDGES + LEARN_TILE) * TENSION_FEATURES];
} model_run;

/// Eq. (17) without the curvature. The product with 1 / mean is that of the training.
static void published_features(const bat_curve_angle_rule_view *view, real *features)
{
    const double inverse_pi = 0.31830988618379067154, inverse_mean = 1 / view->mean_length;
    const double *angles = view->angles, *lengths = view->lengths;
    for (ptrdiff_t j = 0; j < (ptrdiff_t)view->count; j++, features += TENSION_FEATURES)
    {
        for (ptrdiff_t i = 0; i < 4; i++)
            features[i] = (real)(angles[j - 1 + i] * inverse_pi);
        features[4] = (real)(lengths[j] * inverse_mean);
        features[5] = (real)(lengths[j + 1] * inverse_mean);
    }
}

/// The network's angles are positive to the left, as eq. (9) prints them.
static void learned_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                           void *scratch)
{
    const bat_curve_model *model = rule->parameters;
    model_run *run = scratch;
    int curvature = 0;
    (void)space_is_surface(view->space, &curvature);
    published_features(view, run->features);
    tension_inference_angles(&model->published, (size_t)((ptrdiff_t)curvature + 1), view->count, run->features, angles,
                             run->scratch);
}

static bat_status take_published(const safetensors *content, bat_curve_model *model, bat_error *error)
{
    learn_parameters parameters;
    tension_embedding embedding;
    bat_status status = tension_weights_take(content, &parameters, &embedding, error);
    if (status != BAT_OK)
        return status;
    status = tension_inference_make(&parameters, &model->published, error);
    learn_parameters_free(&parameters);
    model->rule = (bat_curve_angle_rule){
        .name = "learned",
        .reach = 2,
        .wants_mean_length = true,
        .scratch_size = sizeof(model_run),
        .parameters = model,
        .fault = learned_rule_fault,
        .angles = learned_angles,
    };
    return status;
}

static bat_status take_fairing(const safetensors *content, const char *prefix, bat_curve_model *model, bat_error *error)
{
    bat_status status = learned_network_make(&model->fairing, error);
    if (status == BAT_OK)
        status = learn_parameters_extract(&model->fairing, content, prefix, model->fairing.values, error);
    model->rule = learned_rule(model->fairing.values);
    return status;
}

static bat_status take_weights(const safetensors *content, bat_curve_model *model, bat_error *error)
{
    const char *prefix;
    if (tension_weights_prefix(content, "layer.0.kept", &prefix))
        return take_fairing(content, prefix, model, error);
    return take_published(content, model, error);
}

/// Make the model that a file's content holds.
static bat_status model_of(const safetensors *content, bat_curve_model **model, bat_error *error)
{
    bat_curve_model *made = calloc(1, sizeof *made);
    bat_status status = made != NULL ? take_weights(content, made, error) : error_memory(error, sizeof *made);
    if (status == BAT_OK)
        *model = made;
    else
        bat_curve_model_free(made);
    return status;
}

bat_status bat_curve_model_read(const char *path, bat_curve_model **model, bat_error *error)
{
    safetensors content;
    bat_status status = safetensors_read(path, &content, error);
    if (status != BAT_OK)
        return status;
    status = model_of(&content, model, error);
    safetensors_free(&content);
    return status;
}

static const bat_choice MODELS[] = {
    {.name = "learned", .summary = "the curve scheme that comes with the library, 134,144 weights; weights/batten.md"},
    {.name = "learned-published",
     .summary = "the network of Ugail and Howard (2026), 140,505 weights, to compare with; weights/tension-published.md"},
};
const bat_family bat_curve_model_family = FAMILY("curve model", MODELS);

bat_status bat_curve_model_builtin(bat_curve_model **model, bat_error *error)
{
    return model_of(&weights_learned, model, error);
}

bat_status bat_curve_model_published(bat_curve_model **model, bat_error *error)
{
    return model_of(&weights_published, model, error);
}

bool bat_curve_model_has_fairness(const bat_curve_model *model)
{
    return model->fairing.values != NULL;
}

void bat_curve_model_free(bat_curve_model *model)
{
    if (model == NULL)
        return;
    tension_inference_free(&model->published);
    learn_parameters_free(&model->fairing);
    free(model);
}

bat_curve_scheme bat_curve_scheme_of_model(const bat_curve_model *model)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle_rule(&model->rule);
    scheme.fairness = 0.5;
    return scheme;
}

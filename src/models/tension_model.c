#include "batten/tension_model.h"

#include "base/error.h"
#include "models/tension_inference.h"
#include "models/tension_weights.h"
#include "space/known.h"

#include <stdlib.h>

struct bat_tension_model
{
    bat_angle_rule rule;
    tension_inference network;
};

/// One call's memory.
typedef struct model_run
{
    _Alignas(64) real scratch[TENSION_INFERENCE_SCRATCH];
    real features[(BAT_ANGLE_RULE_EDGES + LEARN_TILE) * TENSION_FEATURES];
} model_run;

static const char *fault(const bat_angle_rule *rule, const bat_space *space)
{
    (void)rule;
    bool known = space_is_plane(space) || space_is_sphere(space) || space_is_disk(space);
    return known ? NULL : "the network knows the plane, the sphere and the disk";
}

/// Eq. (17) without the curvature. The product with 1 / mean is that of the training.
static void published_features(const bat_angle_rule_view *view, real *features)
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
static void learned_angles(const bat_angle_rule *rule, const bat_angle_rule_view *view, double *angles, void *scratch)
{
    const bat_tension_model *model = rule->parameters;
    model_run *run = scratch;
    size_t curvature_and_one = space_is_disk(view->space) ? 0 : space_is_plane(view->space) ? 1 : 2;
    published_features(view, run->features);
    tension_inference_angles(&model->network, curvature_and_one, view->count, run->features, angles, run->scratch);
}

static bat_status take_weights(const char *path, tension_inference *network, bat_error *error)
{
    learn_parameters parameters;
    bat_tension_embedding embedding;
    bat_status status = tension_weights_read(path, &parameters, &embedding, error);
    if (status != BAT_OK)
        return status;
    status = tension_inference_make(&parameters, network, error);
    learn_parameters_free(&parameters);
    return status;
}

bat_status bat_tension_model_read(const char *path, bat_tension_model **model, bat_error *error)
{
    bat_tension_model *made = calloc(1, sizeof *made);
    bat_status status = made != NULL ? take_weights(path, &made->network, error) : error_memory(error, sizeof *made);
    if (status != BAT_OK)
    {
        free(made);
        return status;
    }
    made->rule = (bat_angle_rule){
        .name = "learned",
        .reach = 2,
        .wants_mean_length = true,
        .scratch_size = sizeof(model_run),
        .parameters = made,
        .fault = fault,
        .angles = learned_angles,
    };
    *model = made;
    return BAT_OK;
}

void bat_tension_model_free(bat_tension_model *model)
{
    if (model == NULL)
        return;
    tension_inference_free(&model->network);
    free(model);
}

bat_scheme bat_scheme_learned(const bat_tension_model *model)
{
    return bat_scheme_angle_rule(&model->rule);
}

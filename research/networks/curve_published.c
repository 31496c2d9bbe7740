#include "batten/research/networks.h"

#include "base/error.h"
#include "curve/network/learned_network.h"
#include "research/networks/tension_inference.h"
#include "research/networks/weights.h"
#include "space/builtin.h"

#include <stdio.h>
#include <stdlib.h>

/// @file
/// The published network as a bat_curve_angle_rule.

static const char FIRST_ARRAY[] = "input_proj.0.weight";

/// One call's memory.
typedef struct run
{
    _Alignas(64) real scratch[TENSION_INFERENCE_SCRATCH];
    real features[(BAT_CURVE_ANGLE_RULE_EDGES + LEARN_TILE) * TENSION_FEATURES];
} run;

/// Eq. (17) without the curvature. The product with 1 / mean is that of the training.
static void compute_features(const bat_curve_angle_rule_view *view, real *features)
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
static void insertion_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *angles,
                             void *scratch)
{
    run *memory = scratch;
    int curvature = 0;
    (void)space_is_surface(view->space, &curvature);
    compute_features(view, memory->features);
    tension_inference_angles(rule->parameters, (size_t)((ptrdiff_t)curvature + 1), view->count, memory->features, angles,
                             memory->scratch);
}

static const bat_curve_angle_rule RULE = {
    .name = "learned",
    .reach = 2,
    .wants_mean_length = true,
    .scratch_size = sizeof(run),
    .fault = learned_rule_fault,
    .angles = insertion_angles,
};

/// Which of the networks of table 3 a file holds shows in its first layer.
static bat_status make(const learn_source *source, learn_parameters *parameters, bat_error *error)
{
    char name[LEARN_NAME_SIZE];
    (void)snprintf(name, sizeof name, "%s%s", source->prefix, FIRST_ARRAY);
    const safetensors_array *first = safetensors_find(source->content, name);
    size_t inputs = first != NULL && first->rank == 2 ? first->shape[1] : 0;
    tension_embedding embedding = inputs == TENSION_FEATURES                    ? TENSION_NO_SPACE
                                  : inputs == TENSION_FEATURES + TENSION_SPACES ? TENSION_ONE_HOT
                                                                                : TENSION_EMBEDDED;
    return tension_network_make_embedded(embedding, parameters, error);
}

static bat_status pack(const learn_source *source, const learn_parameters *parameters, void **network, bat_error *error)
{
    (void)source;
    tension_inference *made = malloc(sizeof *made);
    bat_status status = made == NULL ? error_memory(error, sizeof *made) : tension_inference_make(parameters, made, error);
    if (status == BAT_OK)
        *network = made;
    else
        free(made);
    return status;
}

static void release(void *network)
{
    if (network != NULL)
        tension_inference_free(network);
    free(network);
}

static const learn_network PUBLISHED = {FIRST_ARRAY, NULL, &RULE, make, pack, release};

bat_status bat_curve_model_read_published(const char *path, bat_curve_model **model, bat_error *error)
{
    static const learn_network *const ALL[] = {&curve_network_learned, &PUBLISHED};
    const learn_networks networks = {ALL, 2, &weights_published};
    return curve_model_read(&networks, path, model, error);
}

// The weights themselves

/// As plain numbers, for those who look into the network.
static bat_status keep(const learn_source *source, const learn_parameters *parameters, void **network, bat_error *error)
{
    learn_parameters *kept = calloc(1, sizeof *kept);
    if (kept == NULL)
        return error_memory(error, sizeof *kept);
    bat_status status = make(source, kept, error);
    if (status == BAT_OK)
        memcpy(kept->values, parameters->values, parameters->total * sizeof *kept->values);
    if (status == BAT_OK)
        *network = kept;
    else
        free(kept);
    return status;
}

bat_status tension_network_read(const char *path, learn_parameters *parameters, bat_error *error)
{
    static const learn_network PLAIN = {FIRST_ARRAY, NULL, NULL, make, keep, free};
    static const learn_network *const ALL[] = {&PLAIN};
    const learn_networks networks = {ALL, 1, &weights_published};
    learn_model *model = NULL;
    bat_status status = learn_model_read(&networks, path, sizeof *model, &model, error);
    if (status == BAT_OK)
        *parameters = *(learn_parameters *)model->network;
    learn_model_free(model);
    return status;
}

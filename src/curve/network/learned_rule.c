#include "curve/network/learned_rule.h"

#include "batten/curve_scheme.h"
#include "curve/network/learned_inference.h"
#include "learn/weights.h"
#include "space/builtin.h"

#include <math.h>
#include <stdlib.h>

const char *learned_rule_fault(const bat_curve_angle_rule *rule, const bat_space *space)
{
    (void)rule;
    int curvature;
    return space_is_surface(space, &curvature) ? NULL : "the network knows the plane, the sphere and the disk";
}

static void angles_by(const real *weights, const bat_curve_angle_rule_view *view, double *chosen, void *scratch)
{
    int curvature = 0;
    (void)space_is_surface(view->space, &curvature);
    bool even = view->first % 2 == 0;
    learned_setting setting = {.curvature = curvature,
                               .fairness = view->fairness,
                               .level = (double)view->level,
                               .parity = view->level == 0 ? 0
                                         : even           ? 1
                                                          : -1};
    learned_inference_angles(weights, view->count, view->angles, view->lengths, setting, chosen, scratch);
}

static void shipped_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *chosen,
                           void *scratch)
{
    (void)rule;
    angles_by(weights_learned.arrays[0].values, view, chosen, scratch);
}

static void given_angles(const bat_curve_angle_rule *rule, const bat_curve_angle_rule_view *view, double *chosen,
                         void *scratch)
{
    angles_by(rule->parameters, view, chosen, scratch);
}

static const bat_curve_angle_rule SHIPPED = {
    .name = "learned",
    .reach = LEARNED_RANGE,
    .levels = LEARNED_LEVELS,
    .scratch_size = sizeof(learned_scratch),
    .fault = learned_rule_fault,
    .angles = shipped_angles,
};

static const bat_curve_angle_rule GIVEN = {
    .name = "learned",
    .reach = LEARNED_RANGE,
    .levels = LEARNED_LEVELS,
    .scratch_size = sizeof(learned_scratch),
    .fault = learned_rule_fault,
    .angles = given_angles,
};

bat_curve_angle_rule learned_rule(const real *weights)
{
    bat_curve_angle_rule rule = GIVEN;
    rule.parameters = weights;
    return rule;
}

static bat_status make(const learn_source *source, learn_parameters *parameters, bat_error *error)
{
    (void)source;
    return learned_network_make(parameters, error);
}

const learn_network curve_network_learned = {
    .array = "layer.0.kept",
    .rule = &GIVEN,
    .make = make,
    .pack = learn_model_copy,
    .free = free,
};

bat_curve_scheme bat_curve_scheme_learned(double fairness)
{
    bat_curve_scheme scheme = bat_curve_scheme_angle_rule(&SHIPPED);
    scheme.fairness = fairness;
    return scheme;
}

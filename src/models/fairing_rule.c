#include "models/fairing_rule.h"

#include "batten/tension_model.h"
#include "models/fairing_inference.h"
#include "models/weights.h"
#include "space/known.h"

#include <math.h>

const char *fairing_rule_fault(const bat_angle_rule *rule, const bat_space *space)
{
    (void)rule;
    int curvature;
    return space_is_surface(space, &curvature) ? NULL : "the network knows the plane, the sphere and the disk";
}

static void angles(const bat_angle_rule *rule, const bat_angle_rule_view *view, double *chosen, void *scratch)
{
    int curvature = 0;
    (void)space_is_surface(view->space, &curvature);
    fairing_inference_angles(rule->parameters, view->count, view->angles, view->lengths, curvature, view->fairness, chosen,
                             scratch);
}

static const bat_angle_rule SHIPPED = {
    .name = "learned",
    .reach = FAIRING_REACH,
    .scratch_size = sizeof(fairing_scratch),
    .parameters = &weights_fairing,
    .fault = fairing_rule_fault,
    .angles = angles,
};

bat_angle_rule fairing_rule(const real *weights)
{
    bat_angle_rule rule = SHIPPED;
    rule.parameters = weights;
    return rule;
}

bat_scheme bat_scheme_learned(double fairness)
{
    bat_scheme scheme = bat_scheme_angle_rule(&SHIPPED);
    scheme.fairness = isnan(fairness) ? 0.5 : fmin(fmax(fairness, 0), 1);
    return scheme;
}

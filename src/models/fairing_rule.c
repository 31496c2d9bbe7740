#include "models/fairing_rule.h"

#include "batten/tension_model.h"
#include "models/fairing_inference.h"
#include "models/weights.h"
#include "space/known.h"

#include <math.h>

static const char *fault(const bat_angle_rule *rule, const bat_space *space)
{
    (void)rule;
    bool known = space_is_plane(space) || space_is_sphere(space) || space_is_disk(space);
    return known ? NULL : "the network knows the plane, the sphere and the disk";
}

static void angles(const bat_angle_rule *rule, const bat_angle_rule_view *view, double *chosen, void *scratch)
{
    double curvature = space_is_disk(view->space) ? -1 : space_is_plane(view->space) ? 0 : 1;
    fairing_inference_angles(rule->parameters, view->count, view->angles, view->lengths, curvature, view->fairness, chosen,
                             scratch);
}

static const bat_angle_rule SHIPPED = {
    .name = "learned",
    .reach = FAIRING_REACH,
    .scratch_size = sizeof(fairing_scratch),
    .parameters = &weights_fairing,
    .fault = fault,
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

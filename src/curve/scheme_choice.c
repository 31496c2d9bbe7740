#include "batten/curve.h"

#include "base/choice.h"
#include "curve/plan.h"
#include "space/builtin.h"

bat_curve_scheme bat_curve_scheme_for(const bat_space *space, const char **name)
{
    int curvature;
    const char *chosen = space_is_euclidean(space) ? "four-point" : "log-exp-4";
    if (space_is_surface(space, &curvature))
        chosen = "learned";
    else if (space->exterior_angle != NULL && space->apex != NULL)
        chosen = "angle-4";
    bat_curve_scheme scheme = {.kind = BAT_CURVE_SCHEME_KIND_AUTO};
    (void)bat_curve_scheme_by_name(chosen, &scheme, NULL);
    if (name != NULL)
        *name = chosen;
    return scheme;
}

static const bat_choice END_RULES[] = {
    {.name = "auto", .summary = "point reflection", .value = BAT_CURVE_END_RULE_AUTO, .use = BAT_CHOICE_USE_UNNAMED},
    {.name = "reflect", .summary = "point reflection in the end point", .value = BAT_CURVE_END_RULE_REFLECT},
    {.name = "extrapolate",
     .summary = "the extrapolation that keeps what the scheme reproduces",
     .value = BAT_CURVE_END_RULE_EXTRAPOLATE},
    {.name = "free", .summary = "none: the curve shrinks; linear schemes", .value = BAT_CURVE_END_RULE_FREE},
};
const bat_family bat_curve_end_rule_family = FAMILY("end rule", END_RULES);

static const bat_choice SIMPLE_CHOICES[] = {
    {.name = "auto", .summary = "closed curves", .value = BAT_CURVE_SIMPLE_AUTO, .use = BAT_CHOICE_USE_UNNAMED},
    {.name = "rings", .summary = "closed curves that are simple when they come in", .value = BAT_CURVE_SIMPLE_RINGS},
    {.name = "always",
     .summary = "open and closed curves that are simple when they come in",
     .value = BAT_CURVE_SIMPLE_ALWAYS},
    {.name = "never", .summary = "no test", .value = BAT_CURVE_SIMPLE_NEVER},
};
const bat_family bat_curve_simple_family = FAMILY("choice of simple curves", SIMPLE_CHOICES);

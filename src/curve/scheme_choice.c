#include "batten/curve.h"

#include "base/choice.h"
#include "curve/plan.h"
#include "space/known.h"

#include <stdint.h>

/// The most new points for which the learned scheme is chosen. It takes about a microsecond a point, and curves that are
/// dense already come out alike by every scheme.
static const size_t LEARNED_POINTS = 1000000;

bat_curve_scheme bat_curve_scheme_for(const bat_space *space, size_t new_points, const char **name)
{
    int curvature;
    const char *chosen = space_is_euclidean(space) ? "four-point" : "log-exp-4";
    if (space_is_surface(space, &curvature) && new_points <= LEARNED_POINTS)
        chosen = "learned";
    else if (space->exterior_angle != NULL && space->apex != NULL)
        chosen = "angle-4";
    bat_curve_scheme scheme = {.kind = BAT_CURVE_SCHEME_AUTO};
    (void)bat_curve_scheme_by_name(chosen, &scheme, NULL);
    if (name != NULL)
        *name = chosen;
    return scheme;
}

size_t curves_new_points(const bat_curve *curves, size_t count, size_t levels)
{
    size_t points = 0;
    for (size_t i = 0; i < count; i++)
        points = curves[i].count <= SIZE_MAX - points ? points + curves[i].count : SIZE_MAX;
    bool fits = levels < 8 * sizeof(size_t) && points <= SIZE_MAX >> levels;
    return fits ? points << levels : SIZE_MAX;
}

bat_curve_scheme bat_curves_scheme(const bat_curve *curves, size_t count, const bat_curve_refine_options *options,
                                   const char **name)
{
    const bat_curve_refine_options defaults = bat_curve_refine_defaults();
    options = options != NULL ? options : &defaults;
    if (name != NULL)
        *name = NULL;
    if (options->scheme.kind != BAT_CURVE_SCHEME_AUTO || count == 0)
        return options->scheme;
    return bat_curve_scheme_for(curves[0].space, curves_new_points(curves, count, options->levels), name);
}

static const bat_choice END_RULES[] = {
    {.name = "reflect", .summary = "point reflection in the end point", .value = BAT_CURVE_END_REFLECT},
    {.name = "extrapolate",
     .summary = "the extrapolation that keeps what the scheme reproduces",
     .value = BAT_CURVE_END_EXTRAPOLATE},
    {.name = "free", .summary = "none: the curve shrinks; linear schemes", .value = BAT_CURVE_END_FREE},
};
static const choice_table END_TABLE = CHOICE_TABLE("end rule", END_RULES);

CHOICE_FUNCTIONS(bat_curve_end_rule, END_TABLE, 0)

static const bat_choice SIMPLE_CHOICES[] = {
    {.name = "rings", .summary = "closed curves that are simple when they come in", .value = BAT_CURVE_SIMPLE_RINGS},
    {.name = "always",
     .summary = "open and closed curves that are simple when they come in",
     .value = BAT_CURVE_SIMPLE_ALWAYS},
    {.name = "never", .summary = "no test", .value = BAT_CURVE_SIMPLE_NEVER},
};
static const choice_table SIMPLE_TABLE = CHOICE_TABLE("choice of simple curves", SIMPLE_CHOICES);

CHOICE_FUNCTIONS(bat_curve_simple, SIMPLE_TABLE, 0)

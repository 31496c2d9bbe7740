#ifndef TESTS_SUPPORT_REFINE_HELPERS_H
#define TESTS_SUPPORT_REFINE_HELPERS_H

// Schemes by name, and refinement that must succeed.

#include "check.h"

#include "batten/curve.h"

static const double PI = 3.14159265358979323846;

static inline bat_curve_scheme scheme(const char *name)
{
    bat_curve_scheme result;
    bat_error error;
    if (bat_curve_scheme_by_name(name, &result, &error) != BAT_OK)
        fail_msg("%s: %s", name, error.text);
    return result;
}

static inline bat_curve_refine_options options(const char *name, size_t levels)
{
    bat_curve_refine_options result = bat_curve_refine_defaults();
    result.scheme = scheme(name);
    result.levels = levels;
    return result;
}

static inline bat_curve refined(const bat_curve *coarse, const bat_curve_refine_options *how)
{
    bat_curve fine = {0};
    bat_error error;
    if (bat_curve_refine(coarse, how, &fine, &error) != BAT_OK)
        fail_msg("%s", error.text);
    return fine;
}

#endif

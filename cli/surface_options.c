#include "surface_options.h"

#include <stdlib.h>

enum
{
    MAX_FUNCTIONS = 100000000,
    MAX_ROUNDS = 1000
};

const option_spec SURFACE_FIT_OPTIONS[] = {
    {"tolerance", "T", METHOD, COMMON, "refine where points are farther off than this, in their units",
     POSITIVE(bat_surface_fit_options, tolerance)},
    {"functions", "N", METHOD, COMMON,
     "the maximum number of functions, which is that of control points; default: as many as bring held-out points nearer",
     WHOLE(bat_surface_fit_options, functions, 1, MAX_FUNCTIONS)},
    {"degree", "P[,Q]", METHOD, COMMON, "of the spline in its two directions, 1 to 15; default 3", NO_FIELD},
    {"share", "S", METHOD, 0, "stop when this share of the points is within the tolerance; default 1",
     NUMBER(bat_surface_fit_options, share)},
    {"iterations", "N", METHOD, 0, "the maximum number of refinements; default 30",
     WHOLE(bat_surface_fit_options, iterations, 0, MAX_ROUNDS)},
    {"smoothing", "WEIGHT", METHOD, 0, "of the thin plate; default: found by likelihood, or by --noise",
     NUMBER(bat_surface_fit_options, weight)},
    {"noise", "D", METHOD, 0, "standard deviation of a coordinate, where it is known",
     NUMBER(bat_surface_fit_options, noise)},
    {"robust", NULL, METHOD, COMMON, "points far off count less", FLAG(bat_surface_fit_options, robust)},
    {"corrections", "N", METHOD, 0,
     "rounds that move parameters to the nearest place of the surface, after each fit; default 1",
     WHOLE(bat_surface_fit_options, corrections, 0, MAX_ROUNDS)},
    {"final-corrections", "N", METHOD, 0, "the same after the last refinement; default 0",
     WHOLE(bat_surface_fit_options, final_corrections, 0, MAX_ROUNDS)},
    END_OF_OPTIONS,
};

const option_spec SURFACE_WRITE_OPTIONS[] = {
    {"unit", "UNIT", RESULT, 0, "{}: what STEP and IGES name as the unit of the coordinates; default mm",
     CHOICE(bat_surface_write_options, unit, bat_surface_unit_family)},
    {"samples", "N", RESULT, 0, "of each cell and direction, for VTK and OBJ; default: the degree plus 1",
     WHOLE(bat_surface_write_options, samples, 1, MAX_ROUNDS)},
    {"to", "FORMAT", RESULT, 0, "the format of OUT; default: by its ending",
     CHOICE(bat_surface_write_options, format, bat_surface_format_family)},
    END_OF_OPTIONS,
};

static bool read_degrees(const arguments *given, int degree[2])
{
    const char *text = argument(given, "degree");
    if (text == NULL)
        return true;
    char *end;
    long first = strtol(text, &end, 10), second = first;
    bool good = end != text;
    if (good && *end == ',')
    {
        text = end + 1;
        second = strtol(text, &end, 10);
        good = end != text;
    }
    good = good && *end == '\0' && first >= 1 && first <= BAT_SPLINE_MAX_DEGREE && second >= 1 &&
           second <= BAT_SPLINE_MAX_DEGREE;
    degree[0] = (int)first;
    degree[1] = (int)second;
    return good || argument_refused(given, "degree", "a number from 1 to %d, or two as in 3,2", BAT_SPLINE_MAX_DEGREE);
}

bool surface_check_fit(const arguments *given, bat_surface_fit_options *fit)
{
    bat_error error;
    if (argument(given, "smoothing") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    else if (argument(given, "noise") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_NOISE;
    if (!read_degrees(given, fit->space.degree) ||
        !usage_accepts(given, bat_options_check(&bat_surface_fit_fields, fit, &error), &error))
        return false;
    if (argument(given, "noise") != NULL && argument(given, "smoothing") != NULL)
        (void)usage_error(given, "--noise and --smoothing exclude each other");
    else if (argument(given, "share") != NULL && argument(given, "tolerance") == NULL)
        (void)usage_error(given, "--share needs --tolerance");
    else
        return true;
    return false;
}

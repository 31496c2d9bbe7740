#include "surface_options.h"

#include <stdlib.h>

enum
{
    MAX_FUNCTIONS = 100000000,
    MAX_ROUNDS = 1000
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
    if (!good)
        (void)usage_error(given, "--degree takes a number from 1 to %d, or two like 3,2, not '%s'", BAT_SPLINE_MAX_DEGREE,
                          argument(given, "degree"));
    degree[0] = (int)first;
    degree[1] = (int)second;
    return good;
}

static bool read_smoothing(const arguments *given, bat_surface_fit_options *fit)
{
    if (!argument_number(given, "smoothing", fit->weight, &fit->weight) ||
        !argument_number(given, "noise", fit->noise, &fit->noise))
        return false;
    if (argument(given, "smoothing") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_GIVEN;
    else if (argument(given, "noise") != NULL)
        fit->smoothing = BAT_SURFACE_SMOOTHING_NOISE;
    return true;
}

bool surface_read_fit(const arguments *given, bat_surface_fit_options *fit)
{
    long functions, iterations, corrections, final_corrections;
    if (!read_degrees(given, fit->space.degree) || !argument_number(given, "tolerance", fit->tolerance, &fit->tolerance) ||
        !argument_number(given, "share", fit->share, &fit->share) || !read_smoothing(given, fit) ||
        !argument_whole(given, "functions", 1, MAX_FUNCTIONS, (long)fit->functions, &functions) ||
        !argument_whole(given, "iterations", 0, MAX_ROUNDS, fit->iterations, &iterations) ||
        !argument_whole(given, "corrections", 0, MAX_ROUNDS, fit->corrections, &corrections) ||
        !argument_whole(given, "final-corrections", 0, MAX_ROUNDS, fit->final_corrections, &final_corrections) ||
        !argument_threads(given, &fit->threads))
        return false;
    fit->functions = (size_t)functions;
    fit->iterations = (int)iterations;
    fit->corrections = (int)corrections;
    fit->final_corrections = (int)final_corrections;
    fit->robust = argument_flag(given, "robust");
    bat_error error;
    if (bat_surface_fit_options_check(fit, &error) == BAT_OK)
        return true;
    (void)usage_error(given, "%s", error.text);
    return false;
}

#pragma once

#include "batten/base.h"

/// @file
/// Kinds of inputs for the search for harm.

/// Make a random input, run the default and the rival, and divide the error of the first by that of the second.
/// @param variant which of the family
/// @return the failure of the default; BAT_NO_MEMORY also of the rest
typedef bat_status harm_case(bat_random *random, int variant, double *ratio, bat_error *error);

/// A kind of input.
typedef struct harm_kind
{
    const char *system, *name, *rival;
    harm_case *run;
    int variant;
} harm_kind;

/// The kinds of curves and motions, those of meshes and clouds, and those of maps.
extern const harm_kind HARM_LINES[], HARM_SURFACES[], HARM_MAPS[];
extern const size_t HARM_LINE_COUNT, HARM_SURFACE_COUNT, HARM_MAP_COUNT;

/// A number between two others.
static inline double harm_between(bat_random *random, double low, double high)
{
    return low + (high - low) * bat_random_uniform(random);
}

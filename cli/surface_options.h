#ifndef CLI_SURFACE_OPTIONS_H
#define CLI_SURFACE_OPTIONS_H

#include "arguments.h"

#include "batten/surface_fit.h"

/// @file
/// The options of a fit of a surface, which two programs have.

/// Read --degree, --tolerance, --share, --smoothing, --noise, --functions, --iterations, --corrections,
/// --final-corrections, --threads and --robust. False after a message.
bool surface_read_fit(const arguments *given, bat_surface_fit_options *fit);

#endif

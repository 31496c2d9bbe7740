#ifndef CLI_SURFACE_OPTIONS_H
#define CLI_SURFACE_OPTIONS_H

#include "arguments.h"

#include "batten/surface_file.h"
#include "batten/surface_fit.h"

/// @file
/// The options of a fit of a surface, which two programs have.

/// Options for a bat_surface_fit_options, and for a bat_surface_write_options.
extern const option_spec SURFACE_FIT_OPTIONS[], SURFACE_WRITE_OPTIONS[];

/// Read what no row reads, and check the options of the fit. False after a message.
bool surface_check_fit(const arguments *given, bat_surface_fit_options *fit);

#endif

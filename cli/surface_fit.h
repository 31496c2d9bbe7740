#ifndef CLI_SURFACE_FIT_H
#define CLI_SURFACE_FIT_H

#include "arguments.h"

#include "batten/batten.h"

#include <jansson.h>

/// @file
/// The options of a fit of a surface, and its report, which two programs have.

/// Options for a bat_surface_fit_options, and for a bat_surface_write_options.
extern const option_spec SURFACE_FIT_OPTIONS[], SURFACE_WRITE_OPTIONS[];

/// Read what no row reads, and check the options of the fit. False after a message.
bool surface_check_fit(const arguments *given, bat_surface_fit_options *fit);

/// What is reported on.
typedef struct surface_findings
{
    const char *input;
    const bat_cloud *cloud;
    const bat_surface_reconstruct_options *options;
    const bat_surface_result *result;
} surface_findings;

/// Whether a surface is right, or what is wrong, in a few words.
const char *surface_verdict(const bat_surface_verdict *verdict);
/// Print the report and return null, or return it as an object, which is null where memory ran out.
json_t *surface_report(const surface_findings *findings, bool as_json);

#endif

#ifndef CLI_SURFACE_REPORT_H
#define CLI_SURFACE_REPORT_H

#include "batten/batten.h"

#include <jansson.h>

/// @file
/// The report of `batten surface`.

/// What is reported on.
typedef struct surface_findings
{
    const char *input;
    const bat_cloud *cloud;
    const bat_surface_reconstruct_options *options;
    const bat_surface_result *result;
} surface_findings;

/// Why these parameters were chosen, in a few words.
void surface_report_reason(const surface_findings *findings, char *text, size_t size);

/// Whether a surface is right, or what is wrong, in a few words.
const char *surface_report_verdict(const bat_surface_verdict *verdict);

void surface_report_print(const surface_findings *findings);
json_t *surface_report_json(const surface_findings *findings);

#endif

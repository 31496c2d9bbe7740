#ifndef CLI_ANALYZE_H
#define CLI_ANALYZE_H

#include "batten/curve_analysis.h"

#include <jansson.h>
#include <stdio.h>

/// What `batten analyze SCHEME --sweep NAME=A:B` found.
typedef struct analyze_sweep
{
    const char *parameter;
    size_t smoothness;
    const bat_mask_interval *intervals;
    size_t count;
} analyze_sweep;

/// Print an analysis as a page to read.
void analyze_report(FILE *out, const char *scheme, const bat_analysis *analysis);
void analyze_report_sweep(FILE *out, const char *scheme, const analyze_sweep *sweep);

/// The same as JSON objects for report_json(); null when out of memory.
json_t *analyze_json(const char *scheme, const bat_analysis *analysis);
json_t *analyze_sweep_json(const char *scheme, const analyze_sweep *sweep);

#endif
